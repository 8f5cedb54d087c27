//! The Snakemake workflow of docs/many-rigs gives what one run of `host study` gives, to the bit.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;
use tests::image::workspace;
use tests::lab::Lab;
use tests::program;
use tests::python::python;

/// The version that the workflow is tried with.
const SNAKEMAKE: &str = "snakemake==9.27.1";

/// Runs the workflow with so many parts on two jobs at a time; gives its table.
fn by_workflow(snakemake: &Path, lab: &Lab, n_parts: usize) -> String {
    let out = format!("out-{n_parts}");
    let program = program::path().display();
    let mut command = Command::new(snakemake);
    command.arg("--snakefile").arg(workspace().join("docs/many-rigs/Snakefile"));
    command.args(["--cores", "2", "--config", "folder=.", &format!("parts={n_parts}"), &format!("out={out}")]);
    command.arg(format!("host={program}")).env("XDG_CACHE_HOME", lab.at(".cache")).current_dir(lab.folder());
    let output = command.output().expect("snakemake runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(lab.at(&format!("{out}/study.html"))).expect("a page");
    assert!(page.contains("3 rigs, 60 recordings"), "{}", page.len());
    let joined = std::fs::read_to_string(lab.at(&format!("{out}/study.txt"))).expect("what was said");
    assert!(joined.contains("60 recordings, 0 of them studied now"), "{joined}");
    std::fs::read_to_string(lab.at(&format!("{out}/study.csv"))).expect("a table")
}

#[test]
#[ignore = "installs Snakemake from PyPI: tests/more many-rigs"]
fn the_workflow_gives_what_one_run_gives_whatever_the_parts() {
    let snakemake = python(&[SNAKEMAKE]).with_file_name("snakemake");
    let lab = Lab::with(3, 20);
    lab.json("--database one.sqlite");
    let one = lab.table("one.sqlite");
    std::fs::remove_file(lab.at("table.csv")).unwrap();
    assert_eq!(one.lines().count(), 61);
    for n_parts in [2, 5] {
        assert!(by_workflow(&snakemake, &lab, n_parts) == one, "{n_parts} parts");
    }
}

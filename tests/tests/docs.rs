//! The documents say what the program does: pages made from the code are up to date, and every code block works.
#![cfg(target_os = "linux")]

use host::recording::{ReadOptions, read};
use host::rigfile::RigFile;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::device::Device;
use tests::program::{PATIENT, host, path};
use tests::protocol_page;

/// Pages with code blocks, each run by a test of its own.
const PAGES: [&str; 25] = [
    "README.md",
    "docs/add-a-board.md",
    "docs/add-an-effect.md",
    "docs/add-a-sensor.md",
    "docs/board-checks.md",
    "docs/board-emulator.md",
    "docs/calibration.md",
    "docs/constants.md",
    "docs/decisions.md",
    "docs/diagnosis.md",
    "docs/performance.md",
    "docs/real.md",
    "docs/effects.md",
    "docs/files.md",
    "docs/fitting.md",
    "docs/instruction-counts.md",
    "docs/many-rigs.md",
    "docs/paper.md",
    "docs/physics.md",
    "docs/promises.md",
    "docs/protocol.md",
    "docs/fmu.md",
    "docs/matlab.md",
    "docs/python.md",
    "docs/python-package.md",
];

/// What stands for `cargo` while a page is run: its aliases, with the program that is built already.
const CARGO: &str = r#"
cargo() {
    case "$1 ${2-}" in
        "host serve") shift; served "$@" ;;
        "host "*) shift; host "$@" ;;
        "run --release") shift 5; host "$@" ;;
        "firmware "*) grep -q '^firmware = ' "$REPOSITORY/.cargo/config.toml" ;;
        *) echo "a page says: cargo $*" >&2; return 1 ;;
    esac
}

# The page is served, without a browser and on any free port, until its address is printed; then Ctrl-C ends it cleanly.
served() {
    coproc SERVER { exec host "$@" --no-open --listen 127.0.0.1:0; }
    local server=$SERVER_PID address
    read -r address <&"${SERVER[0]}"
    [[ "$address" == http://127.0.0.1:* ]]
    kill -INT "$server"
    wait "$server"
}
"#;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

fn written(page: &str) -> String {
    std::fs::read_to_string(repository().join(page)).unwrap()
}

/// Compares a page with what it should be; with UPDATE_DOCS=1 it is written instead.
fn check_made(page: &str, made: &str) {
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(repository().join(page), made).unwrap();
    }
    assert!(written(page) == made, "{page} is out of date; run: UPDATE_DOCS=1 cargo test -p tests --test docs");
}

#[test]
fn the_page_of_effects_is_up_to_date() {
    check_made("docs/effects.md", &host(Path::new("."), "effects --markdown").stdout);
}

#[test]
fn the_page_of_the_protocol_is_up_to_date() {
    check_made("docs/protocol.md", &protocol_page::page());
}

#[test]
fn the_book_lists_every_page() {
    let summary = written("docs/SUMMARY.md");
    let listed = |page: &str| summary.contains(&format!("({})", page.trim_start_matches("docs/")));
    let pages = std::fs::read_dir(repository().join("docs")).unwrap().flatten();
    let names = pages.map(|page| page.file_name().into_string().unwrap());
    for name in names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md") {
        let page = format!("docs/{name}");
        assert!(listed(&page), "{page} is not in SUMMARY.md");
        assert!(PAGES.contains(&page.as_str()) || page == "docs/wiring.md", "{page} is not run by a test");
    }
}

#[test]
fn every_link_between_pages_leads_somewhere() {
    for page in PAGES.into_iter().chain(["docs/SUMMARY.md", "docs/wiring.md", "CONTRIBUTING.md", "ARCHITECTURE.md"]) {
        let text = written(page);
        let folder = repository().join(page).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap();
            let is_ours = !file.is_empty() && !target.contains("://") && !file.contains(' ');
            assert!(!is_ours || folder.join(file).exists(), "{page} leads to {target}");
        }
    }
}

/// A page tells numbers that only a run of the program can know.
#[test]
fn the_page_of_the_paper_tells_what_the_program_prints() {
    let page = written("docs/paper.md");
    let printed = host(Path::new("."), "fit --paper").stdout;
    let squeezed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    let told = [
        ("all 168", "168 of 168 printed counts"),
        ("within 1.1 % (rms)", "1.1 % in Table 3"),
        ("within 3.1 % (rms)", "3.1 % in Table 8"),
        ("0.031 coded units", "0.031 coded units"),
        ("101 within rounding", "101 of 105 coefficients"),
        ("5.39482e-4", "Mw 5.40104e-4 5.39482e-4"),
        ("7.12308e-4", "Mc 7.12350e-4 7.12308e-4"),
        ("2.70661e-3", "I 2.70677e-3 2.70661e-3"),
        ("155716893.94", "printed 1557167198.56, the table gives 155716893.94"),
        ("5454.55", "printed 545.55, the table gives 5454.55"),
        ("| −625000 | 625000 |", "printed -625000, the table gives 625000"),
        ("1103787.88", "printed -110378.88, the table gives 1103787.88"),
        ("−44 % (mseV, design 1)", "mseV of design 1 (-44 %)"),
        ("−99 %", "eNM of design 3 (-99 %)"),
        ("| 8.3e-2 | 3.2e-2 | 2.9e-2 |", "8.3e-2, 3.2e-2, 2.9e-2"),
    ];
    for (in_page, in_output) in told {
        assert!(page.contains(in_page), "the page does not say {in_page:?}");
        assert!(squeezed.contains(in_output), "the program does not print {in_output:?}\n{printed}");
    }
}

#[test]
fn the_readme_works() {
    run("README.md");
}

#[test]
fn fitting_works() {
    run("docs/fitting.md");
}

#[test]
fn diagnosis_works() {
    run("docs/diagnosis.md");
}

#[test]
fn calibration_works() {
    run("docs/calibration.md");
}

#[test]
fn python_works() {
    run("docs/python.md");
}

#[test]
fn the_protocol_works() {
    run("docs/protocol.md");
}

#[test]
fn the_other_pages_work() {
    for page in PAGES {
        let has_own_test = ["README", "fitting", "diagnosis", "calibration", "python", "protocol"];
        if !has_own_test.iter().any(|name| page.contains(name)) {
            run(page);
        }
    }
}

/// A fenced block of a page.
struct Block {
    language: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let text = written(page);
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let inside: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            blocks.push(Block { language: language.to_owned(), text: inside.join("\n") + "\n" });
        }
    }
    blocks
}

/// Runs every block of a page, one after the other, in a folder of their own.
fn run(page: &str) {
    let bench = Bench::new();
    let mut said = String::new();
    for block in blocks(page) {
        match block.language.as_str() {
            "" | "sh" => said = bench.shell(page, &block.text),
            // The README promises these results.
            "text" if page == "README.md" => check_promise(page, &block.text, &said),
            "text" => {}
            "python" => bench.python(page, &block.text),
            "c" => bench.c(page, &block.text),
            "toml" => drop(RigFile::parse(page, &block.text).unwrap()),
            "csv" => bench.recording(page, &block.text),
            "rust" => quoted(page, &block.text),
            // A whole effect or sensor; `tests/more new-effect new-sensor` adds it to a copy of the tree.
            "rust,effect" | "rust,sensor" => {}
            // Runs where the package is built: host/python/tests/test_guide.py.
            "python,package" => {}
            other => panic!("{page}: nobody knows how to run a block of {other:?}"),
        }
    }
}

/// A result on a page is that of the command before it: as many lines, from the one that is the block's first. With
/// UPDATE_DOCS=1 it is written anew.
fn check_promise(page: &str, text: &str, said: &str) {
    let first = text.lines().next().unwrap_or_default();
    let from_there = said.lines().map(str::trim_end).skip_while(|line| *line != first);
    let now: String = from_there.take(text.lines().count()).map(|line| format!("{line}\n")).collect();
    if std::env::var_os("UPDATE_DOCS").is_some() && !now.is_empty() {
        std::fs::write(repository().join(page), written(page).replace(text, &now)).unwrap();
        return;
    }
    let hint = "UPDATE_DOCS=1 cargo test -p tests --test docs writes it anew";
    assert!(now == text, "{page} promises\n{text}\nbut the command before prints\n{said}\n{hint}");
}

/// Pieces of Rust are quoted from the code itself.
fn quoted(page: &str, text: &str) {
    let folders = ["shared/src", "shared/src/effect", "firmware/src", "firmware/src/board"];
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(repository().join(folder)).unwrap().flatten());
    let found = files.filter_map(|file| std::fs::read_to_string(file.path()).ok()).any(|code| code.contains(text));
    assert!(found, "{page} quotes code that is not there:\n{text}");
}

/// A folder that looks like the repository's, and a rig on a serial port.
struct Bench {
    folder: tempfile::TempDir,
    rig: Device,
}

impl Bench {
    fn new() -> Self {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        for name in ["host", "docs"] {
            symlink(repository().join(name), folder.path().join(name)).unwrap();
        }
        std::fs::create_dir_all(folder.path().join("bin")).unwrap();
        symlink(path(), folder.path().join("bin/host")).unwrap();
        // The whole check can't run within itself; that it is there and a program is all that is asked here.
        std::fs::create_dir_all(folder.path().join("tests")).unwrap();
        symlink("/bin/true", folder.path().join("tests/run")).unwrap();
        assert!(repository().join("tests/run").exists());
        Self { folder, rig: Device::rig("plain") }
    }

    fn shell(&self, page: &str, text: &str) -> String {
        let text = text.replace("/dev/ttyACM0", &self.rig.port).replace("PORT", &self.rig.port);
        self.said_by(page, Command::new("bash").args(["-euc", &format!("{CARGO}\n{text}")]))
    }

    fn python(&self, page: &str, text: &str) {
        let has_pandas = || Command::new("python3").args(["-c", "import pandas"]).output().unwrap().status.success();
        // Where pandas is missing its one line can only be read.
        let work = if text.contains("import pandas") && !has_pandas() { "compile" } else { "exec" };
        let script = if work == "exec" { text.to_owned() } else { format!("compile({text:?}, 'page', 'exec')") };
        self.said_by(page, Command::new("python3").args(["-B", "-c", &script]));
    }

    fn c(&self, page: &str, text: &str) {
        std::fs::write(self.folder.path().join("main.c"), text).unwrap();
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "main.c", "-o", "main", "-lm"];
        self.said_by(page, Command::new("cc").args(strict));
        self.said_by(page, &mut Command::new("./main"));
    }

    fn recording(&self, page: &str, text: &str) {
        let file = self.folder.path().join("page.csv");
        // A page shows the first rows of many.
        let more: String = (2..50).map(|row| format!("{:.6},0.7238190,10190\n", 1e-3 * f64::from(row))).collect();
        std::fs::write(&file, text.to_owned() + &more).unwrap();
        let recording = read(&file, &ReadOptions::default()).unwrap_or_else(|error| panic!("{page}: {error}"));
        assert!(recording.header().calibration.is_some(), "{page}");
    }

    fn said_by(&self, page: &str, command: &mut Command) -> String {
        let search = format!("{}:{}", self.folder.path().join("bin").display(), std::env::var("PATH").unwrap());
        let command = command
            .env("PATH", search)
            .env("REPOSITORY", repository())
            .env(PATIENT.0, PATIENT.1)
            .current_dir(self.folder.path());
        let output = command.output().unwrap_or_else(|error| panic!("{page}: {command:?}: {error}"));
        let (said, told) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "{page}: {command:?}\n{said}\n{told}");
        said.into_owned()
    }
}

/// Every promise names tests that exist: `file`: `name`, `name`.
#[test]
fn every_promise_has_its_test() {
    let page = std::fs::read_to_string(repository().join("docs/promises.md")).unwrap();
    let mut n_tests = 0;
    for row in page.lines().filter(|line| line.starts_with("| ") && line.contains('`')) {
        let (_, proofs) = row.trim_matches(['|', ' ']).rsplit_once(" | ").unwrap();
        for proof in proofs.split("; ") {
            let mut words = proof.split('`').skip(1).step_by(2);
            let file = words.next().unwrap();
            let folders = ["tests/tests", "shared/tests"].map(|folder| repository().join(folder));
            let sources = folders.map(|folder| std::fs::read_to_string(folder.join(format!("{file}.rs"))));
            let source = sources.into_iter().find_map(Result::ok).unwrap_or_else(|| panic!("there is no {file}.rs"));
            for name in words {
                assert!(source.contains(&format!("fn {name}()")), "{file} has no test {name}");
                n_tests += 1;
            }
        }
    }
    assert!(n_tests > 15, "{n_tests}");
}

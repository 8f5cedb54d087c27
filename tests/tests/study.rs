//! `host study`: many recordings of many rigs, each fitted once, whatever happens meanwhile.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use tests::chance::Chance;
use tests::lab::{Lab, pendulum, pushed, swing};
use tests::program::{self, host};
use tests::rates::fewest_hits;

/// Kills; `STUDY_KILLS` makes it more.
const N_KILLS: u64 = 4;

/// Rigs whose clean swings are judged; `STUDY_RIGS` makes it more.
const N_CLEAN_RIGS: u64 = 2;
const N_CLEAN_SWINGS: u64 = 20;

fn count(object: &Value, key: &str) -> u64 {
    object[key].as_u64().unwrap_or_else(|| panic!("no count {key} in {object}"))
}

fn n_rows(table: &str) -> usize {
    table.lines().count() - 1
}

fn words<'a>(object: &'a Value, list: &str) -> Vec<&'a str> {
    let field = if list == "problems" { "why" } else { "words" };
    object[list].as_array().unwrap().iter().map(|each| each[field].as_str().unwrap()).collect()
}

#[test]
fn each_recording_gets_a_row_and_each_rig_one_with_its_friction() {
    let lab = Lab::with(2, 4);
    let said = lab.json("");
    assert_eq!((count(&said, "n_found"), count(&said, "n_studied")), (8, 8));
    assert_eq!(n_rows(&lab.table("study.sqlite")), 8);
    for (rig, number) in said["rigs"].as_array().unwrap().iter().zip(1..) {
        assert_eq!((rig["rig"].as_str().unwrap(), count(rig, "n_fitted")), (format!("rig-{number}").as_str(), 4));
        let truth = pendulum(40 + number);
        for (symbol, truth) in [("Mc", truth.coulomb_nm), ("Mw", truth.viscous)] {
            let all = rig["friction"].as_array().unwrap();
            let found = all.iter().find(|found| found["symbol"] == symbol).unwrap();
            let [value, std] = ["value", "std_error"].map(|key| found[key].as_f64().unwrap());
            // Four swings that vary by 0.5 %: Student's t with 3 degrees of freedom is below 13 in all but one of a
            // thousand; the fit's own error of 0.3 % comes on top.
            assert!((value - truth).abs() < 13.0 * std + 0.003 * truth, "{symbol}: {value} ± {std}, true {truth}");
            assert!(std < 0.01 * truth, "{symbol}: {std}");
        }
    }
    let database = rows_of_rigs(&lab.at("study.sqlite"));
    assert_eq!(database, ["rig-1 4 4", "rig-2 4 4"]);
}

/// The table of rigs, as any program that knows SQLite sees it.
fn rows_of_rigs(database: &Path) -> Vec<String> {
    let script = "import sqlite3, sys\n\
                  rows = sqlite3.connect(sys.argv[1]).execute('select rig, recordings, fitted from rig order by 1')\n\
                  print(*(' '.join(map(str, row)) for row in rows), sep='\\n')";
    let output = Command::new("python3").args(["-c", script]).arg(database).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn only_what_is_new_or_has_changed_is_studied() {
    let lab = Lab::with(1, 3);
    assert_eq!(count(&lab.json(""), "n_studied"), 3);
    let before = lab.table("study.sqlite");
    assert_eq!(count(&lab.json(""), "n_studied"), 0);

    // A copy of the same bytes with a new date is nothing new.
    let bytes = std::fs::read(lab.at("rig-1/swing-2.csv")).unwrap();
    std::fs::write(lab.at("rig-1/swing-2.csv"), &bytes).unwrap();
    assert_eq!(count(&lab.json(""), "n_studied"), 0);
    assert_eq!(lab.table("study.sqlite"), before);

    let other = swing(&pendulum(41), 77, 0.005).recording(0);
    lab.save(&other, "rig-1/swing-2.csv");
    lab.save(&swing(&pendulum(41), 4, 0.005).recording(0), "rig-1/swing-4.csv");
    assert_eq!(count(&lab.json(""), "n_studied"), 2);
    let after = lab.table("study.sqlite");
    let differ: Vec<usize> = (0..4).filter(|idx| before.lines().nth(*idx) != after.lines().nth(*idx)).collect();
    assert_eq!((differ, n_rows(&after)), (vec![2], 4));

    // Another model, other numbers; other options likewise; and whoever wants all of it anew gets it.
    let model = std::fs::read_to_string(lab.at("rig-1/rig.toml")).unwrap();
    std::fs::write(lab.at("rig-1/rig.toml"), format!("{model}\n# turned by hand\n")).unwrap();
    assert_eq!(count(&lab.json(""), "n_studied"), 4);
    assert_eq!(count(&lab.json("--from 2"), "n_studied"), 4);
    assert_eq!(count(&lab.json("--from 2"), "n_studied"), 0);
    assert_eq!(count(&lab.json("--from 2 --again"), "n_studied"), 4);
}

/// Files that were changed long ago, as those of yesterday's swings.
fn aged(lab: &Lab, name: &str, seconds: u64) {
    let changed = std::time::SystemTime::now() - std::time::Duration::from_secs(seconds);
    std::fs::File::options().write(true).open(lab.at(name)).unwrap().set_modified(changed).unwrap();
}

#[test]
fn a_file_is_read_again_only_if_it_looks_otherwise() {
    let lab = Lab::with(1, 3);
    let swings = ["rig-1/swing-1.csv", "rig-1/swing-2.csv", "rig-1/swing-3.csv"];
    swings.iter().for_each(|name| aged(&lab, name, 3600));
    let read_and_studied = |arguments: &str| {
        let run = lab.study(&format!("-v --no-diagnosis {arguments}"));
        run.succeeded();
        let n_said = |what: &str| run.stderr.lines().filter(|line| line.contains(what)).count();
        (n_said("hashing "), n_said("studying "))
    };
    assert_eq!(read_and_studied(""), (3, 3));
    assert_eq!(read_and_studied(""), (0, 0));
    // Touched: read again, once, and the same.
    aged(&lab, swings[0], 1800);
    assert_eq!(read_and_studied(""), (1, 0));
    assert_eq!(read_and_studied(""), (0, 0));
    // Other readings of the same length, with the date of the old ones.
    let text = std::fs::read_to_string(lab.at(swings[1])).unwrap();
    let (head, last) = text.trim_end().split_at(text.trim_end().len() - 1);
    let other = if last == "1" { "2" } else { "1" };
    let changed = std::fs::metadata(lab.at(swings[1])).unwrap().modified().unwrap();
    std::fs::write(lab.at(swings[1]), format!("{head}{other}\n")).unwrap();
    std::fs::File::options().write(true).open(lab.at(swings[1])).unwrap().set_modified(changed).unwrap();
    assert_eq!(std::fs::metadata(lab.at(swings[1])).unwrap().len(), text.len() as u64);
    assert_eq!(read_and_studied(""), (1, 1));
    assert_eq!(read_and_studied("--again"), (3, 3));
    // A database from before files were remembered.
    let script = "import sqlite3, sys\nwith sqlite3.connect(sys.argv[1]) as old: old.execute('drop table file')";
    assert!(Command::new("python3").args(["-c", script]).arg(lab.at("study.sqlite")).status().unwrap().success());
    assert_eq!(read_and_studied(""), (3, 0));
    assert_eq!(read_and_studied(""), (0, 0));
    // What was written just now may change again unseen; a date to come stands for now, however slow this test is.
    let to_come = std::time::SystemTime::now() + std::time::Duration::from_secs(3600);
    std::fs::File::options().write(true).open(lab.at(swings[2])).unwrap().set_modified(to_come).unwrap();
    assert_eq!(read_and_studied(""), (1, 0));
    assert_eq!(read_and_studied(""), (1, 0));
}

#[test]
fn neither_order_nor_threads_nor_parts_change_a_bit() {
    let lab = Lab::with(2, 5);
    lab.json("--jobs 1 --database one.sqlite");
    lab.json("--jobs 3 --database three.sqlite");
    let one = lab.table("one.sqlite");
    assert_eq!(one, lab.table("three.sqlite"));
    assert_eq!(n_rows(&one), 10);

    let parts: u64 =
        (1..=3).map(|part| count(&lab.json(&format!("--shard {part}/3 --database {part}.sqlite")), "n_studied")).sum();
    assert_eq!(parts, 10);
    let joined = lab.json("--join 3.sqlite --join 1.sqlite --join 2.sqlite --database a.sqlite");
    lab.json("--join 2.sqlite --join 3.sqlite --join 1.sqlite --database b.sqlite");
    assert_eq!((count(&joined, "n_found"), count(&joined, "n_studied")), (10, 0));
    assert_eq!(one, lab.table("a.sqlite"));
    assert_eq!(one, lab.table("b.sqlite"));
    let told = |database: &str| {
        let said = lab.json(&format!("--as-is --database {database}"));
        (said["rigs"].clone(), said["between"].clone())
    };
    assert_eq!(told("one.sqlite"), told("b.sqlite"));
}

fn started(folder: &Path, database: &str, n_jobs: usize) -> Child {
    let n_jobs = n_jobs.to_string();
    let mut command = Command::new(program::path());
    command.args(["study", ".", "--jobs", &n_jobs, "--database", database, "-v"]).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Studies with a limit on the size of files, bytes. What writes beyond it is killed by the system (SIGXFSZ), so that a
/// kill comes after so many bytes of the database, however fast the computer is. Gives what was said, too.
fn killed(folder: &Path, most_bytes: u64) -> (ExitStatus, String) {
    let limit = format!("--fsize={most_bytes}");
    let study = ["study", ".", "--jobs", "1", "--database", "k.sqlite", "-v", "--no-diagnosis"];
    let mut command = Command::new("prlimit");
    command.args([&limit, "--core=0"]).arg(program::path()).args(study).current_dir(folder);
    let output = command.stdin(Stdio::null()).output().unwrap();
    (output.status, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_kill_at_any_moment_loses_nothing_and_repeats_one_recording_at_most() {
    let n_kills = std::env::var("STUDY_KILLS").map_or(N_KILLS, |kills| kills.parse().unwrap());
    const N: usize = 12;
    let lab = Lab::with(1, N as u64);
    lab.json("--jobs 1 --database whole.sqlite");
    let whole = lab.table("whole.sqlite");
    // From the making of the tables to the last recording, which is behind 100 kB.
    const LEAST: f64 = 10_000.0;
    const MOST: f64 = 100_000.0;
    let mut n_cut = 0;
    for seed in 0..n_kills {
        ["k.sqlite", "k.sqlite-wal", "k.sqlite-shm"].iter().for_each(|name| {
            let _ = std::fs::remove_file(lab.at(name));
        });
        let (status, said) = killed(lab.folder(), Chance::new(seed).within(LEAST..MOST) as u64);
        let n_said = said.lines().filter(|line| line.contains("kept ")).count();
        let n_begun = said.lines().filter(|line| line.contains("studying ")).count();
        if status.success() {
            assert_eq!(n_said, N, "seed {seed}");
            continue;
        }
        assert!(status.signal().is_some(), "seed {seed}: {status}\n{said}");
        n_cut += 1;
        let again = lab.json("--jobs 1 --database k.sqlite");
        let n_again = count(&again, "n_studied") as usize;
        let n_kept = N - n_again;
        assert!(
            n_kept >= n_said && n_begun <= n_kept + 1,
            "seed {seed}: {n_begun} begun, {n_said} told, {n_kept} kept"
        );
        assert_eq!(lab.table("k.sqlite"), whole, "seed {seed}");
    }
    println!("{n_kills} runs, {n_cut} of them cut");
    assert!(4 * n_cut >= 3 * n_kills, "{n_cut} of {n_kills} were cut");
}

#[test]
fn two_at_once_do_not_hurt_each_other() {
    let lab = Lab::with(2, 8);
    lab.json("--database one.sqlite");
    let both = [started(lab.folder(), "two.sqlite", 2), started(lab.folder(), "two.sqlite", 2)];
    let mut n_studied = 0;
    for child in both {
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        n_studied += said.lines().filter(|line| line.contains("kept ")).count();
    }
    // Each is done by one of them, or by both at the same moment.
    assert!((16..=32).contains(&n_studied), "{n_studied}");
    assert_eq!(lab.table("one.sqlite"), lab.table("two.sqlite"));
    assert_eq!(count(&lab.json("--database two.sqlite"), "n_studied"), 0);
}

#[test]
fn an_interrupt_ends_it_orderly_and_the_same_command_goes_on() {
    use std::io::{BufRead, BufReader};
    let lab = Lab::with(1, 12);
    let mut child = started(lab.folder(), "study.sqlite", 1);
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let first = lines.by_ref().map(Result::unwrap).find(|line| line.contains("kept ")).expect("one is kept");
    assert!(first.contains("rig-1/swing-"), "{first}");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let rest: Vec<String> = lines.map(Result::unwrap).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(rest.last().unwrap().contains("the same command goes on"), "{rest:?}");
    let n_kept = 1 + rest.iter().filter(|line| line.contains("kept ")).count() as u64;
    assert!(n_kept < 12, "{n_kept}");
    assert_eq!(count(&lab.json(""), "n_studied"), 12 - n_kept);
}

#[test]
fn what_cannot_be_studied_is_named_and_the_rest_goes_on() {
    let lab = Lab::with(2, 2);
    let write = |name: &str, text: &str| std::fs::write(lab.at(name), text).unwrap();
    write("rig-1/notes.txt", "Monday: oiled the bearing.");
    write("rig-1/empty.csv", "");
    write("loose.csv", "t,theta\n0,1\n");
    std::fs::copy(lab.at("rig-1/swing-1.csv"), lab.at("rig-1/copy.csv")).unwrap();
    std::fs::create_dir_all(lab.at("mixed")).unwrap();
    for name in ["rig.toml", "other.toml"] {
        std::fs::copy(lab.at("rig-1/rig.toml"), lab.at(&format!("mixed/{name}"))).unwrap();
    }
    std::fs::create_dir_all(lab.at("torn")).unwrap();
    write("torn/rig.toml", "format = 1\n[pendulum\n");
    // A recording of a pendulum of twice the length among those of rig 2.
    let longer = tests::hidden::Rig { length_m: 2.0 * pendulum(42).length_m, ..pendulum(42) };
    lab.save(&longer.recording(0), "rig-2/swing-3.csv");
    lab.save(&swing(&pendulum(42), 4, 0.005).recording(0), "rig-2/swing-4.csv");

    let said = lab.json("");
    assert_eq!(count(&said, "n_found"), 9);
    let problems: Vec<String> = said["problems"].as_array().unwrap().iter().map(Value::to_string).collect();
    let told = |words: &[&str]| {
        assert!(
            problems.iter().any(|problem| words.iter().all(|word| problem.contains(word))),
            "{words:?}: {problems:#?}"
        );
    };
    told(&["rig-1/notes.txt", "no row of numbers"]);
    told(&["rig-1/empty.csv", "empty"]);
    told(&["loose.csv", "no rig's folder"]);
    told(&["copy.csv", "same bytes"]);
    told(&["mixed", "several rigs", "folder of its own"]);
    told(&["torn", "rig.toml", "line 2"]);
    told(&["rig-2/swing-3.csv", "period"]);
    assert_eq!(problems.len(), words(&said, "problems").len());
    let fitted: Vec<u64> = said["rigs"].as_array().unwrap().iter().map(|rig| count(&rig["friction"][0], "n")).collect();
    assert_eq!(fitted, [2, 3]);
    // What is broken is not tried again while it stays as it is, but named again.
    let again = lab.json("");
    assert_eq!(count(&again, "n_studied"), 0);
    assert_eq!(again["problems"], said["problems"]);
    let text = lab.study("--quiet");
    assert!(text.succeeded().contains("Left out") && text.stdout.contains("rig-1/empty.csv"), "{}", text.stdout);
}

#[test]
fn wrong_use_is_refused_with_what_to_do() {
    let lab = Lab::with(1, 1);
    lab.study("--no-diagnosis").succeeded();
    host(lab.folder(), "study nowhere").failed(2, &["nowhere is no folder", "rig.toml"]);
    lab.study("--shard 3/2").failed(2, &["3/2", "K/N"]);
    lab.study("--jobs 0").failed(2, &["jobs"]);
    lab.study("--join none.sqlite").failed(2, &["none.sqlite", "host study"]);
    lab.study("--as-is --database none.sqlite").failed(2, &["no database none.sqlite"]);
    std::fs::write(lab.at("text.sqlite"), "no database at all, but long enough to be one. ".repeat(9)).unwrap();
    lab.study("--database text.sqlite").failed(2, &["text.sqlite", "--database"]);
    lab.study("--csv a.csv").succeeded();
    lab.study("--csv a.csv").failed(2, &["a.csv exists already", "--force"]);
    lab.study("--csv study.sqlite --force").failed(2, &["study.sqlite is being read"]);
    lab.study("--database no/folder/a.sqlite").failed(1, &["no/folder/a.sqlite", "--database"]);
    // A place where nothing can be written, for root neither.
    lab.study("--database /proc/study.sqlite").failed(1, &["/proc/study.sqlite", "may be written to"]);
    let script = "import sqlite3, sys\nsqlite3.connect(sys.argv[1]).execute('pragma user_version = 9')";
    Command::new("python3").args(["-c", script]).arg(lab.at("study.sqlite")).status().unwrap();
    lab.study("").failed(2, &["version 9", "has 1"]);
    // A folder without any rig is a result, with a note.
    std::fs::create_dir(lab.at("bare")).unwrap();
    let bare = host(&lab.at("bare"), "study .");
    assert!(bare.succeeded().contains("0 recordings") && bare.stderr.contains("no recording"), "{bare:?}");
    assert!(
        bare.stdout.contains("nothing is kept") && bare.stderr.contains("its rig.toml and its recordings"),
        "{bare:?}"
    );
    assert_eq!(std::fs::read_dir(lab.at("bare")).unwrap().count(), 0);
    lab.study("--csv none/a.csv").failed(1, &["none/a.csv", "a folder that exists"]);
    let one = host(lab.folder(), "study rig-1 --no-diagnosis --database one.sqlite");
    assert!(one.succeeded().contains("\n rig-1  "), "{}", one.stdout);
}

#[test]
fn a_swing_that_was_pushed_is_found_and_takes_no_part() {
    let lab = Lab::with(1, 9);
    let clean = swing(&pendulum(41), 10, 0.005).recording(0);
    lab.save(&pushed(&clean), "rig-1/swing-10.csv");
    let said = lab.json("--no-diagnosis --report page.html");
    let findings = said["rigs"][0]["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!((&findings[0]["kind"], &findings[0]["recording"]), (&"pushed".into(), &"swing-10.csv".into()));
    assert_eq!(count(&said["rigs"][0]["friction"][0], "n"), 9);
    let page = std::fs::read_to_string(lab.at("page.html")).unwrap();
    assert!(page.contains("pushed by hand?") && page.contains("swing-10.csv was disturbed"));
    assert!(!page.contains("http://") && !page.contains("https://"), "it needs no network");
}

/// All that a study may say by mistake of clean swings of rigs that differ: at most one word in a thousand of them.
#[test]
fn clean_swings_are_seldom_accused() {
    let n_rigs = std::env::var("STUDY_RIGS").map_or(N_CLEAN_RIGS, |rigs| rigs.parse().unwrap());
    let n_swings = n_rigs * N_CLEAN_SWINGS;
    let lab = Lab::new();
    for number in 1..=n_rigs {
        let (name, rig) = (format!("rig-{number}"), pendulum(600 + number));
        lab.add_rig(&name, &rig);
        (1..=N_CLEAN_SWINGS)
            .for_each(|n| lab.save(&swing(&rig, n, 0.005).recording(0), &format!("{name}/swing-{n}.csv")));
    }
    let said = lab.json("--no-diagnosis");
    assert_eq!((count(&said, "n_studied"), words(&said, "problems").len()), (n_swings, 0), "{}", said["problems"]);
    let fitted: u64 = said["rigs"].as_array().unwrap().iter().map(|rig| count(rig, "n_fitted")).sum();
    assert_eq!(fitted, n_swings);
    let findings: Vec<String> =
        said["rigs"].as_array().unwrap().iter().flat_map(|rig| words(rig, "findings")).map(str::to_owned).collect();
    println!("{} of {n_swings} accused: {findings:#?}", findings.len());
    assert!(n_swings as usize - findings.len() >= fewest_hits(n_swings as usize, 0.999), "{findings:#?}");
}

#[test]
fn a_rig_whose_model_lacks_something_is_diagnosed_once() {
    let lab = Lab::new();
    let rig = pendulum(45).with("quadratic-drag");
    lab.add_rig("dusty", &rig);
    for n in 1..=3 {
        let rig = tests::hidden::Rig { releases_rad: vec![[1.5, -1.0, 0.6][n as usize - 1]], ..swing(&rig, n, 0.0) };
        lab.save(&rig.recording(0), &format!("dusty/swing-{n}.csv"));
    }
    let said = lab.json("");
    assert_eq!(said["rigs"][0]["diagnosis"]["missing"][0], "quadratic-drag", "{said:#}");
    let again = lab.study("");
    assert!(again.succeeded().contains("quadratic-drag") && !again.stderr.contains("trying every effect"), "{again:?}");
    assert!(!lab.study("--shard 1/1 --database s.sqlite").succeeded().contains("quadratic-drag"));
}

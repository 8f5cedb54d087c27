//! Help, completions and manual pages of every command; terminals, colours and silence.

use std::path::Path;
use std::process::{Command, Stdio};
use tests::program::{host, path};

/// A screen and a half: what a person still reads.
const MOST_LINES: usize = 60;

/// Every command, read from the help itself.
fn commands() -> Vec<String> {
    let help = host(Path::new("."), "--help");
    let listed = help.succeeded().lines().skip_while(|line| *line != "Commands:").skip(1);
    // Wrapped lines stand further in.
    let names: Vec<String> = listed
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect();
    assert!(names.len() > 15 && names.contains(&"doctor".to_owned()), "{names:?}");
    names
}

#[test]
fn every_help_has_an_example_and_fits_a_screen_or_two() {
    let with_program = commands().into_iter().filter(|name| name != "help").map(|name| format!("{name} --help"));
    for arguments in with_program.chain(["--help".to_owned()]) {
        let run = host(Path::new("."), &arguments);
        let help = run.succeeded();
        assert!(help.contains("Example:\n  host "), "{arguments}:\n{help}");
        assert!(help.lines().count() <= MOST_LINES, "{arguments}: {} lines", help.lines().count());
        assert!(help.lines().all(|line| line.chars().count() <= 120), "{arguments}:\n{help}");
    }
}

#[test]
fn a_range_is_no_promise_about_the_result() {
    let help = host(Path::new("."), "fit --help").succeeded().to_owned();
    assert!(help.contains("A --range is where the search begins"), "{help}");
}

#[test]
fn exit_codes_are_documented_and_true() {
    let here = Path::new(".");
    assert!(host(here, "--help").succeeded().contains("Exit codes: 0 there is a result"));
    host(here, "statistics --port /dev/nope").failed(1, &["/dev/nope"]);
    host(here, "statistics").failed(2, &["--port"]);
}

#[test]
fn shells_get_completions_of_every_command() {
    for shell in ["bash", "zsh", "fish"] {
        let text = host(Path::new("."), &format!("completions {shell}")).succeeded().to_owned();
        commands().iter().for_each(|command| assert!(text.contains(command.as_str()), "{shell}: {command}"));
    }
}

#[test]
fn bash_takes_the_completions() {
    let folder = tempfile::tempdir().unwrap();
    let text = host(folder.path(), "completions bash").stdout;
    std::fs::write(folder.path().join("host"), text).unwrap();
    let script = "source ./host && COMP_WORDS=(host doc) COMP_CWORD=1 && _host host doc host && echo ${COMPREPLY[@]}";
    let output = Command::new("bash").args(["-c", script]).current_dir(folder.path()).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "doctor", "{output:?}");
}

#[test]
fn every_command_gets_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "man pages/man1").succeeded();
    for command in commands().iter().filter(|name| *name != "help") {
        let page = std::fs::read_to_string(folder.path().join(format!("pages/man1/host-{command}.1"))).unwrap();
        assert!(page.contains(".SH") && page.contains("Example"), "{command}");
    }
}

#[test]
fn quiet_leaves_the_result_alone_and_nothing_is_coloured_without_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let loud = host(folder.path(), "record --port sim -o a.csv");
    assert!(loud.stderr.contains("released"), "{loud:?}");
    let quiet = host(folder.path(), "record --port sim -o b.csv --quiet");
    assert_eq!(quiet.stderr, "");
    assert!(quiet.succeeded().starts_with("wrote b.csv"));
    for run in [loud, quiet, host(folder.path(), "fit nothing.csv"), host(folder.path(), "--help")] {
        assert!(!run.stdout.contains('\x1b') && !run.stderr.contains('\x1b'), "{run:?}");
    }
}

#[test]
fn more_is_told_on_the_way_when_asked_and_nothing_of_it_in_the_result() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --unknown-geometry").succeeded();
    host(folder.path(), "simulate --rate 100 --seconds 10 -o a.csv").succeeded();
    let plain = host(folder.path(), "simulate --rate 100 --seconds 10 -o a.csv --force");
    assert!(!plain.stderr.contains("host::"), "{plain:?}");
    let doctor = host(folder.path(), "doctor --port sim --json");
    let verbose = host(folder.path(), "doctor --port sim --json -v");
    assert_eq!(verbose.succeeded(), doctor.succeeded());
    assert!(verbose.stderr.contains("host::link::session: asking the rig to"), "{}", verbose.stderr);
    assert!(!verbose.stderr.contains("heard Samples"), "{}", verbose.stderr);
    let chosen = Command::new(path())
        .args(["doctor", "--port", "sim"])
        .env("RUST_LOG", "host::link=trace")
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&chosen.stderr).contains("heard Samples"));
    host(folder.path(), "doctor --quiet -v").failed(2, &["cannot be used with"]);
}

/// What a person at a terminal sees, both streams together.
#[cfg(target_os = "linux")]
fn on_a_terminal(arguments: &[&str], no_colour: Option<&str>) -> String {
    use std::io::Read;
    let pty = nix::pty::openpty(None, None).unwrap();
    let stream = || Stdio::from(pty.slave.try_clone().unwrap());
    let mut command = Command::new(path());
    command.args(arguments).env("TERM", "xterm").env_remove("NO_COLOR").stdin(Stdio::null());
    command.stdout(stream()).stderr(stream());
    no_colour.map(|value| command.env("NO_COLOR", value));
    let mut child = command.spawn().unwrap();
    drop((command, pty.slave));
    let mut seen = Vec::new();
    // The terminal ends with an error once the program has closed it.
    let _ = std::fs::File::from(pty.master).read_to_end(&mut seen);
    child.wait().unwrap();
    String::from_utf8(seen).unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn colours_are_for_terminals_and_no_color_switches_them_off() {
    for arguments in [&["fit", "nothing.csv"][..], &["statistics"], &["effects", "--help"]] {
        let coloured = on_a_terminal(arguments, None);
        let plain = on_a_terminal(arguments, Some("1"));
        assert!(!plain.contains('\x1b'), "{arguments:?}: {plain:?}");
        assert!(plain.len() > 40, "{arguments:?}: {plain:?}");
        // An empty NO_COLOR counts as none (no-color.org).
        assert_eq!(on_a_terminal(arguments, Some("")), coloured);
        assert!(coloured.contains('\x1b'), "{arguments:?}: {coloured:?}");
    }
}

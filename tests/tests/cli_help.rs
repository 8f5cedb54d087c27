//! Help, completions and manual pages of every command; terminals, colours and silence.

use tests::program::host;

/// A screen and a half: what a person still reads.
const MOST_LINES: usize = 60;

/// Every command, read from the help itself.
fn commands() -> Vec<String> {
    let help = host(std::path::Path::new("."), "--help");
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
        let run = host(std::path::Path::new("."), &arguments);
        let help = run.succeeded();
        assert!(help.contains("Example:\n  host "), "{arguments}:\n{help}");
        assert!(help.lines().count() <= MOST_LINES, "{arguments}: {} lines", help.lines().count());
        assert!(help.lines().all(|line| line.chars().count() <= 120), "{arguments}:\n{help}");
    }
}

#[test]
fn exit_codes_are_documented_and_true() {
    let here = std::path::Path::new(".");
    assert!(host(here, "--help").succeeded().contains("Exit codes: 0 there is a result"));
    host(here, "statistics --port /dev/nope").failed(1, &["/dev/nope"]);
    host(here, "statistics").failed(2, &["--port"]);
}

#[test]
fn shells_get_completions_of_every_command() {
    for shell in ["bash", "zsh", "fish"] {
        let text = host(std::path::Path::new("."), &format!("completions {shell}")).succeeded().to_owned();
        commands().iter().for_each(|command| assert!(text.contains(command.as_str()), "{shell}: {command}"));
    }
}

#[test]
fn bash_takes_the_completions() {
    let folder = tempfile::tempdir().unwrap();
    let text = host(folder.path(), "completions bash").stdout;
    std::fs::write(folder.path().join("host"), text).unwrap();
    let script = "source ./host && COMP_WORDS=(host doc) COMP_CWORD=1 && _host host doc host && echo ${COMPREPLY[@]}";
    let output = std::process::Command::new("bash").args(["-c", script]).current_dir(folder.path()).output().unwrap();
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

use super::*;

fn listing(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write(&path, "old", Existing::Keep).unwrap();
    let kept = write(&path, "new", Existing::Keep).unwrap_err();
    assert!(matches!(kept, FileError::Exists { .. }) && kept.next_step().contains("--force"), "{kept:?}");
    let mut half = NewFile::whole(&path, Existing::Overwrite).unwrap();
    half.write_all(b"half").unwrap();
    half.flush().unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    drop(half);
    assert_eq!(listing(folder.path()), ["a.txt"]);
    write(&path, "new", Existing::Overwrite).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(listing(folder.path()), ["a.txt"]);
}

#[test]
fn a_folder_that_is_not_there_is_told_by_the_name_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none/x.toml");
    let error = write(&path, "new", Existing::Keep).unwrap_err();
    let told = error.to_string();
    assert!(told.contains("x.toml: ") && !told.contains(".new") && !told.contains("at path"), "{told}");
    assert!(error.next_step().contains("a folder that exists"), "{}", error.next_step());
}

#[test]
fn whether_a_file_can_be_written_is_known_before_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let asked = |name: &str, existing| check(&[&at(name)], &[], existing);
    asked("new.toml", Existing::Keep).unwrap();
    assert!(listing(folder.path()).is_empty());
    assert!(matches!(asked("none/x.toml", Existing::Keep), Err(FileError::Io { .. })));
    std::fs::create_dir(at("inside")).unwrap();
    assert!(matches!(asked("inside", Existing::Overwrite), Err(FileError::Io { .. })));
    check_folder(&at("inside/a/b")).unwrap();
    assert!(listing(&at("inside")).is_empty());
    std::fs::write(at("file"), "").unwrap();
    assert!(matches!(check_folder(&at("file/a")), Err(FileError::Io { .. })));
}

#[test]
fn a_file_that_came_meanwhile_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    let ours = NewFile::whole(&path, Existing::Keep).unwrap();
    std::fs::write(&path, "theirs").unwrap();
    assert!(matches!(ours.finish(), Err(FileError::Exists { .. })));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "theirs");
}

#[test]
fn what_grows_in_the_place_of_another_leaves_both_until_it_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, "old").unwrap();
    let mut new = NewFile::growing(&path, Existing::Overwrite).unwrap();
    new.write_all(b"new").unwrap();
    new.flush().unwrap();
    drop(new);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    let names = listing(folder.path());
    assert!(names.len() == 2 && names[1].starts_with("a.csv.") && names[1].ends_with(".new"), "{names:?}");
}

#[test]
fn what_is_discarded_or_left_takes_no_other_file_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("old.csv"), "old").unwrap();
    NewFile::growing(&at("old.csv"), Existing::Overwrite).unwrap().discard();
    NewFile::growing(&at("new.csv"), Existing::Keep).unwrap().discard();
    assert_eq!(listing(folder.path()), ["old.csv"]);
    let mut new = NewFile::growing(&at("old.csv"), Existing::Overwrite).unwrap();
    new.write_all(b"new").unwrap();
    let beside = new.leave().unwrap();
    assert_eq!(std::fs::read_to_string(beside).unwrap(), "new");
    assert_eq!(std::fs::read_to_string(at("old.csv")).unwrap(), "old");
    let mut new = NewFile::growing(&at("new.csv"), Existing::Keep).unwrap();
    new.write_all(b"new").unwrap();
    assert_eq!(new.leave().unwrap(), at("new.csv"));
    assert_eq!(std::fs::read_to_string(at("new.csv")).unwrap(), "new");
}

#[test]
fn two_that_choose_one_name_get_two() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing-1.csv");
    check(&[&path], &[], Existing::Number).unwrap();
    let files: Vec<_> = (0..3).map(|_| NewFile::growing(&path, Existing::Number).unwrap()).collect();
    assert!(files.iter().all(|file| file.path() == file.lies_at()));
    assert_eq!(listing(folder.path()), ["swing-1-2.csv", "swing-1-3.csv", "swing-1.csv"]);
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_refused_before_and_with_force_what_it_leads_to_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::os::unix::fs::symlink("there.svg", at("link.svg")).unwrap();
    assert!(matches!(check(&[&at("link.svg")], &[], Existing::Keep), Err(FileError::Exists { .. })));
    let twice = check(&[&at("link.svg"), &at("there.svg")], &[], Existing::Overwrite);
    assert!(matches!(twice, Err(FileError::Twice { .. })), "{twice:?}");
    write(&at("link.svg"), "new", Existing::Overwrite).unwrap();
    assert!(at("link.svg").is_symlink());
    assert_eq!(std::fs::read_to_string(at("there.svg")).unwrap(), "new");
}

#[cfg(unix)]
#[test]
fn a_file_is_known_by_all_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.csv"), "1").unwrap();
    std::fs::hard_link(at("a.csv"), at("hard.csv")).unwrap();
    std::os::unix::fs::symlink(at("a.csv"), at("soft.csv")).unwrap();
    for name in ["a.csv", "hard.csv", "soft.csv", "./a.csv"] {
        let refused = check(&[&at(name)], &[&at("a.csv")], Existing::Overwrite);
        assert!(matches!(refused, Err(FileError::IsRead { .. })), "{name}");
    }
    assert!(matches!(check(&[&at("n"), &at("./n")], &[], Existing::Keep), Err(FileError::Twice { .. })));
    check(&[&at("b.csv")], &[&at("a.csv")], Existing::Keep).unwrap();
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link_and_a_mode_its_mode() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.toml"), "old").unwrap();
    std::fs::set_permissions(at("a.toml"), PermissionsExt::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink(at("a.toml"), at("soft.toml")).unwrap();
    write(&at("soft.toml"), "new", Existing::Overwrite).unwrap();
    assert!(at("soft.toml").is_symlink());
    assert_eq!(std::fs::read_to_string(at("a.toml")).unwrap(), "new");
    assert_eq!(at("a.toml").metadata().unwrap().permissions().mode() & 0o777, 0o640);
}

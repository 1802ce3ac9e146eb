use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, SystemTime};

use super::sweep;
use super::*;

fn names(folder: &Path) -> Vec<String> {
    let listing = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        listing.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_and_keeps_its_permissions() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.csv");
    write(&file, "old").expect("written");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).expect("changed");
    write(&file, "new").expect("written");
    assert_eq!(fs::read_to_string(&file).expect("there"), "new");
    assert_eq!(fs::metadata(&file).expect("there").permissions().mode() & 0o777, 0o640);
    assert_eq!(names(folder.path()), ["a.csv"]);
}

#[test]
fn a_link_stays_one_and_what_it_names_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let [file, link] = ["a.csv", "link.csv"].map(|name| folder.path().join(name));
    std::os::unix::fs::symlink("a.csv", &link).expect("a link");
    let refused = write(&link, "x").expect_err("a link to nothing");
    assert!(matches!(refused, FileError::DanglingTarget { .. }));
    assert!(
        refused
            .to_string()
            .contains("link.csv is a link to a.csv, which does not exist: nothing was written")
    );
    assert!(!file.exists());
    write(&file, "old").expect("written");
    write(&link, "new").expect("written");
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert_eq!(fs::read_to_string(&file).expect("there"), "new");
    assert_eq!(names(folder.path()), ["a.csv", "link.csv"]);
}

#[test]
fn what_is_no_file_is_not_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let null = folder.path().join("null");
    std::os::unix::fs::symlink("/dev/null", &null).expect("a link");
    let cases = [
        (folder.path(), "is a folder, which is not replaced"),
        (&pipe, "is a pipe, which is not replaced"),
        (Path::new("/dev/full"), "/dev/full is a device, which is not replaced: nothing was written"),
        (&null, "is a device, which is not replaced"),
        (Path::new("/"), "is a folder"),
    ];
    for (path, words) in cases {
        let refused = write(path, "x").expect_err("no file").to_string();
        assert!(refused.contains(words), "{refused}");
    }
    let protected = folder.path().join("kept.csv");
    fs::write(&protected, "old").expect("written");
    fs::set_permissions(&protected, fs::Permissions::from_mode(0o444)).expect("changed");
    let refused = write(&protected, "new").expect_err("protected").to_string();
    assert!(refused.contains("kept.csv is write-protected: nothing was written"), "{refused}");
    assert_eq!(fs::read_to_string(&protected).expect("there"), "old");
    assert_eq!(names(folder.path()), ["kept.csv", "null", "pipe"]);
}

#[test]
fn what_is_not_finished_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.csv");
    write(&file, "old").expect("written");
    let failed = write_with(&file, |out| {
        use std::io::Write;
        out.write_all(&[b'x'; 100_000])?;
        Err(std::io::Error::from(std::io::ErrorKind::StorageFull))
    });
    let words = failed.expect_err("full").to_string();
    assert!(words.contains("a.csv cannot be written (no storage space)"), "{words}");
    assert!(words.contains("what was there before is unchanged"), "{words}");
    let dropped = Replacement::of(&file).expect("a file");
    dropped.fill("half").expect("written");
    assert_eq!(names(folder.path()).len(), 2);
    drop(dropped);
    assert_eq!(fs::read_to_string(&file).expect("there"), "old");
    assert_eq!(names(folder.path()), ["a.csv"]);
    let nowhere = write(&folder.path().join("none/a.csv"), "x").expect_err("no folder").to_string();
    assert!(nowhere.contains("choose a folder that exists"), "{nowhere}");
}

#[test]
fn long_names_can_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = format!("{}.csv", "é".repeat(125));
    let replacement = Replacement::of(&folder.path().join(&name)).expect("a file");
    assert_eq!(replacement.temporary().extension().expect("one"), "csv");
    replacement.fill("x").expect("written");
    replacement.commit().expect("in its place");
    assert_eq!(names(folder.path()), [name]);
}

#[test]
fn two_names_of_one_file_leave_no_third() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.png");
    fs::write(&file, "x").expect("written");
    let replacement = Replacement::of(&file).expect("a file");
    fs::hard_link(&file, replacement.temporary()).expect("a second name");
    replacement.commit().expect("the same contents");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn what_killed_processes_left_is_swept_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    // No process has this number: Linux counts to 2²² at most.
    let gone = u32::MAX;
    let alive = std::process::id();
    let stale = [format!(".{gone}-6a2f-0.part-a.csv"), format!(".{gone}-3.part-.png")];
    let kept = [
        format!(".{alive}-6a2f-0.part-a.csv"),
        ".notes.part-a".to_owned(),
        format!("{gone}-1-1.part-a.csv"),
        "a.csv".to_owned(),
    ];
    for name in stale.iter().chain(&kept) {
        fs::write(folder.path().join(name), "x").expect("written");
    }
    sweep::sweep(folder.path(), SystemTime::now());
    assert_eq!(names(folder.path()).len(), 6, "another machine may still be writing them");
    sweep::sweep(folder.path(), SystemTime::now() + Duration::from_secs(3600));
    let mut kept = kept.to_vec();
    kept.sort();
    assert_eq!(names(folder.path()), kept);
}

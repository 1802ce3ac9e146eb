use std::fs;
use std::path::Path;
use std::process::Command;

use super::*;

const LIMIT: Size = Size(100);

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn pipe(at: &Path) {
    assert!(Command::new("mkfifo").arg(at).status().expect("mkfifo").success());
}

fn link(to: &Path, at: &Path) {
    std::os::unix::fs::symlink(to, at).expect("a link");
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = folder();
    let pipe_at = folder.path().join("a.pipe");
    pipe(&pipe_at);
    let socket_at = folder.path().join("a.socket");
    let _socket = std::os::unix::net::UnixListener::bind(&socket_at).expect("a socket");
    let cases = [
        (folder.path(), "is a folder, not a file"),
        (pipe_at.as_path(), "is a pipe, not a file"),
        (socket_at.as_path(), "is a socket, not a file"),
        (Path::new("/dev/zero"), "/dev/zero is a device, not a file: give a file"),
    ];
    for (path, words) in cases {
        let refused = read(path, LIMIT).expect_err("no file");
        assert!(refused.to_string().contains(words), "{refused}");
        assert!(matches!(refused, FileError::NotAFile { .. }));
    }
    let through = folder.path().join("link");
    link(&pipe_at, &through);
    assert!(matches!(read(&through, LIMIT), Err(FileError::NotAFile { kind: Kind::Pipe, .. })));
}

#[test]
fn too_much_is_refused_with_size_and_limit() {
    let folder = folder();
    let file = folder.path().join("a.csv");
    fs::write(&file, [b'x'; 100]).expect("written");
    assert_eq!(read(&file, LIMIT).expect("just fits").len(), 100);
    fs::write(&file, [b'x'; 101]).expect("written");
    let refused = read(&file, LIMIT).expect_err("one too many").to_string();
    assert!(refused.contains("is too large (101 bytes; at most 100 bytes are read)"), "{refused}");
    // A file with a hole has a size, but takes no room: nothing of it is read.
    fs::File::create(&file).expect("made").set_len(3_000_000_000_000).expect("a hole");
    let refused = read(&file, Size::IMAGE).expect_err("3 TB").to_string();
    assert!(refused.contains("(3 TB; at most 256 MB are read)"), "{refused}");
}

#[cfg(target_os = "linux")]
#[test]
fn files_that_tell_no_size_are_read_up_to_the_limit() {
    let file = Path::new("/proc/self/status");
    assert_eq!(fs::metadata(file).expect("it is there").len(), 0);
    assert!(!read(file, Size::SHORT).expect("short").is_empty());
    let refused = read(file, LIMIT).expect_err("longer than that");
    assert!(matches!(refused, FileError::TooLarge { size: None, .. }));
    assert!(refused.to_string().contains("(more than 100 bytes; at most"), "{refused}");
}

#[test]
fn a_link_to_nothing_is_no_absent_file() {
    let folder = folder();
    let [file, at] = ["gone.csv", "touches.csv"].map(|name| folder.path().join(name));
    assert!(!present(&file).expect("absent"));
    assert!(read(&file, LIMIT).expect_err("absent").is_absent());
    link(&file, &at);
    for refused in [present(&at).err(), read(&at, LIMIT).err()] {
        let refused = refused.expect("dangling");
        assert!(!refused.is_absent());
        let words = refused.to_string();
        assert!(words.contains("touches.csv is a link to ") && words.contains("gone.csv"), "{words}");
        assert!(words.contains("which does not exist: restore that file, or remove the link"), "{words}");
    }
    fs::write(&file, "x").expect("written");
    assert!(present(&at).expect("now it leads somewhere"));
    // A place below a file cannot be looked at.
    assert!(present(&file.join("touches.csv")).is_err());
}

#[test]
fn text_is_text() {
    let folder = folder();
    let file = folder.path().join("a.toml");
    fs::write(&file, "\u{feff}a = 1").expect("written");
    assert_eq!(read_text(&file, LIMIT).expect("text"), "a = 1");
    fs::write(&file, [0xff, 0xfe, 0x00]).expect("written");
    let refused = read_text(&file, LIMIT).expect_err("no text").to_string();
    assert!(refused.contains("is not a text file"), "{refused}");
}

#[test]
fn sizes_and_quotes_are_short() {
    assert_eq!(Size::TEXT.to_string(), "64 MB");
    assert_eq!(Size(1_234_567).to_string(), "1.2 MB");
    assert_eq!(Size(999).to_string(), "999 bytes");
    assert_eq!(shortened("1,5"), "1,5");
    assert_eq!(shortened("a\u{1b}[2Jb\n"), "a\u{fffd}[2Jb\u{fffd}");
    assert_eq!(told("a line\nanother\u{1b}"), "a line\nanother\u{fffd}");
    let long = format!("begin {} end", "é".repeat(2_000_000));
    let short = told(&long);
    assert!(short.starts_with("begin ") && short.ends_with(" end") && short.chars().count() < 1300);
    assert!(short.contains("… (1998810 characters left out) …"), "{short}");
    let long = "é".repeat(2_000_000);
    assert_eq!(shortened(&long), format!("{}… (2000000 characters)", "é".repeat(MOST_SHOWN)));
}

/// A session with a table, an image, and a file that somebody put there.
fn session(folder: &Path) {
    for name in ["session.toml", "touches.csv", "stereo/left/a.png", "robot.urdf", "model.json", "best.png"] {
        let file = folder.join(name);
        fs::create_dir_all(file.parent().expect("below the folder")).expect("a folder");
        fs::write(file, name).expect("written");
    }
}

#[test]
fn an_output_is_none_of_the_files_by_which_a_session_is_one() {
    let folder = folder();
    let at = folder.path().join("s");
    session(&at);
    let refused = ["session.toml", "touches.csv", "TOUCHES.CSV", "localizations.csv", "stereo/left/a.png"];
    let refused =
        refused.into_iter().chain(["stereo/left/new.pfm", "robot.urdf", "best.png", "./touches.csv"]);
    for name in refused.chain(["stereo/../touches.csv"]) {
        let answer = output(&at.join(name), &[&at]).expect_err(name).to_string();
        assert!(answer.starts_with("the result would replace ") && answer.contains(name), "{answer}");
        assert!(answer.ends_with("nothing was written; choose another file name"), "{answer}");
    }
    for name in ["model.json", "new.json", "report.html", "scores.csv", "new.png"] {
        output(&at.join(name), &[&at]).expect(name);
    }
    output(&folder.path().join("touches.csv"), &[&at]).expect("elsewhere");
}

#[test]
fn an_export_replaces_no_measurement() {
    let folder = folder();
    let at = folder.path().join("s");
    session(&at);
    link(&at.join("touches.csv"), &folder.path().join("soft.csv"));
    for target in [at.join("touches.csv"), at.join("session.toml"), folder.path().join("soft.csv")] {
        let refused = export(&target).expect_err("a measurement").to_string();
        assert!(refused.contains("is part of the session or data set in its folder: nothing"), "{refused}");
    }
    export(&folder.path().join("touches.csv")).expect("no session there");
    export(&at.join("model.json")).expect("an old model");
    assert!(matches!(export(&folder.path().join("none/a.csv")), Err(FileError::Unwritable { .. })));
}

#[test]
fn an_output_is_no_input_under_another_name() {
    let folder = folder();
    let at = folder.path().join("s");
    session(&at);
    let file = at.join("touches.csv");
    let [soft, hard, to_folder] = ["soft", "hard", "folder"].map(|name| folder.path().join(name));
    link(&file, &soft);
    fs::hard_link(&file, &hard).expect("a second name");
    link(&at, &to_folder);
    for target in [&soft, &hard, &to_folder.join("touches.csv")] {
        assert!(output(target, &[&at]).is_err(), "{}", target.display());
        assert!(output(target, &[&file]).is_err(), "{}", target.display());
        assert!(output(&file, &[target]).is_err(), "{}", target.display());
    }
    assert!(output(&file, &[&to_folder]).is_err());
    // Also one that is not there yet.
    let new = at.join("new.json");
    assert!(output(&to_folder.join("new.json"), &[&new]).is_err());
    output(&new, &[&file]).expect("another file");
}

//! Whole images are started, interrupted, damaged and replaced, as it happens at a desk.

mod made;

use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use made::{Packed, Place, TELLS, WAITS, names, said, sealed};

/// Waits for something to become true.
fn until(what: &str, mut is_true: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_true() {
        assert!(begun.elapsed() < Duration::from_secs(20), "{what} did not happen");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn the_program_is_told_where_it_runs_from_and_is_unpacked_once() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(TELLS, 1));
    let first = place.start(&image, &["--version", "a b"]);
    let (out, errors) = said(&first);
    assert_eq!(first.status.code(), Some(7), "{errors}");
    let unpacked = place.unpacked();
    assert_eq!(unpacked.len(), 1, "{:?}", place.cached());
    let (image_path, folder) = (image.display(), unpacked[0].display());
    let here = place.folder.path().display();
    assert_eq!(out, format!("{image_path}|{folder}|{image_path}|{here}|--version a b\n"));
    assert!(errors.contains("once"), "{errors}");
    let inode = || std::fs::metadata(unpacked[0].join("AppRun")).expect("AppRun").ino();
    let before = inode();
    let second = place.start(&image, &[]);
    assert_eq!((second.status.code(), said(&second).1.as_str(), inode()), (Some(7), "", before));
    assert_eq!(std::fs::read(unpacked[0].join(".DirIcon")).expect("through the link"), b"<svg/>");
}

#[test]
fn starts_at_once_unpack_once() {
    let place = Place::new();
    let content = b"0123456789abcdef".repeat(500_000);
    let mut packed = Packed::new(TELLS, 1);
    packed.file("large", 0o644, &content);
    let image = place.put("plumbline.AppImage", packed);
    let starts: Vec<_> = (0..6).map(|_| made::spawn(&mut place.command(&image))).collect();
    let mut unpackings = 0;
    for start in starts {
        let output = start.wait_with_output().expect("it ends");
        let (out, errors) = said(&output);
        assert_eq!(output.status.code(), Some(7), "{errors}");
        assert!(out.starts_with(&*image.to_string_lossy()), "{out}");
        unpackings += usize::from(errors.contains("unpacking into"));
    }
    assert_eq!(unpackings, 1);
    assert_eq!(place.cached().len(), 2, "the folder and its lock: {:?}", place.cached());
}

#[test]
fn a_killed_unpacking_is_begun_anew() {
    let place = Place::new();
    let content = b"0123456789abcdef".repeat(500_000);
    let mut packed = Packed::new(TELLS, 1);
    packed.file("large", 0o644, &content);
    let image = place.put("plumbline.AppImage", packed);
    // The kernel kills who writes a file to beyond this limit: here, in the midst of it.
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -c 0; ulimit -f 2000; exec \"$0\""]).arg(&image);
    let killed = made::output(place.at_home(&mut command));
    assert!(killed.status.signal().is_some(), "{}", said(&killed).1);
    let is_part = |name: &String| name.ends_with(".part");
    assert!(place.cached().iter().any(is_part), "{:?}", place.cached());
    assert!(place.unpacked().is_empty(), "a part is not taken for whole: {:?}", place.cached());
    let again = place.start(&image, &[]);
    assert_eq!(again.status.code(), Some(7), "{}", said(&again).1);
    assert!(!place.cached().iter().any(is_part), "{:?}", place.cached());
    assert_eq!(std::fs::read(place.unpacked()[0].join("large")).expect("readable"), content);
}

#[test]
fn an_older_image_goes_when_nobody_runs_it_and_a_newer_one_stays() {
    let place = Place::new();
    let old = place.put("old.AppImage", Packed::new(WAITS, 1));
    let new = place.put("new.AppImage", Packed::new(TELLS, 2));
    let mut running = made::spawn(place.command(&old).stdin(Stdio::piped()));
    let mut line = String::new();
    BufReader::new(running.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
    assert_eq!(line, "runs\n");
    let of_old = place.unpacked();
    std::fs::create_dir(place.path("caches/plumbline/thumbnails")).expect("somebody else's");
    place.start(&new, &[]);
    assert!(of_old[0].join("AppRun").exists(), "it is in use");
    drop(running.stdin.take());
    running.wait().expect("it ends");
    place.start(&new, &[]);
    assert!(!of_old[0].exists(), "nobody uses it: {:?}", place.cached());
    assert!(place.path("caches/plumbline/thumbnails").exists());
    let of_new =
        place.unpacked().into_iter().find(|folder| !folder.ends_with("thumbnails")).expect("the new one");
    place.start(&old, &[]);
    assert!(of_new.exists(), "the older one does not remove the newer one");
}

#[test]
fn a_folder_that_lost_a_file_is_made_whole_unless_it_is_in_use() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(WAITS, 1));
    let mut running = made::spawn(place.command(&image).stdin(Stdio::piped()));
    until("unpacking", || !place.unpacked().is_empty());
    let lost = place.unpacked()[0].join("share/plumbline.svg");
    // It holds the folder once it runs.
    let mut line = String::new();
    BufReader::new(running.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
    std::fs::remove_file(&lost).expect("removed");
    let refused = place.start(&image, &[]);
    assert!(!refused.status.success());
    assert!(said(&refused).1.contains("Close every window"), "{}", said(&refused).1);
    drop(running.stdin.take());
    running.wait().expect("it ends");
    assert!(place.start(&image, &[]).stdout.starts_with(b"runs"));
    assert!(lost.exists());
}

#[test]
fn a_damaged_image_and_one_that_was_cut_off_are_told() {
    let place = Place::new();
    let whole = sealed(&Packed::new(TELLS, 1).squashfs());
    let mut damaged = whole.clone();
    // In what a file holds, behind the superblock.
    damaged[made::runtime().len() + 110] ^= 1;
    for (image, words) in [
        (damaged.as_slice(), "is damaged"),
        (&whole[..whole.len() - 1], "not copied or downloaded to its end"),
        (&whole[..made::runtime().len() + 50], "not copied or downloaded to its end"),
        (&made::runtime()[..], "nothing follows the runtime"),
    ] {
        let image = place.write("plumbline.AppImage", image);
        for option in ["--version", "--appimage-extract", "--appimage-extract-and-run"] {
            let refused = place.start(&image, &[option]);
            assert_eq!(refused.status.code(), Some(1));
            assert!(said(&refused).1.contains(words), "{option}: {}", said(&refused).1);
        }
    }
    assert!(place.unpacked().is_empty() && names(&place.path("temporary")).is_empty());
    assert!(!place.path("squashfs-root").exists());
}

#[test]
fn nothing_is_written_outside_of_the_folder() {
    let place = Place::new();
    let mut link = Packed::new(TELLS, 1);
    link.link("out", "../..");
    let mut named = Packed::new(TELLS, 1);
    named.folder("qq");
    named.file("qq/file", 0o644, b"out");
    let named = made::renamed(named.squashfs(), b"qq", b"..");
    for squashfs in [link.squashfs(), named] {
        let image = place.write("plumbline.AppImage", &sealed(&squashfs));
        for option in ["--version", "--appimage-extract", "--appimage-extract-and-run"] {
            let refused = place.start(&image, &[option]);
            let (out, errors) = said(&refused);
            assert_eq!(refused.status.code(), Some(1), "{out} {errors}");
            assert!(errors.contains("out of the folder") || errors.contains("Invalid file path"), "{errors}");
        }
    }
    assert_eq!(names(place.folder.path()), ["plumbline.AppImage", "temporary"]);
    assert!(names(&place.path("temporary")).is_empty());
}

#[test]
fn extracting_takes_a_pattern_and_may_be_repeated() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(TELLS, 1));
    let listed = |arguments: &[&str]| {
        let output = place.start(&image, &[&["--appimage-extract"], arguments].concat());
        assert!(output.status.success(), "{}", said(&output).1);
        said(&output).0.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(listed(&["*.svg"; 0]).len(), 4);
    std::fs::remove_dir_all(place.path("squashfs-root")).expect("removed");
    assert_eq!(listed(&["share/*.svg"]), ["squashfs-root/share", "squashfs-root/share/plumbline.svg"]);
    assert_eq!(listed(&["share"]).len(), 2, "a folder with what is in it");
    assert_eq!(listed(&[".DirIcon"]), ["squashfs-root/.DirIcon"]);
    assert_eq!(names(&place.path("squashfs-root")), [".DirIcon", "share"]);
    let nothing = place.start(&image, &["--appimage-extract", "*.png"]);
    assert!(said(&nothing).1.contains("nothing in the image is called *.png"));
    // A link that lies where a file is to be is replaced, and what it leads to stays as it is.
    std::fs::write(place.path("precious"), "mine").expect("written");
    std::os::unix::fs::symlink(place.path("precious"), place.path("squashfs-root/AppRun")).expect("a link");
    listed(&["AppRun"]);
    assert_eq!(std::fs::read(place.path("precious")).expect("readable"), b"mine");
    assert_eq!(std::fs::read(place.path("squashfs-root/AppRun")).expect("readable"), TELLS.as_bytes());
}

#[test]
fn a_run_from_temporary_files_leaves_nothing() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(TELLS, 1));
    let run = place.start(&image, &["--appimage-extract-and-run", "calibrate"]);
    assert_eq!(run.status.code(), Some(7), "{}", said(&run).1);
    assert!(said(&run).0.trim_end().ends_with("|calibrate"), "{}", said(&run).0);
    assert!(place.cached().is_empty(), "nothing in the caches");
    until("cleaning up", || names(&place.path("temporary")).is_empty());
    // Killed while it runs.
    let waits = place.put("waits.AppImage", Packed::new(WAITS, 1));
    let mut command = place.command(&waits);
    command.stdin(Stdio::piped()).env("APPIMAGE_EXTRACT_AND_RUN", "1");
    let mut running = made::spawn(&mut command);
    let mut line = String::new();
    BufReader::new(running.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
    assert_eq!(names(&place.path("temporary")).len(), 1);
    running.kill().expect("killed");
    running.wait().expect("it ends");
    until("cleaning up", || names(&place.path("temporary")).is_empty());
}

#[test]
fn what_the_options_say() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(TELLS, 1));
    let offset = said(&place.start(&image, &["--appimage-offset"])).0;
    assert_eq!(
        offset.trim().parse(),
        Ok(made::runtime().len()),
        "the squashfs lies right behind the runtime"
    );
    assert!(said(&place.start(&image, &["--appimage-help"])).0.contains("--appimage-extract-and-run"));
    for unknown in ["--appimage-mount", "--appimage-clean-up"] {
        let refused = place.start(&image, &[unknown]);
        assert!(said(&refused).1.contains("--appimage-help"), "{}", said(&refused).1);
    }
    assert!(place.cached().is_empty());
}

#[test]
fn caches_that_cannot_be_written_to_are_told() {
    let place = Place::new();
    let image = place.put("plumbline.AppImage", Packed::new(TELLS, 1));
    let refused = made::output(place.command(&image).env_remove("XDG_CACHE_HOME"));
    assert!(said(&refused).1.contains("neither XDG_CACHE_HOME nor HOME"), "{}", said(&refused).1);
    std::fs::write(place.path("file"), "").expect("written");
    let refused = made::output(place.command(&image).env("XDG_CACHE_HOME", place.path("file")));
    assert!(said(&refused).1.contains("set XDG_CACHE_HOME to a folder"), "{}", said(&refused).1);
    let at_home =
        made::output(place.command(&image).env_remove("XDG_CACHE_HOME").env("HOME", place.path("home")));
    assert_eq!(at_home.status.code(), Some(7));
    assert_eq!(names(&place.path("home/.cache/plumbline")).len(), 2);
}

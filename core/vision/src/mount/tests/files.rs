//! The file keeps everything, and bad files are refused with a sentence.

use super::world::{World, board};
use crate::mount::{MountCalibration, MountOptions, Target};

#[test]
fn a_mount_read_back_is_the_same() {
    let mut world = World::new(20);
    let mut views = world.board_views(6);
    views[2].right = None;
    views[3].left.as_mut().expect("seen")[5] = None;
    let options = MountOptions { head_zero_sd_rad: Some(0.01), ..MountOptions::default() };
    let mut solved = world.solve_with(&views, &Target::UnknownBoard(board()), &options).expect("solvable");
    assert_eq!(solved.evidence.minutes_since_on, None, "views do not say it");
    solved.evidence.minutes_since_on = Some(12.5);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mount.toml");
    solved.write(&file).expect("writable");
    let read = MountCalibration::read(&file, &world.rig).expect("readable");
    assert_eq!(read, solved);
    assert!(read.made_with(&world.rig.eyes.cameras));
    let names: Vec<_> = std::fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(names.len(), 1, "no temporary file is left");
    // Written again it is the same text.
    let text = std::fs::read_to_string(&file).expect("readable");
    read.write(&file).expect("writable");
    assert_eq!(std::fs::read_to_string(&file).expect("readable"), text);
}

#[test]
fn bad_files_are_refused_with_a_sentence() {
    let mut world = World::new(21);
    let views = world.board_views(5);
    let solved = world.solve(&views).expect("solvable");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mount.toml");
    solved.write(&file).expect("writable");
    let good = std::fs::read_to_string(&file).expect("readable");
    let refusal = |text: &str| {
        std::fs::write(&file, text).expect("writable");
        MountCalibration::read(&file, &world.rig).expect_err("must be refused").to_string()
    };
    let line = |start: &str| good.lines().find(|line| line.starts_with(start)).expect("a line").to_owned();
    for (from, to, words) in [
        ("format = 1".to_owned(), "format = 9", "this program reads 1"),
        ("rig = \"nico\"".to_owned(), "rig = \"other\"", "made for the rig other"),
        (line("rms_px"), "rms_px = nan", "NaN is not a number"),
        (line("rms_px"), "rms = 1.0", "rms"),
        (line("pixel_sigma_px"), "pixel_sigma_px = -1.0", "must not be negative"),
        (line("rotation_wxyz"), "rotation_wxyz = [1.0, 1.0, 0.0, 0.0]", "length 1"),
        (line("translation_m"), "translation_m = [80.0, 35.0, 95.0]", "lengths are in meters"),
        ("\"head_z\"".to_owned(), "\"neck_z\"", "neck_z"),
        ("complete = true".to_owned(), "complete = false", "not whole"),
        ("square_m = 0.03".to_owned(), "square_m = -0.03", "square"),
    ] {
        assert!(good.contains(&from), "{from}");
        let message = refusal(&good.replacen(&from, to, 1));
        assert!(message.contains(words) && message.contains("mount.toml"), "{message}");
    }
    for share in [0.3, 0.7, 0.99] {
        let cut = &good[..(good.len() as f64 * share) as usize];
        let message = refusal(cut);
        assert!(message.contains("not a valid mount file"), "{message}");
    }
    assert!(refusal("").contains("is empty"));
    assert!(refusal("hello").contains("not a valid mount file"));
    let missing = MountCalibration::read(&folder.path().join("none.toml"), &world.rig).expect_err("missing");
    assert!(missing.to_string().contains("cannot be read"), "{missing}");
    let nowhere = folder.path().join("no/such/folder/mount.toml");
    assert!(solved.write(&nowhere).expect_err("no folder").to_string().contains("cannot be written"));
}

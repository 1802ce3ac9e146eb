//! A full disk: every writer says so, leaves what was there, and nothing half written.
//!
//! The disk is full for the program alone: no file of it can grow beyond a limit (`ulimit -f`), so
//! that a write fails at its beginning or in its middle, as on a full disk.

use std::path::Path;

use super::desk::{Desk, ended};

const PAIRS: &str = "--left lab/board/left --right lab/board/right --board 8x5 --square-mm 30";
const MATCH: &str = "disparity --left lab/table/left/table_00.png --right lab/table/right/table_00.png \
                     --rectified --max-disparity 64";

/// Runs a writer whose target holds "old", with no room and with some; `at_least` is a size that the
/// result surely has.
fn keeps_the_old_file(desk: &Desk, words: &str, target: &str) {
    desk.write(target, "old");
    let before = desk.files();
    for room in [0, 1024] {
        let ended = ended(desk.command_on_full_disk(words, room));
        assert_eq!(ended.status, Some(1), "{words} with room for {room} bytes: {}", ended.said);
        assert!(ended.said.contains("cannot be written ("), "{words}: {}", ended.said);
        assert!(ended.said.contains("what was there before is unchanged"), "{words}: {}", ended.said);
        assert!(desk.files() == before, "{words} with room for {room} bytes changed files");
        assert_eq!(hidden(&desk.path("")), [".home"], "{words} left something");
    }
    let done = desk.run(words);
    assert_eq!(done.status, Some(0), "{words}: {}", done.said);
    let written = &desk.files()[Path::new(target)];
    assert!(written.len() > 1024, "{target} has {} bytes, so the second try proves nothing", written.len());
}

fn hidden(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).expect("a folder").flatten();
    let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.starts_with('.')).collect()
}

#[test]
fn models_and_reports_of_touches() {
    let desk = Desk::new();
    keeps_the_old_file(&desk, "train --model m1 --session s --out model.json", "model.json");
    keeps_the_old_file(&desk, "train --model m3 --session s --out model.onnx", "model.onnx");
    keeps_the_old_file(&desk, "gap --session s --report page.html", "page.html");
    keeps_the_old_file(&desk, "gap --session s --report page.pdf", "page.pdf");
}

#[test]
fn a_model_with_effects() {
    let desk = Desk::new();
    let words = "gap --session s --add --out rig-model.toml";
    desk.write("rig-model.toml", "old");
    let before = desk.files();
    let refused = ended(desk.command_on_full_disk(words, 0));
    assert_eq!(refused.status, Some(1), "{}", refused.said);
    assert!(refused.said.contains("what was there before is unchanged"), "{}", refused.said);
    assert!(desk.files() == before);
    let done = desk.run(words);
    assert_eq!(done.status, Some(0), "{}", done.said);
}

#[test]
fn calibrations_and_maps() {
    let desk = Desk::with_pairs();
    keeps_the_old_file(&desk, &format!("{MATCH} --out map.pfm"), "map.pfm");
    keeps_the_old_file(&desk, &format!("calibrate stereo {PAIRS} --out cameras.yaml"), "cameras.yaml");
}

#[test]
fn many_files_stop_at_the_first_that_does_not_fit() {
    let desk = Desk::new();
    let refused = ended(desk.command_on_full_disk("sample --pairs 1 --out lab", 1024));
    assert_eq!(refused.status, Some(1), "{}", refused.said);
    assert!(refused.said.contains("cannot be written ("), "{}", refused.said);
    assert!(desk.files().keys().all(|file| !file.starts_with("lab")), "half an image is worse than none");
}

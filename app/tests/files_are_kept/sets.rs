//! Labeled sets: one folder holds one set, and a kill leaves whole images with their labels.

use std::path::Path;
use std::time::Duration;

use super::desk::{Desk, ended};

/// Whether anything can draw here.
fn draws(desk: &Desk) -> bool {
    let ended = desk.run("detector-set --pairs 1 --out probe");
    if ended.status != Some(0) {
        plumbline_model::measured_data::left_out(format!(
            "no images are drawn on this machine: {}",
            ended.said
        ));
    }
    ended.status == Some(0)
}

#[test]
fn a_folder_holds_one_set() {
    let desk = Desk::new();
    desk.refuses("detector-set --pairs 1 --out s", "is not empty and holds no set that this program drew");
    if !draws(&desk) {
        return;
    }
    desk.refuses("detector-set --pairs 1 --seed 2 --out probe", "holds a set that was drawn with seed 1");
    desk.refuses(
        "detector-set --pairs 1 --as-twin --out probe",
        "now it would be drawn with seed 1, world twin",
    );
    let parts = desk.run("detector-set --pairs 1 --first 1 --out probe");
    assert_eq!(parts.status, Some(0), "{}", parts.said);
}

#[test]
fn a_kill_leaves_whole_images_with_their_labels() {
    let desk = Desk::new();
    if !draws(&desk) {
        return;
    }
    let words = "detector-set --pairs 40 --out set";
    let mut seen = 0;
    for kill in 0..4_usize {
        let mut child = desk.command(words).spawn().expect("the program starts");
        // When some more images are there than the last time.
        let enough = 2 * kill + 1;
        while child.try_wait().expect("a child").is_none() && files_below(&desk, "set", "jpg").len() < enough
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        let _ = child.wait_with_output();
        for image in files_below(&desk, "set", "jpg") {
            let file = desk.path("").join(&image);
            image::open(&file).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
            let labels = image.to_string_lossy().replace("images", "labels").replace(".jpg", ".txt");
            assert!(desk.path(&labels).is_file(), "{labels} is missing");
        }
        seen = files_below(&desk, "set", "jpg").len();
    }
    assert!(seen >= 7, "{seen} images");
    // It can be drawn again, and is whole then; another seed is refused still.
    desk.refuses("detector-set --pairs 1 --seed 9 --out set", "holds a set that was drawn with seed 1");
    let again = desk.run("detector-set --pairs 2 --out set");
    assert_eq!(again.status, Some(0), "{}", again.said);
}

#[test]
fn a_full_disk_ends_the_drawing_and_keeps_what_is_whole() {
    let desk = Desk::new();
    if !draws(&desk) {
        return;
    }
    let before = desk.files();
    let refused = ended(desk.command_on_full_disk("detector-set --pairs 1 --first 5 --out probe", 1024));
    assert_eq!(refused.status, Some(1), "{}", refused.said);
    assert!(refused.said.contains("cannot be written ("), "{}", refused.said);
    let after = desk.files();
    for (file, bytes) in before {
        // Names and numbers fit into what is left, and say the same as before.
        assert!(after.get(&file) == Some(&bytes), "{} was changed", file.display());
    }
    assert!(after.keys().all(|file| !file.starts_with("probe/images") || !is_of_pair(file, 5)));
}

fn is_of_pair(file: &Path, pair: usize) -> bool {
    file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&format!("{pair:05}_")))
}

/// What the shipped detector says of a set: labels, scores, matrices.
#[test]
fn a_full_disk_leaves_labels_and_scores_as_they_were() {
    let desk = Desk::new();
    if !draws(&desk) {
        return;
    }
    let image = files_below(&desk, "probe/images", "jpg").pop().expect("an image was drawn");
    let label = image.file_name().expect("a name").to_string_lossy().replace(".jpg", ".txt");
    let folder = image.parent().expect("a folder").display().to_string();
    let probe = desk.run("detect-eval --data probe/data.yaml --split train --matrices known");
    assert_eq!(probe.status, Some(0), "{}", probe.said);
    let matrix = files_below(&desk, "known", "csv").pop().expect("a matrix");
    let matrix = matrix.file_name().expect("a name").to_string_lossy().into_owned();
    for (words, target) in [
        (format!("detect --images {folder} --labels-out found"), format!("found/{label}")),
        (
            "detect-eval --data probe/data.yaml --split train --csv scores.csv".to_owned(),
            "scores.csv".to_owned(),
        ),
        (
            "detect-eval --data probe/data.yaml --split train --matrices judged".to_owned(),
            format!("judged/{matrix}"),
        ),
    ] {
        desk.write(&target, "old");
        let before = desk.files();
        let refused = ended(desk.command_on_full_disk(&words, 0));
        assert_eq!(refused.status, Some(1), "{words}: {}", refused.said);
        assert!(refused.said.contains("cannot be written ("), "{words}: {}", refused.said);
        let after = desk.files();
        for (file, bytes) in &before {
            assert!(after.get(file) == Some(bytes), "{words}: {} was changed", file.display());
        }
        assert!(after.values().all(|bytes| !bytes.is_empty()), "{words} left an empty file");
        let done = desk.run(&words);
        assert_eq!(done.status, Some(0), "{words}: {}", done.said);
        assert!(desk.files()[Path::new(&target)] != b"old", "{words} does not write {target}");
    }
}

fn files_below(desk: &Desk, folder: &str, end: &str) -> Vec<std::path::PathBuf> {
    let below = desk.path(folder);
    if !below.is_dir() {
        return vec![];
    }
    let files = super::desk::files(&below).into_keys();
    files
        .filter(|file| file.extension().is_some_and(|found| found == end))
        .map(|file| Path::new(folder).join(file))
        .collect()
}

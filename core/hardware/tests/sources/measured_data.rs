//! Measured pairs, where they are at hand.

use std::path::PathBuf;

use plumbline_hardware::{FolderSource, PairFolder, Replay, Report, StereoSource};

use crate::world::collect;

/// A folder of the measured data, if it is at hand.
fn measured(name: &str) -> Option<PathBuf> {
    plumbline_model::measured_data::folder(name).ok()
}

#[test]
fn every_layout_of_the_measured_data_opens() {
    let expected = [
        ("nico-chessboard", 31, (640, 480)),
        ("opencv-fisheye-jy", 34, (1280, 800)),
        ("opencv-stereo-13", 13, (640, 480)),
        ("bumblebee2", 11, (640, 480)),
    ];
    for (name, count, size) in expected {
        let Some(path) = measured(name) else { return };
        let folder = PairFolder::open_one(&path).expect(name);
        assert_eq!((folder.pairs().len(), folder.image_size()), (count, Some(size)), "{name}");
        assert!(
            !folder.reports().iter().any(|r| matches!(r, Report::Unpaired { .. })),
            "{:?}",
            folder.reports()
        );
        let mut source = FolderSource::new(folder, Replay::ONCE).expect(name);
        assert_eq!(collect(&mut source, 100).expect(name).len(), count, "{name}");
        assert_eq!(source.counters().skipped, 0, "{name}");
    }
}

#[test]
fn scenes_with_pairs_and_single_images_tell_which_are_single() {
    let Some(path) = measured("nico-scenes") else { return };
    let folder = PairFolder::open_one(&path.join("images")).expect("pairs");
    assert_eq!(folder.pairs().len(), 10);
    let single: usize = folder
        .reports()
        .iter()
        .map(|report| match report {
            Report::Unpaired { files, .. } => files.len(),
            _ => 0,
        })
        .sum();
    assert_eq!(single, 20, "40 images are 10 pairs and 20 single ones");
    let told: Vec<String> = folder.reports().iter().map(ToString::to_string).collect();
    assert!(told.len() <= 2 && told[0].contains("and are left out: "), "{told:?}");
}

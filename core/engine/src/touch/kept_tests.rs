//! A run of touches on disk, when the program is killed or the disk is full.

use std::path::Path;

use jiff::Timestamp;
use plumbline_model::Pixel;
use plumbline_model::session::{TouchTable, names};
use plumbline_model::touch_plan::Purpose;

use super::record::Progress;
use super::store;
use super::testing::record;

/// What happened after so many touches.
fn progress(touches: usize) -> Progress {
    let mut progress = Progress::new(Purpose::Train, Timestamp::UNIX_EPOCH, 100_000);
    let touch =
        |number| record(number, "g", Pixel::new(100.0, 200.0), Pixel::new(101.0, number as f64 % 1000.0));
    progress.records = (1..=touches).map(touch).collect();
    progress
}

/// Touches in both files; both must be whole.
fn touches(session: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(session.join(store::PROGRESS)).expect("there");
    let progress: Progress = serde_json::from_str(&text).expect("whole");
    let table = TouchTable::read(&session.join(names::TOUCHES), &[]).expect("whole");
    (progress.records.len(), table.row_count())
}

#[test]
fn a_kill_takes_no_touch_that_was_reported() {
    const TEST: &str = "touch::kept_tests::a_kill_takes_no_touch_that_was_reported";
    if let Some(folder) = crate::ground::kept::writing() {
        let (there, _) = touches(&folder);
        // As when a run goes on: what follows from the progress is written anew.
        store::write(&folder, &[], &progress(there)).expect("written");
        for number in crate::ground::kept::until_killed() {
            store::write(&folder, &[], &progress(there + number + 1)).expect("written");
        }
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    store::write(folder.path(), &[], &progress(1)).expect("written");
    let (mut known, mut nth) = (1, 0);
    // How much is written between two kills is the disk's affair: some touches, in the end.
    while nth < 20 || (known <= 20 && nth < 1000) {
        crate::ground::kept::kill(TEST, folder.path(), nth);
        nth += 1;
        let (recorded, in_table) = touches(folder.path());
        // The table follows from the progress, which is written first.
        assert!(recorded >= known && (recorded - 1..=recorded).contains(&in_table), "kill {nth}");
        known = recorded;
    }
    assert!(known > 20, "{known} touches");
}

#[test]
fn a_full_disk_is_told_and_takes_nothing() {
    const TEST: &str = "touch::kept_tests::a_full_disk_is_told_and_takes_nothing";
    if let Some(folder) = crate::ground::kept::writing() {
        let told = store::write(&folder, &[], &progress(51)).expect_err("the disk is full").to_string();
        assert!(told.contains("cannot be written") && told.contains("what was there before is unchanged"));
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    store::write(folder.path(), &[], &progress(50)).expect("written");
    let entries = std::fs::read_dir(folder.path()).expect("there").count();
    for room in [0, 1024] {
        assert!(
            crate::ground::kept::run_on_full_disk(TEST, folder.path(), room).success(),
            "room for {room}"
        );
        assert_eq!(touches(folder.path()), (50, 50));
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), entries);
    }
}

#[test]
fn touches_that_gave_the_screen_its_place_are_not_outdated_by_it() {
    let session = tempfile::tempdir().expect("a folder");
    store::write(session.path(), &[], &progress(3)).expect("written");
    let table = session.path().join(names::TOUCHES);
    let of_table = || std::fs::metadata(&table).and_then(|about| about.modified()).expect("there");
    let kept = || {
        let text = std::fs::read_to_string(session.path().join(store::PROGRESS)).expect("there");
        serde_json::from_str::<Progress>(&text).expect("whole")
    };
    let before = of_table();
    store::keep_placement(session.path(), Timestamp::UNIX_EPOCH).expect("kept");
    assert_eq!(kept(), Progress { gave_placement: Some(Timestamp::UNIX_EPOCH), ..progress(3) });
    assert_eq!(of_table(), before, "findings in these touches are of the same tables");
    let empty = tempfile::tempdir().expect("a folder");
    assert!(store::keep_placement(empty.path(), Timestamp::UNIX_EPOCH).is_err(), "there is no run");
}

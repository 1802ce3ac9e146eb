//! A source that is lost is told, retried, and comes back by itself.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use plumbline_hardware::{
    Lost, Next, Replay, Report, RetryPolicy, Retrying, SourceError, SourceOptions, SourceSpec, SourceStatus,
    StereoSource, open, open_retrying,
};

use crate::world::{World, collect, moment_of};

const FAST: RetryPolicy =
    RetryPolicy { first_pause: Duration::from_millis(10), longest_pause: Duration::from_millis(40) };

fn looping() -> SourceOptions {
    SourceOptions { replay: Replay { looping: true, ..Replay::ONCE }, ..SourceOptions::default() }
}

/// Asks until the source is lost.
fn until_lost(source: &mut Retrying) -> Lost {
    let deadline = Instant::now() + Duration::from_secs(10);
    while Instant::now() < deadline {
        source.next_pair().expect("a retrying source never fails");
        if let SourceStatus::Lost(lost) = source.status() {
            return lost;
        }
    }
    panic!("the loss was not noticed");
}

#[test]
fn a_deleted_folder_comes_back_where_it_was() {
    let world = World::new();
    world.save_pairs(0..4);
    let spec = SourceSpec::Folder(world.path().to_path_buf());
    let mut source = Retrying::open(move || open(&spec, &looping()), FAST).expect("pairs");
    let before = collect(&mut source, 2).expect("running");
    assert_eq!(before.iter().map(moment_of).collect::<Vec<_>>(), [0, 1]);

    fs::rename(world.at("left"), world.at("elsewhere")).expect("moving it away");
    let lost = until_lost(&mut source);
    assert!(lost.reason.contains("left is gone; bring it back"), "{}", lost.reason);
    assert!(matches!(source.next_pair(), Ok(Next::NotYet)));
    std::thread::sleep(Duration::from_millis(60));
    assert!(matches!(source.next_pair(), Ok(Next::NotYet)));
    let SourceStatus::Lost(later) = source.status() else { panic!("it cannot be back") };
    assert!(later.attempts > 0);
    assert_eq!(later.since, lost.since, "since when does not move with the attempts");
    assert_eq!(source.describe().pair_count, Some(4), "it is still known what was lost");

    fs::rename(world.at("elsewhere"), world.at("left")).expect("bringing it back");
    let after = collect(&mut source, 2).expect("running again");
    assert_eq!(source.status(), SourceStatus::Running);
    assert_eq!(after.iter().map(moment_of).collect::<Vec<_>>(), [2, 3], "it goes on where it was");
    assert_eq!(after[0].stamp.seq, 2, "numbers go on too");
    assert_eq!(source.counters().delivered, 4);
    let told = source.take_reports();
    assert!(
        matches!(told.as_slice(), [Report::Lost { .. }, Report::Returned { after }] if *after > Duration::from_millis(50)),
        "{told:?}"
    );
}

#[test]
fn pauses_grow_and_are_bounded() {
    let attempts = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&attempts);
    let world = World::new();
    world.save_pairs(0..2);
    let spec = SourceSpec::Folder(world.path().to_path_buf());
    let reopen = move || {
        counted.fetch_add(1, Ordering::Relaxed);
        open(&spec, &looping())
    };
    let policy =
        RetryPolicy { first_pause: Duration::from_millis(20), longest_pause: Duration::from_millis(80) };
    let mut source = Retrying::open(reopen, policy).expect("pairs");
    fs::remove_dir_all(world.at("right")).expect("deleting");
    let lost = until_lost(&mut source);
    // Pauses of 20, 40, 80, 80 ... ms: in 500 ms eight attempts at most, three at least.
    while lost.since.elapsed() < Duration::from_millis(500) {
        source.next_pair().expect("a retrying source never fails");
        assert!(source.wait_hint() <= policy.longest_pause);
        std::thread::sleep(Duration::from_millis(1));
    }
    let tried = attempts.load(Ordering::Relaxed) - 1;
    assert!((3..=8).contains(&tried), "{tried} attempts in half a second");

    source.retry_now();
    source.next_pair().expect("a retrying source never fails");
    assert_eq!(attempts.load(Ordering::Relaxed) - 1, tried + 1, "asked to retry at once");
}

#[test]
fn reports_of_files_are_not_repeated_after_a_return() {
    let world = World::new();
    world.save_pairs(0..2);
    world.write("left/lonely.png", "text");
    let spec = SourceSpec::Folder(world.path().to_path_buf());
    let mut source = Retrying::open(move || open(&spec, &looping()), FAST).expect("pairs");
    assert_eq!(source.take_reports().len(), 1);
    fs::rename(world.at("left"), world.at("elsewhere")).expect("moving it away");
    until_lost(&mut source);
    fs::rename(world.at("elsewhere"), world.at("left")).expect("bringing it back");
    collect(&mut source, 2).expect("running again");
    let told = source.take_reports();
    assert!(matches!(told.as_slice(), [Report::Lost { .. }, Report::Returned { .. }]), "{told:?}");
}

#[test]
fn a_source_that_never_was_is_an_error_at_once() {
    let world = World::new();
    let spec = SourceSpec::Folder(world.at("mistyped"));
    let error = open_retrying(&spec, &looping()).err().expect("nothing to retry");
    assert_eq!(error, SourceError::NoSuchFolder { path: world.at("mistyped") });
    let cameras = SourceSpec::Cameras { left_index: 4000, right_index: 4001 };
    let error = open_retrying(&cameras, &looping()).err().expect("no such cameras").to_string();
    assert!(
        error.contains("the left camera (number 4000) cannot be used: there is no /dev/video4000"),
        "{error}"
    );
}

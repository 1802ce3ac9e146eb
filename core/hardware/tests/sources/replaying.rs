//! Pace, winding and looping.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::{
    FolderSource, MemorySource, Next, PairFolder, Replay, ReplayRate, SourceError, StereoSource,
};
use plumbline_model::{Eye, Stamp, StereoFrame};

use crate::world::{World, collect, moment_of, moments, picture};

fn memory(count: u8, replay: Replay) -> MemorySource {
    let pair = |moment| StereoFrame {
        stamp: Stamp { seq: 99, captured_at: Instant::now() },
        left: Arc::new(picture(Eye::Left, moment)),
        right: Arc::new(picture(Eye::Right, moment)),
        time_difference_s: None,
        name: None,
        beside: Default::default(),
    };
    MemorySource::new("synthetic", (0..count).map(pair).collect(), replay).expect("a source")
}

fn folder(world: &World, count: u8, replay: Replay) -> FolderSource {
    world.save_pairs(0..count);
    FolderSource::new(PairFolder::open_one(world.path()).expect("pairs"), replay).expect("a source")
}

#[test]
fn replay_keeps_its_rate() {
    let world = World::new();
    let replay = Replay::looping_at(50.0);
    let sources: [Box<dyn StereoSource>; 2] =
        [Box::new(memory(3, replay)), Box::new(folder(&world, 3, replay))];
    for mut source in sources {
        let start = Instant::now();
        let pairs = collect(source.as_mut(), 26).expect("a running source");
        let took = start.elapsed();
        // The first pair was due when the source was made, a moment before the clock started.
        assert!(took >= Duration::from_millis(480), "25 distances of 20 ms in {took:?}");
        assert!(took < Duration::from_millis(1500), "25 distances of 20 ms in {took:?}");
        assert!(pairs.windows(2).all(|w| w[1].stamp.seq == w[0].stamp.seq + 1));
        assert_eq!(source.describe().rate_hz, Some(50.0));
    }
}

#[test]
fn winding_delivers_the_asked_pair_at_once() {
    let world = World::new();
    let slow = Replay::looping_at(0.1);
    let sources: [Box<dyn StereoSource>; 2] = [Box::new(memory(6, slow)), Box::new(folder(&world, 6, slow))];
    for mut source in sources {
        let start = Instant::now();
        for index in [4, 0, 5, 5] {
            source.as_finite().expect("finite").seek(index).expect("it is there");
            let pair = collect(source.as_mut(), 1).expect("a running source");
            assert_eq!(usize::from(moment_of(&pair[0])), index);
        }
        assert!(start.elapsed() < Duration::from_secs(5), "winding waited for the slow replay");
        assert!(matches!(source.next_pair(), Ok(Next::NotYet)));
        let finite = source.as_finite().expect("finite");
        assert_eq!(finite.pair_count(), 6);
        assert_eq!(finite.seek(6), Err(SourceError::NoSuchPair { index: 6, pairs: 6 }));
    }
}

#[test]
fn the_end_stays_the_end_until_wound_back() {
    let mut source = memory(3, Replay::ONCE);
    assert_eq!(moments(&mut source), [0, 1, 2]);
    assert!(matches!(source.next_pair(), Ok(Next::End)));
    source.as_finite().expect("finite").seek(1).expect("it is there");
    assert_eq!(moments(&mut source), [1, 2]);
    source.as_finite().expect("finite").set_replay(Replay { looping: true, ..Replay::ONCE }).expect("a rate");
    assert_eq!(
        collect(&mut source, 4).expect("looping").iter().map(moment_of).collect::<Vec<_>>(),
        [0, 1, 2, 0]
    );
}

#[test]
fn an_impossible_rate_changes_nothing() {
    let mut source = memory(3, Replay::ONCE);
    let finite = source.as_finite().expect("finite");
    let rate = ReplayRate::PairsPerSecond(-3.0);
    assert!(finite.set_replay(Replay { rate, looping: false }).is_err());
    assert_eq!(finite.replay(), Replay::ONCE);
    assert!(MemorySource::new("none", Vec::new(), Replay { rate, looping: false }).is_err());
}

#[test]
fn nothing_in_memory_is_the_end() {
    let mut source = memory(0, Replay { looping: true, ..Replay::ONCE });
    assert!(matches!(source.next_pair(), Ok(Next::End)));
}

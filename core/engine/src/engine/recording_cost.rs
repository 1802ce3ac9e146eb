//! What recording costs beside the live pictures: a running engine with eyes that deliver thirty pairs a second, with and
//! without a recording.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use plumbline_hardware::{
    Counters, Next, Report, SourceDescription, SourceError, SourceKind, SourceSpec, StereoSource,
};
use plumbline_model::{Beside, Stamp, StereoFrame};

use super::Engine;
use super::settings::EngineSettings;
use crate::ground::watched::Trial;
use crate::live::command::{LiveCommand, Products};
use crate::recording::command::RecordingCommand;
use crate::source::command::SourceCommand;
use crate::source::view::SourceStatus;
use crate::view::{RecordingState, View};

const SIZE: (u32, u32) = (640, 480);
const PERIOD: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// It is measured so long with a recording, and so long without, in turn.
const TURN: Duration = Duration::from_secs(5);
const TURNS: usize = 3;

/// Eyes that deliver a pair each thirtieth of a second, whoever asks when. Pairs that were not asked for in time are
/// counted as replaced, as cameras count them.
struct Steady {
    pictures: Vec<Arc<RgbImage>>,
    began: Instant,
    counters: Counters,
}

impl Steady {
    fn new() -> Self {
        let picture = |number: u32| {
            Arc::new(RgbImage::from_fn(SIZE.0, SIZE.1, |u, v| {
                let mut grain = ((u / 2 + number) * 0x9E37) ^ ((v / 2) * 0x85EB);
                grain = (grain ^ (grain >> 7)).wrapping_mul(0x2C1B_3C6D) >> 27;
                let shade = (90 + grain + 40 * ((u / 80 + v / 60) % 2)) as u8;
                Rgb([shade, shade - 12, shade - 30])
            }))
        };
        let pictures = (0..8).map(picture).collect();
        Self { pictures, began: Instant::now(), counters: Counters::default() }
    }

    /// How many pairs there were until now.
    fn due(&self) -> u64 {
        (self.began.elapsed().as_secs_f64() / PERIOD.as_secs_f64()) as u64
    }
}

impl StereoSource for Steady {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        let (due, seen) = (self.due(), self.counters.delivered + self.counters.superseded);
        if due <= seen {
            return Ok(Next::NotYet);
        }
        self.counters.superseded += due - seen - 1;
        let seq = self.counters.delivered;
        self.counters.delivered += 1;
        let image = |eye: u64| self.pictures[((due + 3 * eye) % 8) as usize].clone();
        Ok(Next::Pair(StereoFrame {
            stamp: Stamp { seq, captured_at: Instant::now() },
            left: image(0),
            right: image(1),
            time_difference_s: Some(0.0),
            name: None,
            beside: Beside::default(),
        }))
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Cameras,
            title: "steady eyes".to_owned(),
            image_size: Some(SIZE),
            rate_hz: Some(30.0),
            pair_count: None,
        }
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        Vec::new()
    }
}

/// What came of a turn.
#[derive(Clone, Copy, Debug, Default)]
struct Came {
    /// Pairs that a window could have shown.
    shown: usize,
    /// Of those, rectified.
    rectified: usize,
    /// Longest time without a new pair.
    longest: Duration,
}

struct Bench {
    engine: Engine,
    woken: crossbeam_channel::Receiver<()>,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let (wake, woken) = crossbeam_channel::bounded(1);
        let data_dir = Some(folder.path().to_owned());
        let settings = EngineSettings { data_dir, source: Some(SourceSpec::Twin), twin: None };
        let wake = Arc::new(move || _ = wake.try_send(()));
        let trial = Trial::with_eyes(Arc::new(|| Box::new(Steady::new())));
        let engine = Engine::start_on_trial(settings, wake, trial);
        engine.send(LiveCommand::Want(Products { rectified: true, ..Products::default() }));
        Self { engine, woken, _folder: folder }
    }

    fn until(&self, what: &str, fulfilled: impl Fn(&View) -> bool) {
        let begun = Instant::now();
        while !fulfilled(&self.engine.view()) {
            assert!(begun.elapsed() < Duration::from_secs(60), "never: {what}");
            self.engine.heartbeat();
            _ = self.woken.recv_timeout(Duration::from_millis(20));
        }
    }

    /// What comes for a while.
    fn watch(&self, time: Duration) -> Came {
        let (mut shown, mut rectified) = (BTreeSet::new(), BTreeSet::new());
        let (begun, mut newest, mut longest) = (Instant::now(), Instant::now(), Duration::ZERO);
        while begun.elapsed() < time {
            _ = self.woken.recv_timeout(Duration::from_millis(20));
            let live = self.engine.view().live.clone();
            if live.raw.as_ref().is_some_and(|raw| shown.insert(raw.stamp.seq)) {
                longest = longest.max(newest.elapsed());
                newest = Instant::now();
            }
            rectified.extend(live.rectified.as_ref().map(|pair| pair.stamp.seq));
        }
        Came { shown: shown.len(), rectified: rectified.len(), longest }
    }

    fn switch(&self, on: bool) {
        self.engine.send(if on { RecordingCommand::Start } else { RecordingCommand::Stop });
        self.until("recording is switched", |view| match view.recording.state {
            RecordingState::On { .. } => on,
            RecordingState::Off => !on,
            _ => false,
        });
    }
}

/// A measurement: `cargo test --release -p plumbline-engine --lib -- --ignored --nocapture costs_no_live`.
#[test]
#[ignore = "measures time"]
#[allow(clippy::print_stdout, reason = "a measurement")]
fn recording_thirty_pairs_a_second_costs_no_live_pair() {
    let bench = Bench::start();
    bench.engine.send(SourceCommand::Open(SourceSpec::Twin));
    bench.until("pairs", |view| view.source.status == SourceStatus::Running && view.live.rectified.is_some());
    bench.watch(Duration::from_secs(2));
    let (mut with, mut without) = (Came::default(), Came::default());
    let (mut recorded, mut dropped) = (0, 0);
    for turn in 0..2 * TURNS {
        let on = turn % 2 == 1;
        let before = bench.engine.view().source.counters.superseded;
        if on {
            bench.switch(true);
        }
        let came = bench.watch(TURN);
        if on {
            bench.switch(false);
            let last = bench.engine.view().recording.last.clone().expect("just ended");
            (recorded, dropped) = (recorded + last.so_far.pairs, dropped + last.so_far.dropped);
        }
        let replaced = bench.engine.view().source.counters.superseded - before;
        println!("recording: {on:>5}, {came:?}, {replaced} replaced before anybody asked");
        let sum = if on { &mut with } else { &mut without };
        sum.shown += came.shown;
        sum.rectified += came.rectified;
        sum.longest = sum.longest.max(came.longest);
    }
    println!("without: {without:?}; with: {with:?}; {recorded} recorded, {dropped} dropped");
    let due = TURNS as f64 * TURN.as_secs_f64() / PERIOD.as_secs_f64();
    assert!(without.shown as f64 > 0.9 * due, "this machine has too much else to do: {without:?} of {due}");
    // A pair more or less falls into a turn at its ends, and the machine has other things to do as well.
    assert!(with.shown + 3 * TURNS >= without.shown, "{with:?} {without:?}");
    assert!(recorded >= with.shown as u64, "{recorded} of {with:?}");
}

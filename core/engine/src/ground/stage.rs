//! A stage on a thread of its own: newest input in, newest output out.

use std::panic::AssertUnwindSafe;
use std::time::{Duration, Instant};

use plumbline_model::Stamp;
use plumbline_model::priority::step_back;

use super::bell::Bell;
use super::jobs::panic_message;
use super::slot::{Putter, Taker, newest_value_slot};
use super::watched::{self, Pulse, Watched, WatchedThread};

/// At work on one input for this long, a stage is taken to hang. A detector on a slow processor takes
/// seconds.
const SILENT: Duration = Duration::from_secs(30);

/// The two ends of a stage's thread. Ends when dropped.
pub struct StageThread<I, O> {
    input: Option<Putter<I>>,
    output: Taker<Result<Timed<O>, StagePanic>>,
    watched: Watched,
}

/// A stage met a defect of this program. It goes on with the next input, from scratch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StagePanic {
    /// Which stage.
    pub stage: WatchedThread,
    /// What the program said.
    pub message: String,
}

/// A result and how long it took.
#[derive(Clone, Debug)]
pub struct Timed<T> {
    /// Of the pair that it was made from.
    pub stamp: Stamp,
    /// Time spent on it.
    pub busy: Duration,
    /// The result.
    pub result: T,
}

/// Pairs skipped in front of each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Between source and engine.
    pub source: u64,
    /// In front of rectification.
    pub rectify: u64,
    /// In front of the chessboard search.
    pub corners: u64,
    /// In front of measuring.
    pub probe: u64,
    /// In front of the detector.
    pub detect: u64,
}

/// A stage of the live pipeline: a plain struct that makes something of a pair, run on a thread of its
/// own. It may keep what it needs from pair to pair.
pub trait Stage: Default + 'static {
    /// What it gets.
    type Input: Send + 'static;
    /// What it makes of it.
    type Output: Send + 'static;
    /// What its result depends on: the same input is not given twice.
    type Key: PartialEq;
    /// On which thread it runs.
    const THREAD: WatchedThread;

    /// Of which pair an input is.
    fn stamp(input: &Self::Input) -> Stamp;

    /// What the result depends on.
    fn key(input: &Self::Input) -> Self::Key;

    /// Does it.
    fn process(&mut self, input: Self::Input) -> Self::Output;
}

/// Runs a stage on a watched thread.
///
/// # Errors
/// When the system gives no thread.
pub fn start_stage<S: Stage>(pulse: Pulse, bell: Bell) -> std::io::Result<StageThread<S::Input, S::Output>> {
    let make = || {
        let mut stage = S::default();
        move |input| stage.process(input)
    };
    run_stage(pulse, bell, S::stamp, make)
}

/// Runs what `make` makes on a watched thread, which steps back behind the joint bus and the window.
/// `stamp` tells the stamp of an input.
pub fn run_stage<I, O, P>(
    pulse: Pulse,
    bell: Bell,
    stamp: impl Fn(&I) -> Stamp + Send + 'static,
    make: impl Fn() -> P + Send + 'static,
) -> std::io::Result<StageThread<I, O>>
where
    I: Send + 'static,
    O: Send + 'static,
    P: FnMut(I) -> O,
{
    let (input, inputs) = newest_value_slot::<I>();
    let (outputs, output) = newest_value_slot();
    let stage = pulse.thread();
    let work = move |(): &mut (), pulse: &Pulse| {
        // Before anything that starts threads of its own.
        step_back();
        let mut process = make();
        pulse.rest();
        while let Some(input) = inputs.take() {
            pulse.promise(SILENT);
            let (begun, stamp) = (Instant::now(), stamp(&input));
            let result = std::panic::catch_unwind(AssertUnwindSafe(|| process(input)));
            let output = match result {
                Ok(result) => Ok(Timed { stamp, busy: begun.elapsed(), result }),
                Err(panic) => {
                    // What it kept may be half changed.
                    process = make();
                    Err(StagePanic { stage, message: panic_message(panic.as_ref()) })
                }
            };
            if !outputs.put(output) {
                return;
            }
            bell.ring();
            pulse.rest();
        }
    };
    Ok(StageThread { input: Some(input), output, watched: watched::spawn(pulse, (), work)? })
}

impl<I, O> StageThread<I, O> {
    /// Hands over an input; one that was not begun yet is replaced and counted as skipped.
    pub fn put(&self, input: I) {
        if let Some(slot) = &self.input {
            slot.put(input);
        }
    }

    /// The newest output that was not taken yet.
    pub fn take(&self) -> Option<Result<Timed<O>, StagePanic>> {
        self.output.try_take()
    }

    /// Whether it does its work.
    pub fn watched(&self) -> &Watched {
        &self.watched
    }

    /// Inputs that were replaced before the stage could begin.
    pub fn skipped(&self) -> u64 {
        self.input.as_ref().map_or(0, Putter::skipped)
    }
}

impl<I, O> Drop for StageThread<I, O> {
    fn drop(&mut self) {
        self.watched.ask_to_end();
        // Cut off it ends; the watched thread is waited for.
        self.input = None;
    }
}

#[cfg(test)]
mod tests {
    use super::watched::Trial;
    use super::*;

    fn pulse(bell: &Bell) -> Pulse {
        Pulse::new(WatchedThread::Probe, bell.clone(), Trial::default())
    }

    fn stamp(seq: &u64) -> Stamp {
        Stamp { seq: *seq, captured_at: Instant::now() }
    }

    #[test]
    fn a_slow_stage_gets_the_newest_input_and_its_output_keeps_the_stamp() {
        let (bell, heard) = Bell::new();
        let (begun, begins) = crossbeam_channel::bounded::<()>(0);
        let (go, wait) = crossbeam_channel::bounded::<()>(0);
        let make = move || {
            let (begun, wait) = (begun.clone(), wait.clone());
            move |seq: u64| {
                let _ = begun.send(());
                let _ = wait.recv();
                seq * 10
            }
        };
        let stage = run_stage(pulse(&bell), bell, stamp, make).expect("a thread");
        let next = |expected: Option<(u64, u64)>| {
            go.send(()).expect("running");
            heard.recv_timeout(Duration::from_secs(10)).expect("rung");
            let output = stage.take().and_then(Result::ok);
            assert_eq!(output.map(|output| (output.stamp.seq, output.result)), expected);
        };
        stage.put(1);
        begins.recv().expect("begun");
        for seq in 2..=5 {
            stage.put(seq);
        }
        next(Some((1, 10)));
        begins.recv().expect("begun");
        next(Some((5, 50)));
        assert_eq!(stage.skipped(), 3);
        drop((go, begins));
    }

    #[test]
    fn a_stage_that_panics_says_so_and_goes_on_from_scratch() {
        let (bell, heard) = Bell::new();
        let make = || {
            let mut sum = 0;
            move |seq: u64| {
                assert!(seq != 2, "two is too much");
                sum += seq;
                sum
            }
        };
        let stage = run_stage(pulse(&bell), bell, stamp, make).expect("a thread");
        let mut outputs = Vec::new();
        for seq in [1, 2, 3] {
            stage.put(seq);
            heard.recv_timeout(Duration::from_secs(10)).expect("rung");
            outputs.push(stage.take().expect("an output").map(|output| output.result));
        }
        let panic = StagePanic { stage: WatchedThread::Probe, message: "two is too much".into() };
        assert_eq!(outputs, [Ok(1), Err(panic), Ok(3)]);
    }
}

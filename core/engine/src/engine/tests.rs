//! Every thread of a running engine is made to fail: that is seen, said within a second, and can be
//! started again.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::SourceSpec;

use super::Engine;
use super::settings::EngineSettings;
use crate::command::Command;
use crate::eyes::command::EyesCommand;
use crate::ground::watched::{Strike, Trial, WatchCommand, WatchedThread};
use crate::live::command::{LiveCommand, Products};
use crate::robot::command::RobotCommand;
use crate::robot::view::{Connection, MotionState};
use crate::source::command::SourceCommand;
use crate::source::view::SourceStatus;
use crate::view::View;

/// On a busy machine too something has come of it by then.
const PATIENCE: Duration = Duration::from_secs(60);

struct Bench {
    engine: Engine,
    trial: Trial,
    woken: crossbeam_channel::Receiver<()>,
    folder: tempfile::TempDir,
}

impl Bench {
    fn start(twin: Option<&str>) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let trial = Trial::armed();
        let (wake, woken) = crossbeam_channel::bounded(1);
        let settings = EngineSettings {
            data_dir: Some(folder.path().join("data")),
            twin: twin.map(str::to_owned),
            ..EngineSettings::default()
        };
        let wake = Arc::new(move || {
            let _ = wake.try_send(());
        });
        let engine = Engine::start_on_trial(settings, wake, trial.clone());
        Self { engine, trial, woken, folder }
    }

    /// Waits for a view that fulfills this.
    fn until(&self, what: &str, fulfilled: impl Fn(&View) -> bool) -> Arc<View> {
        let begun = Instant::now();
        loop {
            self.engine.heartbeat();
            let view = self.engine.view();
            if fulfilled(&view) {
                return view;
            }
            assert!(begun.elapsed() < PATIENCE, "never: {what}; {:?}; {:?}", view.threads, view.notices);
            let _ = self.woken.recv_timeout(Duration::from_millis(20));
        }
    }

    fn panic_in(&self, thread: WatchedThread) -> Arc<View> {
        self.trial.strike(thread, Strike::Panic);
        self.until(thread.name(), |view| view.fault(thread).is_some_and(|fault| fault.said.is_some()))
    }

    fn start_again(&self, thread: WatchedThread) -> Arc<View> {
        self.until("it lets go", |view| view.fault(thread).is_some_and(|fault| fault.can_start_again));
        self.engine.send(WatchCommand::StartAgain(thread));
        self.until("it runs again", |view| view.fault(thread).is_none())
    }

    fn open_pairs(&self) {
        let pairs = self.folder.path().join("pairs");
        write_pairs(&pairs);
        self.engine.send(SourceCommand::Open(SourceSpec::Folder(pairs)));
        self.engine.send(SourceCommand::PairsPerSecond(20.0));
    }
}

fn write_pairs(folder: &Path) {
    for side in ["left", "right"] {
        let side = folder.join(side);
        std::fs::create_dir_all(&side).expect("a folder");
        for i in 0..4_u8 {
            let image = image::RgbImage::from_fn(64, 48, |u, v| image::Rgb([u as u8, v as u8, i * 40]));
            image.save(side.join(format!("{i}.png"))).expect("written");
        }
    }
}

fn says(view: &View, words: &str) -> bool {
    view.notices.iter().any(|notice| notice.text.contains(words))
}

#[test]
fn a_robot_thread_that_died_is_said_moves_nothing_and_is_started_again_not_connected() {
    let bench = Bench::start(Some("perfect"));
    let before = bench.until("the twin's joints", |view| view.robot.measured.is_some());
    assert!(before.robot.connection.is_connected() && before.twin.running);

    let view = bench.panic_in(WatchedThread::Robot);
    let fault = view.fault(WatchedThread::Robot).expect("just seen");
    assert_eq!(fault.said.as_deref(), Some("struck by a test"));
    assert!(fault.meaning.contains("the arm holds its last goal"), "{}", fault.meaning);
    let robot = &view.robot;
    assert_eq!(robot.motion, MotionState::Unknown, "no \"arm held\"");
    assert_eq!((robot.bus.cycles_per_s, robot.bus.cycles), (None, 0), "no rate");
    assert!(matches!(&robot.connection, Connection::Lost { reason, .. } if reason.contains("power switch")));
    assert!(robot.joints.iter().all(|joint| joint.angle_rad.is_none() && joint.torque_on.is_none()));
    assert!(robot.measured.is_none() && robot.stopped && !view.twin.running);
    assert!(says(&view, "struck by a test") && says(&view, "failed inside"));

    // Every command is answered with the reason.
    for command in [
        RobotCommand::ConnectTwin { scenario: "perfect".to_owned() },
        RobotCommand::RunPreview,
        RobotCommand::ReleaseStop,
    ] {
        let said = bench.engine.view().notices.iter().map(|notice| notice.times).sum::<u32>();
        bench.engine.send(command.clone());
        let answered = bench
            .until("an answer", |view| view.notices.iter().map(|notice| notice.times).sum::<u32>() > said);
        let answer = answered.notices.last().expect("an answer").text.clone();
        assert!(answer.contains("What talks to the arm has failed inside"), "{command:?}: {answer}");
    }
    assert_eq!(bench.engine.view().robot.motion, MotionState::Unknown);

    bench.start_again(WatchedThread::Robot);
    let view = bench.until("not connected", |view| view.robot.connection == Connection::None);
    assert!(says(&view, "Nothing is connected, and nothing moves"));
    assert!(view.robot.stopped, "STOP stays pressed until the operator releases it");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(bench.engine.view().robot.connection, Connection::None, "it never connects by itself");

    // Connected as usual, it works as before, with another twin's eyes.
    bench.engine.send(RobotCommand::ConnectTwin { scenario: "perfect".to_owned() });
    let view = bench.until("the twin's joints again", |view| view.robot.measured.is_some());
    assert!(view.robot.connection.is_connected() && view.twin.running);
    bench.engine.send(RobotCommand::ReleaseStop);
    bench.until("released", |view| !view.robot.stopped);
}

#[test]
fn a_silent_robot_thread_is_stopped_said_and_back_when_it_gives_a_sign_of_life() {
    let bench = Bench::start(None);
    bench.until("a robot", |view| view.robot.rig.is_some());
    bench.trial.strike(WatchedThread::Robot, Strike::Hang(Duration::from_millis(5500)));
    let struck = Instant::now();
    let view = bench.until("silence", |view| view.fault(WatchedThread::Robot).is_some());
    let fault = view.fault(WatchedThread::Robot).expect("just seen");
    assert!(fault.is_silent() && !fault.can_start_again);
    assert!(fault.meaning.contains("STOP was pressed"), "{}", fault.meaning);
    assert!(view.robot.stopped && view.robot.motion == MotionState::Unknown);
    // Struck within half a second, silent after three.
    assert!(struck.elapsed() > Duration::from_millis(2900), "{:?}", struck.elapsed());
    bench.engine.send(WatchCommand::StartAgain(WatchedThread::Robot));
    bench.until("why not", |view| says(view, "cannot be started again yet"));
    let view = bench.until("life", |view| view.fault(WatchedThread::Robot).is_none());
    assert!(says(&view, "There is a sign of life again: what talks to the arm"));
    let view = bench.until("its own word", |view| view.robot.connection == Connection::None);
    assert!(view.robot.stopped, "STOP stays pressed");
}

#[test]
fn a_source_that_died_shows_failed_and_is_opened_again() {
    let bench = Bench::start(None);
    bench.open_pairs();
    let before = bench.until("a picture", |view| view.live.raw.is_some());
    let view = bench.panic_in(WatchedThread::Source);
    match &view.source.status {
        SourceStatus::Lost { reason, .. } => {
            assert!(reason.contains("pictures that are shown are old"), "{reason}")
        }
        other => panic!("{other:?}"),
    }
    bench.engine.send(SourceCommand::Play);
    bench.until("an answer", |view| {
        view.notices.last().is_some_and(|notice| notice.text.contains("What brings the images"))
    });
    // The button of a lost source does the same as the one beside the fault.
    bench.until("it lets go", |view| {
        view.fault(WatchedThread::Source).is_some_and(|fault| fault.can_start_again)
    });
    bench.engine.send(SourceCommand::Retry);
    bench.until("it plays again", |view| view.source.status == SourceStatus::Running);
    let seq = |view: &View| view.live.raw.as_ref().map(|frame| frame.stamp.seq);
    bench.until("a new picture", |view| seq(view) > seq(&before));
    bench.until("no fault", |view| view.threads.is_empty());
}

#[test]
fn a_silent_source_shows_lost_and_is_back_when_it_gives_a_sign_of_life() {
    let bench = Bench::start(None);
    bench.open_pairs();
    bench.until("a picture", |view| view.live.raw.is_some());
    bench.trial.strike(WatchedThread::Source, Strike::Hang(Duration::from_millis(5500)));
    let view = bench.until("silence", |view| view.fault(WatchedThread::Source).is_some());
    assert!(matches!(view.source.status, SourceStatus::Lost { .. }), "{:?}", view.source.status);
    assert!(says(&view, "What brings the images gives no sign of life"));
    let view = bench.until("life", |view| view.threads.is_empty());
    assert_eq!(view.source.status, SourceStatus::Running);
}

#[test]
fn live_stages_that_died_show_failed_and_are_started_again() {
    let bench = Bench::start(None);
    bench.open_pairs();
    bench.until("a picture", |view| view.live.raw.is_some());
    bench.engine.send(LiveCommand::Want(Products { corners: true, ..Products::default() }));
    bench.until("looked at", |view| view.live.corners.is_some());
    let view = bench.panic_in(WatchedThread::Corners);
    assert!(view.live.corners.is_none(), "corners of a pair before are not shown");
    assert!(says(&view, "no board is found"));
    bench.start_again(WatchedThread::Corners);
    bench.until("looked at again", |view| view.live.corners.is_some());
}

#[test]
fn a_journal_that_died_is_said_counts_what_it_lacks_and_goes_on_in_a_new_file() {
    let bench = Bench::start(None);
    let before = bench.until("a journal", |view| view.kept.journal.is_some());
    assert_eq!((before.kept.journal_lost, before.kept.folder.clone()), (0, bench.folder.path().join("data")));
    bench.trial.strike(WatchedThread::Journal, Strike::Panic);
    bench.engine.send(EyesCommand::AutoCapture(false));
    let view = bench.until("the fault", |view| view.fault(WatchedThread::Journal).is_some());
    assert!(says(&view, "The journal is not written any more"));
    for _ in 0..3 {
        bench.engine.send(EyesCommand::AutoCapture(false));
    }
    bench.until("what it lacks", |view| view.kept.journal_lost == 4);
    let view = bench.start_again(WatchedThread::Journal);
    assert!(says(&view, "what was done meanwhile is not in it"));
    let view = bench.until("another file", |view| view.kept.journal != before.kept.journal);
    assert!(view.kept.journal_lost >= 4, "it stays known");
    let lost = view.kept.journal_lost;
    bench.engine.send(EyesCommand::AutoCapture(false));
    bench.engine.send(EyesCommand::AutoCapture(true));
    let view = bench.until("done", |view| view.eyes.auto_capture);
    assert_eq!(view.kept.journal_lost, lost);
}

#[test]
fn a_journal_that_cannot_begin_is_said_and_begins_once_it_can() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("journal"), "a file where a folder should be").expect("written");
    let settings = EngineSettings { data_dir: Some(folder.path().to_owned()), ..EngineSettings::default() };
    let engine = Engine::start(settings, Arc::new(|| {}));
    let until = |fulfilled: &dyn Fn(&View) -> bool| {
        let begun = Instant::now();
        while !fulfilled(&engine.view()) {
            assert!(begun.elapsed() < PATIENCE, "{:?} {:?}", engine.view().threads, engine.view().kept);
            std::thread::sleep(Duration::from_millis(10));
        }
    };
    until(&|view| view.fault(WatchedThread::Journal).is_some() && view.kept.no_journal_because.is_some());
    std::fs::remove_file(folder.path().join("journal")).expect("removed");
    engine.send(WatchCommand::StartAgain(WatchedThread::Journal));
    until(&|view| view.threads.is_empty() && view.kept.journal.is_some());
}

#[test]
fn when_the_heart_fails_nothing_is_shown_as_true_and_it_is_started_again_with_nothing_open() {
    let bench = Bench::start(Some("perfect"));
    bench.until("the twin's joints", |view| view.robot.measured.is_some());
    let view = bench.panic_in(WatchedThread::Engine);
    assert_eq!(view.robot.motion, MotionState::Unknown);
    assert_eq!(view.robot.bus.cycles_per_s, None);
    assert!(view.robot.stopped && !view.robot.connection.is_connected() && !view.twin.running);
    assert!(says(&view, "The heart of the program has failed inside"));
    bench.engine.send(RobotCommand::RunPreview);
    bench.until("an answer", |now| now.revision > view.revision);
    bench.engine.send(WatchCommand::StartAgain(WatchedThread::Engine));
    let view = bench.until("a new heart", |view| view.threads.is_empty() && view.robot.rig.is_some());
    assert!(!view.robot.connection.is_connected() && view.source.spec.is_none());
}

#[test]
fn a_heart_that_gives_no_sign_of_life_is_said_by_the_view_itself() {
    let bench = Bench::start(None);
    bench.until("a robot", |view| view.robot.rig.is_some());
    bench.trial.strike(WatchedThread::Engine, Strike::Hang(Duration::from_millis(6500)));
    let view = bench.until("silence", |view| view.fault(WatchedThread::Engine).is_some());
    assert!(view.fault(WatchedThread::Engine).is_some_and(|fault| fault.meaning.contains("STOP works")));
    bench.until("life", |view| view.threads.is_empty());
}

#[test]
fn what_runs_is_not_started_again() {
    let bench = Bench::start(None);
    bench.until("a robot", |view| view.robot.rig.is_some());
    bench.engine.send(Command::Watch(WatchCommand::StartAgain(WatchedThread::Robot)));
    bench.until("an answer", |view| says(view, "nothing to start again: what talks to the arm runs"));
}

#[test]
fn numbers_from_outside_end_no_thread() {
    let bench = Bench::start(None);
    bench.open_pairs();
    bench.until("a picture", |view| view.live.raw.is_some());
    let numbers = [0.0, -1.0, 1e-30, 1e-308, 1e30, 1e308, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for number in numbers {
        bench.engine.send(SourceCommand::PairsPerSecond(number));
        bench.engine.send(RobotCommand::Speed(number));
        bench
            .engine
            .send(RobotCommand::Jog(crate::JogRates { velocity_m_s: [number; 3], yaw_rad_s: number }));
        bench.engine.send(EyesCommand::MinutesSinceOn(Some(number)));
        bench.engine.send(crate::TwinCommand::AdvanceWarmUp { minutes: number });
    }
    // What is sent last comes after all of it on every thread.
    bench.engine.send(SourceCommand::Seek(2));
    bench.engine.send(RobotCommand::Speed(0.5));
    let view = bench.until("the last word", |view| (view.robot.speed - 0.5).abs() < 1e-9);
    bench.until("the third pair", |view| view.source.replay.and_then(|replay| replay.position) == Some(2));
    assert!(view.threads.is_empty(), "{:?}", view.threads);
    for words in ["cannot be played", "cannot be set", "number from 0 to 527040"] {
        assert!(says(&view, words), "{words}: {:?}", view.notices);
    }
    assert_eq!(view.eyes.minutes_since_on, Some(1e-308), "the last that is a time");
}

//! The clock of the eyes as all rooms see it: in a state with cameras, without threads.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::RgbImage;
use plumbline_hardware::SourceSpec;
use plumbline_model::{Stamp, StereoFrame};

use super::clock::CamerasClock;
use super::command::EyesCommand;
use crate::drift::command::DriftCommand;
use crate::drift::{DriftInput, DriftStage};
use crate::ground::Time;
use crate::ground::stage::{Skipped, Stage as _, Timed};
use crate::live::command::{LiveCommand, Products};
use crate::robot::News;
use crate::source::view::{ReplayView, SourceStatus, SourceView};
use crate::state::State;
use crate::twin::view::TwinView;
use crate::view::View;

const CAMERAS: SourceSpec = SourceSpec::Cameras { left_index: 0, right_index: 2 };

struct Desk {
    state: State,
    stage: DriftStage,
    time: Time,
    opened: u64,
    pairs: u64,
    _folder: tempfile::TempDir,
}

impl Desk {
    /// Drift is watched through this source.
    fn watching(spec: SourceSpec) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let state = State::new(folder.path());
        let time = Time::now();
        let mut desk =
            Self { state, stage: DriftStage::default(), time, opened: 0, pairs: 0, _folder: folder };
        desk.open(spec);
        let products = Products { rectified: true, ..Products::default() };
        desk.state.apply_at(LiveCommand::Want(products).into(), desk.time);
        desk.state.apply_at(DriftCommand::Start.into(), desk.time);
        desk
    }

    fn open(&mut self, spec: SourceSpec) {
        self.opened += 1;
        let replay = ReplayView {
            position: Some(0),
            length: 100,
            playing: true,
            looping: true,
            pairs_per_second: Some(30.0),
            growth: Default::default(),
        };
        let is_recorded = matches!(spec, SourceSpec::Recording { .. });
        self.tell(SourceView {
            opened: self.opened,
            spec: Some(spec),
            status: SourceStatus::Running,
            replay: is_recorded.then_some(replay),
            ..SourceView::default()
        });
    }

    fn tell(&mut self, view: SourceView) {
        self.state.hold_time(Some(self.time));
        self.state.source_changed(view);
    }

    fn later(&mut self, seconds: u64) {
        self.time = self.time.after(Duration::from_secs(seconds));
    }

    /// What the cameras tell.
    fn cameras(&mut self, status: SourceStatus) {
        let opened = self.opened;
        self.tell(SourceView { opened, spec: Some(CAMERAS), status, ..SourceView::default() });
    }

    /// No source is open any more.
    fn close(&mut self) {
        self.opened += 1;
        self.tell(SourceView { opened: self.opened, ..SourceView::default() });
    }

    /// The cameras go away and are back so much later.
    fn away_for(&mut self, seconds: u64) {
        self.cameras(lost(self.time.instant));
        self.later(seconds);
        self.cameras(SourceStatus::Running);
    }

    /// The machine sleeps: only the time of day goes on.
    fn sleep(&mut self, seconds: u64) {
        self.time.day = self.time.after(Duration::from_secs(seconds)).day;
        self.cameras(SourceStatus::Running);
    }

    fn is_told(&mut self, words: &str) -> bool {
        self.view().notices.iter().any(|notice| notice.text.contains(words))
    }

    fn say(&mut self, minutes: f64) {
        self.state.apply_at(EyesCommand::MinutesSinceOn(Some(minutes)).into(), self.time);
    }

    /// So much later a pair comes, and is looked at for drift.
    fn look(&mut self, after_s: u64) -> Arc<DriftInput> {
        self.later(after_s);
        let gray = Arc::new(RgbImage::new(640, 480));
        let stamp = Stamp { seq: self.pairs, captured_at: self.time.instant };
        self.pairs += 1;
        let frame = StereoFrame {
            stamp,
            left: gray.clone(),
            right: gray,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        self.state.hold_time(Some(self.time));
        self.state.frame(self.opened, frame, self.time.instant);
        let input = self.state.drift_input().expect("it is looked at");
        let result = self.stage.process(input.clone());
        self.state.drift_looked(Timed { stamp, busy: Duration::ZERO, result });
        input
    }

    fn on_s(&mut self, after_s: u64) -> Option<f64> {
        self.look(after_s).setup.eyes_on_s
    }

    fn view(&mut self) -> View {
        self.state.view(Skipped::default(), 0, self.time.instant)
    }
}

fn lost(since: Instant) -> SourceStatus {
    SourceStatus::Lost { reason: "gone".to_owned(), since, attempts: 0 }
}

fn is_about(on_s: Option<f64>, expected_s: f64) -> bool {
    on_s.is_some_and(|on_s| (on_s - expected_s).abs() < 1e-6)
}

#[test]
fn what_was_said_of_cameras_goes_on_from_look_to_look_and_what_was_not_said_is_not_known() {
    let mut desk = Desk::watching(CAMERAS);
    assert_eq!(desk.on_s(60), None, "cameras that deliver may have been on for hours");
    assert_eq!(desk.view().eyes.minutes_since_on, None);
    desk.say(12.0);
    let first = desk.look(60);
    let second = desk.look(90);
    assert!(is_about(first.setup.eyes_on_s, 780.0), "{:?}", first.setup.eyes_on_s);
    assert!(is_about(second.setup.eyes_on_s, 870.0), "{:?}", second.setup.eyes_on_s);
    assert!((second.at_s - first.at_s - 90.0).abs() < 1e-6, "{} {}", first.at_s, second.at_s);
    // Who looks live corrects by the same time.
    let live = desk.state.rectify_input().expect("it is to be rectified");
    assert_eq!(live.setup.eyes_on_s, Some(870.0));
    let shown_min = desk.view().eyes.minutes_since_on.expect("it was said");
    assert!((shown_min - 14.5).abs() < 1e-9, "{shown_min}");
}

#[test]
fn cameras_that_were_away_for_long_count_from_when_they_are_back_and_that_is_said() {
    let mut desk = Desk::watching(CAMERAS);
    desk.say(30.0);
    desk.away_for(10);
    assert!(is_about(desk.on_s(5), 1815.0), "a short loss cools no lens");
    assert!(desk.view().notices.iter().all(|notice| !notice.text.contains("counts from now")));
    desk.away_for(300);
    assert!(is_about(desk.on_s(5), 5.0));
    assert!(desk.view().notices.iter().any(|notice| notice.text.contains("counts from now")));
    // Who knows better says so.
    desk.say(35.0);
    assert!(is_about(desk.on_s(60), 2160.0));
}

#[test]
fn cameras_that_nobody_said_anything_of_are_known_once_they_were_seen_to_come_back() {
    let mut desk = Desk::watching(CAMERAS);
    assert_eq!(desk.on_s(5), None);
    desk.away_for(120);
    assert!(is_about(desk.on_s(45), 45.0));
}

#[test]
fn a_recording_of_the_twin_has_not_the_clock_of_the_twin_that_runs() {
    let twin = Arc::new(TwinView { running: true, eyes_on_s: 250.0, ..TwinView::default() });
    let mut desk = Desk::watching(SourceSpec::Twin);
    desk.state.robot_changed(News { robot: Arc::default(), twin, twins_started: 0 });
    assert_eq!(desk.on_s(5), Some(250.0));
    desk.open(SourceSpec::Recording { file: "log.mcap".into(), of_twin: true });
    assert_eq!(desk.on_s(5), None);
    let why = desk.view().drift.unexplained.expect("it cannot be explained");
    assert!(why.contains("this recording does not say"), "{why}");
    // Nor has a recording of the robot the clock of the cameras.
    desk.open(CAMERAS);
    desk.say(12.0);
    desk.open(SourceSpec::Recording { file: "log.mcap".into(), of_twin: false });
    assert_eq!(desk.on_s(5), None);
    desk.open(CAMERAS);
    assert!(is_about(desk.on_s(50), 775.0), "they were on meanwhile");
}

#[test]
fn a_clock_that_is_corrected_begins_a_watch_anew_whichever_way_it_was_wrong() {
    let mut desk = Desk::watching(CAMERAS);
    desk.say(12.0);
    let mut before = desk.look(60);
    assert_eq!(desk.look(60).watch, before.watch, "nothing was set");
    for (minutes, on_s) in [(40.0, 2460.0), (5.0, 360.0)] {
        desk.say(minutes);
        let after = desk.look(60);
        assert!(is_about(after.setup.eyes_on_s, on_s), "{:?}", after.setup.eyes_on_s);
        assert_ne!(after.watch, before.watch, "{minutes} min: times of two clocks are no one course");
        before = after;
    }
    assert!(desk.is_told("was set: watching drift begins anew"));
    assert!(!desk.is_told("switched on again"), "nobody did");
}

#[test]
fn cameras_that_could_not_be_opened_again_after_a_loss_were_away_all_the_time() {
    let mut desk = Desk::watching(CAMERAS);
    desk.say(30.0);
    desk.cameras(lost(desk.time.instant));
    desk.later(20);
    desk.close();
    desk.later(20);
    desk.open(CAMERAS);
    assert!(is_about(desk.on_s(5), 5.0), "they were away for 40 s");
    assert!(desk.is_told("counts from now"));
}

#[test]
fn of_other_cameras_nobody_knows_how_long_they_have_been_on() {
    let mut desk = Desk::watching(CAMERAS);
    desk.say(30.0);
    desk.open(SourceSpec::Cameras { left_index: 2, right_index: 0 });
    assert!(is_about(desk.on_s(5), 1805.0), "the same two, the other way round");
    desk.open(SourceSpec::Cameras { left_index: 0, right_index: 4 });
    assert_eq!(desk.on_s(5), None);
    assert_eq!(desk.view().eyes.minutes_since_on, None);
}

#[test]
fn after_a_sleep_of_the_computer_it_is_not_known_how_long_the_cameras_have_been_on() {
    let mut desk = Desk::watching(CAMERAS);
    desk.sleep(3600);
    assert!(!desk.is_told("slept"), "nothing was known that is known no more");
    desk.say(30.0);
    desk.sleep(20);
    assert!(is_about(desk.on_s(5), 1805.0), "the time of day was corrected a little");
    desk.sleep(3600);
    assert_eq!(desk.on_s(5), None);
    assert!(desk.is_told("slept"));
    desk.say(95.0);
    assert!(is_about(desk.on_s(60), 5760.0), "once it was said again, it goes on");
}

#[test]
fn what_is_said_while_no_source_is_open_is_not_of_the_cameras() {
    let mut desk = Desk::watching(CAMERAS);
    desk.close();
    desk.say(12.0);
    assert_eq!(desk.view().eyes.minutes_since_on, Some(12.0), "of pairs that are collected");
    desk.later(60);
    assert_eq!(desk.view().eyes.minutes_since_on, Some(12.0), "nothing is live");
    desk.open(CAMERAS);
    assert_eq!(desk.on_s(5), None);
}

#[test]
fn before_it_was_switched_on_a_camera_was_not_on() {
    let start = Time::now();
    let said_at = |seconds| start.after(Duration::from_secs(seconds));
    let at = |seconds| said_at(seconds).instant;
    let mut clock = CamerasClock::default();
    clock.say(Some(1.0), said_at(100));
    assert!(is_about(clock.on_s(at(50)), 10.0));
    assert_eq!(clock.on_s(at(30)), None);
    assert_eq!(clock.shown_min(at(100)), Some(1.0), "as it was said");
    clock.say(None, said_at(120));
    assert_eq!(clock.on_s(at(130)), None);
}

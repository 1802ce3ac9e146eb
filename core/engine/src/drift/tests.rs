//! From the press to what the window shows, on rendered pairs.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use image::{GrayImage, RgbImage};
use nalgebra::{Isometry3, Vector3};
use plumbline_drift::{Mover, Verdict};
use plumbline_effects::{Kind, RobotModel};
use plumbline_model::robot::{CalibratedAt, Rig, default_rig};
use plumbline_model::{Stamp, StereoFrame};
use plumbline_vision::health::turned;
use plumbline_vision::synthetic::{Plane, Scene, granite_texture};

use super::cold::counted_twice;
use super::command::DriftCommand;
use super::view::{BeganAnew, DriftView};
use super::{DriftAround, DriftStage, DriftWorkflow, Told};
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::stage::{Skipped, Stage as _, Timed};
use crate::ground::step::StepState;
use crate::ground::{Context, Moment, Time, Workflow as _, World};
use crate::rig_models::made_up::model_with;

const EVERY: Duration = Duration::from_secs(3);

struct Desk {
    room: DriftWorkflow,
    stage: DriftStage,
    around: DriftAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
    pairs: u64,
    /// A look takes so long.
    busy: Duration,
}

impl Desk {
    fn new() -> Self {
        let around = DriftAround {
            is_live: true,
            is_recorded: false,
            recorded_head_rad: None,
            opened: 1,
            model: Arc::new(RobotModel::nominal(default_rig())),
            own_eyes: false,
            robot: Arc::default(),
            eyes_on_s: Some(3600.0),
            clock_settings: 0,
            is_calibrated: false,
            is_mounted: false,
            clock_pace: 1.0,
            world: None,
            twin: None,
            found: None,
            board: None,
        };
        Self {
            room: DriftWorkflow::new(Path::new("")),
            stage: DriftStage::default(),
            around,
            notices: Notices::default(),
            jobs: JobList::default(),
            time: Time::now(),
            pairs: 0,
            busy: Duration::from_millis(50),
        }
    }

    fn with(
        &mut self,
        act: impl FnOnce(&mut DriftWorkflow, &DriftAround, &mut super::workflow::Context<'_>),
    ) {
        let Self { room, around, notices, jobs, time, .. } = self;
        let mut asked = Vec::new();
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
    }

    fn ask(&mut self, command: DriftCommand) {
        self.with(|room, around, context| room.apply(command, around, context));
    }

    /// A pair comes, the thread looks if it is to; whether it did.
    fn see(&mut self, images: &[Arc<RgbImage>; 2]) -> bool {
        self.pairs += 1;
        self.time = self.time.after(EVERY);
        self.around.eyes_on_s = self.around.eyes_on_s.map(|on_s| on_s + EVERY.as_secs_f64());
        let stamp = Stamp { seq: self.pairs, captured_at: self.time.instant };
        let [left, right] = images.clone();
        let frame = StereoFrame {
            stamp,
            left,
            right,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        self.with(|room, around, context| room.saw(&frame, around, context));
        let Some(input) = self.room.input() else { return false };
        let result = self.stage.process(input);
        let output = Timed { stamp, busy: self.busy, result };
        self.with(|room, _, context| room.looked(output, context));
        true
    }

    fn view(&mut self) -> Arc<DriftView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    fn said(&mut self) -> Vec<String> {
        self.notices.view().iter().map(|notice| notice.text.clone()).collect()
    }

    /// A table and a wall, the right eye turned about its upright axis.
    fn pair(&self, pan_deg: f64) -> [Arc<RgbImage>; 2] {
        let table = Isometry3::new(Vector3::new(0.0, 0.25, 0.5), Vector3::new(1.9, 0.0, 0.0));
        let wall = Isometry3::translation(0.0, 0.0, 1.6);
        let planes =
            vec![Plane::new(table, granite_texture(0.012, 7)), Plane::new(wall, granite_texture(0.05, 8))];
        let scene = Scene { planes, balls: vec![], background: 90.0 };
        let cameras = &self.around.model.rig().eyes.cameras;
        let eyes = turned(cameras, &Vector3::new(0.0, pan_deg.to_radians(), 0.0));
        let (left, right) = scene.render_pair(&eyes, 1.0, 3);
        let rgb = |gray: GrayImage| Arc::new(image::DynamicImage::ImageLuma8(gray).to_rgb8());
        [rgb(left), rgb(right)]
    }
}

#[test]
fn a_knocked_eye_is_told_once_and_shown_with_its_cost() {
    let mut desk = Desk::new();
    let (still, knocked) = (desk.pair(0.0), desk.pair(0.5));
    assert!(!desk.see(&still), "nobody asked for it");
    desk.ask(DriftCommand::Start);
    assert_eq!(desk.view().step, StepState::Running);
    for _ in 0..17 {
        assert!(desk.see(&still));
    }
    let course = desk.view().course.clone().expect("looked");
    assert!(matches!(course.verdict, Verdict::Steady { .. }), "{:?}", course.verdict);
    assert!(course.from_switching_on && course.points.len() == 17 && course.band_m.is_some());
    assert_eq!(desk.said(), [""; 0]);
    for _ in 0..4 {
        desk.see(&knocked);
    }
    let view = desk.view();
    let course = view.course.clone().expect("looked");
    let Verdict::Moved(alarm) = course.verdict else { panic!("{:?}", course.verdict) };
    assert_eq!(alarm.what, Mover::RightEye);
    assert!((course.turns_rad[1][1].to_degrees() - 0.5).abs() < 0.02, "{:?}", course.turns_rad);
    assert!(matches!(&view.step, StepState::Stale { why } if why.contains("right eye")), "{:?}", view.step);
    assert_eq!(desk.said().len(), 1, "{:?}", desk.said());
    assert!(desk.said()[0].contains("right eye has turned"), "{:?}", desk.said());
    // What was seen stays to be looked at.
    desk.ask(DriftCommand::Stop);
    assert!(!desk.see(&knocked) && desk.view().course.is_some() && !desk.view().is_watching);
    assert_eq!(desk.view().step, StepState::Done);
    assert!(desk.room.newest(2).is_none(), "other eyes have not moved");
    let Some((watch, Told::Newest(model, newest))) = desk.room.newest(1) else { panic!("it stands") };
    assert!(watch == 1 && Arc::ptr_eq(model, &desk.around.model) && newest.off_m[2] > 0.005, "{newest:?}");
    // Another watch begins with nothing moved.
    desk.ask(DriftCommand::Start);
    assert!(matches!(desk.room.newest(1), Some((2, Told::Nothing))));
}

#[test]
fn lights_off_another_source_and_eyes_switched_on_again() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..3).for_each(|_| _ = desk.see(&still));
    let dark = [0, 1].map(|_| Arc::new(RgbImage::from_pixel(640, 480, image::Rgb([3; 3]))));
    (0..5).for_each(|_| _ = desk.see(&dark));
    let view = desk.view();
    assert!(view.failed.is_some(), "nothing can be seen in the dark");
    assert_eq!(view.course.as_ref().map(|course| course.points.len()), Some(3), "what was seen stays");
    desk.see(&still);
    assert_eq!(desk.view().failed, None);
    // Cold again.
    desk.around.eyes_on_s = Some(0.0);
    desk.see(&still);
    assert!(desk.said().iter().any(|text| text.contains("switched on again")), "{:?}", desk.said());
    assert_eq!(desk.view().course.as_ref().map(|course| course.points.len()), Some(1));
    let anew = desk.view().anew.clone().expect("nobody asked for it");
    assert_eq!((anew.why, anew.moved_before), (BeganAnew::SwitchedOn, None));
    desk.around.opened = 2;
    desk.see(&still);
    assert_eq!(desk.view().anew.as_ref().map(|anew| anew.why), Some(BeganAnew::Opened));
    assert_eq!(
        desk.view().course.as_ref().map(|course| course.points.len()),
        Some(1),
        "other eyes, a new watch"
    );
    desk.around.is_live = false;
    assert!(!desk.see(&still));
    assert!(desk.view().waits_because.as_deref().is_some_and(|why| why.contains("No pairs come")));
    desk.ask(DriftCommand::Start);
    assert!(desk.said().last().is_some_and(|text| text.contains("Nothing can be watched yet")));
}

/// The cameras go off and on: that an eye was knocked before is not forgotten, until somebody begins a new watch or
/// another world is looked at.
#[test]
fn what_had_moved_before_the_cameras_were_switched_on_again_stays_said() {
    let mut desk = Desk::new();
    let (still, knocked) = (desk.pair(0.0), desk.pair(0.5));
    desk.ask(DriftCommand::Start);
    (0..17).for_each(|_| _ = desk.see(&still));
    (0..4).for_each(|_| _ = desk.see(&knocked));
    let moved_before = |desk: &mut Desk| desk.view().anew.as_ref().and_then(|anew| anew.moved_before.clone());
    let says_so =
        |desk: &mut Desk| moved_before(desk).is_some_and(|moved| moved.contains("right eye has turned"));
    assert!(desk.view().anew.is_none());
    for opened in [2, 3] {
        desk.around.opened = opened;
        desk.see(&knocked);
        assert!(says_so(&mut desk), "{:?}", desk.view().anew);
    }
    desk.around.world = Some(World::Twin);
    desk.around.opened = 4;
    desk.see(&knocked);
    assert!(desk.view().anew.is_some() && !says_so(&mut desk), "the twin's eyes were not knocked");
    desk.ask(DriftCommand::Start);
    assert!(desk.view().anew.is_none(), "it was asked for");
}

/// A hand that waves: it hides most of both images, elsewhere each time.
fn hidden(pair: &[Arc<RgbImage>; 2], wave: u32) -> [Arc<RgbImage>; 2] {
    pair.clone().map(|image| {
        let mut image = RgbImage::clone(&image);
        let (from, width) = (wave * 37 % 120, 500);
        for (u, v, pixel) in image.enumerate_pixels_mut() {
            if (from..from + width).contains(&u) {
                let shade = 150 + ((u + 13 * wave) / 9 % 5 * 8 + v / 11 % 4 * 6) as u8;
                *pixel = image::Rgb([shade, shade - 30, shade - 50]);
            }
        }
        Arc::new(image)
    })
}

#[test]
fn a_hand_that_waves_before_the_eyes_turns_no_eye() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..17).for_each(|_| _ = desk.see(&still));
    for wave in 0..8 {
        desk.see(&hidden(&still, wave));
    }
    (0..4).for_each(|_| _ = desk.see(&still));
    let view = desk.view();
    let course = view.course.clone().expect("looked");
    assert!(matches!(course.verdict, Verdict::Steady { .. }), "{}", course.sentence);
    assert_eq!((view.failed.clone(), course.alarms.len()), (None, 0), "{:?}", desk.said());
}

#[test]
fn looking_takes_three_percent_of_a_core_at_most() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..17).for_each(|_| _ = desk.see(&still));
    assert!(desk.view().course.as_ref().is_some_and(|course| course.band_m.is_some()), "it has learned");
    for busy_ms in [300, 900] {
        desk.busy = Duration::from_millis(busy_ms);
        let looks = (0..200).filter(|_| desk.see(&still)).count();
        let share = looks as f64 * desk.busy.as_secs_f64() / (200.0 * EVERY.as_secs_f64());
        assert!(looks > 0 && share <= 0.031, "{busy_ms} ms a look, {looks} looks: {share}");
    }
}

#[test]
fn it_looks_seldom_and_waits_while_the_thread_is_at_work() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    assert!(desk.see(&still));
    let [left, right] = still;
    let frame = StereoFrame {
        stamp: Stamp { seq: 99, captured_at: desk.time.instant },
        left,
        right,
        time_difference_s: None,
        name: None,
        beside: Default::default(),
    };
    desk.time = desk.time.after(Duration::from_millis(500));
    desk.with(|room, around, context| room.saw(&frame, around, context));
    assert!(desk.room.input().is_none(), "half a second later is too early");
    desk.time = desk.time.after(EVERY);
    desk.with(|room, around, context| room.saw(&frame, around, context));
    let waits = desk.room.input().expect("it is time");
    desk.time = desk.time.after(EVERY);
    let later = StereoFrame { stamp: Stamp { seq: 100, captured_at: desk.time.instant }, ..frame };
    desk.with(|room, around, context| room.saw(&later, around, context));
    assert!(Arc::ptr_eq(&waits, &desk.room.input().expect("the same")), "one at a time");
}

#[test]
fn a_clock_of_the_eyes_that_goes_back_a_little_is_no_switching_on() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..3).for_each(|_| _ = desk.see(&still));
    // Set by somebody, or by the network: back by a little more than has passed since the last look.
    desk.around.eyes_on_s = desk.around.eyes_on_s.map(|on_s| on_s - EVERY.as_secs_f64() - 0.5);
    (0..2).for_each(|_| _ = desk.see(&still));
    let course = desk.view().course.clone().expect("looked");
    assert_eq!(desk.said(), [""; 0], "nobody switched them on again");
    let times: Vec<f64> = course.points.iter().map(|point| point.at_s).collect();
    assert!(times.len() == 5 && times.windows(2).all(|two| two[0] <= two[1]), "{times:?}");
}

/// What is said when ten minutes of eyes that stand still are to be explained.
fn said_when_explained(calibrated_at: CalibratedAt) -> Vec<String> {
    let mut desk = Desk::new();
    let mut rig = Rig::clone(&default_rig());
    rig.eyes.calibrated_at = calibrated_at;
    desk.around.model = Arc::new(RobotModel::nominal(Arc::new(rig)));
    desk.around.world = Some(World::Robot);
    (desk.around.is_calibrated, desk.around.is_mounted) = (true, true);
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    for _ in 0..20 {
        desk.time = desk.time.after(Duration::from_secs(27));
        desk.around.eyes_on_s = desk.around.eyes_on_s.map(|on_s| on_s + 27.0);
        desk.see(&still);
    }
    assert_eq!(desk.view().unexplained, None);
    desk.ask(DriftCommand::Explain);
    assert!(desk.view().is_busy, "{:?}", desk.said());
    desk.said()
}

#[test]
fn that_a_correction_may_count_twice_what_a_calibration_of_unknown_time_holds_is_said() {
    let known = CalibratedAt { cameras_s: Some(1500.0), mount_s: Some(1560.0) };
    assert_eq!(said_when_explained(known), [""; 0], "a correction goes on from there");
    // Of what was imported, or made before that was kept, nobody knows it.
    let unknown = [
        (CalibratedAt { cameras_s: None, ..known }, "the calibration in use was"),
        (CalibratedAt { mount_s: None, ..known }, "the mount in use was"),
        (CalibratedAt::default(), "the calibration and the mount in use were"),
    ];
    for (calibrated_at, words) in unknown {
        let said = said_when_explained(calibrated_at);
        let is_said = |text: &String| ["not known", words, "twice"].iter().all(|part| text.contains(part));
        assert!(said.iter().any(is_said), "{said:?}");
    }
}

#[test]
fn that_an_effect_in_force_counts_from_cold_eyes_beside_a_warm_calibration_is_said() {
    let said = |reference_s: f64, shape: Option<f64>, calibrated_s: f64| {
        let mut rig = Rig::clone(&default_rig());
        rig.eyes.calibrated_at = CalibratedAt { cameras_s: Some(calibrated_s), mount_s: Some(calibrated_s) };
        let mut added = model_with(&rig, &[("eye-yaw", "right", &[0.006])]);
        for effect in &mut added.contents.effects {
            (effect.shape, effect.reference_s) = (shape, reference_s);
        }
        let model = RobotModel::new(Arc::new(rig), Arc::new(added)).expect("it fits");
        counted_twice(&DriftAround { model: Arc::new(model), ..Desk::new().around })
    };
    let cold = said(0.0, Some(300.0), 1500.0);
    assert!(
        matches!(&cold[..], [words] if words.contains(Kind::EyeYaw.about()) && words.contains("25 min")),
        "{cold:?}"
    );
    for (reference_s, shape, calibrated_s) in
        [(1500.0, Some(300.0), 1500.0), (0.0, None, 1500.0), (0.0, Some(300.0), 20.0)]
    {
        assert_eq!(said(reference_s, shape, calibrated_s), [""; 0], "{reference_s} {shape:?} {calibrated_s}");
    }
}

#[test]
fn a_clock_that_was_set_begins_the_watch_anew_with_words_of_its_own() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..3).for_each(|_| _ = desk.see(&still));
    for (nth, on_s) in [7200.0, 60.0].into_iter().enumerate() {
        (desk.around.eyes_on_s, desk.around.clock_settings) = (Some(on_s), nth as u64 + 1);
        (0..2).for_each(|_| _ = desk.see(&still));
        let course = desk.view().course.clone().expect("looked");
        assert_eq!(course.points.len(), 2, "what was seen by the other clock is no part of it");
        assert!(
            (course.points[0].at_s - on_s - EVERY.as_secs_f64()).abs() < 1e-6,
            "{}",
            course.points[0].at_s
        );
    }
    let said = desk.said();
    // The same words twice take one line, which counts them.
    let notices = desk.notices.view();
    let times = notices.iter().filter(|notice| notice.text.contains("was set")).map(|notice| notice.times);
    assert_eq!(times.sum::<u32>(), 2, "{said:?}");
    assert!(!said.iter().any(|text| text.contains("switched on again")), "{said:?}");
}

/// Time that all threads of this program were on a processor, s; `None` where the system does not say.
fn on_processor_s() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = told.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |k: usize| fields.get(k)?.parse::<f64>().ok();
    // User and system, in hundredths of a second.
    Some(0.01 * (ticks(11)? + ticks(12)?))
}

/// A measurement: `cargo test --release -p plumbline-engine --lib -- --ignored --nocapture what_looking_takes`.
#[test]
#[ignore = "measures time, alone"]
#[allow(clippy::print_stdout, reason = "a measurement")]
fn what_looking_takes_of_a_processor() {
    let mut desk = Desk::new();
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    (0..17).for_each(|_| _ = desk.see(&still));
    let (looks, began) = (40, std::time::Instant::now());
    let before_s = on_processor_s().expect("this system says");
    for number in 0..looks {
        // What the thread is handed, and what it makes of it.
        desk.time = desk.time.after(Duration::from_secs(60));
        assert!(desk.see(&still), "look {number}");
    }
    let (cpu_s, wall_s) = (on_processor_s().expect("as before") - before_s, began.elapsed().as_secs_f64());
    let (cpu_s, wall_s) = (cpu_s / f64::from(looks), wall_s / f64::from(looks));
    // It rests until its wall time is three percent, and two seconds at least.
    let share = cpu_s / (wall_s / 0.03).max(2.0);
    println!(
        "a look: {:.0} ms on processors, {:.0} ms by the clock; {:.1} % of a core",
        1e3 * cpu_s,
        1e3 * wall_s,
        1e2 * share
    );
    assert!(share <= 0.032, "{share}");
}

#[test]
fn what_a_recording_says_of_time_and_head_is_used() {
    let mut desk = Desk::new();
    desk.around.is_recorded = true;
    desk.around.recorded_head_rad = Some([0.2, -0.5]);
    let posture = desk.around.posture();
    let eyes = &desk.around.model.rig().eyes;
    assert_eq!([posture[eyes.pan], posture[eyes.tilt]], [0.2, -0.5], "as the head stood then");
    let still = desk.pair(0.0);
    desk.ask(DriftCommand::Start);
    desk.see(&still);
    assert!(desk.view().course.as_ref().is_some_and(|course| course.from_switching_on));
    assert_ne!(
        desk.view().unexplained,
        Some("this recording does not say when its cameras were switched on")
    );
    // It begins again at its end.
    desk.around.eyes_on_s = Some(100.0);
    desk.see(&still);
    assert!(desk.said().iter().any(|text| text.contains("wound back")), "{:?}", desk.said());
    // An older one says nothing of it.
    desk.around.eyes_on_s = None;
    desk.see(&still);
    assert_eq!(
        desk.view().unexplained,
        Some("this recording does not say when its cameras were switched on")
    );
}

#[test]
fn the_board_is_a_reference_while_it_is_seen() {
    let mut desk = Desk::new();
    let model = desk.around.model.clone();
    let posture = desk.around.posture();
    let corners = [[0.3, 0.1], [0.3, -0.1], [0.45, -0.1], [0.45, 0.1]];
    let seen = corners.map(|[x, y]| {
        let corner = plumbline_model::Point::new(x, y, 0.0);
        model.project(&corner, &posture, &plumbline_effects::SeenUnder::default()).expect("before both eyes")
    });
    let captured_at = desk.time.instant;
    let outlines = [seen.map(|(left, _)| left), seen.map(|(_, right)| right)];
    desk.around.board = Some(super::BoardAt { captured_at, outlines });
    let frame = |after: Duration| StereoFrame {
        stamp: Stamp { seq: 1, captured_at: captured_at + after },
        left: Arc::new(RgbImage::new(8, 8)),
        right: Arc::new(RgbImage::new(8, 8)),
        time_difference_s: None,
        name: None,
        beside: Default::default(),
    };
    let board = |desk: &Desk, after: Duration| {
        let all = desk.around.references(&frame(after));
        all.into_iter().find(|reference| reference.name == "Board")
    };
    let found = board(&desk, Duration::from_millis(300)).expect("it was seen just now");
    assert!(found.place.distance_m(&plumbline_model::Point::new(0.3, 0.1, 0.0)) < 1e-6, "{found:?}");
    assert!(board(&desk, Duration::from_secs(60)).is_none(), "a minute ago it lay there");
}

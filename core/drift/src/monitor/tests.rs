//! Courses that were made up: what is noticed, named, and left alone.

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::robot::default_rig;

use super::*;
use crate::cost::errors;
use crate::watch::{ReferenceKind, ReferenceSeen};
use crate::words;

const EVERY_S: f64 = 3.0;
/// Scatter of a turn from look to look, rad: ten times what was measured.
const SCATTER_RAD: f64 = 1e-4;

struct Course {
    model: Arc<RobotModel>,
    monitor: Monitor,
    at_s: f64,
    dice: u64,
}

impl Course {
    fn new(at_s: f64) -> Self {
        let model = Arc::new(RobotModel::nominal(default_rig()));
        Self { model, monitor: Monitor::default(), at_s, dice: 1 }
    }

    /// Sum of twelve throws: normal enough, and the same every time.
    fn noise(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.dice =
                self.dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (self.dice >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    }

    fn look(&mut self, left_rad: Vector3<f64>, right_rad: Vector3<f64>, references: Vec<ReferenceSeen>) {
        let scatter = |course: &mut Self| Vector3::from_fn(|_, _| SCATTER_RAD * course.noise());
        let turns_rad = [left_rad + scatter(self), right_rad + scatter(self)];
        let rig = self.model.rig().clone();
        let seen = SeenUnder::default();
        let table = errors(&self.model, &rig.home(), turns_rad, &seen, &seen).expect("seen");
        let right_from_left = rig.eyes.cameras.right_from_left.isometry.rotation;
        let look = Look {
            turns_rad,
            sigmas_rad: [SCATTER_RAD; 2],
            against_rad: turns_rad[1] - right_from_left * turns_rad[0],
            knows_which: true,
            table,
            epipolar_px: None,
            references,
            along_share: 1.0,
        };
        self.monitor.add(Sample { at_s: self.at_s, look });
        self.at_s += EVERY_S;
    }

    fn still(&mut self, looks: usize) {
        (0..looks).for_each(|_| self.look(Vector3::zeros(), Vector3::zeros(), vec![]));
    }
}

fn degrees(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z).map(f64::to_radians)
}

fn moved(course: &Course) -> Alarm {
    match course.monitor.verdict() {
        Verdict::Moved(alarm) => alarm,
        other => panic!("nothing has moved: {other:?}"),
    }
}

#[test]
fn half_a_degree_is_noticed_within_ten_seconds_and_named() {
    for axis in [degrees(0.5, 0.0, 0.0), degrees(0.0, 0.5, 0.0), degrees(0.0, -0.5, 0.0)] {
        let none = Vector3::zeros();
        for (left, right, what) in
            [(axis, none, Mover::LeftEye), (none, axis, Mover::RightEye), (axis, axis, Mover::Head)]
        {
            let mut course = Course::new(3600.0);
            course.still(40);
            assert!(matches!(course.monitor.verdict(), Verdict::Steady { .. }));
            let at_s = course.at_s;
            let mut looks = 0;
            while !matches!(course.monitor.verdict(), Verdict::Moved(_)) {
                course.look(left, right, vec![]);
                looks += 1;
                assert!(f64::from(looks) * EVERY_S <= 10.0, "{what:?} {axis:?}: not noticed in time");
            }
            let alarm = moved(&course);
            assert_eq!((alarm.what, alarm.since_s, alarm.sudden), (what, at_s, true), "{axis:?}");
            assert!(alarm.cost_m[2] > 0.001, "{what:?} {axis:?}: {:?}", alarm.cost_m);
            let said = words::alarm(&alarm);
            assert!(said.contains("minute 62") && said.contains("far"), "{said}");
            // It stays one alarm, and goes when the eye is put back.
            (0..20).for_each(|_| course.look(left, right, vec![]));
            assert_eq!(course.monitor.alarms().len(), 1);
            course.still(3);
            assert!(matches!(course.monitor.verdict(), Verdict::Steady { .. }));
        }
    }
}

#[test]
fn healthy_eyes_raise_no_alarm_in_eight_hours() {
    let mut course = Course::new(3600.0);
    let looks = (8.0 * 3600.0 / EVERY_S) as usize;
    course.still(looks);
    assert_eq!(course.monitor.alarms(), &[]);
    assert!(matches!(course.monitor.verdict(), Verdict::Steady { .. }));
    assert!(course.monitor.samples().len() <= super::MOST_SAMPLES, "what is old is thinned out");
}

#[test]
fn eyes_that_warm_up_are_told_from_a_knock_and_how_long_it_takes() {
    let mut course = Course::new(0.0);
    let (tau_s, most) = (420.0, degrees(0.01, -0.3, 0.01));
    let mut told_s = vec![];
    while course.at_s < 2000.0 {
        let share = 1.0 - (-course.at_s / tau_s).exp();
        course.look(-0.6 * most * share, most * share, vec![]);
        if let Verdict::Warming { to_go: Some(to_go), what, .. } = course.monitor.verdict() {
            assert_eq!(what, Mover::BothEyes);
            told_s.push((course.at_s, to_go.about_s));
        }
    }
    assert_eq!(course.monitor.alarms(), &[], "nobody knocked");
    assert!(told_s[0].0 < 120.0, "it is noticed early: {:?}", told_s[0]);
    // From ten minutes on the end is known to two minutes.
    let end_s = |(at_s, about_s): &(f64, f64)| at_s + about_s;
    let late: Vec<f64> = told_s.iter().filter(|told| told.0 > 600.0 && told.1 > 0.0).map(end_s).collect();
    let [soonest, latest] = late.iter().fold([f64::MAX, 0.0], |[a, b], end| [a.min(*end), f64::max(b, *end)]);
    assert!(latest - soonest < 240.0, "{soonest} to {latest} s");
    let said = words::verdict(&course.monitor.verdict());
    assert!(said.starts_with("Warmed up. Both eyes have turned"), "{said}");
    // And that stays no alarm.
    while course.at_s < 6000.0 {
        course.look(-0.6 * most, most, vec![]);
    }
    assert_eq!(course.monitor.alarms(), &[]);
}

#[test]
fn a_thing_that_was_moved_and_a_hand_that_sags_are_no_fault_of_the_eyes() {
    let mut course = Course::new(3600.0);
    course.still(30);
    let at_s = course.at_s;
    let seen = |name: &str, kind, px: f64| ReferenceSeen {
        name: name.to_owned(),
        kind,
        is_lost: false,
        own_px: Some([[px, 0.0], [px, 0.0]]),
        own_m: Some(Vector3::new(0.0, -0.004 * px, 0.0)),
        drift_m: Some(Vector3::new(0.0, -0.004 * px, 0.0)),
    };
    for _ in 0..5 {
        let references = vec![
            seen("Tomato", ReferenceKind::Thing, 5.0),
            seen("Right hand", ReferenceKind::Hand, -2.0),
            seen("Touchscreen", ReferenceKind::Screen, 0.1),
        ];
        course.look(Vector3::zeros(), Vector3::zeros(), references);
    }
    assert!(matches!(course.monitor.verdict(), Verdict::Steady { .. }));
    let own = course.monitor.own_motions();
    let told: Vec<_> = own.iter().map(|motion| (motion.name.as_str(), motion.since_s)).collect();
    assert_eq!(told, [("Tomato", at_s), ("Right hand", at_s)]);
    assert_eq!(words::own_motion(&own[0]), "Tomato: was moved by 20 mm at minute 62; the eyes stand still.");
    assert!(words::own_motion(&own[1]).contains("sags by 8.0 mm"), "{}", words::own_motion(&own[1]));
    // What stands again where it was is not elsewhere.
    for _ in 0..5 {
        let references = vec![
            seen("Tomato", ReferenceKind::Thing, 0.1),
            seen("Right hand", ReferenceKind::Hand, -2.0),
            seen("Touchscreen", ReferenceKind::Screen, 0.1),
        ];
        course.look(Vector3::zeros(), Vector3::zeros(), references);
    }
    let said: Vec<String> = course.monitor.own_motions().iter().map(words::own_motion).collect();
    assert!(said[0].contains("and is where it was since minute"), "{said:?}");
    assert!(said[1].contains("sags by 8.0 mm"), "{said:?}");
}

#[test]
fn before_anything_is_learned_nothing_is_claimed_but_a_hard_knock_is() {
    let mut course = Course::new(10.0);
    assert_eq!(course.monitor.verdict(), Verdict::NotSeen);
    course.still(4);
    assert_eq!(course.monitor.verdict(), Verdict::Learning { looks: 4, needed: Band::LOOKS });
    (0..2).for_each(|_| course.look(Vector3::zeros(), degrees(0.0, 1.0, 0.0), vec![]));
    assert_eq!(moved(&course).what, Mover::RightEye);
}

/// An accepted law of the warm-up: eyes go on turning, and places stay.
#[test]
fn turns_that_the_model_in_use_takes_off_are_told_as_what_they_cost() {
    let mut course = Course::new(10.0);
    course.still(20);
    let still = course.monitor.samples().last().expect("looked").look.clone();
    for step in 0..400 {
        let turn_rad = degrees(0.0, 0.3, 0.0) * f64::from(step) / 400.0;
        let turns_rad = [still.turns_rad[0] - turn_rad, still.turns_rad[1] + turn_rad];
        let look = Look { turns_rad, against_rad: still.against_rad + 2.0 * turn_rad, ..still.clone() };
        course.monitor.add(Sample { at_s: course.at_s, look });
        course.at_s += EVERY_S;
        let verdict = course.monitor.verdict();
        assert!(matches!(verdict, Verdict::Steady { .. }), "{step}: {}", words::verdict(&verdict));
    }
    assert_eq!(course.monitor.alarms(), &[]);
}

/// Looks that are minutes apart while the eyes turn fast: what they turn is no scatter, and places are off from
/// where they came out at first, not from the middle of the way.
#[test]
fn what_drifts_while_the_band_is_learned_does_not_widen_it_and_is_told_from_the_beginning() {
    let mut course = Course::new(0.0);
    for _ in 0..40 {
        let share = 1.0 - (-course.at_s / 420.0).exp();
        let turn_rad = degrees(0.0, 0.3, 0.0) * share;
        course.look(-turn_rad, turn_rad, vec![]);
        course.at_s += 30.0;
    }
    let mut still = Course::new(3600.0);
    still.still(20);
    let half_m = |course: &Course| course.monitor.band().expect("learned").half_m[2];
    assert!(half_m(&course) < 1.3 * half_m(&still), "{} {}", half_m(&course), half_m(&still));
    let off_m = |index: usize| course.monitor.off_m(&course.monitor.samples()[index])[2];
    assert!(off_m(0) < half_m(&course) && off_m(14) > 0.015, "{} {}", off_m(0), off_m(14));
    let farther = (1..40).filter(|index| off_m(*index) > off_m(index - 1)).count();
    assert!(farther > 30, "it goes one way: {farther} of 39");
    assert_eq!(course.monitor.alarms(), &[], "nobody knocked");
}

//! A hand whose place is not known well enough over the thing: M5 refuses with the reason, closes nothing, and
//! the arm holds where it is.

use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;

use jiff::Timestamp;
use nalgebra::{Matrix3, Vector2, Vector3};
use plumbline_effects::RobotModel;
use plumbline_grasp::attempt::{FoundHand, HandFinder, HandMissing};
use plumbline_grasp::plan::GraspPlan;
use plumbline_grasp::record::Iteration;
use plumbline_grasp::see::{Looker, Seen};
use plumbline_grasp::{
    Body, Corrections, Failure, Grasper, Halt, Hand, HandChoice, Knowledge, Method, Order, Outcome, Record,
    ServoState, Sight, Step, Watch,
};
use plumbline_model::frame::Tip;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Point, Pose, Robot, StereoCalibration};
use plumbline_twin::{Lockstep, Scenario, Toy};
use plumbline_vision::detect::{DetectSettings, DetectorOptions, shipped_detector};

const PLACE_M: [f64; 2] = [0.3, -0.1];

/// Finds the hand where the arm has it, with this standard deviation per axis, m.
struct Unsure(f64);

impl HandFinder for Unsure {
    fn find(
        &mut self,
        _knowledge: &Knowledge,
        _before: &Sight,
        _now: &Sight,
        _commanded: &Posture,
        robot_from_palm: &Pose<Robot, Tip>,
        _covariance_m2: &Matrix3<f64>,
    ) -> Result<FoundHand, HandMissing> {
        let palm = robot_from_palm.translation_m();
        let covariance_m2 = Matrix3::identity() * self.0.powi(2);
        Ok(FoundHand { palm: Point::new(palm.x, palm.y, palm.z), covariance_m2 })
    }
}

/// Knows which step it is.
struct Steps(Rc<Cell<Step>>);

impl Watch for Steps {
    fn step(&mut self, step: Step) {
        self.0.set(step);
    }

    fn saw(&mut self, _step: Step, _sight: &Sight, _seen: &[Seen]) {}

    fn planned(&mut self, _plan: &GraspPlan) {}

    fn aligned(&mut self, _iteration: &Iteration) {}
}

/// A twin that is asked to end when its hand is to close.
struct TwinBody {
    twin: Lockstep,
    step: Rc<Cell<Step>>,
    pairs: u64,
}

impl Body for TwinBody {
    fn rig(&self) -> &Arc<Rig> {
        self.twin.rig()
    }

    fn now_s(&self) -> f64 {
        self.twin.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        let servos = self.twin.servos().into_iter().map(|servo| ServoState {
            joint: servo.joint,
            angle_rad: servo.angle_rad,
            load: Some(servo.load),
            current_a: None,
            temperature_c: Some(servo.temperature_c),
        });
        Ok(servos.collect())
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        Ok(self.twin.commanded().clone())
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        if self.step.get() == Step::Close {
            return Err(Halt::Cancelled);
        }
        self.twin.follow(way, speed_rad_s);
        Ok(())
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        self.twin.wait(duration_s);
        Ok(())
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        let pair = self.twin.look().map_err(|error| Halt::Blind(error.to_string()))?;
        self.pairs += 1;
        Ok(Sight {
            left: Arc::new(pair.left),
            right: Arc::new(pair.right),
            posture: self.twin.encoders(),
            at_s: self.twin.now_s(),
            eyes_on_s: Some(self.twin.eyes_on_s()),
            seq: self.pairs,
        })
    }
}

fn knowledge(rig: &Arc<Rig>) -> Knowledge {
    Knowledge {
        model: RobotModel::nominal(rig.clone()),
        described: rig.clone(),
        calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
        corrections: Corrections::default(),
    }
}

/// What becomes of a grasp of a tomato by M5 whose hand is known so well (standard deviation per axis, m), and
/// the twin as it is then.
fn attempt(sigma_m: f64) -> (Record, Lockstep) {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let scenario = Scenario::built_in("perfect").expect("valid");
    let mut twin = Lockstep::new(rig.clone(), &scenario, 1).expect("a twin");
    Toy::ALL.into_iter().filter(|toy| *toy != Toy::Tomato).for_each(|toy| twin.remove_toy(toy));
    twin.place_toy(Toy::Tomato, PLACE_M[0], PLACE_M[1]).expect("on the table");
    twin.wait(1.0);
    let knowledge = knowledge(&rig);
    let options = DetectorOptions { threads: Some(1), ..DetectorOptions::default() };
    let detector = shipped_detector().expect("comes with the program").open(&options).expect("it opens");
    let looker = Looker::new(detector, &knowledge, DetectSettings::default());
    let mut finder = |_: Hand| -> Option<Box<dyn HandFinder>> { Some(Box::new(Unsure(sigma_m))) };
    let mut grasper = Grasper::new(knowledge, looker, &mut finder).expect("an arm");
    let step = Rc::new(Cell::new(Step::Ready));
    let mut body = TwinBody { twin, step: step.clone(), pairs: 0 };
    let order =
        Order { method: Method::M5, hand: HandChoice::Right, object: "tomato".to_owned(), near_m: None };
    let record = grasper.attempt(&mut body, &order, Timestamp::UNIX_EPOCH, &mut Steps(step));
    (record, body.twin)
}

fn tomato_m(twin: &mut Lockstep) -> Vector3<f64> {
    let truth = twin.truth_for_judging();
    let place = truth.toys.iter().find(|(toy, _)| *toy == Toy::Tomato).and_then(|(_, place)| *place);
    place.expect("out").translation.vector
}

#[test]
fn a_hand_that_is_too_uncertain_is_refused_with_the_reason_and_the_arm_holds_over_the_thing() {
    const SIGMA_M: f64 = 0.03;
    let (record, mut twin) = attempt(SIGMA_M);
    let Some(Outcome::Refused { why }) = &record.outcome else { panic!("{:?}", record.outcome) };
    assert!(why.contains("hand and object are known to 30."), "{why}");
    assert!(why.contains("calibrate the mount of the eyes"), "what to do: {why}");
    assert_eq!(record.step, Some(Step::Align));
    let last = record.moments.last().expect("it came over the thing");
    assert_eq!(last.after, Step::Align, "it is neither lowered nor closed");
    // It looked as often as it may, and every look says when and how sure.
    assert_eq!(record.iterations.len(), 5, "{:?}", record.iterations);
    assert!(record.iterations.iter().all(|look| look.sigma_m.is_some_and(|m| (m - SIGMA_M).abs() < 1e-3)));
    let times_s: Vec<f64> = record.iterations.iter().filter_map(|look| look.at_s).collect();
    assert!(times_s.len() == 5 && times_s.windows(2).all(|pair| pair[0] < pair[1]), "{times_s:?}");
    assert!(record.seen_at_s.is_some_and(|at_s| at_s < times_s[0]), "{:?}", record.seen_at_s);
    // It holds where it was sent, and nothing was pushed.
    let (sent, stood, place_m) = (twin.commanded().clone(), twin.encoders(), tomato_m(&mut twin));
    assert_eq!(sent.angles_rad(), last.commanded_rad);
    twin.wait(1.0);
    let moved_rad = twin.encoders().distance_rad(&stood);
    assert!(moved_rad < 0.01 && sent == *twin.commanded(), "it moves by {moved_rad} rad");
    let pushed_m = (place_m.xy() - Vector2::from(PLACE_M)).norm();
    assert!(pushed_m < 0.01, "the tomato was pushed by {pushed_m} m");
}

#[test]
fn a_hand_that_is_known_well_is_lowered_to_close() {
    let (record, _) = attempt(0.0015);
    let failed = matches!(record.outcome, Some(Outcome::Failed { failure: Failure::Halted, .. }));
    assert!(failed && record.step == Some(Step::Close), "{:?} in {:?}", record.outcome, record.step);
}

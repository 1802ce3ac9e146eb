//! What the eyes see of a hand where it will grasp.
//!
//! Touches tell of an arm only where its fingertip meets the glass. Held open over the table at places all
//! around, the hand is rendered where the arm's model has it and found in both eyes; what it is beside sizes
//! the arm's effects anew. An arm that touches nothing is sized by that alone, and by where its servos stop.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Observation, What};
use plumbline_effects::{Kind, Measurements, RobotModel};
use plumbline_fit::{Looked, SeenHand, SeenHands, measurements, row};
use plumbline_grasp::attempt::{HandFinder as _, RenderedHand};
use plumbline_grasp::plan::{GraspPlanner, Standing};
use plumbline_grasp::{Body, Halt, Hand, PalmArm, Sight};
use plumbline_model::JobContext;
use plumbline_model::robot::{JointIndex, Posture};
use serde::{Deserialize, Serialize};

use crate::picture::still;
use crate::{HandEyeError, Start};

/// Where the right hand is held open over the table, the left one at their mirror images: x, y, m.
const OVER_M: [[f64; 2]; 12] = [
    [0.22, -0.35],
    [0.32, -0.33],
    [0.38, -0.25],
    [0.25, -0.2],
    [0.33, -0.12],
    [0.4, -0.08],
    [0.24, -0.05],
    [0.32, 0.03],
    [0.4, 0.1],
    [0.25, 0.14],
    [0.32, 0.2],
    [0.38, 0.18],
];
/// As if something so high stood there, m.
const HEIGHT_M: f64 = 0.04;
/// Peak joint speed on the way, rad/s: that of touches.
const SPEED_RAD_S: f64 = 0.6;
/// What is found of a hand is off by so much besides what its picture says, standard deviation per axis, m.
const FOUND_SD_M: f64 = 0.0015;
/// The hand of an arm that has touched is looked for this far around, at first and in later rounds, m.
pub const AROUND_M: [f64; 2] = [0.02, 0.01];
/// A hand whose arm has touched nothing is looked for this far around at first, m.
pub const UNKNOWN_AROUND_M: f64 = 0.03;
/// Fewer hands tell nothing.
const FEWEST: usize = 5;
/// One in so many looks is not used, and judges.
const HELD_BACK: usize = 4;

/// A hand that was looked at.
#[derive(Clone, Debug)]
struct Look {
    sight: Sight,
    commanded: Posture,
    /// The posture before, which says from which side each joint came.
    before: Posture,
}

impl Look {
    /// From which side each joint came: 1 or −1.
    fn direction(&self, joints: &[JointIndex]) -> Vec<f64> {
        let came = self.before.of(joints).into_iter().zip(self.commanded.of(joints));
        came.map(|(from, to)| if to >= from { 1.0 } else { -1.0 }).collect()
    }
}

/// Looks at one hand.
#[derive(Clone, Debug)]
pub struct Looks {
    hand: Hand,
    /// The table without the hand.
    without: Sight,
    looks: Vec<Look>,
}

impl Looks {
    /// Places at which a hand is looked at, at most.
    pub const MOST: usize = OVER_M.len();

    /// Holds the open hand over the table at one place after another, and goes home. The arms stand at home.
    /// `looks` is told of each place before it is gone to.
    ///
    /// # Errors
    /// When the robot does not carry it out, or it is cancelled.
    pub fn take(
        body: &mut dyn Body,
        model: &RobotModel,
        hand: Hand,
        looks: &mut dyn FnMut(usize),
        context: &dyn JobContext,
    ) -> Result<Self, HandEyeError> {
        let planner = planner(model, hand)?;
        let without = still(body)?;
        let mut taken = vec![];
        for (number, xy_m) in OVER_M.into_iter().enumerate() {
            context.checkpoint()?;
            looks(number);
            let xy_m = if planner.arm().is_left() { [xy_m[0], -xy_m[1]] } else { xy_m };
            let standing =
                Standing { xy_m, support_m: model.rig().table.height_m, height_m: HEIGHT_M, lower_m: 0.0 };
            let stands = body.commanded()?;
            let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &stands) else { continue };
            match along(body, &plan.approach, stands) {
                Ok(before) => {
                    let commanded = body.commanded()?;
                    taken.push(Look { sight: still(body)?, commanded, before });
                }
                // What protects the robot knows better: the next place is planned from where it holds.
                Err(Halt::Refused(_)) => {}
                Err(halt) => return Err(halt.into()),
            }
        }
        home(body, &planner)?;
        Ok(Self { hand, without, looks: taken })
    }

    /// Whose hand it is.
    pub fn hand(&self) -> Hand {
        self.hand
    }

    /// Places at which the hand was looked at.
    pub fn count(&self) -> usize {
        self.looks.len()
    }

    /// All of them.
    pub fn every(&self) -> Vec<usize> {
        (0..self.looks.len()).collect()
    }

    /// Those that are used, and those that judge.
    pub fn used_and_back(&self) -> (Vec<usize>, Vec<usize>) {
        self.every().iter().partition(|i| *i % HELD_BACK != 1)
    }

    /// How far servos of the arm stop from where they are sent, at every look.
    ///
    /// # Errors
    /// When the robot has no such arm.
    pub fn lags(&self, start: &Start) -> Result<Measurements, HandEyeError> {
        let arm = Arm::of_rig(&start.described, self.hand.index_tip())?;
        let joints: Vec<_> = arm.parts.iter().filter_map(|part| part.index).collect();
        let rows = self.looks.iter().map(|look| Observation {
            commanded_rad: Some(look.commanded.of(&joints)),
            ..row(What::Pose, look.sight.posture.of(&joints), look.direction(&joints))
        });
        let rows = rows.collect();
        Ok(measurements(&start.described, arm, None, rows))
    }
}

/// Goes through postures one after the other; the last one but one.
fn along(body: &mut dyn Body, way: &[Posture], from: Posture) -> Result<Posture, Halt> {
    let mut before = from;
    for posture in way {
        before = body.commanded()?;
        body.follow(std::slice::from_ref(posture), SPEED_RAD_S)?;
    }
    Ok(before)
}

/// The arm goes home by a free way.
pub(crate) fn home(body: &mut dyn Body, planner: &GraspPlanner) -> Result<(), HandEyeError> {
    if let Some(way) = planner.parked(&body.commanded()?)? {
        body.follow(&way, SPEED_RAD_S)?;
    }
    Ok(())
}

pub(crate) fn planner(model: &RobotModel, hand: Hand) -> Result<GraspPlanner, HandEyeError> {
    Ok(GraspPlanner::new(PalmArm::new(model, hand.name())?))
}

/// How far a hand is seen from where the arm has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Miss {
    /// Where the arm has the palm, along the table, m.
    pub at_m: [f64; 2],
    /// How far beside it is seen, along the table, m; `None`: it is not found.
    pub off_m: Option<[f64; 2]>,
}

/// Root mean square of the distances of hands that were found, m; `None`: none was.
pub fn rms_m(misses: &[Miss]) -> Option<f64> {
    let squares: Vec<f64> = misses.iter().filter_map(|miss| miss.off_m).map(|[x, y]| x * x + y * y).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// A palm where it is seen, m, and the information of that, 1/m².
struct FoundPalm {
    seen_m: Vector3<f64>,
    information: Matrix3<f64>,
}

/// The eyes that look for hands, with a robot as it is known.
pub struct Eyes<'a> {
    looks: &'a Looks,
    finder: RenderedHand,
}

impl<'a> Eyes<'a> {
    /// For what was taken.
    ///
    /// # Errors
    /// When the hand has no shape.
    pub fn new(looks: &'a Looks, start: &Start) -> Result<Self, HandEyeError> {
        Ok(Self { looks, finder: RenderedHand::of_rig(start.model.rig(), looks.hand.palm())? })
    }

    /// Looks for a hand where a model has it. `None`: it is not found.
    fn find(
        &mut self,
        start: &Start,
        planner: &GraspPlanner,
        look: &Look,
        around_m: f64,
    ) -> Option<FoundPalm> {
        let prior = Matrix3::identity() * around_m.powi(2);
        let palm = planner.arm().robot_from_palm(&look.commanded);
        let (knowledge, without) = (start.knowledge(), &self.looks.without);
        let found =
            self.finder.find(&knowledge, without, &look.sight, &look.commanded, &palm, &prior).ok()?;
        // What was seen alone: the prior's pull taken out.
        let posterior = found.covariance_m2.try_inverse()?;
        let information = posterior - Matrix3::identity() / around_m.powi(2);
        let measured_m2 = (information + Matrix3::identity() * 1e-2 / around_m.powi(2)).try_inverse()?;
        let palm_m = palm.translation_m();
        let off_m = measured_m2 * posterior * (found.palm.coords.coords - palm_m);
        let information = (measured_m2 + Matrix3::identity() * FOUND_SD_M.powi(2)).try_inverse()?;
        Some(FoundPalm { seen_m: palm_m + off_m, information })
    }

    /// Hands as the eyes see them, beside the angles of the arm.
    ///
    /// # Errors
    /// When too few are found.
    pub fn seen(&mut self, start: &Start, which: &[usize], around_m: f64) -> Result<SeenHands, HandEyeError> {
        let (described, hand, looks) = (&start.described, self.looks.hand, self.looks);
        let planner = planner(&start.model, hand)?;
        let arm = Arm::of_rig(described, hand.palm())?;
        let joints: Vec<_> = arm.parts.iter().filter_map(|part| part.index).collect();
        // Those who fit know the neck's zero as an unknown: here it is taken out.
        let mut eyes = [0.0; 7];
        eyes[0] = neck_rad(start);
        let undone: Isometry3<f64> = Looked::new(described).moved(&eyes).inverse();
        let (mut rows, mut seen) = (vec![], vec![]);
        for look in which.iter().map(|i| &looks.looks[*i]) {
            let Some(found) = self.find(start, &planner, look, around_m) else { continue };
            let palm_m = (undone * Point3::from(found.seen_m)).coords;
            rows.push(row(What::Pose, look.sight.posture.of(&joints), look.direction(&joints)));
            seen.push(SeenHand { palm_m, information: found.information });
        }
        if seen.len() < FEWEST {
            return Err(HandEyeError::FewHands { hand: hand.name(), found: seen.len(), of: which.len() });
        }
        Ok(SeenHands { arm: measurements(described, arm, None, rows), seen })
    }

    /// How far along the table hands are seen from where the arm has them, both as `start` has them. They are
    /// looked for where `known` has them.
    ///
    /// # Errors
    /// When the robot has no such arm.
    pub fn misses(
        &mut self,
        start: &Start,
        known: &Start,
        which: &[usize],
        around_m: f64,
    ) -> Result<Vec<Miss>, HandEyeError> {
        let looks = self.looks;
        let (has, finds) = (planner(&start.model, looks.hand)?, planner(&known.model, looks.hand)?);
        let miss = |look: &Look| {
            let palm_m = has.arm().robot_from_palm(&look.commanded).translation_m();
            let off_m = self.find(known, &finds, look, around_m).map(|found| {
                let posture = &look.sight.posture;
                let known_from_left = known.model.robot_from_left(posture).isometry;
                let start_from_left = start.model.robot_from_left(posture).isometry;
                let seen = start_from_left * known_from_left.inverse() * Point3::from(found.seen_m);
                (seen.coords - palm_m).xy().into()
            });
            Miss { at_m: palm_m.xy().into(), off_m }
        };
        Ok(which.iter().map(|i| &looks.looks[*i]).map(miss).collect())
    }
}

/// Zero of the neck's turn in a model, rad.
fn neck_rad(start: &Start) -> f64 {
    let rig = &start.described;
    let pan = &rig.description.joint(rig.eyes.pan).name;
    let effects = start.model.added().effects().iter();
    let of_neck = effects.filter(|effect| effect.id == Kind::HeadJoint.id() && effect.site == *pan);
    of_neck.flat_map(|effect| &effect.values).sum()
}

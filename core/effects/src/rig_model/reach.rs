//! Inverse kinematics with effects: what must be commanded so that the real tip gets to a target.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::predict::Angles;
use plumbline_model::robot::ik::{Answer, IkError, Options, Solver, Target};
use plumbline_model::robot::{DescriptionError, Rig};
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::{Pixel, Point, Pose, Robot};

use super::RigModel;
use super::predict::in_the_air;
use crate::arm::Arm;
use crate::forward::Assumed;
use crate::library::{Present, Surface};
use crate::measurements::{Apparatus, Measurements, Observation, What};

/// The tip counts as there within this, m.
pub const SETTLED_M: f64 = 5e-5;
/// Steps stop below this, m.
const GOAL_M: f64 = 1e-6;
/// Points that are sent to the nominal inverse kinematics at most.
const STEPS: usize = 40;
/// A point that is sent farther from its target than this is no correction any more, m.
const FARTHEST_M: f64 = 0.3;

/// What effects depend on besides the pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Last motion of each joint of the arm: −1, 0 (not known) or 1; empty: not known.
    pub direction: Vec<f64>,
    /// Mass at the palm, kg.
    pub payload_kg: f64,
    /// Time since power-on, s.
    pub t_secs: Option<f64>,
}

/// An arm with the effects of a model.
#[derive(Clone, Debug)]
pub struct DeviatedArm {
    measurements: Measurements,
    /// On the touchscreen.
    touching: Assumed,
    /// Anywhere else.
    free: Assumed,
    joints: usize,
}

/// What must be commanded.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The nominal answer for the point that is sent: its joints are commanded. Its errors are those
    /// to the point that is sent.
    pub answer: Answer,
    /// The point that is sent to the nominal inverse kinematics.
    pub sent: Point<Robot>,
    /// Distance of the real tip to the target, by the model, m.
    pub error_m: f64,
}

impl Reached {
    /// Whether the tip gets there, as the target's tolerance or [`SETTLED_M`] says.
    pub fn is_reached(&self) -> bool {
        self.answer.is_reached() && self.error_m <= SETTLED_M
    }

    /// In one word, as [`Answer::status`], or `unsettled`: no point was found that leads there, because
    /// the effects jump near the target.
    pub fn status(&self) -> String {
        if self.answer.is_reached() && !self.is_reached() {
            "unsettled".to_owned()
        } else {
            self.answer.status()
        }
    }
}

impl RigModel {
    /// The arm that ends in a tip, with this model's effects.
    ///
    /// # Errors
    /// When the rig has no such tip.
    pub fn arm(&self, rig: &Rig, tip: &str) -> Result<DeviatedArm, DescriptionError> {
        let arm = Arm::of_rig(rig, tip)?;
        let effects = self.present(Some(tip), Some(&arm), None);
        let nominal = &rig.touchscreen;
        let surface = Surface::of(self.screen(nominal).unwrap_or(nominal));
        Ok(DeviatedArm::new(arm, surface, effects))
    }
}

impl DeviatedArm {
    fn new(arm: Arm, surface: Surface, effects: Vec<Present>) -> Self {
        let joints = arm.len();
        let apparatus = Apparatus { arm: Some(arm), surface: Some(surface), ..Apparatus::default() };
        Self {
            measurements: Measurements {
                rig: String::new(),
                apparatuses: vec![apparatus],
                rows: vec![],
                left_out: vec![],
                present: vec![],
            },
            free: Assumed {
                effects: in_the_air(&effects),
                placements: vec![Isometry3::identity()],
                ..Assumed::default()
            },
            touching: Assumed { effects, placements: vec![Isometry3::identity()], ..Assumed::default() },
            joints,
        }
    }

    /// Whether it is the nominal arm.
    pub fn is_nominal(&self) -> bool {
        self.touching.effects.is_empty()
    }

    /// Where the tip is when these angles (rad, one per joint of the chain) are commanded.
    pub fn tip(&self, commanded_rad: &[f64], conditions: &Conditions) -> Point<Robot> {
        let at = self.predict(What::Pose, commanded_rad, 0.0, conditions);
        Point::new(at.x, at.y, at.z)
    }

    /// Where the touchscreen, on a block of this height, sees that tip: along u and v from the middle
    /// of its image, and the height over the glass, m.
    pub fn touch_m(
        &self,
        commanded_rad: &[f64],
        screen_height_m: f64,
        conditions: &Conditions,
    ) -> Vector3<f64> {
        self.predict(What::Touch, commanded_rad, screen_height_m, conditions)
    }

    fn predict(
        &self,
        what: What,
        commanded_rad: &[f64],
        screen_height_m: f64,
        conditions: &Conditions,
    ) -> Vector3<f64> {
        debug_assert_eq!(commanded_rad.len(), self.joints, "one angle per joint");
        let angles_rad = Some(commanded_rad.to_vec());
        let row = Observation { screen_height_m, commanded_rad: angles_rad, ..self.row(what, conditions) };
        let assumed = if what == What::Touch { &self.touching } else { &self.free };
        let at = self.measurements.predict(&row, assumed);
        let at = at.expect("an arm and a screen are there, which is all that touches and poses need");
        Vector3::new(at[0], at[1], at[2])
    }

    fn row(&self, what: What, conditions: &Conditions) -> Observation {
        let known = conditions.direction.len() == self.joints;
        Observation {
            direction: if known { conditions.direction.clone() } else { vec![0.0; self.joints] },
            payload_kg: conditions.payload_kg,
            t_secs: conditions.t_secs,
            ..Observation::imagined(what)
        }
    }

    /// Place of the tip with these effects in place of its own; angles (rad) as commanded, or as the
    /// encoders read them.
    pub(crate) fn robot_from_tip(
        &self,
        angles: (Angles, &[f64]),
        conditions: &Conditions,
        effects: &[Present],
    ) -> Isometry3<f64> {
        let (angles, angles_rad) = angles;
        let mut row = self.row(What::Pose, conditions);
        match angles {
            Angles::Commanded => row.commanded_rad = Some(angles_rad.to_vec()),
            Angles::Encoder => row.encoder_rad = Some(angles_rad.to_vec()),
        }
        self.measurements.robot_from_tip(&row, effects).expect("there is an arm")
    }

    /// What must be commanded so that the tip gets to a target: nominal inverse kinematics of a point
    /// that is shifted until the arm with its effects ends in the target. The orientation is asked of
    /// the nominal arm. Limits are those of the solver, for the commanded angles. Without effects it is
    /// the solver's own answer.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn reach(
        &self,
        solver: &Solver,
        target: &Target,
        start_rad: &[f64],
        options: &Options,
        conditions: &Conditions,
    ) -> Result<Reached, IkError> {
        let wanted = target.point();
        let first = solver.solve(target, start_rad, options)?;
        if self.is_nominal() {
            let error_m = first.best().position_error_m;
            return Ok(Reached { answer: first, sent: wanted, error_m });
        }
        let mut answer = first;
        let mut best: Option<Reached> = None;
        settle(wanted, |sent| {
            // Each point from the solution of the one before, so that the arm is held the same way.
            let held = answer.best().joints.to_vec();
            answer = solver.solve(&moved(target, sent), &held, options)?;
            let off = self.tip(&answer.best().joints, conditions).coords - wanted.coords;
            let better = best.as_ref().is_none_or(|best| off.norm() < best.error_m);
            if better {
                best = Some(Reached { answer: answer.clone(), sent, error_m: off.norm() });
            }
            Ok::<_, IkError>(answer.is_reached().then_some(off))
        })?;
        Ok(best.expect("the target itself was sent first"))
    }

    /// The point that must be sent so that a pixel is touched, on a block of this height. `commanded`
    /// gives the angles that the arm is commanded when a point is sent, and the directions in which its
    /// joints come there. `None` when no point leads there. Without effects it is the pixel's place.
    ///
    /// # Errors
    /// Those of `commanded`.
    pub fn sent_for<E>(
        &self,
        screen: &Touchscreen,
        target: Pixel<Screen>,
        screen_height_m: f64,
        payload_kg: f64,
        mut commanded: impl FnMut(Point<Robot>) -> Result<(Vec<f64>, Vec<f64>), E>,
    ) -> Result<Option<Point<Robot>>, E> {
        let screen = screen.raised(screen_height_m);
        let wanted = screen.point_at(target);
        if self.is_nominal() {
            return Ok(Some(wanted));
        }
        let ([pitch_u_m, pitch_v_m], middle) = (screen.pitch_m(), screen.middle());
        let along_m = [(target.u_px - middle.u_px) * pitch_u_m, (target.v_px - middle.v_px) * pitch_v_m];
        let axes = [screen.u_axis.vector(), screen.v_axis.vector(), screen.normal().vector()];
        settle(wanted, |sent| {
            let (angles_rad, direction) = commanded(sent)?;
            let conditions = Conditions { direction, payload_kg, t_secs: None };
            let at = self.touch_m(&angles_rad, screen_height_m, &conditions);
            let off = axes[0] * (at.x - along_m[0]) + axes[1] * (at.y - along_m[1]) + axes[2] * at.z;
            Ok(Some(off))
        })
    }
}

/// Shifts the point that is sent until nothing is off: effects move the tip nearly the same way for
/// neighboring points, so that the shift is what is off. Where that overshoots, half of it.
/// `off` says by how much the tip misses; `Ok(None)`: the point cannot be sent.
fn settle<E>(
    wanted: Point<Robot>,
    mut off: impl FnMut(Point<Robot>) -> Result<Option<Vector3<f64>>, E>,
) -> Result<Option<Point<Robot>>, E> {
    let mut sent = wanted;
    let Some(mut left) = off(sent)? else { return Ok(None) };
    let mut share = 1.0;
    for _ in 0..STEPS {
        if left.norm() <= GOAL_M {
            break;
        }
        let next = Point::from(sent.coords - left * share);
        if next.distance_m(&wanted) > FARTHEST_M {
            break;
        }
        match off(next)? {
            Some(now) if now.norm() < left.norm() => (sent, left, share) = (next, now, 1.0),
            _ if share < 0.02 => break,
            _ => share *= 0.5,
        }
    }
    Ok((left.norm() <= SETTLED_M).then_some(sent))
}

/// The same target at another point.
fn moved(target: &Target, point: Point<Robot>) -> Target {
    match target {
        Target::Position(_) => Target::Position(point),
        Target::PositionYaw { yaw_rad, .. } => Target::PositionYaw { point, yaw_rad: *yaw_rad },
        Target::Pose(pose) => {
            Target::Pose(Pose::new(Isometry3::from_parts(point.coords.coords.into(), pose.isometry.rotation)))
        }
    }
}

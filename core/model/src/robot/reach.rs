//! From where the robot is and where a tip shall go to a move that can be made, or the reason why
//! there is none.

use std::sync::Arc;

use super::collision::{Allowance, Body, CollisionError, CollisionModel, PathCheck};
use super::ik::{Answer, IkError, Options, Solution, Solver, SolverError, Target};
use super::{LinkIndex, Posture, Rig};

/// Different solutions that are tried until the way to one is clear.
const SOLUTIONS: usize = 8;

/// Plans moves of one tip. Made once (about a millisecond), used for many targets.
#[derive(Clone, Debug)]
pub struct Reach {
    solver: Solver,
    model: Arc<CollisionModel>,
    /// Links that the last joint carries.
    hand: Vec<LinkIndex>,
}

/// How to plan.
#[derive(Clone, Debug)]
pub struct ReachOptions {
    /// How to solve for the joint angles.
    pub ik: Options,
    /// What the hand may touch: the screen when it shall be touched, the table when something
    /// lying on it shall be grasped.
    pub may_touch: Vec<Body>,
    /// How deep the hand's shapes may then enter, m: fingers are thinner and softer than they are
    /// drawn.
    pub touch_depth_m: f64,
}

impl Default for ReachOptions {
    fn default() -> Self {
        Self { ik: Options::default(), may_touch: vec![], touch_depth_m: 0.015 }
    }
}

/// The best move that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Where it ends: the start with the chain's joints at the solution.
    pub posture: Posture,
    /// The joint angles and what they leave.
    pub solution: Solution,
    /// What the straight way in joint angles to it runs into.
    pub path: PathCheck,
    /// Why the move must not be made; `None`: it can be made.
    pub refusal: Option<Refusal>,
}

impl Plan {
    /// Whether the move can be made.
    pub fn is_clear(&self) -> bool {
        self.refusal.is_none()
    }
}

/// Why a move must not be made. Reads as a sentence for the operator.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The target is inside of something.
    #[error("the target lies {} mm inside the {body}: choose one outside", mm(.depth_m))]
    Inside {
        /// Name of the body.
        body: String,
        /// How deep, m.
        depth_m: f64,
    },
    /// A joint limit stands in the way.
    #[error(
        "{joint} stands at its limit of {:.1}° with {} mm and {:.1}° still to go: choose a target nearer or turned otherwise",
        .limit_rad.to_degrees(), mm(.short_m), .short_rad.to_degrees()
    )]
    Limited {
        /// Name of the joint in the description.
        joint: String,
        /// Its limit, rad.
        limit_rad: f64,
        /// Position error that is left, m.
        short_m: f64,
        /// Orientation error that is left, rad.
        short_rad: f64,
    },
    /// The arm is too short, or cannot turn its tip so.
    #[error(
        "the target is out of reach by {} mm and {:.1}°: choose a nearer one", mm(.by_m), .by_rad.to_degrees()
    )]
    OutOfReach {
        /// Position error that is left, m.
        by_m: f64,
        /// Orientation error that is left, rad.
        by_rad: f64,
    },
    /// The way runs into something.
    #[error(
        "{} the {a} would meet the {b}: go there by a posture in between", on_the_way(*.at_fraction)
    )]
    Collision {
        /// Where on the way, 0–1.
        at_fraction: f64,
        /// Name of one body.
        a: String,
        /// Name of the other.
        b: String,
    },
    /// A joint would turn too far on the way.
    #[error(
        "{} {joint} would turn {} ({why}): move the joint it depends on first",
        on_the_way(*.at_fraction), too_far(*.by_rad)
    )]
    BeyondLimit {
        /// Where on the way, 0–1.
        at_fraction: f64,
        /// Name of the joint in the description.
        joint: String,
        /// How far, rad.
        by_rad: f64,
        /// What is in the way.
        why: String,
    },
}

/// What would be written as nothing is no number.
fn on_the_way(at_fraction: f64) -> String {
    match 100.0 * at_fraction {
        percent if percent < 0.5 => "where it stands".to_owned(),
        percent => format!("on the way ({percent:.0} %)"),
    }
}

fn too_far(by_rad: f64) -> String {
    match by_rad.to_degrees() {
        by_deg if by_deg < 0.05 => "just past its end".to_owned(),
        by_deg => format!("too far by {by_deg:.1}°"),
    }
}

/// Why nothing was planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReachError {
    /// The question is not proper.
    #[error(transparent)]
    Ik(#[from] IkError),
    /// The posture is not proper.
    #[error(transparent)]
    Posture(#[from] CollisionError),
}

impl Reach {
    /// For a tip of a rig.
    ///
    /// # Errors
    /// When there is no such tip, or when its chain cannot be solved.
    pub fn new(rig: &Rig, tip: &str) -> Result<Self, SolverError> {
        Self::with_model(rig, tip, Arc::new(CollisionModel::of_rig(rig)))
    }

    /// The same with bodies that are shared with other tips.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_model(rig: &Rig, tip: &str, model: Arc<CollisionModel>) -> Result<Self, SolverError> {
        let solver = Solver::of_rig(rig, tip)?;
        let hand = solver.joints().last().map(|joint| model.links_moved_by(*joint)).unwrap_or_default();
        Ok(Self { solver, model, hand })
    }

    /// Its inverse kinematics.
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// Its bodies.
    pub fn model(&self) -> &Arc<CollisionModel> {
        &self.model
    }

    /// The move that brings the tip from a posture to a target: joint angles inside the limits and
    /// a clear way there. Of several solutions the one nearest to the start whose way is clear.
    ///
    /// # Errors
    /// When start or target are not numbers or do not fit to the robot. A move that must not be
    /// made is no error but a [`Plan`] with a [`Refusal`].
    pub fn plan(&self, start: &Posture, target: &Target, options: &ReachOptions) -> Result<Plan, ReachError> {
        // Checked before its angles are looked up.
        self.model.accept(start)?;
        let answer = self.solver.solve_from(target, start, &options.ik)?;
        let allowances = self.allowances(options);
        let first = self.plan_to(start, *answer.best(), &allowances)?;
        let refusal = self.inside(start, target, options).or_else(|| not_reached(&answer));
        if refusal.is_some() {
            return Ok(Plan { refusal, ..first });
        }
        if first.is_clear() {
            return Ok(first);
        }
        let from = start.of(self.solver.joints());
        for other in self.solver.solutions(target, &from, &options.ik, SOLUTIONS)? {
            let plan = self.plan_to(start, other, &allowances)?;
            if plan.is_clear() {
                return Ok(plan);
            }
        }
        Ok(first)
    }

    fn plan_to(
        &self,
        start: &Posture,
        solution: Solution,
        allowances: &[Allowance],
    ) -> Result<Plan, CollisionError> {
        let posture = start.with(self.solver.joints(), &solution.joints);
        let path = self.model.check_path(start, &posture, allowances)?;
        let refusal = blocked(&path);
        Ok(Plan { posture, solution, path, refusal })
    }

    fn allowances(&self, options: &ReachOptions) -> Vec<Allowance> {
        let to =
            |body: &Body| Allowance { links: self.hand.clone(), body: *body, depth_m: options.touch_depth_m };
        let mut allowances: Vec<Allowance> = options.may_touch.iter().map(to).collect();
        if options.may_touch.contains(&Body::Touchscreen) {
            // The screen lies on the table: what enters it by more than its frame meets the table too.
            allowances.push(to(&Body::Table));
        }
        allowances
    }

    fn inside(&self, start: &Posture, target: &Target, options: &ReachOptions) -> Option<Refusal> {
        let (body, depth_m) = self.model.body_around(target.point(), start, self.solver.joints())?;
        let wanted = options.may_touch.contains(&body) && depth_m <= options.touch_depth_m;
        (!wanted).then(|| Refusal::Inside { body: self.model.name(body), depth_m })
    }
}

fn not_reached(answer: &Answer) -> Option<Refusal> {
    let best = answer.best();
    let (short_m, short_rad) = (best.position_error_m, best.orientation_error_rad);
    match answer {
        Answer::Reached(_) => None,
        Answer::LimitedBy { name, limit_rad, .. } => {
            Some(Refusal::Limited { joint: name.clone(), limit_rad: *limit_rad, short_m, short_rad })
        }
        Answer::OutOfReach { .. } => Some(Refusal::OutOfReach { by_m: short_m, by_rad: short_rad }),
    }
}

fn blocked(path: &PathCheck) -> Option<Refusal> {
    match path {
        PathCheck::Clear { .. } => None,
        PathCheck::Collides { at_fraction, contact, .. } => Some(Refusal::Collision {
            at_fraction: *at_fraction,
            a: contact.a_name.clone(),
            b: contact.b_name.clone(),
        }),
        PathCheck::BeyondLimit { at_fraction, name, by_rad, why, .. } => Some(Refusal::BeyondLimit {
            at_fraction: *at_fraction,
            joint: name.clone(),
            by_rad: *by_rad,
            why: why.clone(),
        }),
    }
}

/// Millimeters for a sentence: one digit after the point while it matters.
fn mm(meters: &f64) -> String {
    let millimeters = meters * 1e3;
    if millimeters < 10.0 { format!("{millimeters:.1}") } else { format!("{millimeters:.0}") }
}

#[cfg(test)]
mod tests {
    use super::Refusal;

    #[test]
    fn what_would_be_written_as_nothing_is_no_number() {
        let beyond = |at_fraction: f64, by_deg: f64| {
            let (joint, why) = ("r_elbow_y".to_owned(), "its end".to_owned());
            Refusal::BeyondLimit { at_fraction, joint, by_rad: by_deg.to_radians(), why }.to_string()
        };
        assert!(
            beyond(0.5, 2.4).starts_with("on the way (50 %) r_elbow_y would turn too far by 2.4° (its end)")
        );
        assert!(
            beyond(0.0, 0.01).starts_with("where it stands r_elbow_y would turn just past its end (its end)")
        );
    }
}

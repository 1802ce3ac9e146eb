//! From what the operator asks for to the posture it means.

use plumbline_effects::rig_model::Conditions;
use plumbline_effects::robot_model::worst_sigma_m;
use plumbline_effects::{ModelArm, RobotModel};
use plumbline_model::Point;
use plumbline_model::robot::collision::PathCheck;
use plumbline_model::robot::ik::{Answer, Options, Target};
use plumbline_model::robot::{JointIndex, Posture, Reach, ReachError, ReachOptions, Refusal, Rig};

use super::command::Destination;
use super::unable::NoDestination;
use super::view::PoseView;

/// Different ways to hold the arm that are tried until one is free.
const WAYS: usize = 8;
/// A joint that turns by less comes from nowhere, rad.
const STANDING_RAD: f64 = 1e-4;

/// Where a move goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// For people: "to Home".
    pub title: String,
    /// Where everything would be.
    pub end: Posture,
    /// Joints that are to be moved; others stay without being sent anything.
    pub joints: Vec<JointIndex>,
    /// One standard deviation of the place that the tip gets to, along the worst direction, by what is
    /// not known of the model's effects, m; `None` where no place was asked for.
    pub tip_sigma_m: Option<f64>,
}

impl Resolved {
    /// A move of which no place of the tip was asked.
    pub fn of_joints(title: String, end: Posture, joints: Vec<JointIndex>) -> Self {
        Self { title, end, joints, tip_sigma_m: None }
    }
}

/// What a destination is resolved with.
pub struct Circumstances<'a> {
    /// The robot as it is known.
    pub model: &'a RobotModel,
    /// The chosen tip: ways of it, and its arm with the model's effects; `None` when it cannot be moved.
    pub reach: Option<(&'a Reach, &'a ModelArm)>,
    /// Where the joints are.
    pub present: &'a Posture,
    /// Poses to choose from.
    pub poses: &'a [PoseView],
}

/// The posture that a destination means, or a sentence that says why there is none.
pub fn resolve(destination: &Destination, around: &Circumstances<'_>) -> Result<Resolved, NoDestination> {
    let Circumstances { model, present, .. } = around;
    let rig = &**model.rig();
    let resolved = match destination {
        Destination::Joint { joint, angle_rad } => {
            let servo = rig.servo_of(*joint).ok_or(NoDestination::NoServo)?;
            let title = format!("{} to {:.1}°", servo.title, angle_rad.to_degrees());
            Resolved::of_joints(title, present.with(&[*joint], &[*angle_rad]), vec![*joint])
        }
        Destination::Pose { name } => {
            let pose = around.poses.iter().find(|pose| pose.name == *name);
            let pose = pose.ok_or_else(|| NoDestination::NoPose(name.clone()))?;
            let (joints, angles_rad): (Vec<_>, Vec<_>) = pose.joints.iter().copied().unzip();
            let end = present.with(&joints, &angles_rad);
            Resolved::of_joints(format!("to {}", pose.title), end, joints)
        }
        Destination::Posture(posture) => {
            if posture.len() != present.len() {
                let (posture, robot) = (posture.len(), present.len());
                return Err(NoDestination::OtherRobot { posture, robot });
            }
            let joints = rig.servos.iter().map(|servo| servo.joint).collect();
            Resolved::of_joints("to a posture".to_owned(), posture.clone(), joints)
        }
        Destination::TipPosition { point_m } => {
            tip(around, *point_m, &Target::Position(point(*point_m)?), Options::default())?
        }
        Destination::TipPositionYaw { point_m, yaw_rad } => {
            let target = Target::PositionYaw { point: point(*point_m)?, yaw_rad: *yaw_rad };
            tip(around, *point_m, &target, Options::upright())?
        }
        Destination::LookAt { point_m } => look_at(around, *point_m)?,
    };
    if !resolved.end.is_finite() {
        return Err(NoDestination::NotANumber);
    }
    within_limits(rig, &resolved)?;
    Ok(resolved)
}

fn tip(
    around: &Circumstances<'_>,
    point_m: [f64; 3],
    to: &Target,
    ik: Options,
) -> Result<Resolved, NoDestination> {
    let (reach, arm) = around.reach.ok_or(NoDestination::NoTip)?;
    let options = ReachOptions { ik, ..ReachOptions::default() };
    let plan = reach.plan(around.present, to, &options)?;
    let nominal = match plan.refusal {
        // The way is looked at again when it is shown, with what is in it.
        None | Some(Refusal::Collision { .. } | Refusal::BeyondLimit { .. }) => Ok(plan.posture),
        // Effects may put a place into reach that the arm without them does not get to.
        Some(Refusal::Limited { .. } | Refusal::OutOfReach { .. }) if !arm.is_nominal() => Ok(plan.posture),
        Some(refusal) => Err(refusal),
    }?;
    let title = format!("the tip to {}", words(point_m));
    let joints = arm.joints().to_vec();
    if arm.is_nominal() {
        return Ok(Resolved { title, end: nominal, joints, tip_sigma_m: Some(0.0) });
    }
    let way = ToTheReal { reach, arm, present: around.present, to, ik: &options.ik };
    let (end, conditions) = way.end(&nominal)?;
    let tip_sigma_m = Some(worst_sigma_m(&arm.covariance_m2(&end, &conditions)));
    Ok(Resolved { title, end, joints, tip_sigma_m })
}

/// What it takes to bring the real tip, with its effects, to a target.
struct ToTheReal<'a> {
    reach: &'a Reach,
    arm: &'a ModelArm,
    present: &'a Posture,
    to: &'a Target,
    ik: &'a Options,
}

impl ToTheReal<'_> {
    /// The posture to command. The arm is held as in the way that was found without effects; where that
    /// leads into something, in another way that is free.
    fn end(&self, nominal: &Posture) -> Result<(Posture, Conditions), NoDestination> {
        let first = self.settled(nominal)?;
        if self.is_free(&first.0) {
            return Ok(first);
        }
        let from = self.present.of(self.arm.joints());
        let others = self.reach.solver().solutions(self.to, &from, self.ik, WAYS).unwrap_or_default();
        for other in others {
            let held = self.present.with(self.arm.joints(), &other.joints);
            if let Ok(found) = self.settled(&held)
                && self.is_free(&found.0)
            {
                return Ok(found);
            }
        }
        Ok(first)
    }

    /// The posture whose real tip is at the target, and under which conditions: joints come from where
    /// they are now, which play and friction depend on.
    fn settled(&self, held: &Posture) -> Result<(Posture, Conditions), NoDestination> {
        let mut conditions = Conditions::default();
        let mut end = self.commanded(held, &conditions)?;
        let now = self.present.of(self.arm.joints());
        let turns = end.of(self.arm.joints()).into_iter().zip(now).map(|(to, from)| to - from);
        let sign = |turn: f64| if turn.abs() < STANDING_RAD { 0.0 } else { turn.signum() };
        conditions.direction = turns.map(sign).collect();
        end = self.commanded(&end, &conditions)?;
        Ok((end, conditions))
    }

    fn commanded(&self, held: &Posture, conditions: &Conditions) -> Result<Posture, NoDestination> {
        let found = self.arm.reach(self.to, held, self.ik, conditions).map_err(ReachError::from)?;
        let best = found.answer.best();
        let (short_m, short_rad) = (found.error_m, best.orientation_error_rad);
        match &found.answer {
            Answer::Reached(_) if found.is_reached() => {
                Ok(self.present.with(self.arm.joints(), &best.joints))
            }
            Answer::Reached(_) => Err(NoDestination::Unsettled { by_m: short_m }),
            Answer::LimitedBy { name, limit_rad, .. } => {
                let (joint, limit_rad) = (name.clone(), *limit_rad);
                Err(Refusal::Limited { joint, limit_rad, short_m, short_rad }.into())
            }
            Answer::OutOfReach { .. } => Err(Refusal::OutOfReach { by_m: short_m, by_rad: short_rad }.into()),
        }
    }

    fn is_free(&self, end: &Posture) -> bool {
        let path = self.reach.model().check_path(self.present, end, &[]);
        path.is_ok_and(|path| matches!(path, PathCheck::Clear { .. }))
    }
}

fn look_at(around: &Circumstances<'_>, point_m: [f64; 3]) -> Result<Resolved, NoDestination> {
    let eyes = &around.model.rig().eyes;
    let (pan_rad, tilt_rad) = around.model.look_at(point(point_m)?, around.present);
    let joints = vec![eyes.pan, eyes.tilt];
    let end = around.present.with(&joints, &[pan_rad, tilt_rad]);
    Ok(Resolved::of_joints(format!("the head to look at {}", words(point_m)), end, joints))
}

fn point(point_m: [f64; 3]) -> Result<Point<plumbline_model::Robot>, NoDestination> {
    let [x, y, z] = point_m;
    if [x, y, z].iter().all(|c| c.is_finite()) {
        Ok(Point::new(x, y, z))
    } else {
        Err(NoDestination::NoPoint)
    }
}

fn words([x, y, z]: [f64; 3]) -> String {
    format!("x {:.0}, y {:.0}, z {:.0} mm", x * 1e3, y * 1e3, z * 1e3)
}

/// Joints that are moved have to end inside their limits.
fn within_limits(rig: &Rig, resolved: &Resolved) -> Result<(), NoDestination> {
    for joint in &resolved.joints {
        let limits = rig.limits_in(*joint, &resolved.end);
        let angle_rad = resolved.end[*joint];
        // Half a tick of a servo is no reason to refuse.
        if limits.excess_rad(angle_rad).abs() > 1e-3 {
            let title = rig.servo_of(*joint).map_or("A joint", |servo| &servo.title);
            let why = rig.coupled_limits.iter().find(|coupled| coupled.joint == *joint);
            let why = why.filter(|_| rig.limits(*joint).contain(angle_rad));
            let why = why.map(|coupled| format!(" ({})", coupled.why)).unwrap_or_default();
            let limits_rad = [limits.lower_rad, limits.upper_rad];
            return Err(NoDestination::BeyondLimits { joint: title.to_owned(), angle_rad, limits_rad, why });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::rig_models::made_up::model_with;

    const PALM: &str = "right_palm_center";

    fn resolve_at_home(destination: &Destination) -> Result<Resolved, NoDestination> {
        resolve_with(destination, &[])
    }

    fn known(effects: &[(&str, &str, &[f64])]) -> RobotModel {
        let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
        RobotModel::new(rig.clone(), Arc::new(model_with(&rig, effects))).expect("they fit")
    }

    fn resolve_with(
        destination: &Destination,
        effects: &[(&str, &str, &[f64])],
    ) -> Result<Resolved, NoDestination> {
        let model = if effects.is_empty() {
            RobotModel::nominal(Arc::new(Rig::built_in("nico").expect("the rig that comes with the program")))
        } else {
            known(effects)
        };
        let (reach, arm) = (Reach::new(model.rig(), PALM).expect("a tip"), model.arm(PALM).expect("a tip"));
        let present = model.rig().home();
        let reach = Some((&reach, &arm));
        resolve(destination, &Circumstances { model: &model, reach, present: &present, poses: &[] })
    }

    #[test]
    fn a_reachable_point_is_reached_by_the_arm_only() {
        let rig = Rig::built_in("nico").expect("the rig that comes with the program");
        let resolved =
            resolve_at_home(&Destination::TipPosition { point_m: [0.3, -0.2, 0.2] }).expect("in reach");
        let place = rig.chain("right_palm_center").expect("a tip").robot_from_tip_in(&resolved.end);
        assert!((place.translation_m() - nalgebra::Vector3::new(0.3, -0.2, 0.2)).norm() < 1e-4);
        assert_eq!(resolved.joints.len(), 6);
    }

    #[test]
    fn what_cannot_be_done_is_said_in_a_sentence() {
        let rig = Rig::built_in("nico").expect("the rig that comes with the program");
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint");
        for (destination, words) in [
            (Destination::TipPosition { point_m: [2.0, 0.0, 0.5] }, "out of reach by"),
            (Destination::TipPosition { point_m: [f64::NAN, 0.0, 0.5] }, "not a number"),
            (Destination::Joint { joint: elbow, angle_rad: 0.0 }, "its limits there are"),
            (Destination::Joint { joint: elbow, angle_rad: f64::NAN }, "not a number"),
            (Destination::Pose { name: "gone".to_owned() }, "no pose called gone"),
            (Destination::Posture(Posture::new(vec![0.0; 3])), "of another robot"),
            (Destination::LookAt { point_m: [-1.0, 0.0, 0.3] }, "Head"),
        ] {
            let message = resolve_at_home(&destination).expect_err("it cannot be done").to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    #[test]
    fn the_counterweights_are_named_when_the_lowered_head_cannot_turn() {
        let message = resolve_at_home(&Destination::LookAt { point_m: [0.1, 0.5, 0.06] })
            .expect_err("too far to the side")
            .to_string();
        assert!(message.contains("counterweights"), "{message}");
    }

    #[test]
    fn the_real_tip_gets_to_where_it_is_sent_whatever_the_arm_does() {
        let effects: [(&str, &str, &[f64]); 3] = [
            ("joint-zero", "r_elbow_y", &[0.08]),
            ("servo-droop", "r_shoulder_y", &[0.03]),
            ("backlash", "r_arm_x", &[0.01]),
        ];
        let arm = known(&effects).arm(PALM).expect("a tip");
        let home = known(&effects).rig().home();
        for point_m in [[0.3, -0.2, 0.2], [0.35, -0.1, 0.15], [0.28, -0.3, 0.18]] {
            let point = Point::new(point_m[0], point_m[1], point_m[2]);
            let to = Destination::TipPosition { point_m };
            let [real, nominal] = [resolve_with(&to, &effects), resolve_at_home(&to)].map(|resolved| {
                let end = resolved.expect("in reach").end;
                let direction = arm.joints().iter().map(|joint| (end[*joint] - home[*joint]).signum());
                let conditions = Conditions { direction: direction.collect(), ..Conditions::default() };
                arm.tip(&end, &conditions).distance_m(&point)
            });
            assert!(real < 1e-4, "{:.3} mm beside {point_m:?}", real * 1e3);
            assert!(nominal > 5e-3, "without its effects only {:.3} mm beside", nominal * 1e3);
        }
    }

    #[test]
    fn the_head_looks_from_where_the_eyes_really_are() {
        let model = known(&[("camera-mount", "eyes", &[0.0, 0.0, 0.0, 0.05, 0.03, 0.0])]);
        let to = Destination::LookAt { point_m: [0.4, -0.1, 0.06] };
        let effects: [(&str, &str, &[f64]); 1] =
            [("camera-mount", "eyes", &[0.0, 0.0, 0.0, 0.05, 0.03, 0.0])];
        let [real, nominal] = [resolve_with(&to, &effects), resolve_at_home(&to)].map(|resolved| {
            let end = resolved.expect("in sight").end;
            let in_left = model.robot_from_left(&end).inverse() * Point::new(0.4, -0.1, 0.06);
            in_left.coords.x.hypot(in_left.coords.y) / in_left.coords.z
        });
        assert!(real < 1e-3 && nominal > 0.03, "{real} {nominal}");
    }
}

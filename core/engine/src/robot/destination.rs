//! From what the operator asks for to the posture it means.

use plumbline_model::Point;
use plumbline_model::robot::ik::{Options, Target};
use plumbline_model::robot::{JointIndex, Posture, Reach, ReachOptions, Refusal, Rig};

use super::command::Destination;
use super::unable::NoDestination;
use super::view::PoseView;

/// Where a move goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// For people: "to Home".
    pub title: String,
    /// Where everything would be.
    pub end: Posture,
    /// Joints that are to be moved; others stay without being sent anything.
    pub joints: Vec<JointIndex>,
}

/// What a destination is resolved with.
pub struct Circumstances<'a> {
    /// The robot.
    pub rig: &'a Rig,
    /// The chosen tip; `None` when it cannot be moved.
    pub reach: Option<&'a Reach>,
    /// Where the joints are.
    pub present: &'a Posture,
    /// Poses to choose from.
    pub poses: &'a [PoseView],
}

/// The posture that a destination means, or a sentence that says why there is none.
pub fn resolve(destination: &Destination, around: &Circumstances<'_>) -> Result<Resolved, NoDestination> {
    let Circumstances { rig, present, .. } = around;
    let resolved = match destination {
        Destination::Joint { joint, angle_rad } => {
            let servo = rig.servo_of(*joint).ok_or(NoDestination::NoServo)?;
            let title = format!("{} to {:.1}°", servo.title, angle_rad.to_degrees());
            Resolved { title, end: present.with(&[*joint], &[*angle_rad]), joints: vec![*joint] }
        }
        Destination::Pose { name } => {
            let pose = around.poses.iter().find(|pose| pose.name == *name);
            let pose = pose.ok_or_else(|| NoDestination::NoPose(name.clone()))?;
            let (joints, angles_rad): (Vec<_>, Vec<_>) = pose.joints.iter().copied().unzip();
            Resolved { title: format!("to {}", pose.title), end: present.with(&joints, &angles_rad), joints }
        }
        Destination::Posture(posture) => {
            if posture.len() != present.len() {
                let (posture, robot) = (posture.len(), present.len());
                return Err(NoDestination::OtherRobot { posture, robot });
            }
            let joints = rig.servos.iter().map(|servo| servo.joint).collect();
            Resolved { title: "to a posture".to_owned(), end: posture.clone(), joints }
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
    let reach = around.reach.ok_or(NoDestination::NoTip)?;
    let options = ReachOptions { ik, ..ReachOptions::default() };
    let plan = reach.plan(around.present, to, &options)?;
    match plan.refusal {
        // The way is looked at again when it is shown, with what is in it.
        None | Some(Refusal::Collision { .. } | Refusal::BeyondLimit { .. }) => Ok(Resolved {
            title: format!("the tip to {}", words(point_m)),
            end: plan.posture,
            joints: reach.solver().joints().to_vec(),
        }),
        Some(refusal) => Err(refusal.into()),
    }
}

fn look_at(around: &Circumstances<'_>, point_m: [f64; 3]) -> Result<Resolved, NoDestination> {
    let eyes = &around.rig.eyes;
    let (pan_rad, tilt_rad) = around.rig.look_at(point(point_m)?, around.present);
    let joints = vec![eyes.pan, eyes.tilt];
    Ok(Resolved {
        title: format!("the head to look at {}", words(point_m)),
        end: around.present.with(&joints, &[pan_rad, tilt_rad]),
        joints,
    })
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
    use super::*;

    fn resolve_at_home(destination: &Destination) -> Result<Resolved, NoDestination> {
        let rig = Rig::built_in("nico").expect("the rig that comes with the program");
        let present = rig.home();
        let reach = Reach::new(&rig, "right_palm_center").expect("a tip");
        resolve(destination, &Circumstances { rig: &rig, reach: Some(&reach), present: &present, poses: &[] })
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
}

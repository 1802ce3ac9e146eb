//! What is measured, less what is so. Rounded to what people read, so that the window is not drawn anew
//! for less.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_effects::RigModel;
use plumbline_effects::library::across;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_model::robot::{Joint, JointKind, Posture, Rig};

use super::judge::Facts;
use super::view::{TruthOf, TruthRow};
use super::workflow::TruthAround;

/// To this, m and rad.
const ROUND_M: f64 = 1e-4;
const ROUND_RAD: f64 = 2e-4;

/// One row per thing that is known and can be compared.
pub(super) fn rows(facts: &Facts, around: &TruthAround) -> Vec<TruthRow> {
    let mut rows = toys(facts, around);
    rows.extend(finger(facts, around));
    let posture = around.measured.as_ref().unwrap_or(&facts.encoders);
    rows.extend(eyes(facts, around, posture));
    rows.extend(joints(facts, around));
    rows
}

fn row(of: TruthOf, name: &str, off_m: Option<Vector3<f64>>, off_rad: Option<f64>) -> TruthRow {
    let round = |value: f64, to: f64| (value / to).round() * to;
    TruthRow {
        of,
        name: name.to_owned(),
        off_m: off_m.map(|off| off.map(|part| round(part, ROUND_M)).into()),
        off_rad: off_rad.map(|angle| round(angle, ROUND_RAD)),
    }
}

fn toys(facts: &Facts, around: &TruthAround) -> Vec<TruthRow> {
    let seen = around.seen.iter().filter_map(|seen| {
        let is_it = |name: &&str| name.eq_ignore_ascii_case(&seen.name);
        let stands = facts.toys.iter().find(|(name, _)| is_it(name))?.1.translation.vector;
        Some(row(TruthOf::Toy, &seen.name, Some(seen.place.coords.coords - stands), None))
    });
    seen.collect()
}

fn finger(facts: &Facts, around: &TruthAround) -> Option<TruthRow> {
    let (tip, place) = around.tip.as_ref()?;
    let link = around.model.rig().description.find_link(tip).ok()?;
    let stands = facts.robot_from_link.get(link.0)?.as_ref()?.translation.vector;
    let name = tip.replace('_', " ");
    Some(row(TruthOf::Finger, &name, Some(place.coords.coords - stands), None))
}

fn eyes(facts: &Facts, around: &TruthAround, posture: &Posture) -> Vec<TruthRow> {
    let rig = around.model.rig();
    let differs = |name: &str, measured: Isometry3<f64>, stands: Isometry3<f64>| {
        let off_m = measured.translation.vector - stands.translation.vector;
        row(TruthOf::Mount, name, Some(off_m), Some(measured.rotation.angle_to(&stands.rotation)))
    };
    let mut rows = vec![];
    let head = facts.robot_from_link.get(rig.eyes.link.0).and_then(Option::as_ref);
    if let Some(robot_from_head) = head {
        let stands = robot_from_head.inverse() * facts.robot_from_left;
        rows.push(differs("left eye in the head", rig.eyes.head_from_left.isometry, stands));
    }
    let looks = around.model.robot_from_left(posture).isometry;
    rows.push(differs("left eye in the robot", looks, facts.robot_from_left));
    let right_from_left = facts.robot_from_right.inverse() * facts.robot_from_left;
    rows.push(differs("eyes to each other", rig.eyes.cameras.right_from_left.isometry, right_from_left));
    rows
}

/// Of each joint that turns: the part of its difference about its axis is its zero (with its play, and
/// what its bracket gives way), the part across it its axis. Of both, what the model in use has is taken off.
fn joints(facts: &Facts, around: &TruthAround) -> Vec<TruthRow> {
    let (rig, added) = (around.model.rig(), around.model.added());
    let mut rows = vec![];
    for joint in rig.description.joints() {
        let JointKind::Revolute { axis, index, .. } = &joint.kind else { continue };
        let angle_rad = facts.encoders[*index] + known_zero_rad(rig, added, &joint.name);
        let skew_rad = known_skew_rad(rig, added, &joint.name, axis);
        // A joint sits askew before it turns.
        let turn =
            UnitQuaternion::from_scaled_axis(skew_rad) * UnitQuaternion::from_axis_angle(axis, angle_rad);
        let Some(left_rad) = left_rad(joint, &turn, facts) else { continue };
        let Some(servo) = rig.servo_of(*index) else { continue };
        // Fingers bend around what they hold: that is no zero of theirs.
        if rig.arms.iter().any(|arm| arm.hand.contains(index)) {
            continue;
        }
        let about_rad = left_rad.dot(axis);
        let across = left_rad - axis.into_inner() * about_rad;
        rows.push(row(TruthOf::Zero, &servo.title, None, Some(-about_rad)));
        rows.push(row(TruthOf::Axis, &servo.title, None, Some(across.norm())));
    }
    rows
}

/// How the carried link is really turned against where this turn of the joint puts it: rotation vector, axes
/// of the joint, rad.
fn left_rad(joint: &Joint, turn: &UnitQuaternion<f64>, facts: &Facts) -> Option<Vector3<f64>> {
    let of = |link: usize| facts.robot_from_link.get(link)?.as_ref();
    let stands = of(joint.parent.0)?.inverse() * of(joint.child.0)?;
    let known = joint.parent_from_joint.rotation * turn;
    Some((known.inverse() * stands.rotation).scaled_axis())
}

/// The zero of a joint that the model in use has, rad.
fn known_zero_rad(rig: &Rig, added: &RigModel, joint: &str) -> f64 {
    known(rig, added, "joint-zero", joint, 1).into_iter().flatten().sum()
}

/// How a joint's axis is askew in the model in use: rotation vector, axes of the joint, rad.
fn known_skew_rad(rig: &Rig, added: &RigModel, joint: &str, axis: &Vector3<f64>) -> Vector3<f64> {
    let [a, b] = across(axis);
    let skews = known(rig, added, "axis-skew", joint, 2);
    skews.into_iter().map(|values| a * values[0] + b * values[1]).sum()
}

/// Values of a joint, `count` from each effect of this kind that the model in use has.
fn known<'a>(rig: &Rig, added: &'a RigModel, id: &str, joint: &str, count: usize) -> Vec<&'a [f64]> {
    let of = |effect: &'a ModelEffect| {
        if effect.site == joint {
            return effect.values.get(..count);
        }
        if rig.description.find_joint(&effect.site).is_ok() {
            return None;
        }
        // Of every joint of an arm, in the order of its chain.
        let chain = rig.chain(effect.tip.as_deref()?).ok()?;
        let at = chain.names().iter().position(|name| name == joint)?;
        effect.values.get(at * count..(at + 1) * count)
    };
    added.effects().iter().filter(|effect| effect.id == id).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Translation3;
    use plumbline_effects::RobotModel;
    use plumbline_model::Point;

    use super::*;
    use crate::rig_models::made_up::model_with;
    use crate::truth::Seen;

    /// Everything is as described, but what is changed here.
    fn facts(rig: &Rig) -> Facts {
        let encoders = rig.home();
        let places = rig.description.forward(&encoders);
        let links = rig.description.links().len();
        let left = rig.robot_from_left(&encoders).isometry;
        Facts {
            robot_from_link: (0..links)
                .map(|link| Some(places.of(plumbline_model::robot::LinkIndex(link)).isometry))
                .collect(),
            robot_from_left: left,
            robot_from_right: left * rig.eyes.cameras.right_from_left.isometry.inverse(),
            encoders,
            toys: vec![("tomato", Isometry3::translation(0.4, 0.1, 0.03))],
        }
    }

    fn around(model: RobotModel) -> TruthAround {
        let measured = Some(model.rig().home());
        TruthAround { is_twin: true, model: Arc::new(model), measured, tip: None, seen: vec![] }
    }

    fn of<'a>(rows: &'a [TruthRow], kind: TruthOf, name: &str) -> &'a TruthRow {
        rows.iter()
            .find(|row| row.of == kind && row.name == name)
            .unwrap_or_else(|| panic!("{name} in {rows:?}"))
    }

    #[test]
    fn what_is_as_described_is_off_by_nothing() {
        let rig = plumbline_model::robot::default_rig();
        let mut around = around(RobotModel::nominal(rig.clone()));
        around.seen = vec![Seen { name: "Tomato".to_owned(), place: Point::new(0.403, 0.1, 0.026) }];
        let rows = rows(&facts(&rig), &around);
        let tomato = of(&rows, TruthOf::Toy, "Tomato").distance_m().expect("a place");
        assert!((tomato - 0.005).abs() < 1e-4, "{tomato}");
        for row in rows.iter().filter(|row| row.of != TruthOf::Toy) {
            assert!(row.distance_m().unwrap_or_default() < 1e-6, "{row:?}");
            assert!(row.off_rad.unwrap_or_default().abs() < 1e-6, "{row:?}");
        }
        assert!(rows.iter().filter(|row| row.of == TruthOf::Zero).count() > 10);
    }

    #[test]
    fn a_zero_an_axis_and_a_mount_are_each_found_where_they_are_and_what_the_model_knows_is_taken_off() {
        let rig = plumbline_model::robot::default_rig();
        let mut facts = facts(&rig);
        // The forearm turns by 0.03 about the elbow's axis and by 0.01 across it.
        let joint = rig.description.joints().iter().find(|joint| joint.name == "r_elbow_y").expect("there");
        let JointKind::Revolute { axis, index, .. } = &joint.kind else { panic!("it turns") };
        let across = axis.cross(&Vector3::new(0.3, 0.5, 0.7)).normalize() * 0.01;
        let more = UnitQuaternion::from_scaled_axis(axis.into_inner() * 0.03 + across);
        let elbow = facts.robot_from_link[joint.child.0].as_mut().expect("there");
        elbow.rotation *= more;
        facts.robot_from_left *= Translation3::new(0.002, 0.0, 0.0);
        let title = &rig.servo_of(*index).expect("a servo").title;

        let unknown = rows(&facts, &around(RobotModel::nominal(rig.clone())));
        let zero = of(&unknown, TruthOf::Zero, title).off_rad.expect("an angle");
        assert!((zero + 0.03).abs() < 3e-4, "{zero}");
        let axis_rad = of(&unknown, TruthOf::Axis, title).off_rad.expect("an angle");
        assert!((axis_rad - 0.01).abs() < 3e-4, "{axis_rad}");
        let mount = of(&unknown, TruthOf::Mount, "left eye in the head").distance_m().expect("a place");
        assert!((mount - 0.002).abs() < 1e-4, "{mount}");

        let added = model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.03])]);
        let known = RobotModel::new(rig.clone(), Arc::new(added)).expect("it fits");
        let known = rows(&facts, &around(known));
        let zero = of(&known, TruthOf::Zero, title).off_rad.expect("an angle");
        assert!(zero.abs() < 3e-4, "{zero}");
    }

    #[test]
    fn an_axis_that_the_model_knows_to_be_askew_is_taken_off() {
        let rig = plumbline_model::robot::default_rig();
        let mut facts = facts(&rig);
        let joint = rig.description.joints().iter().find(|joint| joint.name == "r_elbow_y").expect("there");
        let JointKind::Revolute { axis, index, .. } = &joint.kind else { panic!("it turns") };
        // The elbow is bent, so it matters that the axis is askew before it turns.
        facts.encoders = rig.home().with(&[*index], &[1.2]);
        let places = rig.description.forward(&facts.encoders);
        for (link, stands) in facts.robot_from_link.iter_mut().enumerate() {
            *stands = Some(places.of(plumbline_model::robot::LinkIndex(link)).isometry);
        }
        let [a, b] = across(axis);
        let turn = UnitQuaternion::from_scaled_axis(a * 0.01 - b * 0.004)
            * UnitQuaternion::from_axis_angle(axis, 1.2);
        let upper_arm = facts.robot_from_link[joint.parent.0].expect("there");
        facts.robot_from_link[joint.child.0] = Some(upper_arm * joint.parent_from_joint * turn);
        let title = &rig.servo_of(*index).expect("a servo").title;
        let off_rad = |model: RobotModel, kind: TruthOf| {
            of(&rows(&facts, &around(model)), kind, title).off_rad.expect("an angle")
        };
        let unknown = off_rad(RobotModel::nominal(rig.clone()), TruthOf::Axis);
        assert!((unknown - 0.01_f64.hypot(0.004)).abs() < 3e-4, "{unknown}");
        let known = |values: &[f64]| {
            let added = model_with(&rig, &[("axis-skew", "r_elbow_y", values)]);
            RobotModel::new(rig.clone(), Arc::new(added)).expect("it fits")
        };
        let right = off_rad(known(&[0.01, -0.004]), TruthOf::Axis);
        assert!(right < 3e-4, "{right}");
        assert!(off_rad(known(&[0.01, -0.004]), TruthOf::Zero).abs() < 3e-4);
        let wrong = off_rad(known(&[-0.01, 0.004]), TruthOf::Axis);
        assert!((wrong - 2.0 * 0.01_f64.hypot(0.004)).abs() < 3e-4, "twice as far off: {wrong}");
    }
}

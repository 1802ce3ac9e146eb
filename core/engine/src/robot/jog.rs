//! From how fast a tip should go to how fast the joints must turn.
//!
//! The smallest joint speeds that take the tip just where it is asked to, all of them slower where one would be too
//! fast. The hand keeps its turn about the vertical as long as the arm can do both. Where the arm is nearly stretched
//! joints would go wild for little: it reaches no farther that way. A way that leads out of there is gone damped, slower
//! than asked and a little beside it. (Damped also on the way in, the tip went aside and down by a fifth of its way.)
//! Sources: Nakamura and Hanafusa: Inverse kinematic solutions with singularity robustness (1986); numerical filtering:
//! Maciejewski and Klein (1988).

use nalgebra::{DMatrix, DVector};
use plumbline_effects::ModelArm;
use plumbline_effects::rig_model::Conditions;
use plumbline_model::robot::Posture;

use super::command::JogRates;

/// Below this singular value (m/rad) directions are damped.
const DAMPING: f64 = 0.02;
/// The tip goes at least so far for a radian of the joints, m/rad: nearer to where the arm is stretched it is not jogged.
const LEAST_GAIN_M_RAD: f64 = 0.04;
/// It goes where it is asked to, to this share of the way.
const ASTRAY: f64 = 0.02;
/// A turn that is so much less than the way is not meant: a stick is never pushed quite straight.
const SLIGHT: f64 = 0.2;
/// So far ahead it is looked whether a way leads out of where the arm is stretched, rad.
const OUT_RAD: f64 = 0.01;
/// A turn of 1 rad/s counts as much as this many m/s.
const LEVER_M: f64 = 0.1;
/// Half of a difference of a joint's angle, rad.
const STEP_RAD: f64 = 1e-5;

/// Joint speeds (rad/s, one per joint of the arm) at which the real tip goes as asked when a posture is
/// commanded, all slowed down together so that none is faster than `fastest_rad_s`. `None`: the arm reaches no farther
/// that way.
pub fn joint_rates(
    arm: &ModelArm,
    commanded: &Posture,
    rates: &JogRates,
    fastest_rad_s: f64,
) -> Option<Vec<f64>> {
    let rows = slopes(arm, commanded);
    let [x, y, z] = rates.velocity_m_s;
    let all = DVector::from_vec(vec![x, y, z, rates.yaw_rad_s * LEVER_M]);
    // A turn that is asked for is no less wanted than a way.
    let turns = all[3].abs() > SLIGHT * (x * x + y * y + z * z).sqrt();
    let counted = if turns { 4 } else { 3 };
    let (of_way, way) = (rows.rows(0, counted).into_owned(), all.rows(0, counted).into_owned());
    let speeds = exact(&rows, &all, DAMPING)
        .or_else(|| exact(&of_way, &way, LEAST_GAIN_M_RAD))
        .or_else(|| led_out(arm, commanded, of_way, &way))?;
    let fastest = speeds.amax();
    let slow_down = if fastest > fastest_rad_s { fastest_rad_s / fastest } else { 1.0 };
    Some(speeds.iter().map(|speed| speed * slow_down).collect())
}

/// The smallest joint speeds that give just this velocity; `None`: there are none but wild ones, which take it less far
/// than `least_m_rad`.
fn exact(rows: &DMatrix<f64>, wanted: &DVector<f64>, least_m_rad: f64) -> Option<DVector<f64>> {
    let speeds = rows.clone().try_svd(true, true, f64::EPSILON, 200)?.solve(wanted, 1e-6).ok()?;
    let astray = (rows * &speeds - wanted).norm();
    // NaN fails both comparisons.
    let is_so = speeds.norm() * least_m_rad <= wanted.norm() && astray <= ASTRAY * wanted.norm();
    is_so.then_some(speeds)
}

/// Damped speeds, where the arm is less stretched after them.
fn led_out(
    arm: &ModelArm,
    commanded: &Posture,
    rows: DMatrix<f64>,
    wanted: &DVector<f64>,
) -> Option<DVector<f64>> {
    let counted = rows.nrows();
    let least =
        |rows: DMatrix<f64>| Some(rows.try_svd(false, false, f64::EPSILON, 200)?.singular_values.min());
    let before = least(rows.clone())?;
    let speeds = solved(rows, wanted)?;
    let step = speeds.normalize() * OUT_RAD;
    let angles: Vec<f64> = commanded.of(arm.joints()).iter().zip(&step).map(|(at, by)| at + by).collect();
    let there = slopes(arm, &commanded.with(arm.joints(), &angles)).rows(0, counted).into_owned();
    // NaN, where nothing turns, fails the comparison.
    (least(there)? > before).then_some(speeds)
}

/// The smallest joint speeds that give a velocity; less of it in directions that the arm hardly has. `None`: the numbers
/// are none.
fn solved(rows: DMatrix<f64>, wanted: &DVector<f64>) -> Option<DVector<f64>> {
    let joints = rows.ncols();
    let parts = rows.try_svd(true, true, f64::EPSILON, 200)?;
    let (u, v_t) = (parts.u?, parts.v_t?);
    let mut speeds = DVector::zeros(joints);
    for (k, value) in parts.singular_values.iter().enumerate() {
        let gain = if *value >= DAMPING { 1.0 / value } else { value / (DAMPING * DAMPING) };
        speeds += v_t.row(k).transpose() * (gain * u.column(k).dot(wanted));
    }
    speeds.iter().all(|speed| speed.is_finite()).then_some(speeds)
}

/// Velocity of the tip (m/rad) and its turn about the vertical (times [`LEVER_M`]), one column per
/// joint.
fn slopes(arm: &ModelArm, commanded: &Posture) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(4, arm.joints().len());
    if arm.is_nominal() {
        let (_, jacobian) = arm.chain().jacobian(&commanded.of(arm.joints()));
        rows.rows_mut(0, 3).copy_from(&jacobian.rows(0, 3));
        rows.row_mut(3).copy_from(&(jacobian.row(5) * LEVER_M));
        return rows;
    }
    let conditions = Conditions::default();
    for (i, joint) in arm.joints().iter().enumerate() {
        let at = |step_rad: f64| {
            let turned = commanded.with(&[*joint], &[commanded[*joint] + step_rad]);
            arm.robot_from_tip(&turned, &conditions).isometry
        };
        let (behind, ahead) = (at(-STEP_RAD), at(STEP_RAD));
        let velocity = (ahead.translation.vector - behind.translation.vector) / (2.0 * STEP_RAD);
        let turn = (ahead.rotation * behind.rotation.inverse()).scaled_axis() / (2.0 * STEP_RAD);
        rows.fixed_view_mut::<3, 1>(0, i).copy_from(&velocity);
        rows[(3, i)] = turn.z * LEVER_M;
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Vector3;
    use plumbline_effects::RobotModel;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::rig_models::made_up::model_with;

    const TIP: &str = "right_index_tip";

    fn nominal() -> (Arc<Rig>, ModelArm) {
        let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
        let arm = RobotModel::nominal(rig.clone()).arm(TIP).expect("a tip");
        (rig, arm)
    }

    fn ready(rig: &Rig) -> Posture {
        rig.pose("touch-ready").expect("a pose of NICO").applied_to(&rig.home())
    }

    /// Where the tip goes per second.
    fn went(arm: &ModelArm, from: &Posture, speeds: &[f64]) -> Vector3<f64> {
        let step = 1e-4;
        let angles: Vec<f64> =
            from.of(arm.joints()).iter().zip(speeds).map(|(angle, speed)| angle + speed * step).collect();
        let place = |posture: &Posture| arm.tip(posture, &Conditions::default()).coords;
        (place(&from.with(arm.joints(), &angles)) - place(from)) / step
    }

    #[test]
    fn the_tip_goes_where_it_is_asked_to() {
        let (rig, arm) = nominal();
        let rates = JogRates { velocity_m_s: [0.05, -0.02, 0.01], yaw_rad_s: 0.0 };
        let speeds = joint_rates(&arm, &ready(&rig), &rates, 10.0).expect("within reach");
        let asked = Vector3::from(rates.velocity_m_s);
        let went = went(&arm, &ready(&rig), &speeds);
        assert!((went - asked).norm() < 0.01 * asked.norm(), "{went:?}");
    }

    /// As a held button goes: step by step, each from where the last one ended.
    #[test]
    fn a_jog_of_some_centimeters_stays_on_its_line() {
        let (rig, arm) = nominal();
        let tip = |posture: &Posture| arm.tip(posture, &Conditions::default()).coords;
        for asked in [[0.02, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]] {
            let (mut posture, from) = (ready(&rig), tip(&ready(&rig)));
            for _ in 0..200 {
                let rates = JogRates { velocity_m_s: asked, yaw_rad_s: 0.0 };
                let speeds = joint_rates(&arm, &posture, &rates, 10.0).expect("within reach");
                let angles: Vec<f64> = posture
                    .of(arm.joints())
                    .iter()
                    .zip(&speeds)
                    .map(|(angle, speed)| angle + speed * 0.01)
                    .collect();
                posture = posture.with(arm.joints(), &angles);
            }
            let off = tip(&posture) - from - 2.0 * Vector3::from(asked);
            assert!(off.norm() < 1e-3, "{asked:?}: {off:?} beside 40 mm of way");
        }
    }

    #[test]
    fn with_effects_the_real_tip_goes_where_it_is_asked_to() {
        let (rig, nominal) = nominal();
        let effects = [("joint-zero", "r_elbow_y", [0.2].as_slice()), ("joint-zero", "r_arm_x", &[-0.15])];
        let model = RobotModel::new(rig.clone(), Arc::new(model_with(&rig, &effects))).expect("they fit");
        let real = model.arm(TIP).expect("a tip");
        let rates = JogRates { velocity_m_s: [0.05, -0.02, 0.01], yaw_rad_s: 0.0 };
        // What is asked of the arm without effects and of that with them is judged by the same measure.
        let asked = Vector3::from(rates.velocity_m_s);
        let [with, without] = [&real, &nominal].map(|by| {
            let speeds = joint_rates(by, &ready(&rig), &rates, 10.0).expect("within reach");
            (went(&real, &ready(&rig), &speeds) - asked).norm() / asked.norm()
        });
        assert!(with < 0.01 && without > 0.05, "astray by {with} with and {without} without");
    }

    #[test]
    fn differences_are_the_jacobian() {
        let (rig, arm) = nominal();
        // An effect of size nearly zero, so that differences are taken.
        let model = model_with(&rig, &[("joint-zero", "r_elbow_y", &[1e-12])]);
        let model = RobotModel::new(rig.clone(), Arc::new(model)).expect("it fits");
        let nearly = model.arm(TIP).expect("a tip");
        assert!(!nearly.is_nominal());
        let (by_differences, exact) = (slopes(&nearly, &ready(&rig)), slopes(&arm, &ready(&rig)));
        assert!((by_differences - exact).amax() < 1e-8);
    }

    #[test]
    fn no_joint_is_faster_than_allowed_even_at_a_stretched_arm() {
        let (rig, arm) = nominal();
        let angles = [0.0, 1.2, 0.0, std::f64::consts::PI, 0.0, 0.0];
        let stretched = rig.home().with(arm.joints(), &angles);
        let ways = [[1.0, 1.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
        let asked = ways.into_iter().flat_map(|way| [0.0, 3.0].map(|yaw_rad_s| (way, yaw_rad_s)));
        let gone = asked.filter_map(|(velocity_m_s, yaw_rad_s)| {
            let speeds = joint_rates(&arm, &stretched, &JogRates { velocity_m_s, yaw_rad_s }, 0.5)?;
            for speed in &speeds {
                assert!(speed.is_finite() && speed.abs() <= 0.5 + 1e-12, "{velocity_m_s:?}: {speed}");
            }
            Some(speeds)
        });
        assert!(gone.count() >= 2, "ways that it can go are left to it");
    }

    /// The way of a held button from one posture: all places of the tip until the arm reaches no farther.
    fn held(
        arm: &ModelArm,
        from: &Posture,
        velocity_m_s: [f64; 3],
    ) -> (Posture, Vec<nalgebra::Point3<f64>>, bool) {
        let (mut posture, mut places) = (from.clone(), vec![]);
        for _ in 0..2000 {
            places.push(arm.tip(&posture, &Conditions::default()).coords);
            let rates = JogRates { velocity_m_s, yaw_rad_s: 0.0 };
            let Some(speeds) = joint_rates(arm, &posture, &rates, 0.5) else {
                return (posture, places, true);
            };
            let angles = posture.of(arm.joints());
            let angles: Vec<f64> = angles.iter().zip(&speeds).map(|(at, speed)| at + 0.01 * speed).collect();
            posture = posture.with(arm.joints(), &angles);
        }
        (posture, places, false)
    }

    #[test]
    fn an_arm_that_is_jogged_out_goes_straight_and_ends_and_comes_back() {
        let (rig, arm) = nominal();
        let (stretched, out, ended) = held(&arm, &ready(&rig), [0.06, 0.0, 0.0]);
        assert!(ended, "it says that it reaches no farther");
        let way = out[out.len() - 1] - out[0];
        assert!(way.x > 0.05, "{way:?}");
        for place in &out {
            let aside = (place - out[0]).yz().norm();
            assert!(aside < 2e-3, "{aside} m beside its line after {:?}", place - out[0]);
        }
        let (_, back, _) = held(&arm, &stretched, [-0.06, 0.0, 0.0]);
        let way = back[back.len().min(200) - 1] - back[0];
        assert!(way.x < -0.05, "it comes back: {way:?}");
    }

    #[test]
    fn no_wish_no_motion() {
        let (rig, arm) = nominal();
        let speeds =
            joint_rates(&arm, &rig.home(), &JogRates::default(), 0.5).expect("nothing is out of reach");
        assert!(speeds.iter().all(|speed| *speed == 0.0));
    }
}

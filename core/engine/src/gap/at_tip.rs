//! How far each effect of a model moves what it is about: what a size in degrees or newtons is worth on the table.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use plumbline_effects::rig_model::{Conditions, Contents, ModelEffect};
use plumbline_effects::{Kind, RigModel, RobotModel, SeenUnder};
use plumbline_model::Pixel;
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::touch_plan::TouchArea;

/// Away from the border of the glass, m.
const MARGIN_M: f64 = 0.05;
/// Columns and rows of places at which effects are looked at.
const PLACES: usize = 3;
/// An effect that moves less is called small, m: a fingertip is several times as wide.
pub const SMALL_M: f64 = 0.5e-3;

/// Per effect of a model, rms over a few places of the touchscreen, m: of an arm, how far it moves the fingertip
/// there; of the eyes, how far it moves where they see the place. `None`: nothing there shows it.
pub fn moved_m(model: &RigModel, rig: &Arc<Rig>) -> Vec<Option<f64>> {
    let mut postures: BTreeMap<&str, Vec<Vec<f64>>> = BTreeMap::new();
    for tip in model.effects().iter().filter_map(|effect| effect.tip.as_deref()) {
        postures.entry(tip).or_insert_with(|| self::postures(rig, tip));
    }
    let moved = |effect: &ModelEffect| {
        let contents = Contents {
            eyes: model.contents.eyes.clone(),
            effects: vec![effect.clone()],
            ..Contents::default()
        };
        let alone = RigModel { contents, ..RigModel::nominal(rig) };
        if Kind::of_id(&effect.id).is_some_and(Kind::is_of_eyes) {
            return rms(&seen(alone, rig)?);
        }
        let tip = effect.tip.as_deref()?;
        rms(&touched(&alone, rig, tip, postures.get(tip)?)?)
    };
    model.effects().iter().map(moved).collect()
}

/// Nothing that is looked at is moved by nothing at all: an effect that shows in time or under a load only does.
fn rms(moved_m: &[Vector3<f64>]) -> Option<f64> {
    let mean = moved_m.iter().map(Vector3::norm_squared).sum::<f64>() / moved_m.len().max(1) as f64;
    Some(mean.sqrt()).filter(|moved_m| moved_m.is_finite() && *moved_m > 0.0)
}

/// Places of the touchscreen, px.
fn pixels(rig: &Rig) -> Vec<[f64; 2]> {
    let area = TouchArea::within(&rig.touchscreen, MARGIN_M);
    let at = |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / (PLACES - 1) as f64;
    let all = (0..PLACES * PLACES).map(|k| [at(area.u_px, k % PLACES), at(area.v_px, k / PLACES)]);
    all.collect()
}

/// The arm with its tip at the places that it reaches, angles of its chain, rad.
fn postures(rig: &Rig, tip: &str) -> Vec<Vec<f64>> {
    let Ok(solver) = Solver::of_rig(rig, tip) else { return vec![] };
    let home = rig.home();
    let reached = |[u_px, v_px]: [f64; 2]| {
        let target = Target::Position(rig.touchscreen.point_at(Pixel::new(u_px, v_px)));
        let answer = solver.solve_from(&target, &home, &Options::default()).ok()?;
        answer.is_reached().then(|| answer.best().joints.to_vec())
    };
    pixels(rig).into_iter().filter_map(reached).collect()
}

/// How far the one effect of `alone` moves the tip on the glass, from either side.
fn touched(alone: &RigModel, rig: &Rig, tip: &str, postures: &[Vec<f64>]) -> Option<Vec<Vector3<f64>>> {
    let (nominal, with) = (RigModel::nominal(rig).arm(rig, tip).ok()?, alone.arm(rig, tip).ok()?);
    let moved = |angles_rad: &Vec<f64>| {
        [-1.0, 1.0].map(|side| {
            let direction = vec![side; angles_rad.len()];
            let conditions = Conditions { direction, payload_kg: 0.0, t_secs: None };
            with.touch_m(angles_rad, 0.0, &conditions) - nominal.touch_m(angles_rad, 0.0, &conditions)
        })
    };
    Some(postures.iter().flat_map(moved).collect())
}

/// How far the one effect of `alone` moves where the eyes see the places.
fn seen(alone: RigModel, rig: &Arc<Rig>) -> Option<Vec<Vector3<f64>>> {
    let home = rig.home();
    let posture = rig.pose("look-table").map_or_else(|| home.clone(), |pose| pose.applied_to(&home));
    let with = RobotModel::new(rig.clone(), Arc::new(alone)).ok()?;
    let left_from_robot = rig.robot_from_left(&posture).inverse();
    let moved = |[u_px, v_px]: [f64; 2]| {
        let at = rig.touchscreen.point_at(Pixel::new(u_px, v_px));
        let place =
            with.place(&(left_from_robot * at), &Matrix3::zeros(), &posture, &SeenUnder::default())?;
        Some(place.point.coords.coords - at.coords.coords)
    };
    Some(pixels(rig).into_iter().filter_map(moved).collect())
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;
    use crate::rig_models::made_up::model_with;

    #[test]
    fn a_joint_that_is_off_moves_the_tip_by_its_lever() {
        let rig = Arc::new(default_rig());
        let sizes = [0.001, 0.01].map(|value| {
            let model = model_with(&rig, &[("joint-zero", "r_elbow_y", &[value])]);
            moved_m(&model, &rig)[0].expect("the elbow moves the finger")
        });
        // A forearm is some 0.2 to 0.4 m long.
        assert!((1e-4..5e-4).contains(&sizes[0]), "{sizes:?}");
        assert!((sizes[1] / sizes[0] - 10.0).abs() < 0.3, "{sizes:?}");
    }

    #[test]
    fn each_effect_is_looked_at_alone() {
        let rig = Arc::new(default_rig());
        let both = [("joint-zero", "r_elbow_y", &[0.01][..]), ("joint-zero", "r_shoulder_y", &[0.002][..])];
        let together = moved_m(&model_with(&rig, &both), &rig);
        let alone = both.map(|one| moved_m(&model_with(&rig, &[one]), &rig)[0]);
        assert_eq!(together, alone);
        assert_eq!(moved_m(&RigModel::nominal(&rig), &rig), []);
    }

    #[test]
    fn a_turn_of_the_neck_moves_what_the_eyes_see() {
        let rig = Arc::new(default_rig());
        let pan = rig.description.joint(rig.eyes.pan).name.clone();
        let model = model_with(&rig, &[("head-joint", &pan, &[0.005])]);
        let moved_m = moved_m(&model, &rig)[0].expect("the table is looked at");
        // Half a meter away a turn by 5 mrad is some millimeters.
        assert!((0.5e-3..6e-3).contains(&moved_m), "{moved_m}");
    }
}

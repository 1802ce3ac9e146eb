//! Robots that are off by what is drawn, for the laws of what is stated beside places.

use nalgebra::Matrix3;
use plumbline_model::Point;

use super::*;

/// 95 % of chi-square with three degrees of freedom.
const INSIDE: f64 = 7.815;
/// So many robots are drawn.
const ROBOTS: usize = 250;

pub(super) fn effect(id: &str, site: &str, shape: Option<f64>, values: Vec<f64>) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: None,
        shape,
        reference_s: 0.0,
        values,
        covariance: vec![],
        probability: None,
        parameters: vec![],
    }
}

pub(super) fn model(rig: &Arc<Rig>, effects: Vec<ModelEffect>) -> RobotModel {
    let mut added = RigModel::nominal(rig);
    added.contents.effects = effects;
    RobotModel::new(rig.clone(), Arc::new(added)).expect("they fit")
}

/// Share of places over the table that lie inside the 95 % that `here` states of them, of robots as they are drawn.
pub(super) fn share_inside(
    here: &RobotModel,
    seen: &SeenUnder,
    mut drawn: impl FnMut() -> RobotModel,
) -> f64 {
    let rig = here.rig();
    let posture = rig.home();
    let (mut inside, mut judged) = (0_usize, 0_usize);
    for _ in 0..ROBOTS {
        let truly = drawn();
        for [x, y, z] in [[0.35, -0.1, 0.08], [0.3, 0.12, 0.06], [0.4, 0.0, 0.1]] {
            let point = Point::new(x, y, z);
            let Some((left, right)) = truly.project(&point, &posture, &SeenUnder::default()) else {
                continue;
            };
            let in_left = rig.eyes.cameras.triangulate(left, right).expect("rays meet");
            let found = here.place(&in_left, &Matrix3::zeros(), &posture, seen).expect("a place");
            let error_m = found.point.coords.coords - point.coords.coords;
            let information = found.covariance_m2.try_inverse().expect("nothing is known exactly");
            inside += usize::from((error_m.transpose() * information * error_m).x < INSIDE);
            judged += 1;
        }
    }
    assert!(judged > 740, "{judged} of {} are in view", 3 * ROBOTS);
    inside as f64 / judged as f64
}

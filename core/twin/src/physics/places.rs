//! Where MuJoCo puts the bodies of a model: what another program makes of a file.

use std::collections::BTreeMap;

use mujoco_rs::prelude::*;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::error::TwinError;

/// Places of all named bodies of an MJCF, world frame, when joints stand at some angles (rad, by name);
/// others stand at zero.
///
/// # Errors
/// When MuJoCo does not accept the text, or it has no such joint.
pub fn places_of_bodies(
    mjcf: &str,
    angles_rad: &[(&str, f64)],
) -> Result<BTreeMap<String, Isometry3<f64>>, TwinError> {
    let physics = |reason: String| TwinError::Physics { reason };
    let model = MjModel::from_xml_string(mjcf).map_err(|error| physics(error.to_string()))?;
    let mut data = MjData::new(Box::new(model));
    for (name, angle_rad) in angles_rad {
        let joint = data.joint(name).ok_or_else(|| physics(format!("it has no joint {name}")))?;
        joint.view_mut(&mut data).qpos[0] = *angle_rad;
    }
    data.forward();
    let bodies = data.model().ffi().nbody as usize;
    let place = |body: usize| {
        let ([x, y, z], [w, i, j, k]) = (data.xpos()[body], data.xquat()[body]);
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
        Isometry3::from_parts(Translation3::new(x, y, z), turn)
    };
    let named = |body: usize| {
        let name = data.model().id_to_name(MjtObjBase::mjOBJ_BODY, body)?;
        Some((name.to_owned(), place(body)))
    };
    Ok((0..bodies).filter_map(named).collect())
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    #[test]
    fn a_description_written_for_mujoco_stands_as_described() {
        let rig = default_rig();
        let mjcf = rig.description.to_mjcf();
        for pose in &rig.poses {
            let posture = rig.home();
            let (joints, angles): (Vec<_>, Vec<f64>) = pose.joints.iter().copied().unzip();
            let posture = posture.with(&joints, &angles);
            let movable = rig.description.movable().map(|joint| joint.name.as_str());
            let angles = movable.map(|name| {
                let index = rig.description.find_joint(name).expect("it is there");
                (name, posture[index])
            });
            let places = places_of_bodies(&mjcf, &angles.collect::<Vec<_>>()).expect("MuJoCo accepts it");
            let poses = rig.description.forward(&posture);
            for tip in rig.arms.iter().flat_map(|arm| &arm.tips) {
                let wanted = poses.of(rig.description.find_link(&tip.link).expect("a link")).isometry;
                let found = places[&tip.link];
                let off_m = (found.translation.vector - wanted.translation.vector).norm();
                assert!(off_m < 1e-6, "{} in {}: {off_m} m", tip.link, pose.name);
                assert!(found.rotation.angle_to(&wanted.rotation) < 1e-5, "{} in {}", tip.link, pose.name);
            }
        }
        let refused = places_of_bodies(&mjcf, &[("r_tail_x", 0.0)]).expect_err("no such joint").to_string();
        assert!(refused.contains("r_tail_x"), "{refused}");
        assert!(places_of_bodies("<mujoco><nothing/></mujoco>", &[]).is_err());
    }
}

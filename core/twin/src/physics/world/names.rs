//! The parts of the world by their names in the model.

use mujoco_rs::prelude::*;
use plumbline_model::robot::{JointIndex, LinkIndex, Rig};

use super::{Rub, ToyState};
use crate::error::TwinError;
use crate::physics::parts;
use crate::physics::touch::TouchWatch;
use crate::scenario::Scenario;
use crate::toys::Toy;

pub(super) fn find(model: &MjModel, kind: MjtObjBase, name: &str) -> Result<usize, TwinError> {
    let missing = || TwinError::Physics { reason: format!("the part {name} got lost on the way") };
    model.name_to_id(kind, name).ok_or_else(missing)
}

pub(super) fn find_rub(model: &MjModel, rig: &Rig, joint: JointIndex) -> Result<Rub, TwinError> {
    let described = rig.description.joint(joint);
    if parts::finger(rig, described.child).is_some() {
        return find(model, MjtObjBase::mjOBJ_TENDON, &described.name).map(Rub::Tendon);
    }
    let id = find(model, MjtObjBase::mjOBJ_JOINT, &described.name)?;
    Ok(Rub::Dof(model.jnt_dofadr()[id] as usize))
}

pub(super) fn find_toy(model: &MjModel, toy: Toy) -> Result<ToyState, TwinError> {
    let id = find(model, MjtObjBase::mjOBJ_JOINT, &format!("toy.{}", toy.name()))?;
    let (qpos, dof) = (model.jnt_qposadr()[id] as usize, model.jnt_dofadr()[id] as usize);
    Ok(ToyState { out: true, qpos, dof })
}

pub(super) fn watch(model: &MjModel, rig: &Rig, threshold_n: f64) -> Result<TouchWatch, TwinError> {
    let glass = find(model, MjtObjBase::mjOBJ_GEOM, "glass")? as i32;
    let links = rig.description.links().iter().enumerate();
    let fingers = links
        .filter(|(i, _)| parts::finger(rig, LinkIndex(*i)).is_some())
        .map(|(_, link)| {
            find(model, MjtObjBase::mjOBJ_GEOM, &format!("{}.tip", link.name)).map(|id| id as i32)
        })
        .collect::<Result<_, _>>()?;
    Ok(TouchWatch::new(glass, fingers, threshold_n))
}

pub(super) fn check_names(rig: &Rig, scenario: &Scenario) -> Result<(), TwinError> {
    let unknown = |what, name: &String| TwinError::UnknownPart {
        scenario: scenario.name.clone(),
        what,
        name: name.clone(),
        robot: rig.name.clone(),
    };
    if let Some(name) = scenario.joint.keys().find(|name| rig.description.find_joint(name).is_err()) {
        return Err(unknown("joint", name));
    }
    let is_finger =
        |name: &String| rig.description.find_link(name).is_ok_and(|link| parts::finger(rig, link).is_some());
    match scenario.fingertip.keys().find(|name| !is_finger(name)) {
        Some(name) => Err(unknown("finger", name)),
        None => Ok(()),
    }
}

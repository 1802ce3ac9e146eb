//! Effects that have a home in the robot's description, written into its URDF, so that other programs
//! have them, too. Springs, play and time laws have none there: they stay in the model.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::{Description, DescriptionError, JointKind, Rig};

use super::{ModelEffect, RigModel};
use crate::arm::{Arm, Deviation};
use crate::library::Situation;

/// What stays the same in every situation is exported within this, m and rad.
const EXACT: f64 = 1e-9;

/// A description with the effects that fit into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// Text of the URDF with other origins.
    pub urdf: String,
    /// Effects that are in it, as `id@site`.
    pub inside: Vec<String>,
    /// Effects that are not, because a URDF cannot say them.
    pub left: Vec<String>,
}

/// Why no description was written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// Not a URDF, or it lacks a part of the rig.
    #[error("the description cannot be used ({0}): give the URDF of this robot")]
    Description(#[from] DescriptionError),
    /// A URDF of another robot.
    #[error("joint {joint} of the description sits elsewhere than in the robot: give the URDF of this robot")]
    Other {
        /// The joint.
        joint: String,
    },
    /// Its text is laid out in a way that cannot be edited.
    #[error(
        "the origin of joint {joint} was not found in the text of the description: write it as one tag <origin xyz=\"…\" rpy=\"…\"/> inside of <joint>"
    )]
    Layout {
        /// The joint.
        joint: String,
    },
}

impl RigModel {
    /// The robot's URDF with those effects that are origins: zeros, axes out of square, lengths, the
    /// tip's offset, the tilt of an arm's base. Everything else of the text stays.
    ///
    /// # Errors
    /// When the text is no URDF of this rig, or its origins cannot be edited.
    pub fn urdf_with(&self, rig: &Rig, urdf: &str) -> Result<Exported, ExportError> {
        let given = Description::from_urdf(urdf)?;
        let mut origins: BTreeMap<String, Isometry3<f64>> = BTreeMap::new();
        for joint in rig.description.joints() {
            let same = given.joints().iter().find(|other| other.name == joint.name);
            if !same.is_some_and(|same| near(&same.parent_from_joint, &joint.parent_from_joint)) {
                return Err(ExportError::Other { joint: joint.name.clone() });
            }
            origins.insert(joint.name.clone(), joint.parent_from_joint);
        }
        let tips: BTreeSet<&str> = self.effects().iter().filter_map(|effect| effect.tip.as_deref()).collect();
        let (mut inside, mut changed) = (vec![], BTreeSet::new());
        for tip in tips {
            let own = self.effects().iter().filter(|effect| effect.tip.as_deref() == Some(tip));
            self.move_origins(rig, tip, own, &mut origins, &mut changed, &mut inside)?;
        }
        let left = self.effects().iter().map(ModelEffect::name).filter(|name| !inside.contains(name));
        let mut text = urdf.to_owned();
        for joint in &changed {
            text = with_origin(&text, joint, &origins[joint])
                .ok_or_else(|| ExportError::Layout { joint: joint.clone() })?;
        }
        let written = Description::from_urdf(&text)?;
        for joint in written.joints() {
            if origins.get(&joint.name).is_none_or(|origin| !near(origin, &joint.parent_from_joint)) {
                return Err(ExportError::Layout { joint: joint.name.clone() });
            }
        }
        Ok(Exported { left: left.collect(), urdf: text, inside })
    }

    fn move_origins<'a>(
        &self,
        rig: &Rig,
        tip: &str,
        effects: impl Iterator<Item = &'a ModelEffect>,
        origins: &mut BTreeMap<String, Isometry3<f64>>,
        changed: &mut BTreeSet<String>,
        inside: &mut Vec<String>,
    ) -> Result<(), ExportError> {
        let arm = Arm::of_rig(rig, tip)?;
        let zeros = vec![0.0; arm.len()];
        let up = Vector3::z();
        let situation = Situation::new(&arm, &zeros, &zeros, 0.0, &up);
        let mut deviation = Deviation::none(arm.len());
        let tip_joint =
            rig.description.find_link(tip).ok().and_then(|link| rig.description.joint_above(link));
        let tip_joint = tip_joint.filter(|joint| joint.kind == JointKind::Fixed);
        for effect in effects {
            let Some(present) = effect.on(Some(&arm), None) else { continue };
            let kind = present.effect.kind;
            if kind.is_origin() && (!kind.is_of_tip() || tip_joint.is_some()) {
                present.effect.deviate(&situation, &present.values, &mut deviation);
                inside.push(effect.name());
            }
        }
        let base = Isometry3::from_parts(
            Translation3::from(deviation.base_m),
            UnitQuaternion::from_scaled_axis(deviation.base_rad),
        );
        for (j, part) in arm.parts.iter().enumerate() {
            let nominal = rig.description.joint(part.index).parent_from_joint;
            // Fixed joints between the joint before and this one stay as they are.
            let fixed = part.before * nominal.inverse();
            let mut moved: Isometry3<f64> = Translation3::from(deviation.shift_m[j]) * fixed;
            if j == 0 {
                moved = base * moved;
            }
            let turn = UnitQuaternion::from_scaled_axis(deviation.skew_rad[j])
                * UnitQuaternion::from_axis_angle(&part.axis, deviation.joint_rad[j]);
            let Some(origin) = origins.get_mut(&part.joint) else { continue };
            let next = fixed.inverse() * moved * *origin * turn;
            if !near(&next, origin) {
                *origin = next;
                changed.insert(part.joint.clone());
            }
        }
        if let Some(origin) = tip_joint.and_then(|joint| origins.get_mut(&joint.name))
            && deviation.tip_m.norm() > 0.0
        {
            *origin *= Translation3::from(deviation.tip_m);
            changed.extend(tip_joint.map(|joint| joint.name.clone()));
        }
        Ok(())
    }
}

fn near(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    let off = (a.translation.vector - b.translation.vector).norm();
    off < EXACT && a.rotation.angle_to(&b.rotation) < EXACT
}

/// The text with another origin of one joint; `None` where it is not laid out as expected.
fn with_origin(text: &str, joint: &str, origin: &Isometry3<f64>) -> Option<String> {
    let mut from = 0;
    let (begin, end) = loop {
        let begin = from + text[from..].find("<joint")?;
        let end = begin + text[begin..].find("</joint>")?;
        let head = &text[begin..begin + text[begin..].find('>')?];
        let named = ["\"", "'"].iter().any(|quote| head.contains(&format!("name={quote}{joint}{quote}")));
        // Transmissions name joints, too, without saying what they connect.
        if named && text[begin..end].contains("<parent") {
            break (begin, end);
        }
        from = begin + "<joint".len();
    };
    let [x, y, z]: [f64; 3] = origin.translation.vector.into();
    let (roll, pitch, yaw) = origin.rotation.euler_angles();
    let tag = format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>");
    let (place, length) = match text[begin..end].find("<origin") {
        Some(at) => {
            let rest = &text[begin + at..end];
            (begin + at, rest.find("/>")? + "/>".len())
        }
        None => (begin + text[begin..end].find('>')? + 1, 0),
    };
    Some(format!("{}{tag}{}", &text[..place], &text[place + length..]))
}

//! Effects that have a home in the robot's description, written into its URDF, so that other programs
//! have them, too. Springs, play and time laws have none there: they stay in the model.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use plumbline_model::robot::{Description, DescriptionError, JointKind, Rig};

use super::RigModel;
use super::left_out::{LeftOut, why};
use crate::arm::{Arm, Deviation};
use crate::eyes::{EyeSituation, Eyes, EyesDeviation};
use crate::library::{Kind, Situation};

/// Links that the description gets for the eyes, left first: frames as OpenCV has them, x to the right in
/// the image, y down, z along the optical axis.
pub const CAMERA_LINKS: [&str; 2] = ["left_camera", "right_camera"];

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
    pub left_out: Vec<LeftOut>,
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
    /// A link of the description is called like one of the cameras.
    #[error("the description has a link or joint called {name}, which the camera of an eye gets: rename it")]
    CameraLink {
        /// Its name.
        name: String,
    },
}

/// What is added to the origins of a robot, by the names of its joints and links.
#[derive(Default)]
struct Moved {
    joints: BTreeMap<String, MovedJoint>,
    /// What moves the base of an arm, by its first joint: rotation vector (rad) and shift (m), robot frame.
    bases: BTreeMap<String, [Vector3<f64>; 2]>,
    /// Shifts of tips, tip frame, m.
    tips: BTreeMap<String, Vector3<f64>>,
}

/// A joint as it is moved.
struct MovedJoint {
    /// From the turned frame of the joint before to this one, nominal.
    before: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    turn_rad: f64,
    skew_rad: Vector3<f64>,
    shift_m: Vector3<f64>,
}

impl Moved {
    /// Adds what is found on an arm that ends in a tip.
    fn add(&mut self, arm: &Arm, tip: &str, deviation: &Deviation) {
        for (j, part) in arm.parts.iter().enumerate() {
            let joint = self.joint(part.joint.clone(), part.before, part.axis);
            joint.turn_rad += deviation.joint_rad[j];
            joint.skew_rad += deviation.skew_rad[j];
            joint.shift_m += deviation.shift_m[j];
        }
        if let Some(first) = arm.parts.first() {
            let [turn_rad, shift_m] = self.bases.entry(first.joint.clone()).or_default();
            *turn_rad += deviation.base_rad;
            *shift_m += deviation.base_m;
        }
        *self.tips.entry(tip.to_owned()).or_default() += deviation.tip_m;
    }

    fn joint(&mut self, name: String, before: Isometry3<f64>, axis: Unit<Vector3<f64>>) -> &mut MovedJoint {
        let zero = Vector3::zeros();
        let nominal = MovedJoint { before, axis, turn_rad: 0.0, skew_rad: zero, shift_m: zero };
        self.joints.entry(name).or_insert(nominal)
    }

    /// New origins of the joints that are moved.
    fn origins(&self, rig: &Rig) -> BTreeMap<String, Isometry3<f64>> {
        let mut origins = BTreeMap::new();
        for joint in rig.description.joints() {
            let nominal = joint.parent_from_joint;
            let mut origin = nominal;
            if let Some(moved) = self.joints.get(&joint.name) {
                // Fixed joints between the joint before and this one stay as they are.
                let fixed = moved.before * nominal.inverse();
                let mut place = Translation3::from(moved.shift_m) * moved.before;
                if let Some([turn_rad, shift_m]) = self.bases.get(&joint.name) {
                    let turn = UnitQuaternion::from_scaled_axis(*turn_rad);
                    place = Isometry3::from_parts(Translation3::from(*shift_m), turn) * place;
                }
                let turn = UnitQuaternion::from_axis_angle(&moved.axis, moved.turn_rad);
                origin = fixed.inverse() * place * UnitQuaternion::from_scaled_axis(moved.skew_rad) * turn;
            }
            let child = &rig.description.links()[joint.child.0].name;
            if let Some(shift_m) = self.tips.get(child).filter(|_| joint.kind == JointKind::Fixed) {
                origin *= Translation3::from(*shift_m);
            }
            if !near(&origin, &nominal) {
                origins.insert(joint.name.clone(), origin);
            }
        }
        origins
    }
}

impl RigModel {
    /// The robot's URDF with those effects that are constant geometry: zeros, axes out of square, lengths,
    /// the tip's offset, the tilt of an arm's base, zeros of the neck. Both cameras are added to it as the
    /// links [`CAMERA_LINKS`], where they are with the effects on the eyes. Everything else of the text stays.
    ///
    /// # Errors
    /// When the text is no URDF of this rig, or its origins cannot be edited.
    pub fn urdf_with(&self, rig: &Rig, urdf: &str) -> Result<Exported, ExportError> {
        let given = Description::from_urdf(urdf)?;
        for joint in rig.description.joints() {
            let same = given.joints().iter().find(|other| other.name == joint.name);
            if !same.is_some_and(|same| near(&same.parent_from_joint, &joint.parent_from_joint)) {
                return Err(ExportError::Other { joint: joint.name.clone() });
            }
        }
        let mut inside = BTreeSet::new();
        let mut moved = self.moved_arms(rig, &mut inside)?;
        let cameras = self.moved_eyes(rig, &mut moved, &mut inside)?;
        let origins = moved.origins(rig);
        let mut text = urdf.to_owned();
        for (joint, origin) in &origins {
            text = with_origin(&text, joint, origin)
                .ok_or_else(|| ExportError::Layout { joint: joint.clone() })?;
        }
        let head = &rig.description.links()[rig.eyes.link.0].name;
        for (name, place) in CAMERA_LINKS.into_iter().zip(&cameras) {
            text = with_link(&text, &given, head, name, place)?;
        }
        let written = Description::from_urdf(&text)?;
        for joint in rig.description.joints() {
            let wanted = origins.get(&joint.name).unwrap_or(&joint.parent_from_joint);
            let found = written.joints().iter().find(|other| other.name == joint.name);
            if !found.is_some_and(|found| near(wanted, &found.parent_from_joint)) {
                return Err(ExportError::Layout { joint: joint.name.clone() });
            }
        }
        let (mut names, mut left_out) = (vec![], vec![]);
        for (number, effect) in self.effects().iter().enumerate() {
            if inside.contains(&number) {
                names.push(effect.name());
            } else {
                left_out.push(LeftOut { effect: effect.name(), reason: why(effect).to_owned() });
            }
        }
        Ok(Exported { urdf: text, inside: names, left_out })
    }

    /// What moves the arms; numbers of the effects that do.
    fn moved_arms(&self, rig: &Rig, inside: &mut BTreeSet<usize>) -> Result<Moved, ExportError> {
        let mut moved = Moved::default();
        let tips: BTreeSet<&str> = self.effects().iter().filter_map(|effect| effect.tip.as_deref()).collect();
        for tip in tips {
            let arm = Arm::of_rig(rig, tip)?;
            let zeros = vec![0.0; arm.len()];
            let up = Vector3::z();
            let situation = Situation::new(&arm, &zeros, &zeros, 0.0, &up);
            let mut deviation = Deviation::none(arm.len());
            let above =
                rig.description.find_link(tip).ok().and_then(|link| rig.description.joint_above(link));
            let has_mount = above.is_some_and(|joint| joint.kind == JointKind::Fixed);
            for (number, effect) in self.effects().iter().enumerate() {
                let own = effect.tip.as_deref() == Some(tip);
                let Some(present) = effect.on(Some(&arm), None).filter(|_| own) else { continue };
                let kind = present.effect.kind;
                if kind.is_origin() && (!kind.is_of_tip() || has_mount) {
                    present.effect.deviate(&situation, &present.values, &mut deviation);
                    inside.insert(number);
                }
            }
            moved.add(&arm, tip, &deviation);
        }
        Ok(moved)
    }

    /// Where both cameras sit in the head, and what turns the joints of the neck.
    fn moved_eyes(
        &self,
        rig: &Rig,
        moved: &mut Moved,
        inside: &mut BTreeSet<usize>,
    ) -> Result<[Isometry3<f64>; 2], ExportError> {
        let eyes = Eyes::of_rig(rig)?;
        let mut deviation = EyesDeviation::none(eyes.neck.len());
        // What is constant depends on none of it.
        let neck_rad = vec![0.0; eyes.neck.len()];
        let in_left_m = Point3::new(0.0, 0.0, 0.5);
        let situation = EyeSituation {
            truth_m: eyes.robot_from_left(&neck_rad, &deviation) * in_left_m,
            in_left_m,
            t_secs: None,
            background_m: None,
            set: None,
            neck_torques_nm: neck_rad.clone(),
            neck_rad,
        };
        for (number, effect) in self.effects().iter().enumerate() {
            let Some(present) = effect.on(None, Some(&eyes)) else { continue };
            if is_place_of_eyes(present.effect.kind, present.effect.shape) {
                present.effect.deviate_eyes(&situation, &present.values, &mut deviation);
                inside.insert(number);
            }
        }
        for (part, turn_rad) in eyes.neck.parts.iter().zip(&deviation.neck_rad) {
            moved.joint(part.joint.clone(), part.before, part.axis).turn_rad += turn_rad;
        }
        let mount = Isometry3::from_parts(
            Translation3::from(deviation.mount_m),
            UnitQuaternion::from_scaled_axis(deviation.mount_rad),
        );
        let head_from_left = eyes.head_from_left * mount;
        let mut right_from_left = eyes.cameras.right_from_left.isometry;
        right_from_left.translation.vector *= 1.0 + deviation.baseline_scale;
        let turned = UnitQuaternion::from_scaled_axis(deviation.right_rad);
        let right_from_left = turned.inverse() * right_from_left;
        Ok([head_from_left, head_from_left * right_from_left.inverse()])
    }
}

/// Whether an effect on the eyes is where they sit, at whatever time.
fn is_place_of_eyes(kind: Kind, shape: Option<f64>) -> bool {
    match kind {
        Kind::HeadJoint => true,
        // With a shape it grows with time.
        Kind::CameraMount | Kind::EyeYaw | Kind::EyeRoll => shape.is_none(),
        // With a shape it is the baseline, without the focal length.
        Kind::FocalOrBaseline => shape.is_some(),
        _ => false,
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
    let tag = tag(origin);
    let (place, length) = match text[begin..end].find("<origin") {
        Some(at) => {
            let rest = &text[begin + at..end];
            (begin + at, rest.find("/>")? + "/>".len())
        }
        None => (begin + text[begin..end].find('>')? + 1, 0),
    };
    Some(format!("{}{tag}{}", &text[..place], &text[place + length..]))
}

/// The text with a link on a fixed joint of the same name.
fn with_link(
    text: &str,
    given: &Description,
    parent: &str,
    name: &str,
    place: &Isometry3<f64>,
) -> Result<String, ExportError> {
    let taken = given.find_link(name).is_ok() || given.joints().iter().any(|joint| joint.name == name);
    if taken {
        return Err(ExportError::CameraLink { name: name.to_owned() });
    }
    let layout = || ExportError::Layout { joint: name.to_owned() };
    let end = text.rfind("</robot>").ok_or_else(layout)?;
    let link = format!(
        "  <link name=\"{name}\"/>\n  <joint name=\"{name}\" type=\"fixed\">\n    <parent link=\"{parent}\"/>\n    <child \
         link=\"{name}\"/>\n    {}\n  </joint>\n",
        tag(place)
    );
    Ok(format!("{}{link}{}", &text[..end], &text[end..]))
}

/// An origin as a tag.
fn tag(origin: &Isometry3<f64>) -> String {
    let [x, y, z]: [f64; 3] = origin.translation.vector.into();
    let (roll, pitch, yaw) = origin.rotation.euler_angles();
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

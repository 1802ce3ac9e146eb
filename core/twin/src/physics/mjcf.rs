//! Writes the world as MJCF, MuJoCo's own format.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};
use plumbline_model::decompose;
use plumbline_model::robot::{JointKind, Link, LinkIndex, Rig};

use super::motor::Motor;
use super::parts::{self, Finger};
use super::place::Places;
use crate::error::TwinError;
use crate::scenario::{Holding, JointReality, Scenario};
use crate::scene::Shape;
use crate::toys::Toy;

/// Step of the physics, s.
pub(crate) const STEP_S: f64 = 0.002;
/// The description knows fingers of 9 mg; physics with contacts needs something to hold on to.
const LEAST_LINK_KG: f64 = 0.004;
const LEAST_FINGER_KG: f64 = 0.006;
const LEAST_INERTIA_KGM2: f64 = 2e-6;
/// Inertia between a joint's slack and its gears. With less, the stops of the slack are too stiff for the length of
/// a step: an arm that stands would rattle between them for ever, at a quarter of a radian per second, and shake
/// out of its hand what it holds. It takes nothing from how the arm stands.
const SLACK_KGM2: f64 = 0.003;
/// How much harder friction is than the contact that it needs (MuJoCo, "impratio"). Soft friction lets what is
/// pressed creep out of a hand however hard it is pressed, which dry friction does not: 0.14 mm per second with 20,
/// 0.04 with this.
const FRICTION_OVER_NORMAL: f64 = 100.0;
/// Joint stops stand this far outside of the described limits, so that a posture on its limit
/// does not lean on a stop.
const STOP_MARGIN_RAD: f64 = 0.03;
/// Pull of the tendon on a finger's outer joint, as a share of that on the inner one.
pub(crate) const OUTER_PULL: f64 = 0.6;
/// A spring keeps the outer joint straight until the inner one is held up.
const STRAIGHTENING_NM: f64 = 0.03;

/// Collision groups: (contype, conaffinity). The robot meets table, screen and toys, not itself.
const STATIC: &str = r#"contype="1" conaffinity="0""#;
const ROBOT: &str = r#"contype="2" conaffinity="1""#;
const TOY: &str = r#"contype="4" conaffinity="7""#;

/// The world as MJCF.
pub(crate) fn write(rig: &Rig, scenario: &Scenario, places: &Places) -> Result<String, TwinError> {
    let mut writer = Writer { rig, scenario, text: String::with_capacity(40_000), tail: String::new() };
    writer.head();
    writer.link(LinkIndex(0), 2)?;
    writer.furniture(places);
    writer.toys();
    writer.text.push_str("  </worldbody>\n");
    writer.actuators()?;
    Ok(writer.text)
}

struct Writer<'a> {
    rig: &'a Rig,
    scenario: &'a Scenario,
    text: String,
    /// Couplings, written after the bodies.
    tail: String,
}

impl Writer<'_> {
    fn head(&mut self) {
        let _ = write!(
            self.text,
            r#"<mujoco model="{}">
  <compiler angle="radian" autolimits="true" balanceinertia="true" inertiafromgeom="false" boundmass="0.001" boundinertia="1e-7"/>
  <option timestep="{STEP_S}" integrator="implicitfast" cone="elliptic" impratio="{FRICTION_OVER_NORMAL}" iterations="30" sleep_tolerance="0.004"><flag sleep="enable"/></option>
  <size memory="16M"/>
  <default>
    <geom condim="4" friction="0.8 0.005 0.0005"/>
    <equality solref="0.01 1"/>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" pos="0 0 -0.75" {STATIC}/>
"#,
            self.rig.name
        );
    }

    fn exact(&self) -> bool {
        self.scenario.servo.holding == Holding::Exact
    }

    /// A link and all that it carries.
    fn link(&mut self, index: LinkIndex, depth: usize) -> Result<(), TwinError> {
        let description = self.rig.description.clone();
        let link = &description.links()[index.0];
        let pad = "  ".repeat(depth);
        let joint = description.joint_above(index);
        let reality = joint.map(|joint| self.scenario.joint(&joint.name)).unwrap_or_default();
        let place = joint.map_or_else(Isometry3::identity, |joint| {
            let mut place = Translation3::from(Vector3::from(reality.origin_shift_m))
                * joint.parent_from_joint
                * UnitQuaternion::from_scaled_axis(Vector3::from(reality.axis_tilt_rad));
            if let Some((axis, _)) = joint.motion() {
                place *= UnitQuaternion::from_axis_angle(axis, reality.encoder_zero_rad);
            }
            if let Some(fingertip) = self.scenario.fingertip.get(&link.name) {
                place *= Translation3::from(Vector3::from(fingertip.offset_m));
            }
            place
        });
        // A frame without mass, shape or joint is a mere mark.
        let carries = description.joints().iter().any(|other| other.parent == index);
        let moves = joint.is_some_and(|joint| joint.motion().is_some());
        if link.inertia.is_none() && link.collisions.is_empty() && !carries && !moves {
            let _ = writeln!(self.text, r#"{pad}<site name="{}" {}/>"#, link.name, pose(&place));
            return Ok(());
        }
        let gravity = if self.exact() { r#" gravcomp="1""# } else { "" };
        let _ = writeln!(self.text, r#"{pad}<body name="{}"{gravity} {}>"#, link.name, pose(&place));
        let finger = parts::finger(self.rig, index);
        if let Some(joint) = joint.filter(|joint| joint.motion().is_some()) {
            self.joints(&joint.name, &joint.kind, &reality, finger.as_ref(), &pad)?;
        }
        match &finger {
            Some(finger) => self.finger(link, finger, joint.and_then(|j| j.motion()), &pad),
            None => self.solid(link, &pad),
        }
        for other in description.joints().iter().filter(|other| other.parent == index) {
            self.link(other.child, depth + 1)?;
        }
        let _ = writeln!(self.text, "{pad}</body>");
        Ok(())
    }

    /// The servo's own joint, and behind it play and give where the scenario has them.
    fn joints(
        &mut self,
        name: &str,
        kind: &JointKind,
        reality: &JointReality,
        finger: Option<&Finger>,
        pad: &str,
    ) -> Result<(), TwinError> {
        let (axis, limits) = match kind {
            JointKind::Revolute { axis, limits, .. } | JointKind::Coupled { axis, limits, .. } => {
                (axis, limits)
            }
            JointKind::Fixed => return Ok(()),
        };
        let (armature, damping) = match (kind, finger) {
            // A finger's motor pulls a tendon: rotor and brake are there.
            (_, Some(_)) | (JointKind::Coupled { .. }, _) => (1e-5, 1e-3),
            (JointKind::Revolute { index, .. }, None) => {
                let servo = self.rig.servo_of(*index);
                let motor = servo.map(|servo| Motor::of(&servo.model)).transpose()?;
                let ratio = servo.map_or(1.0, |servo| servo.ratio);
                motor.map_or((1e-4, 0.1), |m| {
                    (m.armature_kgm2 * ratio * ratio, m.damping_nms() * ratio * ratio)
                })
            }
            (JointKind::Fixed, None) => (0.0, 0.0),
        };
        let axis = vector(&axis.into_inner());
        let _ = writeln!(
            self.text,
            r#"{pad}  <joint name="{name}" type="hinge" axis="{axis}" range="{} {}" armature="{armature}" damping="{damping}"/>"#,
            limits.lower_rad - STOP_MARGIN_RAD,
            limits.upper_rad + STOP_MARGIN_RAD,
        );
        if reality.slack_rad > 0.0 {
            let half = 0.5 * reality.slack_rad;
            let _ = writeln!(
                self.text,
                r#"{pad}  <joint name="{name}.slack" type="hinge" axis="{axis}" range="{} {half}" solreflimit="0.006 1" armature="{SLACK_KGM2}" damping="0.02"/>"#,
                -half,
            );
        }
        if reality.compliance_rad_per_nm > 0.0 {
            let stiffness = 1.0 / reality.compliance_rad_per_nm;
            // Plastic that rings off within a few hundredths of a second.
            let damping = 0.01 * stiffness;
            let _ = writeln!(
                self.text,
                r#"{pad}  <joint name="{name}.give" type="hinge" axis="{axis}" stiffness="{stiffness}" armature="0.0005" damping="{damping}"/>"#,
            );
        }
        Ok(())
    }

    /// A rigid link: its mass as described, its shapes.
    fn solid(&mut self, link: &Link, pad: &str) {
        let mass_kg = link.inertia.map_or(0.0, |inertia| inertia.mass_kg).max(LEAST_LINK_KG);
        let center = link.inertia.map_or(Vector3::zeros(), |inertia| inertia.center_m);
        let tensor = link.inertia.map_or(Matrix3::zeros(), |inertia| inertia.tensor_kgm2);
        self.inertia(mass_kg, center, tensor, pad);
        for (i, visual) in link.collisions.iter().enumerate() {
            let (place, shape) = parts::shape_of(visual);
            let name = format!("{}.{i}", link.name);
            self.geom(&name, &place, &shape, ROBOT, pad);
        }
    }

    /// A finger of two parts; the middle joint is kept straight by a spring.
    fn finger(
        &mut self,
        link: &Link,
        finger: &Finger,
        motion: Option<(&Unit<Vector3<f64>>, &plumbline_model::robot::Limits)>,
        pad: &str,
    ) {
        let Some((axis, _)) = motion else { return };
        let rod = |place: &Isometry3<f64>| {
            let inertia = Matrix3::identity() * LEAST_INERTIA_KGM2;
            (place.translation.vector, inertia)
        };
        let (center, tensor) = rod(&finger.near.0);
        self.inertia(LEAST_FINGER_KG, center, tensor, pad);
        let name = &link.name;
        let skin = format!(
            r#"{ROBOT} friction="{} 0.01 0.001" solref="0.01 1""#,
            self.scenario.contact.toy_friction
        );
        self.geom(&format!("{name}.near"), &finger.near.0, &finger.near.1, &skin, pad);
        let bend = 1.45 * finger.closing;
        let range = if bend < 0.0 { [bend, 0.0] } else { [0.0, bend] };
        let gravity = if self.exact() { r#" gravcomp="1""# } else { "" };
        // The spring's rest lies beyond the stop, so that it presses the finger straight.
        let stiffness = 0.02;
        let rest = -finger.closing * STRAIGHTENING_NM / stiffness;
        let _ = writeln!(
            self.text,
            r#"{pad}  <body name="{name}.outer"{gravity} {}>
{pad}    <joint name="{name}.outer" type="hinge" axis="{}" range="{} {}" solreflimit="0.008 1" stiffness="{stiffness}" springref="{rest}" armature="0.00002" damping="0.001"/>"#,
            pose(&parts::at(finger.pivot_m)),
            vector(&axis.into_inner()),
            range[0],
            range[1],
        );
        let (center, tensor) = rod(&finger.far.0);
        let inner = format!("{pad}  ");
        self.inertia(LEAST_FINGER_KG, center, tensor, &inner);
        self.geom(&format!("{name}.tip"), &finger.far.0, &finger.far.1, &skin, &inner);
        let _ = writeln!(self.text, "{pad}  </body>");
    }

    fn inertia(&mut self, mass_kg: f64, center_m: Vector3<f64>, tensor: Matrix3<f64>, pad: &str) {
        // A tensor that has no axes is turned like its part; descriptions are checked when they are read.
        let eigen = decompose::symmetric_eigen(tensor);
        let mut axes = eigen.as_ref().map_or_else(Matrix3::identity, |eigen| eigen.eigenvectors);
        if axes.determinant() < 0.0 {
            axes.column_mut(2).neg_mut();
        }
        let turn = UnitQuaternion::from_matrix(&axes);
        let moments = eigen.map_or_else(Vector3::zeros, |eigen| eigen.eigenvalues);
        let moments = moments.map(|moment| moment.max(LEAST_INERTIA_KGM2));
        let place = Isometry3::from_parts(Translation3::from(center_m), turn);
        let _ = writeln!(
            self.text,
            r#"{pad}  <inertial mass="{mass_kg}" {} diaginertia="{}"/>"#,
            pose(&place),
            vector(&moments)
        );
    }

    fn geom(&mut self, name: &str, place: &Isometry3<f64>, shape: &Shape, more: &str, pad: &str) {
        let form = match shape {
            Shape::Box { half_m } => format!(r#"type="box" size="{}""#, vector(half_m)),
            Shape::Ellipsoid { radii_m } if radii_m.max() - radii_m.min() < 1e-9 => {
                format!(r#"type="sphere" size="{}""#, radii_m.x)
            }
            Shape::Ellipsoid { radii_m } => format!(r#"type="ellipsoid" size="{}""#, vector(radii_m)),
            Shape::Capsule { radius_m, half_length_m } => {
                format!(r#"type="capsule" size="{radius_m} {half_length_m}""#)
            }
            Shape::Cylinder { radius_m, half_length_m } => {
                format!(r#"type="cylinder" size="{radius_m} {half_length_m}""#)
            }
            Shape::Board { .. } | Shape::Mesh { .. } => return,
        };
        let _ = writeln!(self.text, r#"{pad}  <geom name="{name}" {form} {} {more}/>"#, pose(place));
    }

    /// Table, the touchscreen, which may be raised on a block, and the board, which a hand may hold
    /// anywhere.
    fn furniture(&mut self, places: &Places) {
        let [x, y] = places.table_half_m;
        let [u, v] = places.screen_size_m;
        let slab = 0.015;
        let glass = 0.003;
        let friction = self.scenario.contact.glass_friction;
        let _ = write!(
            self.text,
            r#"    <body name="table" {}>
      <geom name="table" type="box" size="{x} {y} {slab}" pos="0 0 -{slab}" {STATIC}/>
    </body>
    <body name="screen" {}>
      <geom name="glass" type="box" size="{} {} {glass}" pos="0 0 {glass}" friction="{friction} 0.002 0.0002" solref="0.008 1" solimp="0.95 0.99 0.0005" priority="1" {STATIC}/>
    </body>
    <body name="board" mocap="true" pos="0 0 -2"/>
"#,
            pose(&places.robot_from_table),
            pose(&places.robot_from_screen),
            0.5 * u,
            0.5 * v,
        );
    }

    fn toys(&mut self) {
        for toy in Toy::ALL {
            let name = toy.name();
            let friction = self.scenario.contact.toy_friction;
            // Soft contacts let a pressed thing creep, about 1.5 mm per second out of a closed hand with the
            // usual 0.96 to 0.99, which dry friction does not. Impedances near one hold it; the solver's "noslip"
            // would too, but it changes how every joint rests.
            let more = format!(
                r#"{TOY} priority="2" condim="6" friction="{friction} 0.008 0.001" solref="0.015 1" solimp="0.999 0.9999 0.002""#
            );
            let _ = writeln!(
                self.text,
                r#"    <body name="toy.{name}" pos="0 0 -1"><freejoint name="toy.{name}"/>"#
            );
            let mass_kg = toy.mass_kg() * self.scenario.contact.toy_mass;
            // A hollow ball of its size.
            let size = self.scenario.contact.toy_size;
            let moment = 2.0 / 3.0 * mass_kg * (size * toy.radius_m()).powi(2);
            let low = if toy == Toy::Duck { -0.006 * size } else { 0.0 };
            self.inertia(mass_kg, Vector3::new(0.0, 0.0, low), Matrix3::identity() * moment, "    ");
            for (i, part) in toy.parts().iter().enumerate() {
                let part = part.of_size(size);
                self.geom(&format!("toy.{name}.{i}"), &part.toy_from_shape, &part.shape, &more, "    ");
            }
            self.text.push_str("    </body>\n");
        }
    }

    /// Motors, one per servo in their order: on the joint, or on the tendon of a finger.
    fn actuators(&mut self) -> Result<(), TwinError> {
        let rig = self.rig;
        let description = &rig.description;
        let mut tendons = String::new();
        let mut motors = String::new();
        for servo in &rig.servos {
            let joint = description.joint(servo.joint);
            let name = &servo.joint_name;
            if let Some(finger) = parts::finger(rig, joint.child) {
                let motor = Motor::of(&servo.model)?;
                let square = servo.ratio * servo.ratio;
                let link = &description.links()[joint.child.0].name;
                let _ = finger;
                let _ = writeln!(
                    tendons,
                    r#"    <fixed name="{name}" armature="{}" damping="{}"><joint joint="{name}" coef="1"/><joint joint="{link}.outer" coef="{OUTER_PULL}"/></fixed>"#,
                    motor.armature_kgm2 * square,
                    motor.damping_nms() * square,
                );
                let _ = writeln!(motors, r#"    <motor name="{name}" tendon="{name}"/>"#);
            } else {
                let _ = writeln!(motors, r#"    <motor name="{name}" joint="{name}"/>"#);
            }
        }
        self.couplings();
        let _ = write!(
            self.text,
            "  <equality>\n{}  </equality>\n  <tendon>\n{tendons}  </tendon>\n  <actuator>\n{motors}  </actuator>\n</mujoco>\n",
            self.tail
        );
        Ok(())
    }

    /// Joints that follow others, with their outer parts.
    fn couplings(&mut self) {
        let description = &self.rig.description;
        for joint in description.joints() {
            let JointKind::Coupled { mimic, .. } = &joint.kind else { continue };
            let source = description.joint(mimic.source);
            let (name, ratio, offset) = (&joint.name, mimic.ratio, mimic.offset_rad);
            let _ = writeln!(
                self.tail,
                r#"    <joint joint1="{name}" joint2="{}" polycoef="{offset} {ratio} 0 0 0"/>"#,
                source.name
            );
            let both = parts::finger(self.rig, joint.child).zip(parts::finger(self.rig, source.child));
            if both.is_some() {
                let link = |index: LinkIndex| &description.links()[index.0].name;
                let _ = writeln!(
                    self.tail,
                    r#"    <joint joint1="{}.outer" joint2="{}.outer" polycoef="0 {ratio} 0 0 0"/>"#,
                    link(joint.child),
                    link(source.child)
                );
            }
        }
    }
}

fn pose(place: &Isometry3<f64>) -> String {
    let q = place.rotation.quaternion();
    format!(r#"pos="{}" quat="{} {} {} {}""#, vector(&place.translation.vector), q.w, q.i, q.j, q.k)
}

fn vector(v: &Vector3<f64>) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

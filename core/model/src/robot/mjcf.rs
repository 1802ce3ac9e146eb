//! Writes a description as MJCF, the format of MuJoCo, for other programs. The twin writes its own world,
//! with motors, contacts and toys.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::description::{Description, Inertia, JointKind, LinkIndex, Shape, Visual};
use crate::decompose;

impl Description {
    /// The robot as MJCF: a body per link, a hinge per joint that turns, with its limits, masses and shapes
    /// as described, an equality per joint that copies another. No motors, no contacts.
    pub fn to_mjcf(&self) -> String {
        let mut writer = Writer { robot: self, text: String::with_capacity(20_000) };
        let _ = write!(
            writer.text,
            r#"<mujoco model="{}">
  <compiler angle="radian" autolimits="true" balanceinertia="true" inertiafromgeom="false" boundmass="1e-6" boundinertia="1e-9"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
"#,
            escaped(&self.name)
        );
        writer.link(LinkIndex(0), 2);
        writer.text.push_str("  </worldbody>\n");
        writer.copies();
        writer.text.push_str("</mujoco>\n");
        writer.text
    }
}

struct Writer<'a> {
    robot: &'a Description,
    text: String,
}

impl Writer<'_> {
    /// A link and all that it carries.
    fn link(&mut self, index: LinkIndex, depth: usize) {
        let robot = self.robot;
        let link = &robot.links[index.0];
        let joint = robot.joint_above(index);
        let place = joint.map_or_else(Isometry3::identity, |joint| joint.parent_from_joint);
        let pad = "  ".repeat(depth);
        let _ = writeln!(self.text, r#"{pad}<body name="{}" {}>"#, escaped(&link.name), pose(&place));
        if let Some((joint, (axis, limits))) = joint.and_then(|joint| Some((joint, joint.motion()?))) {
            let _ = writeln!(
                self.text,
                r#"{pad}  <joint name="{}" type="hinge" axis="{}" range="{} {}"/>"#,
                escaped(&joint.name),
                vector(axis),
                limits.lower_rad,
                limits.upper_rad
            );
        }
        if let Some(inertia) = &link.inertia {
            self.inertia(inertia, &pad);
        }
        // Groups as in MuJoCo's own models: 2 is seen, 3 is run into.
        for (group, shapes) in [(2, &link.visuals), (3, &link.collisions)] {
            shapes.iter().for_each(|visual| self.geom(visual, group, &pad));
        }
        for other in robot.joints.iter().filter(|other| other.parent == index) {
            self.link(other.child, depth + 1);
        }
        let _ = writeln!(self.text, "{pad}</body>");
    }

    fn inertia(&mut self, inertia: &Inertia, pad: &str) {
        let eigen = decompose::symmetric_eigen(inertia.tensor_kgm2);
        // A tensor that has no axes is turned like its link.
        let mut axes = eigen.as_ref().map_or_else(Matrix3::identity, |eigen| eigen.eigenvectors);
        if axes.determinant() < 0.0 {
            axes.column_mut(2).neg_mut();
        }
        let moments = eigen.map_or_else(Vector3::zeros, |eigen| eigen.eigenvalues);
        let turn = UnitQuaternion::from_matrix(&axes);
        let place = Isometry3::from_parts(inertia.center_m.into(), turn);
        let _ = writeln!(
            self.text,
            r#"{pad}  <inertial mass="{}" {} diaginertia="{}"/>"#,
            inertia.mass_kg,
            pose(&place),
            vector(&moments.map(|moment| moment.max(0.0)))
        );
    }

    fn geom(&mut self, visual: &Visual, group: u8, pad: &str) {
        let form = match visual.shape {
            Shape::Box { half_m } => format!(r#"type="box" size="{}""#, vector(&half_m)),
            Shape::Sphere { radius_m } => format!(r#"type="sphere" size="{radius_m}""#),
            Shape::Capsule { radius_m, half_length_m } => {
                format!(r#"type="capsule" size="{radius_m} {half_length_m}""#)
            }
            Shape::Cylinder { radius_m, half_length_m } => {
                format!(r#"type="cylinder" size="{radius_m} {half_length_m}""#)
            }
        };
        let [r, g, b, a] = visual.rgba;
        let place = pose(&visual.link_from_shape);
        let _ =
            writeln!(self.text, r#"{pad}  <geom {form} {place} rgba="{r} {g} {b} {a}" group="{group}"/>"#);
    }

    /// Joints that copy others.
    fn copies(&mut self) {
        let copies = self.robot.joints.iter().filter_map(|joint| match &joint.kind {
            JointKind::Coupled { mimic, .. } => Some((joint, mimic)),
            _ => None,
        });
        let copies: Vec<String> = copies
            .map(|(joint, mimic)| {
                format!(
                    r#"    <joint joint1="{}" joint2="{}" polycoef="{} {} 0 0 0"/>"#,
                    escaped(&joint.name),
                    escaped(&self.robot.joint(mimic.source).name),
                    mimic.offset_rad,
                    mimic.ratio
                )
            })
            .collect();
        if !copies.is_empty() {
            let _ = writeln!(self.text, "  <equality>\n{}\n  </equality>", copies.join("\n"));
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

/// A name as it may stand in an attribute.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

//! The robot of a blind test: the arm of a rig, its nominal kinematics, its nominal screen.

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::pixel::Pixel;
use plumbline_model::robot::servo::TICK_RAD;
use plumbline_model::robot::{Chain, JointKind, LinkIndex, Rig};
use plumbline_model::session::Touchscreen;

use crate::error::BlindError;

/// The rig and the tip that touches.
pub const RIG: &str = "nico";
/// The tip that touches.
pub const TIP: &str = "right_index_tip";
/// The finger that ends in the tip, and the place where a weight is held.
const FINGER: &str = "r_indexfinger";
const PALM: &str = "right_palm_center";

/// A joint of the arm with the link that it carries, as described.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name of the joint.
    pub joint: String,
    /// Name of the link.
    pub link: String,
    /// Place of the link at angle zero in the link before.
    pub place: Isometry3<f64>,
    /// Axis, own frame.
    pub axis: Vector3<f64>,
    /// Bodies fixed to the link (itself among them): place of the center of mass, mass.
    pub masses: Vec<(Vector3<f64>, f64)>,
    /// Smallest step of the encoder, rad of the joint.
    pub tick_rad: f64,
}

/// The arm and its screen as described.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The rig.
    pub rig: Rig,
    /// The chain to the tip.
    pub chain: Chain,
    /// Joints from the base on.
    pub parts: Vec<Part>,
    /// The tip in the last link.
    pub last_from_tip: Isometry3<f64>,
    /// Root of the finger in the last link, m.
    pub knuckle_m: Vector3<f64>,
    /// Where a weight is held, in the last link, m.
    pub palm_m: Vector3<f64>,
}

impl Bench {
    /// The arm of the rig that comes with the program.
    ///
    /// # Errors
    /// When the rig lacks what is needed.
    pub fn usual() -> Result<Self, BlindError> {
        let rig = Rig::built_in(RIG)?;
        let chain = rig.chain(TIP)?;
        let description = rig.description.clone();
        let home = rig.home();
        let poses = description.forward(&home);
        let mut path = vec![];
        let mut link = description.find_link(TIP)?;
        while let Some(joint) = description.joint_above(link) {
            path.push(joint);
            link = joint.parent;
        }
        path.reverse();
        let carriers: Vec<LinkIndex> =
            path.iter().filter(|joint| joint.motion().is_some()).map(|joint| joint.child).collect();
        let mut parts: Vec<Part> = path
            .iter()
            .filter_map(|joint| match &joint.kind {
                JointKind::Revolute { axis, index, .. } => Some(Part {
                    joint: joint.name.clone(),
                    link: description.links()[joint.child.0].name.clone(),
                    place: joint.parent_from_joint,
                    axis: axis.into_inner(),
                    masses: vec![],
                    tick_rad: TICK_RAD / rig.servo_of(*index).map_or(1.0, |servo| servo.ratio),
                }),
                _ => None,
            })
            .collect();
        for (k, link) in description.links().iter().enumerate() {
            let Some(inertia) = link.inertia else { continue };
            let mut at = LinkIndex(k);
            let carrier = loop {
                if let Some(i) = carriers.iter().position(|carrier| *carrier == at) {
                    break Some(i);
                }
                match description.joint_above(at) {
                    Some(joint) => at = joint.parent,
                    None => break None,
                }
            };
            let Some(i) = carrier else { continue };
            let here = poses.of(carriers[i]).isometry.inverse() * poses.of(LinkIndex(k)).isometry;
            parts[i].masses.push(((here * Point3::from(inertia.center_m)).coords, inertia.mass_kg));
        }
        let last = poses.of(carriers[carriers.len() - 1]).isometry.inverse();
        let place = |name: &str| Ok::<_, BlindError>(last * poses.of(description.find_link(name)?).isometry);
        let (tip, finger, palm) = (place(TIP)?, place(FINGER)?, place(PALM)?);
        Ok(Self {
            chain,
            parts,
            last_from_tip: tip,
            knuckle_m: finger.translation.vector,
            palm_m: palm.translation.vector,
            rig,
        })
    }

    /// The screen as the rig file has it.
    pub fn screen(&self) -> &Touchscreen {
        &self.rig.touchscreen
    }

    /// Names of the joints.
    pub fn joints(&self) -> Vec<String> {
        self.parts.iter().map(|part| part.joint.clone()).collect()
    }

    /// Names of the links.
    pub fn links(&self) -> Vec<String> {
        self.parts.iter().map(|part| part.link.clone()).collect()
    }

    /// Axes of the joints, own frames.
    pub fn axes(&self) -> Vec<Vector3<f64>> {
        self.parts.iter().map(|part| part.axis).collect()
    }

    /// Frame of the screen: middle of the image, x along u, y against v, z out of the glass.
    pub fn robot_from_screen(&self) -> Isometry3<f64> {
        let screen = self.screen();
        let (u, n) = (screen.u_axis.vector(), screen.normal().vector());
        let axes = nalgebra::Matrix3::from_columns(&[u, n.cross(&u), n]);
        let middle = screen.point_at(screen.middle()).coords.coords;
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Isometry3::from_parts(Translation3::from(middle), turn)
    }

    /// Where the description puts the tip, in the frame of the nominal screen, m.
    pub fn nominal_tip_m(&self, angles_rad: &[f64]) -> Vector3<f64> {
        let tip = self.chain.robot_from_tip(angles_rad).isometry.translation.vector;
        (self.robot_from_screen().inverse() * Point3::from(tip)).coords
    }

    /// A pixel's place in the frame of the nominal screen, m.
    pub fn on_screen_m(&self, u_px: f64, v_px: f64) -> [f64; 2] {
        let screen = self.screen();
        let (middle, pitch) = (screen.middle(), screen.pitch_m());
        [(u_px - middle.u_px) * pitch[0], -(v_px - middle.v_px) * pitch[1]]
    }

    /// The pixel of a place in the frame of a screen, not rounded.
    pub fn pixel(&self, x_m: f64, y_m: f64) -> Pixel<plumbline_model::session::Screen> {
        let screen = self.screen();
        let (middle, pitch) = (screen.middle(), screen.pitch_m());
        Pixel::new(middle.u_px + x_m / pitch[0], middle.v_px - y_m / pitch[1])
    }
}

//! How the robot is looked at.

use nalgebra::Point3;
use plumbline_model::robot::JointIndex;
use plumbline_widgets::jog_pad::JogSpeed;
use plumbline_widgets::scene3d::SceneCamera;

use crate::operator::GamepadState;

/// How the robot is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct RobotPanels {
    /// From where the scene is seen.
    pub camera: SceneCamera,
    /// What the gamepad says, if there is one.
    pub gamepad: Option<GamepadState>,
    /// How fast a jog is.
    pub jog_speed: JogSpeed,
    /// The joint that the inspector speaks of.
    pub chosen_joint: Option<JointIndex>,
    /// The point of the scene that was clicked, robot frame, m.
    pub chosen_point_m: Option<Point3<f64>>,
    /// Where the last request was made, so that a refusal is shown there.
    pub(crate) asked: Asked,
    /// The pose that is asked about before it is deleted.
    pub(crate) deleting: Option<String>,
    /// The joint that is asked about before it goes limp.
    pub(crate) letting_go: Option<JointIndex>,
}

/// A place where requests are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Asked {
    /// By a shortcut, a script or the palette.
    #[default]
    Elsewhere,
    Scene,
    Joints,
    Jog,
    Poses,
}

//! What is computed live, and how it is looked at.

use plumbline_model::Eye;
use serde::{Deserialize, Serialize};

/// What is computed live.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LiveCommand {
    /// Which products are looked at; nothing else is computed.
    Want(Products),
    /// Measures the point under the mouse on every new pair, until [`LiveCommand::StopProbe`].
    Probe(ProbePoint),
    /// Measures no point.
    StopProbe,
    /// How the virtual pair looks at the workspace.
    Aim(AimChoice),
    /// Where the head looks, which says where the eyes are in the robot's frame.
    Head(HeadPose),
}

/// Live products that somebody looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Products {
    /// The rectified pair.
    pub rectified: bool,
    /// Disparity (computes the rectified pair too).
    pub disparity: bool,
    /// Chessboard corners drawn over both eyes.
    pub corners: bool,
    /// Objects in both eyes.
    #[serde(default)]
    pub detections: bool,
}

/// A point of an image to be measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "image", rename_all = "kebab-case")]
pub enum ProbePoint {
    /// In the raw image of one eye.
    Raw {
        /// Which eye.
        eye: Eye,
        /// Column, pixels.
        u_px: f64,
        /// Row, pixels.
        v_px: f64,
    },
    /// In the rectified image of the left eye.
    Rectified {
        /// Column, pixels.
        u_px: f64,
        /// Row, pixels.
        v_px: f64,
    },
}

/// How the virtual pair is aimed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "aim", rename_all = "kebab-case")]
pub enum AimChoice {
    /// At the table in front of the robot, filling the view.
    #[default]
    Table,
    /// By hand.
    Manual {
        /// Rotation about the baseline; positive looks down, radians.
        pitch_rad: f64,
        /// Width of the field of view, radians.
        horizontal_field_of_view_rad: f64,
    },
}

/// Joint angles of the head.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadPose {
    /// `head_z`, positive looks to the left, radians.
    pub head_z_rad: f64,
    /// `head_y`, positive looks up, radians.
    pub head_y_rad: f64,
}

impl Default for HeadPose {
    /// As it works on the table.
    fn default() -> Self {
        let rig = plumbline_model::robot::default_rig();
        let home = rig.home();
        Self { head_z_rad: home[rig.eyes.pan], head_y_rad: home[rig.eyes.tilt] }
    }
}

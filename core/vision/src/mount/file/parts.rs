//! The keys of the file.

use plumbline_model::{Eye, ModelKind, RejectedPair};
use serde::{Deserialize, Serialize};

use crate::mount::types::{Estimate, MountOptions};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub format: u32,
    pub rig: String,
    pub rms_px: f64,
    pub pixel_sigma_px: f64,
    pub angle_sigma_rad: [f64; 2],
    pub not_seen: Vec<String>,
    pub remarks: Vec<String>,
    /// Rotation vector (rad), then place (m), axes of the head.
    pub covariance: [[f64; 6]; 6],
    pub head_from_left: PosePart,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub head_zeros_rad: Option<[Estimate; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot_from_board: Option<PosePart>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub board_covariance: Option<CovariancePart>,
    #[serde(default)]
    pub rejected: Vec<RejectedPair>,
    pub fit: Vec<FitPart>,
    pub evidence: EvidencePart,
    pub end: EndPart,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CovariancePart {
    pub rows: [[f64; 6]; 6],
}

/// The last section: a file without it was cut off.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EndPart {
    pub complete: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PosePart {
    pub rotation_wxyz: [f64; 4],
    pub translation_m: [f64; 3],
}

/// Eye, corner, measured u and v, measured minus predicted u and v, left out.
pub(super) type ResidualPart = (Eye, usize, f64, f64, f64, f64, bool);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FitPart {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_px: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_px: Option<f64>,
    pub angle_error_rad: [f64; 2],
    pub residuals: Vec<ResidualPart>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EvidencePart {
    pub created: jiff::Timestamp,
    pub software: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minutes_since_on: Option<f64>,
    pub joints: Vec<String>,
    pub options: MountOptions,
    pub nominal_head_from_left: PosePart,
    pub target: TargetPart,
    pub cameras: CamerasPart,
    pub view: Vec<ViewPart>,
}

#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(super) enum TargetPart {
    UnknownBoard { inner_columns: u32, inner_rows: u32, square_m: f64 },
    KnownPoints { points_m: Vec<[f64; 3]> },
    Fingertip { tip: String },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CamerasPart {
    pub left: LensPart,
    pub right: LensPart,
    pub right_from_left: PosePart,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LensPart {
    pub model: ModelKind,
    pub width_px: u32,
    pub height_px: u32,
    /// In the order of the model's parameter names.
    pub parameters: Vec<f64>,
    pub skew_px: f64,
}

/// A pixel (u, v), or nothing where none was measured.
pub(super) type PixelPart = Vec<f64>;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ViewPart {
    pub name: String,
    pub angles_rad: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Vec<PixelPart>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<Vec<PixelPart>>,
}

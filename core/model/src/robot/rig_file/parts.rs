//! The keys of a rig file.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::robot::outlines::OutlinesPart;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) format: u32,
    pub(super) name: String,
    pub(super) title: String,
    pub(super) description: String,
    pub(super) bus: BusPart,
    pub(super) servo: Vec<ServoPart>,
    #[serde(default)]
    pub(super) board: Vec<BoardPart>,
    #[serde(default)]
    pub(super) coupled_limit: Vec<CoupledPart>,
    pub(super) eyes: EyesPart,
    pub(super) table: TablePart,
    pub(super) workspace: WorkspacePart,
    pub(super) touchscreen: ScreenPart,
    pub(super) arm: Vec<ArmPart>,
    #[serde(default)]
    pub(super) pose: Vec<PosePart>,
    #[serde(default)]
    pub(super) outlines: OutlinesPart,
    pub(super) gate: GatePart,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct BusPart {
    pub(super) baud: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct ServoPart {
    pub(in crate::robot) id: u8,
    pub(super) model: String,
    pub(in crate::robot) joint: String,
    pub(in crate::robot) title: String,
    pub(super) direction: DirectionPart,
    pub(super) offset_rad: f64,
    pub(super) ratio: f64,
    pub(super) motor_lower_rad: f64,
    pub(super) motor_upper_rad: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum DirectionPart {
    Direct,
    Indirect,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct BoardPart {
    pub(in crate::robot) id: u8,
    pub(super) model: String,
    pub(in crate::robot) title: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct CoupledPart {
    pub(super) joint: String,
    pub(super) by: String,
    pub(super) why: String,
    pub(super) table_rad: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct EyesPart {
    pub(super) link: String,
    pub(super) pan: String,
    pub(super) tilt: String,
    pub(super) left_position_m: [f64; 3],
    pub(super) left_rotation_rad: [f64; 3],
    pub(super) right_from_left_rotation_rad: [f64; 3],
    pub(super) right_from_left_translation_m: [f64; 3],
    pub(super) left: LensPart,
    pub(super) right: LensPart,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LensPart {
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    pub(super) fx_px: f64,
    pub(super) fy_px: f64,
    pub(super) cx_px: f64,
    pub(super) cy_px: f64,
    pub(super) skew_px: f64,
    pub(super) k: [f64; 4],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct TablePart {
    pub(super) height_m: f64,
    pub(super) x_range_m: [f64; 2],
    pub(super) y_range_m: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct WorkspacePart {
    pub(super) x_range_m: [f64; 2],
    pub(super) y_range_m: [f64; 2],
    pub(super) headroom_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct ScreenPart {
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    pub(super) width_m: f64,
    pub(super) height_m: f64,
    pub(super) origin_m: [f64; 3],
    pub(super) u_axis: [f64; 3],
    pub(super) v_axis: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct ArmPart {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) joints: Vec<String>,
    pub(super) hand: Vec<String>,
    pub(super) tip: Vec<TipPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TipPart {
    pub(super) link: String,
    pub(super) title: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct PosePart {
    pub(in crate::robot) name: String,
    pub(super) title: String,
    pub(super) about: String,
    pub(in crate::robot) joints_rad: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::robot) struct GatePart {
    pub(super) warm_c: f64,
    pub(super) hot_c: f64,
    pub(super) load: f64,
    pub(super) speed_rad_s: f64,
    pub(super) usual_speed_rad_s: f64,
    pub(super) step_rad: f64,
    pub(super) floor_m: f64,
}

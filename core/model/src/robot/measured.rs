//! Rigs of robots that were only measured: a description is enough. What a complete rig file has
//! besides may be missing; stand-ins take its place, and [`Rig::need`] refuses what would use them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Vector3;
use serde::Deserialize;

use super::description::{Description, JointIndex, LinkIndex};
use super::error::RigError;
use super::outlines::Outlines;
use super::rig::{Bus, EyeMount, Gate, Rig, RigPart, TableTop, WorkPatch};
use super::rig_file::{ArmPart, EyesPart, PosePart, Reader, ScreenPart, TablePart, WorkspacePart};
use crate::camera::{Camera, CameraModel, Fisheye};
use crate::files::{self, Size, told};
use crate::formats::depth;
use crate::frame::{Direction, Point, Pose};
use crate::session::{CalibratedAt, Touchscreen};
use crate::stereo::StereoCameras;

/// What tells a complete rig file, which is read strictly, from one of a robot that was only
/// measured.
const OF_COMPLETE_RIGS: [&str; 5] = ["bus", "servo", "eyes", "touchscreen", "gate"];
/// Keys under which files name the description.
const DESCRIPTION_KEYS: [&str; 6] = ["description", "urdf", "urdf_file", "description_file", "model", "file"];
/// Endings of descriptions.
const DESCRIPTION_ENDINGS: [&str; 2] = [".urdf", ".xml"];

/// The parts of a file that are understood; all others are passed over.
#[derive(Deserialize, Default)]
struct Parts {
    eyes: Option<EyesPart>,
    table: Option<TablePart>,
    workspace: Option<WorkspacePart>,
    touchscreen: Option<ScreenPart>,
    #[serde(default)]
    arm: Vec<ArmPart>,
    #[serde(default)]
    pose: Vec<PosePart>,
}

impl Rig {
    /// Reads the rig of a session for its measurements: a complete rig file strictly, as
    /// [`Rig::read`]; else a rig file of which only the description must be there, or a bare
    /// description (`.urdf`). [`Rig::lacking`] names what is missing.
    ///
    /// # Errors
    /// When neither can be read, or the description cannot be used.
    pub fn read_measured(file: &Path) -> Result<Self, RigError> {
        let text = read(file)?;
        if text.trim_start().starts_with('<') {
            return bare(file, &text, toml::Table::new());
        }
        let shown = file.display().to_string();
        depth::check(depth::of_toml(&text))
            .map_err(|reason| RigError::NotRig { file: shown.clone(), reason })?;
        let table: toml::Table = toml::from_str(&text)
            .map_err(|error| RigError::NotRig { file: shown.clone(), reason: told(&error.to_string()) })?;
        if OF_COMPLETE_RIGS.iter().all(|key| table.contains_key(*key)) {
            return Self::read(file);
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        let urdf = match named_description(&table) {
            Some(inline) if inline.trim_start().starts_with('<') => inline,
            Some(name) => read(&folder.join(name))?,
            None => read(&single_description(folder).ok_or(RigError::NoDescription { file: shown })?)?,
        };
        bare(file, &urdf, table)
    }
}

fn read(file: &Path) -> Result<String, RigError> {
    Ok(files::read_text(file, Size::TEXT)?)
}

/// The description that a file names, under a usual key or in a section of its own.
fn named_description(table: &toml::Table) -> Option<String> {
    let known = DESCRIPTION_KEYS.iter().find_map(|key| table.get(*key)?.as_str());
    let is_description = |text: &&str| {
        DESCRIPTION_ENDINGS.iter().any(|end| text.ends_with(end)) || text.trim_start().starts_with('<')
    };
    let any = || table.values().filter_map(toml::Value::as_str).find(is_description);
    let deeper = || table.values().filter_map(toml::Value::as_table).find_map(named_description);
    known.filter(is_description).or_else(any).map(str::to_owned).or_else(deeper)
}

/// The only `.urdf` file of a folder.
fn single_description(folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let files = std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found = files.filter(|path| path.extension().is_some_and(|end| end == "urdf"));
    let first = found.next()?;
    found.next().is_none().then_some(first)
}

fn bare(file: &Path, urdf: &str, table: toml::Table) -> Result<Rig, RigError> {
    let shown = file.display().to_string();
    let (robot, unlimited) = Description::from_urdf_measured(urdf)
        .map_err(|error| RigError::Description { file: shown.clone(), error: Box::new(error) })?;
    let text = |key: &str| table.get(key).and_then(toml::Value::as_str).map(str::to_owned);
    let name = text("name").unwrap_or_else(|| robot.name().to_owned());
    let title = text("title").unwrap_or_else(|| name.clone());
    let parts: Parts = table.try_into().map_err(|error: toml::de::Error| RigError::NotRig {
        file: shown.clone(),
        reason: told(&error.to_string()),
    })?;
    let reader = Reader { file: &shown, robot: &robot };
    let mut lacking = vec![RigPart::Servos, RigPart::Gate];
    let mut lack = |part, missing: bool| {
        if missing {
            lacking.push(part);
        }
    };
    lack(RigPart::Eyes, parts.eyes.is_none());
    lack(RigPart::Table, parts.table.is_none() || parts.workspace.is_none());
    lack(RigPart::Touchscreen, parts.touchscreen.is_none());
    lack(RigPart::Arms, parts.arm.is_empty());
    lack(RigPart::Limits, unlimited);
    lack(RigPart::Masses, robot.links().iter().all(|link| link.inertia.is_none()));
    lacking.sort();
    let given = |range: Option<Result<TableTop, RigError>>| range.unwrap_or(Ok(NO_TABLE));
    Ok(Rig {
        description: Arc::new(robot.clone()),
        bus: Bus { baud: 0 },
        servos: vec![],
        boards: vec![],
        coupled_limits: vec![],
        eyes: parts.eyes.as_ref().map_or_else(|| Ok(no_eyes()), |part| reader.eyes(part))?,
        table: given(parts.table.as_ref().map(|part| reader.table(part)))?,
        work_patch: parts.workspace.as_ref().map_or(Ok(NO_PATCH), |part| reader.work_patch(part))?,
        touchscreen: parts
            .touchscreen
            .as_ref()
            .map_or_else(|| Ok(no_screen()), |part| reader.screen(part))?,
        arms: parts.arm.iter().map(|part| reader.arm(part)).collect::<Result<_, _>>()?,
        poses: parts.pose.iter().map(|part| reader.pose(part)).collect::<Result<_, _>>()?,
        outlines: Outlines::default(),
        gate: NOTHING_MOVES,
        name,
        title,
        lacking,
    })
}

/// No area at all.
const NO_TABLE: TableTop = TableTop { height_m: 0.0, x_range_m: [0.0; 2], y_range_m: [0.0; 2] };
const NO_PATCH: WorkPatch = WorkPatch { x_range_m: [0.0; 2], y_range_m: [0.0; 2], headroom_m: 0.0 };
/// Every servo is too hot, every step too large.
const NOTHING_MOVES: Gate = Gate {
    warm_c: f64::NEG_INFINITY,
    hot_c: f64::NEG_INFINITY,
    load: 0.0,
    speed_rad_s: 0.0,
    usual_speed_rad_s: 0.0,
    step_rad: 0.0,
    floor_m: f64::INFINITY,
};

/// Eyes at the base whose image has one pixel.
fn no_eyes() -> EyeMount {
    let lens = Fisheye { fx_px: 1.0, fy_px: 1.0, cx_px: 0.0, cy_px: 0.0, skew_px: 0.0, k: [0.0; 4] };
    let camera = Camera { model: CameraModel::Fisheye(lens), width_px: 1, height_px: 1 };
    EyeMount {
        link: LinkIndex(0),
        pan: JointIndex(0),
        tilt: JointIndex(0),
        head_from_left: EyeMount::pose(Vector3::zeros(), Vector3::zeros()),
        cameras: StereoCameras {
            left: camera,
            right: camera,
            right_from_left: Pose::from_rotation_vector(Vector3::zeros(), Vector3::zeros()),
        },
        calibrated_at: CalibratedAt::default(),
    }
}

/// A screen of no size.
fn no_screen() -> Touchscreen {
    let axis = |vector: Vector3<f64>| Direction::new(vector).expect("unit vectors have a direction");
    Touchscreen {
        width_px: 0,
        height_px: 0,
        width_m: 0.0,
        height_m: 0.0,
        origin: Point::new(0.0, 0.0, 0.0),
        u_axis: axis(Vector3::x()),
        v_axis: axis(Vector3::y()),
    }
}

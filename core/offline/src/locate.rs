//! `plumbline locate`: where in space points of the raw left image are.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_engine::ground::text::sentence;
use plumbline_engine::rig_models::{Accepted, mounted};
use plumbline_hardware::load_image;
use plumbline_model::robot::{Posture, RigPart};
use plumbline_model::{JobContext, Pixel, Raw, StereoCameras};
use plumbline_vision::calibration_file;
use plumbline_vision::locate::{Located, Locator};
use plumbline_vision::mount::MountCalibration;
use serde::Serialize;

use super::OfflineError;
use super::ik::find_rig;
use super::pairs::check_sizes;
use super::session::ModelFile;
use super::table::Table;

/// What to locate.
#[derive(Clone, Debug)]
pub struct LocateArgs {
    /// Calibration file in any known format; two files for ROS, left eye first.
    pub cameras: Vec<PathBuf>,
    /// Left image.
    pub left: PathBuf,
    /// Right image.
    pub right: PathBuf,
    /// Table with the columns `u_px`, `v_px`: pixels of the raw left image.
    pub points: PathBuf,
    /// The robot whose eyes they are, for places in its frame.
    pub robot: Option<LocateRobot>,
}

/// The robot whose eyes took the images.
#[derive(Clone, Debug)]
pub struct LocateRobot {
    /// Name of a rig that comes with the program, or the path of a rig file.
    pub rig: String,
    /// A model with effects, or a rig file that takes the place of `rig`.
    pub rig_model: PathBuf,
    /// A calibrated mount of the eyes; `None`: nominal.
    pub mount: Option<PathBuf>,
    /// Angles of the head (pan, positive to the left; tilt, positive up; rad); `None`: as in the rig's
    /// home pose.
    pub head_rad: [Option<f64>; 2],
}

/// Where the points are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocateReport {
    /// In the order of the table.
    pub points: Vec<LocatedPoint>,
    /// What was noticed about the images.
    pub notes: Vec<String>,
    /// The model of the robot that places in its frame rest on: "as described", "with 2 effects".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Its effects, as `id@site`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<String>,
}

/// One point. What is not known is null, and `reason` says why.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LocatedPoint {
    /// Column in the raw left image.
    pub u_px: f64,
    /// Row in the raw left image.
    pub v_px: f64,
    /// In the left camera's frame.
    pub x_m: Option<f64>,
    /// In the left camera's frame.
    pub y_m: Option<f64>,
    /// In the left camera's frame.
    pub z_m: Option<f64>,
    /// One standard deviation along the worst direction.
    pub sigma_m: Option<f64>,
    /// Column of the match in the raw right image.
    pub match_u_px: Option<f64>,
    /// Row of the match in the raw right image.
    pub match_v_px: Option<f64>,
    /// Why the point was not found.
    pub reason: Option<String>,
    /// Where it is in the robot's frame; only where a model of the robot was given.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub robot: Option<PointInRobot>,
}

/// A point in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PointInRobot {
    /// Forward.
    pub robot_x_m: f64,
    /// To the left.
    pub robot_y_m: f64,
    /// Up.
    pub robot_z_m: f64,
    /// One standard deviation along the worst direction, with that of the model's effects.
    pub robot_sigma_m: f64,
}

/// Locates every point of the table.
pub fn locate(args: &LocateArgs, context: &dyn JobContext) -> Result<LocateReport, OfflineError> {
    let calibration = calibration_file::load(&args.cameras)?;
    let pixels = read_points(&args.points)?;
    let mut notes = Vec::new();
    let left = read_image(&args.left, &mut notes)?;
    let right = read_image(&args.right, &mut notes)?;
    check_sizes(&calibration.cameras, [left.dimensions(), right.dimensions()])?;
    let robot = args.robot.as_ref().map(|robot| known(robot, &calibration.cameras)).transpose()?;
    let locator = Locator::new(&calibration)?;
    context.checkpoint()?;
    context.report(0.1, "locating");
    let gray = |image: &RgbImage| image::imageops::grayscale(image);
    let located = locator.locate(&gray(&left), &gray(&right), &pixels);
    let points = pixels.iter().zip(located).map(|(pixel, located)| {
        let asked = LocatedPoint { u_px: pixel.u_px, v_px: pixel.v_px, ..LocatedPoint::default() };
        match located {
            Ok(found) => LocatedPoint {
                x_m: Some(found.point.coords.x),
                y_m: Some(found.point.coords.y),
                z_m: Some(found.point.coords.z),
                sigma_m: Some(found.sigma_m),
                match_u_px: Some(found.match_in_right.u_px),
                match_v_px: Some(found.match_in_right.v_px),
                robot: robot.as_ref().and_then(|robot| in_robot(robot, &found)),
                ..asked
            },
            Err(reason) => LocatedPoint { reason: Some(sentence(&reason.to_string())), ..asked },
        }
    });
    let points = points.collect();
    let model = robot.as_ref().map(|(model, _)| model.title());
    let effects = robot.iter().flat_map(|(model, _)| model.added().effects().iter().map(ModelEffect::name));
    Ok(LocateReport { points, notes, model, effects: effects.collect() })
}

/// The robot as it is known, with these eyes, and how it stands.
fn known(args: &LocateRobot, cameras: &StereoCameras) -> Result<(RobotModel, Posture), OfflineError> {
    let mut rig = find_rig(&args.rig)?;
    let effects = match ModelFile::read(&args.rig_model, &rig)? {
        ModelFile::Effects(effects) => Some(Arc::new(*effects)),
        ModelFile::Rig(other) => {
            rig = *other;
            None
        }
        ModelFile::Placement(placement) => {
            rig.touchscreen = placement.screen;
            None
        }
    };
    rig.need(RigPart::Eyes)?;
    let mount = args.mount.as_ref().map(|file| MountCalibration::read(file, &rig)).transpose()?;
    let accepted = Accepted {
        cameras: Some(cameras),
        head_from_left: mount.as_ref().map(|mount| mount.head_from_left),
        mounted: mount.as_ref().map(mounted),
        screen: None,
        effects: effects.as_ref(),
    };
    let model = accepted.robot_model(&rig)?;
    let mut posture = rig.home();
    for (joint, angle_rad) in [rig.eyes.pan, rig.eyes.tilt].into_iter().zip(args.head_rad) {
        posture[joint] = angle_rad.unwrap_or(posture[joint]);
    }
    Ok((model, posture))
}

fn in_robot((model, posture): &(RobotModel, Posture), found: &Located) -> Option<PointInRobot> {
    let place = model.place(&found.point, &found.covariance_m2, posture, &SeenUnder::default())?;
    let at = place.point.coords;
    Some(PointInRobot { robot_x_m: at.x, robot_y_m: at.y, robot_z_m: at.z, robot_sigma_m: place.sigma_m() })
}

/// Reads an image and keeps what was noticed about it.
pub(super) fn read_image(path: &Path, notes: &mut Vec<String>) -> Result<RgbImage, OfflineError> {
    let loaded = load_image(path)?;
    notes.extend(loaded.notes.iter().map(|note| format!("{}: {note}.", path.display())));
    Ok(loaded.image)
}

/// Reads pixels from a table with the header `u_px,v_px`; other columns are ignored.
fn read_points(file: &Path) -> Result<Vec<Pixel<Raw>>, OfflineError> {
    let needs = "the header u_px,v_px and one pixel of the raw left image per line, for example 321.5,240";
    let table = Table::read(file, &["u_px", "v_px"], &[], needs)?;
    Ok(table.rows().iter().map(|row| Pixel::new(row[0], row[1])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Pixel<Raw>>, String> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("points.csv");
        std::fs::write(&file, text).expect("written");
        read_points(&file).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_are_found_by_name() {
        let pixels = read("\u{feff}name,v_px,u_px\r\na,2.5,1\r\n\r\nb,4,3e2\r\n");
        assert_eq!(pixels, Ok(vec![Pixel::new(1.0, 2.5), Pixel::new(300.0, 4.0)]));
        assert_eq!(read("u_px,v_px\n"), Ok(Vec::new()));
    }

    #[test]
    fn a_bad_table_is_refused_with_its_line() {
        for (text, said) in [
            ("", "is empty"),
            ("u,v\n1,2\n", "no column u_px"),
            ("u_px,v_px\n1,2\n3\n", "line 3: 1 cells instead of 2"),
            ("u_px,v_px\n1,two\n", "line 2: \"two\" in column v_px"),
            ("u_px,v_px\n1,NaN\n", "line 2"),
        ] {
            let message = read(text).expect_err("bad");
            assert!(message.contains(said) && message.contains("for example"), "{message}");
        }
    }
}

//! `plumbline locate`: where in space points of the raw left image are.

mod known;

use std::path::{Path, PathBuf};

use image::RgbImage;
use plumbline_engine::ground::text::sentence;
use plumbline_hardware::load_image;
use plumbline_model::{JobContext, Pixel, Raw};
use plumbline_vision::calibration_file;
use plumbline_vision::locate::{Located, Locator};
use serde::Serialize;

use self::known::{EYES_UNTOLD, Known};
use super::OfflineError;
use super::pairs::check_sizes;
use super::table::Table;

/// Why a point that was found has no place in the robot's frame.
const NO_PLACE: &str = "With the effects of the model there is no place that the eyes would see so: ask for another \
                        point, or look at the model.";

/// What to locate.
#[derive(Clone, Debug)]
pub struct LocateArgs {
    /// Whose eyes took the images.
    pub eyes: LocateEyes,
    /// Left image.
    pub left: PathBuf,
    /// Right image.
    pub right: PathBuf,
    /// Table with the columns `u_px`, `v_px`: pixels of the raw left image.
    pub points: PathBuf,
}

/// Whose eyes took the images.
#[derive(Clone, Debug)]
pub enum LocateEyes {
    /// Eyes of which there is a calibration.
    Calibrated {
        /// Calibration file in any known format; two files for ROS, left eye first.
        cameras: Vec<PathBuf>,
        /// The robot that they sit on, for places in its frame.
        robot: Option<LocateRobot>,
    },
    /// Those of a commissioned lab: calibration, mount and effects are those that were accepted there.
    OfLab {
        /// Its folder.
        lab: PathBuf,
        /// How the robot stood.
        stood: Stood,
    },
}

/// The robot whose eyes took the images, from files.
#[derive(Clone, Debug)]
pub struct LocateRobot {
    /// Name of a rig that comes with the program, or the path of a rig file.
    pub rig: String,
    /// A model with effects, or a rig file that takes the place of `rig`.
    pub rig_model: PathBuf,
    /// A calibrated mount of the eyes; `None`: nominal.
    pub mount: Option<PathBuf>,
    /// How it stood.
    pub stood: Stood,
}

/// How the robot stood when the images were taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stood {
    /// Angles of the head (pan, positive to the left; tilt, positive up; rad); `None`: as in the rig's
    /// home pose, from which a commissioning looks at the table.
    pub head_rad: [Option<f64>; 2],
    /// For how long the eyes had been on, s; `None`: what moves as they warm up takes no effect.
    pub eyes_on_s: Option<f64>,
}

/// Where the points are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocateReport {
    /// In the order of the table.
    pub points: Vec<LocatedPoint>,
    /// What was noticed about the images, and why places are stated with a wide uncertainty, or what
    /// it leaves out.
    pub notes: Vec<String>,
    /// The model of the robot that places in its frame rest on: "as described", "with 2 effects".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Its effects, as `id@site`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<String>,
    /// Angle of the head to the side that these places rest on, positive to the left.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub head_z_rad: Option<f64>,
    /// Angle of the head up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub head_y_rad: Option<f64>,
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
    /// Why the point was not found, or has no place in the robot's frame.
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
    /// One standard deviation along the worst direction, with those of the mount (or how far mounts usually are off,
    /// where none was given) and of the model's effects.
    pub robot_sigma_m: f64,
}

/// Locates every point of the table.
///
/// # Errors
/// When the eyes or the robot are not known, or images and points cannot be read.
pub fn locate(args: &LocateArgs, context: &dyn JobContext) -> Result<LocateReport, OfflineError> {
    let (calibration, robot) = match &args.eyes {
        LocateEyes::Calibrated { cameras, robot } => {
            let calibration = calibration_file::load(cameras)?;
            let known = |robot| Known::of_files(robot, &calibration);
            let robot = robot.as_ref().map(known).transpose()?;
            (calibration, robot)
        }
        LocateEyes::OfLab { lab, stood } => {
            let (calibration, robot) = Known::of_lab(lab, stood)?;
            (calibration, Some(robot))
        }
    };
    let pixels = read_points(&args.points)?;
    let mut notes = Vec::new();
    let left = read_image(&args.left, &mut notes)?;
    let right = read_image(&args.right, &mut notes)?;
    check_sizes(&calibration.cameras, [left.dimensions(), right.dimensions()])?;
    let locator = Locator::new(&calibration)?;
    context.checkpoint()?;
    context.report(0.1, "locating");
    let gray = |image: &RgbImage| image::imageops::grayscale(image);
    let located = locator.locate(&gray(&left), &gray(&right), &pixels);
    let points = pixels.iter().zip(located).map(|(pixel, located)| {
        let asked = LocatedPoint { u_px: pixel.u_px, v_px: pixel.v_px, ..LocatedPoint::default() };
        match located {
            Ok(found) => in_robot(robot.as_ref(), &found, asked),
            Err(reason) => LocatedPoint { reason: Some(sentence(&reason.to_string())), ..asked },
        }
    });
    let points = points.collect();
    notes.extend(robot.as_ref().and_then(Known::wide_because).map(str::to_owned));
    if calibration.covariance.is_none() {
        notes.push(EYES_UNTOLD.to_owned());
    }
    let head_rad = robot.as_ref().map(Known::head_rad);
    Ok(LocateReport {
        points,
        notes,
        model: robot.as_ref().map(Known::title),
        effects: robot.as_ref().map(Known::effects).unwrap_or_default(),
        head_z_rad: head_rad.map(|[pan_rad, _]| pan_rad),
        head_y_rad: head_rad.map(|[_, tilt_rad]| tilt_rad),
    })
}

/// A point that was found, with its place in the frame of the robot where one is known.
fn in_robot(robot: Option<&Known>, found: &Located, asked: LocatedPoint) -> LocatedPoint {
    let in_left = found.point.coords;
    let place = robot.map(|robot| robot.place(found));
    LocatedPoint {
        x_m: Some(in_left.x),
        y_m: Some(in_left.y),
        z_m: Some(in_left.z),
        sigma_m: Some(found.sigma_m),
        match_u_px: Some(found.match_in_right.u_px),
        match_v_px: Some(found.match_in_right.v_px),
        reason: matches!(place, Some(None)).then(|| NO_PLACE.to_owned()),
        robot: place.flatten().map(|place| PointInRobot {
            robot_x_m: place.point.coords.x,
            robot_y_m: place.point.coords.y,
            robot_z_m: place.point.coords.z,
            robot_sigma_m: place.sigma_m(),
        }),
        ..asked
    }
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

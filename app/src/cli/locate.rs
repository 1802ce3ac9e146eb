//! `plumbline locate`: where in space points of the left image are.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::{
    self as offline, LocateArgs, LocateEyes, LocateReport, LocateRobot, LocatedPoint, Stood,
};
use plumbline_widgets::format;

use super::calibrate::say_notes;
use super::common::{finite, not_negative};
use super::output::Output;

/// Arguments of `locate`.
#[derive(Debug, Args)]
pub struct Locate {
    /// Stereo calibration: a file of this program, OpenCV or Kalibr, or the two files of ROS camera_info,
    /// left eye first.
    #[arg(
        long,
        value_name = "FILE",
        num_args = 1..=2,
        required_unless_present = "lab",
        conflicts_with = "lab"
    )]
    cameras: Vec<PathBuf>,
    /// Commissioned lab (see plumbline commission): its eyes took the images, and places in the robot's frame
    /// are added, by the calibration, the mount and the effects that were accepted there.
    #[arg(long, value_name = "FOLDER", group = "robot")]
    lab: Option<PathBuf>,
    /// Raw image of the left eye.
    #[arg(long, value_name = "IMAGE")]
    left: PathBuf,
    /// Raw image of the right eye, of the same moment.
    #[arg(long, value_name = "IMAGE")]
    right: PathBuf,
    /// Table with the columns u_px and v_px: pixels of the raw left image, (0, 0) at the center
    /// of the top-left pixel.
    #[arg(long, value_name = "CSV")]
    points: PathBuf,
    /// Model with effects (rig-model.toml, as gap --add writes it) or a rig file: places in the robot's
    /// frame are added, by the robot as this model knows it.
    #[arg(long, value_name = "FILE", group = "robot")]
    rig_model: Option<PathBuf>,
    /// Robot that the model is of: the name of one that comes with the program (nico), or a rig file.
    #[arg(long, value_name = "NAME|FILE", default_value = "nico", requires = "rig_model")]
    rig: String,
    /// Calibrated mount of the eyes (mount.toml); nominal without it.
    #[arg(long, value_name = "FILE", requires = "rig_model")]
    mount: Option<PathBuf>,
    /// Angle of the head to the side when the images were taken, rad, positive to the left; that of the
    /// home pose without it.
    #[arg(long, value_name = "RAD", requires = "robot", allow_negative_numbers = true, value_parser = finite)]
    head_z_rad: Option<f64>,
    /// Angle of the head up, rad; that of the home pose without it.
    #[arg(long, value_name = "RAD", requires = "robot", allow_negative_numbers = true, value_parser = finite)]
    head_y_rad: Option<f64>,
    /// For how long the eyes had been on, s; without it, what moves as they warm up takes no effect.
    #[arg(
        long,
        value_name = "S",
        requires = "robot",
        allow_negative_numbers = true,
        value_parser = not_negative
    )]
    eyes_on_s: Option<f64>,
}

/// Locates every point of the table.
pub fn run(arguments: Locate, output: &Output) -> anyhow::Result<()> {
    let Locate {
        cameras,
        lab,
        left,
        right,
        points,
        rig_model,
        rig,
        mount,
        head_z_rad,
        head_y_rad,
        eyes_on_s,
    } = arguments;
    let stood = Stood { head_rad: [head_z_rad, head_y_rad], eyes_on_s };
    let eyes = match lab {
        Some(lab) => LocateEyes::OfLab { lab, stood },
        None => {
            let robot = rig_model.map(|rig_model| LocateRobot { rig, rig_model, mount, stood });
            LocateEyes::Calibrated { cameras, robot }
        }
    };
    let args = LocateArgs { eyes, left, right, points };
    let report = offline::locate(&args, output)?;
    say_notes(&report.notes);
    output.result(&report, text)
}

fn text(report: &LocateReport) -> String {
    let found = report.points.iter().filter(|point| point.x_m.is_some()).count();
    let mut text = format!(
        "{found} of {} located, in the left camera's frame\n",
        format::count(report.points.len(), "point")
    );
    if let Some(model) = &report.model {
        let named = if report.effects.is_empty() {
            String::new()
        } else {
            format!(": {}", report.effects.join(", "))
        };
        text.push_str(&format!("  in the robot's frame by the robot {model}{named}\n"));
    }
    if let (Some(pan_rad), Some(tilt_rad)) = (report.head_z_rad, report.head_y_rad) {
        text.push_str(&format!("  with the head at {pan_rad:.3} rad to the side, {tilt_rad:.3} rad up\n"));
    }
    for point in &report.points {
        text.push_str(&line(point));
    }
    text
}

fn line(point: &LocatedPoint) -> String {
    let at = format::pixel_position([point.u_px, point.v_px]);
    match (point.x_m, point.y_m, point.z_m, point.sigma_m) {
        (Some(x), Some(y), Some(z), Some(sigma)) => {
            let robot = point.robot.map_or_else(String::new, |robot| {
                let place = format::position_mm([robot.robot_x_m, robot.robot_y_m, robot.robot_z_m]);
                format!("  robot {place} ± {}", format::mm_known_to(robot.robot_sigma_m))
            });
            let place = format!("{} ± {}{robot}", format::position_mm([x, y, z]), format::mm_known_to(sigma));
            let why = point.reason.as_deref().map_or_else(String::new, |why| format!("  {why}"));
            format!("  {at}  {place}{why}\n")
        }
        _ => format!("  {at}  {}\n", point.reason.as_deref().unwrap_or("not found")),
    }
}

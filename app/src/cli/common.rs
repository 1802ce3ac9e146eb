//! Arguments that several verbs share.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plumbline_model::{InnerCorners, ModelKind};

/// The folders of pairs and the board in them.
#[derive(Debug, Args)]
pub struct BoardPairs {
    /// Folder of the left eye's images.
    #[arg(long, value_name = "DIR")]
    pub left: PathBuf,
    /// Folder of the right eye's images; the same file name is one pair.
    #[arg(long, value_name = "DIR")]
    pub right: PathBuf,
    /// Inner corners of the board, columns x rows: 8x5 for 9x6 squares.
    #[arg(long, value_name = "COLUMNSxROWS")]
    pub board: InnerCorners,
    /// Side of one square, millimeters.
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub square_mm: f64,
    /// Pairs to leave out, by file name; may be given more than once.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub exclude: Vec<PathBuf>,
}

/// A stereo calibration.
#[derive(Debug, Args)]
pub struct Cameras {
    /// Stereo calibration: a file of this program, OpenCV or Kalibr, or the two files of ROS
    /// camera_info, left eye first.
    #[arg(long, value_name = "FILE", num_args = 1..=2, required = true)]
    pub cameras: Vec<PathBuf>,
}

/// Lens model of both eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Lens {
    /// Equidistant with four coefficients, for fisheye lenses.
    #[default]
    Fisheye,
    /// Perspective with five distortion coefficients.
    Pinhole,
}

impl From<Lens> for ModelKind {
    fn from(lens: Lens) -> Self {
        match lens {
            Lens::Fisheye => Self::Fisheye,
            Lens::Pinhole => Self::Pinhole,
        }
    }
}

/// A positive, finite number.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        Ok(_) => Err("must be greater than 0".to_owned()),
        Err(_) => Err("is not a number".to_owned()),
    }
}

/// A finite number that is not below zero.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number < 0.0 => Err("must not be less than 0".to_owned()),
        number => Ok(number),
    }
}

/// A number that is one.
pub fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| "is not a number".to_owned())
}

/// Lines under a heading, or nothing.
pub fn listed(heading: &str, lines: impl IntoIterator<Item = String>) -> String {
    let lines: Vec<String> = lines.into_iter().map(|line| format!("  {line}\n")).collect();
    if lines.is_empty() { String::new() } else { format!("{heading}\n{}", lines.concat()) }
}

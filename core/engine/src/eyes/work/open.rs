//! Reads a calibration as a proposal: from a file, or one that was accepted earlier.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::formats::{LengthUnit, ReadOptions};
use plumbline_model::{JobContext, StereoCalibration, Workspace};
use plumbline_vision::calibration_file;

use crate::eyes::assess::{Assessment, assess};
use crate::eyes::command::FileLength;
use crate::eyes::store::Store;
use crate::eyes::view::Origin;
use crate::ground::jobs::JobError;

/// What is read.
#[derive(Clone, Debug)]
pub enum OpenWhat {
    /// A calibration file (or two, for ROS).
    Files {
        /// The files, left eye first.
        files: Vec<PathBuf>,
        /// Unit of lengths in them.
        length: FileLength,
    },
    /// One that was accepted earlier.
    Earlier {
        /// Its id.
        id: String,
    },
}

/// Read a calibration as a proposal.
#[derive(Clone, Debug)]
pub struct Open {
    /// What.
    pub what: OpenWhat,
    /// Where accepted ones are kept.
    pub store: Store,
    /// For comparison.
    pub in_use: Option<Arc<StereoCalibration>>,
    /// Where the eyes are over the table.
    pub workspace: Workspace,
}

/// A calibration that was read.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The calibration.
    pub calibration: Arc<StereoCalibration>,
    /// Where it comes from.
    pub origin: Origin,
    /// What it means on the table.
    pub assessment: Assessment,
}

impl Open {
    /// What it does, for people.
    pub fn title(&self) -> String {
        match &self.what {
            OpenWhat::Files { files, .. } => format!("Read {}", name(files)),
            OpenWhat::Earlier { id } => format!("Read calibration {id}"),
        }
    }

    /// Reads it and looks at it from all sides.
    pub fn run(self, context: &dyn JobContext) -> Result<Opened, JobError> {
        let (calibration, origin) = match &self.what {
            OpenWhat::Files { files, length } => {
                let length_unit = match *length {
                    FileLength::AsPrescribed => None,
                    FileLength::Meters => Some(LengthUnit::Meters),
                    FileLength::Millimeters => Some(LengthUnit::Millimeters),
                    FileLength::Squares { side_m } => Some(LengthUnit::Squares { side_m }),
                };
                let options = ReadOptions { length_unit, ..ReadOptions::default() };
                let calibration = calibration_file::load_with(files, &options).map_err(JobError::failed)?;
                (calibration, Origin::Imported { file: name(files) })
            }
            OpenWhat::Earlier { id } => {
                let (calibration, accepted) = self.store.load(id).map_err(JobError::failed)?;
                (calibration, Origin::Earlier { accepted })
            }
        };
        context.report(0.5, "looking what it means on the table");
        let assessment = assess(&calibration, self.in_use.as_deref(), &self.workspace, context)?;
        Ok(Opened { calibration: Arc::new(calibration), origin, assessment })
    }
}

impl Opened {
    /// What was read, for people.
    pub fn what(&self) -> String {
        match &self.origin {
            Origin::Imported { file } => file.clone(),
            Origin::Earlier { accepted } => format!("the calibration of {accepted}"),
            Origin::Solved => "the calibration".to_owned(),
        }
    }
}

fn name(files: &[PathBuf]) -> String {
    let names: Vec<String> = files
        .iter()
        .map(|file| file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned())
        .collect();
    names.join(" and ")
}

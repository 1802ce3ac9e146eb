//! Commands of calibrating the eyes.

use std::path::PathBuf;

use plumbline_model::CalibrationOptions;
use serde::{Deserialize, Serialize};

/// Calibrating the eyes, in the order of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EyesCommand {
    /// Says which board is used, counted in squares.
    ChooseBoard {
        /// Squares along a row.
        columns: u32,
        /// Squares along a column.
        rows: u32,
        /// Side of a square, meters.
        square_m: f64,
    },
    /// Looks at the newest pair and says which board it shows.
    RecognizeBoard,
    /// How to solve.
    ChooseOptions(CalibrationOptions),
    /// Minutes since the cameras were switched on, as the operator knows it.
    MinutesSinceOn(Option<f64>),
    /// Adds the newest pair.
    Capture,
    /// Captures by itself whenever the board is still, sharp, seen by both eyes and somewhere new.
    AutoCapture(bool),
    /// Collects every pair of the open recording in which the board is seen.
    CollectRecording,
    /// Removes the pair that was added last.
    DeleteLast,
    /// Removes one pair.
    Delete {
        /// Its name.
        pair: String,
    },
    /// Removes all pairs.
    DeleteAll,
    /// Takes back the last change of the collection.
    Undo,
    /// Solves the collected pairs; gives a proposal.
    Solve,
    /// Leaves a pair out of the next solution.
    DropPair {
        /// Its name.
        pair: String,
    },
    /// Takes a dropped pair back in.
    RestorePair {
        /// Its name.
        pair: String,
    },
    /// Judges the calibration in use by what the eyes see, without a board, and the proposal beside it.
    JudgeHealth,
    /// Makes the proposal the calibration in use; refused where it was judged and is not better.
    Accept,
    /// Forgets the proposal; the calibration in use stays.
    Discard,
    /// Reads a calibration file as a proposal.
    Import {
        /// One file, or one per eye (left first) for ROS camera_info.
        files: Vec<PathBuf>,
        /// Unit of lengths in files of other programs.
        #[serde(default)]
        length: FileLength,
    },
    /// Writes a calibration to a file.
    Export {
        /// Which one.
        what: Exported,
        /// In which format.
        format: ExportFormat,
        /// Where to. For ROS camera_info this is the left eye's file; the right eye's gets
        /// `_left` replaced by (or `_right` added to) its name.
        file: PathBuf,
    },
    /// Collects, in place of what is collected, the pairs that the proposal (or else the
    /// calibration in use) was solved from, to solve them again.
    CollectEvidence,
    /// Puts a calibration that was accepted earlier in use again; `None`: none, as the description has
    /// the eyes. Nothing is deleted.
    UseEarlier {
        /// Its id in [`crate::view::EyesView::earlier`].
        id: Option<String>,
    },
    /// Proposes a calibration that was accepted earlier.
    ProposeEarlier {
        /// Its id in [`crate::view::EyesView::earlier`].
        id: String,
    },
}

/// Unit of lengths in a calibration file of another program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileLength {
    /// Meters; refused when that puts the eyes implausibly far apart.
    #[default]
    AsPrescribed,
    /// Meters, however far apart that puts the eyes.
    Meters,
    /// Millimeters, as many OpenCV scripts use.
    Millimeters,
    /// Sides of the board's squares.
    Squares {
        /// Side of a square, meters.
        side_m: f64,
    },
}

/// Which calibration is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exported {
    /// The one in use.
    InUse,
    /// The one proposed.
    Proposal,
}

/// File formats that a calibration can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportFormat {
    /// The program's own, with its evidence.
    Plumbline,
    /// ROS camera_info, one file per eye.
    RosCameraInfo,
    /// OpenCV FileStorage.
    OpenCv,
    /// Kalibr camchain.
    Kalibr,
    /// Corners for mrcal (`.vnl`), not a calibration.
    MrcalCorners,
}

//! Commands of judging detectors on a labeled data set.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Choosing detectors and a data set, judging them, looking at what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScoresCommand {
    /// Adds detectors to the list, chosen.
    AddModels {
        /// ONNX files.
        files: Vec<PathBuf>,
    },
    /// Takes a detector out of the list.
    RemoveModel {
        /// Its file.
        file: PathBuf,
    },
    /// Judges a detector in the next evaluation, or not.
    ChooseModel {
        /// Its file.
        file: PathBuf,
        /// Whether.
        chosen: bool,
    },
    /// Chooses the data set.
    ChooseSet {
        /// Its `data.yaml`, or the folder of it.
        path: PathBuf,
    },
    /// Which part of the data set is judged on.
    ChoosePart(SetPart),
    /// Judges the chosen detectors on the chosen data set.
    Evaluate,
    /// Opens the images behind a cell of the confusion matrix of a model.
    OpenCell {
        /// Place of the model in the table.
        model: usize,
        /// The cell.
        cell: ConfusionCell,
    },
    /// Closes it.
    CloseCell,
    /// Shows one of the images of the open cell large; `None`: the strip again.
    ShowPicture(Option<usize>),
    /// Writes the table.
    ExportCsv {
        /// Where to.
        file: PathBuf,
    },
}

/// A part of a data set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SetPart {
    /// Images that were kept out of training.
    #[default]
    Val,
    /// Images for training.
    Train,
    /// Images for the last word.
    Test,
}

/// A cell of a confusion matrix: what it is, and what it was taken for. `None` is background: not
/// found, or nothing there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ConfusionCell {
    /// Class by the labels, in the order of the data set.
    pub truth: Option<usize>,
    /// Class by the detector, in the order of the data set.
    pub found: Option<usize>,
}

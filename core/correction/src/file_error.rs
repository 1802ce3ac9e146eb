//! Why a model file cannot be used.

use std::path::{Path, PathBuf};

/// Why a model file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] plumbline_model::files::FileError),
    /// It is no JSON, or lacks something.
    #[error("{} is no correction model ({reason}): choose a file that was exported as a model, or export it again", .file.display())]
    NotAModel {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// It was written by a newer program.
    #[error("{} has version {found} of the format, this program knows version {known}: open it with a newer program, or train again", .file.display())]
    OtherVersion {
        /// Which file.
        file: PathBuf,
        /// Its version.
        found: u64,
        /// Ours.
        known: u64,
    },
    /// Its numbers do not make a model.
    #[error("the model in {} is damaged ({reason}): export or train it again", .file.display())]
    Damaged {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// It does not answer as it did when it was written.
    #[error(
        "the model in {} no longer answers as it did when it was written ({} off), so a number in it was changed or damaged: use a copy of the file as it was, or train again", .file.display(), millimeters(*.off_m)
    )]
    OtherAnswers {
        /// Which file.
        file: PathBuf,
        /// Largest difference of an answer or of a stated error, m.
        off_m: f64,
    },
    /// Weights of another shape.
    #[error("the weights in {} have the shapes {found}; needed are kernel 2×H, bias H, kernel H×K, bias K with K = 2 (M2) or 3 (M3): export the network from touch pixel to x, y (z)", .file.display())]
    Shapes {
        /// Which file.
        file: PathBuf,
        /// What was found.
        found: String,
    },
    /// Nothing says how inputs and outputs are scaled.
    #[error("{} does not say how the inputs and outputs of its network {shape} are scaled: add input_mean, input_std, output_mean and output_std", .file.display())]
    NoNormalization {
        /// Which file.
        file: PathBuf,
        /// Shape of the network.
        shape: String,
    },
    /// A graph that is not one of a network with one hidden layer.
    #[error("the graph in {} is not that of a network with one hidden layer ({reason}): export it as Gemm or MatMul and Add, Relu or Tanh, Gemm or MatMul and Add", .file.display())]
    Graph {
        /// Which file.
        file: PathBuf,
        /// Where it differs.
        reason: String,
    },
    /// M1 has no network to export.
    #[error("M1 is a table, not a network: export it as JSON")]
    NotANetwork,
}

fn millimeters(m: f64) -> String {
    if m.is_finite() { format!("{:.3} mm", 1e3 * m) } else { "beyond all measure".to_owned() }
}

impl FileError {
    pub(crate) fn not_a_model(file: &Path, reason: impl ToString) -> Self {
        Self::NotAModel { file: file.to_path_buf(), reason: reason.to_string() }
    }

    pub(crate) fn damaged(file: &Path, reason: impl ToString) -> Self {
        Self::Damaged { file: file.to_path_buf(), reason: reason.to_string() }
    }

    pub(crate) fn graph(file: &Path, reason: impl ToString) -> Self {
        Self::Graph { file: file.to_path_buf(), reason: reason.to_string() }
    }
}

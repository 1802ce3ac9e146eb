//! Commands of looking for the gap between model and measurement.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Finding, naming and adding what makes measurement differ from the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapCommand {
    /// Looks anew which sessions there are.
    ListSessions,
    /// Which sessions are looked at together.
    Choose {
        /// Their folders.
        sessions: Vec<PathBuf>,
    },
    /// With which model they are compared.
    CompareWith(GapModel),
    /// Looks for the gap; gives a finding.
    Find {
        /// Same seed, same answer.
        seed: u64,
    },
    /// Shows a finding that was made before.
    Show {
        /// Its id in [`crate::view::GapView::findings`].
        id: String,
    },
    /// Puts another finding beside the one that is shown; `None`: none.
    Beside {
        /// Its id.
        id: Option<String>,
    },
    /// Deletes a finding. Sessions and model stay as they are.
    Delete {
        /// Its id.
        id: String,
    },
    /// Whether an effect of the finding that is shown is left out of what is added.
    LeaveOut {
        /// By place in its list of effects.
        effect: usize,
        /// Whether it is.
        is_left_out: bool,
    },
    /// Adds effects of the finding that is shown to the model in use. Nothing moves.
    Add {
        /// By place in its list of effects; none: the arm is corrected without a name, where that helps.
        effects: Vec<usize>,
    },
    /// Goes back to the model before.
    Undo,
    /// Puts back what was taken back last, if nothing was changed since.
    Redo,
    /// Takes all effects out of the model.
    UseNominal,
    /// Writes a page about the finding that is shown.
    Report {
        /// Where to.
        file: PathBuf,
        /// As PDF rather than as HTML.
        pdf: bool,
    },
}

/// With which model sessions are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapModel {
    /// The description of the robot as it is, without any effect.
    Nominal,
    /// The model in use, with the effects that were added.
    #[default]
    InUse,
}

//! Commands of correction models, and of the tables of grasp height and yaw.

use std::path::PathBuf;

use plumbline_correction::Method;
use serde::{Deserialize, Serialize};

/// Training and using correction models.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelsCommand {
    /// Looks anew which sessions with touches there are.
    ListSessions,
    /// Which session is learned from.
    ChooseSession {
        /// Its folder.
        session: PathBuf,
    },
    /// Trains these models and compares them on the same held-out touches; gives proposals.
    Train {
        /// Which.
        methods: Vec<Method>,
        /// Same seed, same models.
        seed: u64,
        /// As published (Adam, 200 epochs), or as this program does it.
        published_recipe: bool,
    },
    /// Which model's maps and numbers are shown.
    Show(Method),
    /// Makes a proposed model part of the rig.
    Accept(Method),
    /// Forgets all proposals.
    Discard,
    /// Goes back to the model that was in use before.
    Undo,
    /// Uses no model.
    UseNone,
    /// Reads a model file (own, ONNX, or published weights as JSON) as a proposal.
    Import {
        /// Which file.
        file: PathBuf,
    },
    /// Writes a model.
    Export {
        /// Which; a proposal goes before the one in use.
        method: Method,
        /// As ONNX rather than as JSON.
        onnx: bool,
        /// Where to.
        file: PathBuf,
    },
    /// Edits the tables of grasp height and yaw.
    Tables(TablesCommand),
}

/// Editing the tables of grasp height and yaw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TablesCommand {
    /// Reads a table from a CSV file: heights in place of all heights, yaw in place of the points at
    /// the heights that are in the file (within 1 mm).
    Import {
        /// Which table.
        table: GraspTable,
        /// The file.
        file: PathBuf,
    },
    /// Writes a table.
    Export {
        /// Which table.
        table: GraspTable,
        /// The file.
        file: PathBuf,
    },
    /// Adds a point.
    Add {
        /// Which table.
        table: GraspTable,
        /// Robot frame, m; z counts for yaw only.
        at_m: [f64; 3],
        /// Height, m, or yaw, rad.
        value: f64,
    },
    /// Adds a point where the palm is now, with its height or yaw.
    AddHere {
        /// Which table.
        table: GraspTable,
    },
    /// Moves a point or changes its value.
    Change {
        /// Which table.
        table: GraspTable,
        /// Counted from 0.
        point: usize,
        /// Robot frame, m.
        at_m: [f64; 3],
        /// Height, m, or yaw, rad.
        value: f64,
    },
    /// Removes a point.
    Remove {
        /// Which table.
        table: GraspTable,
        /// Counted from 0.
        point: usize,
    },
    /// Takes back the last change.
    Undo,
}

/// One of the two tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GraspTable {
    /// Grasp height over (x, y).
    #[default]
    Height,
    /// Yaw over (x, y, z).
    Yaw,
}

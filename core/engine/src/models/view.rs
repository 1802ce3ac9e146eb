//! Correction models: what they are trained on, how good they are, where they may be trusted.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_correction::tables::{HeightTable, YawTable};
use plumbline_correction::{Comparison, CorrectionModel, LossPoint, Method, TouchData};
use plumbline_model::robot::Rig;

pub use super::error::ModelError;
use crate::ground::step::StepState;

/// Training and using correction models.
#[derive(Clone, Debug, Default)]
pub struct ModelsView {
    /// For the rail.
    pub step: StepState,
    /// What to do next, a sentence.
    pub next: String,
    /// Sessions with touches, newest first.
    pub sessions: Arc<[TouchSession]>,
    /// The one that is learned from.
    pub session: Option<PathBuf>,
    /// What it has; an error is why nothing can be learned from it.
    pub data: Option<Result<Arc<TouchData>, Arc<ModelError>>>,
    /// Whether training runs.
    pub training: bool,
    /// Loss of every network, as it is (or was) trained, oldest first.
    pub losses: Arc<[LossPoint]>,
    /// Proposals.
    pub proposals: Vec<Arc<CorrectionModel>>,
    /// All methods on the same held-out touches; `None` before training.
    pub comparison: Option<Arc<Comparison>>,
    /// Which method's maps are shown.
    pub shown: Option<Method>,
    /// Maps of the model that is shown: the proposal, else the one in use.
    pub map: Option<Arc<ModelMap>>,
    /// The one in use; `None`: targets are sent as they are.
    pub in_use: Option<Arc<CorrectionModel>>,
    /// What was in use before, newest first; undo goes there.
    pub earlier: Arc<[EarlierModel]>,
    /// The tables of grasp height and yaw.
    pub tables: Arc<TablesView>,
    /// The rig that all of it belongs to.
    pub rig: Option<Arc<Rig>>,
}

/// A session with touches.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchSession {
    /// Its folder.
    pub folder: PathBuf,
    /// When it was begun; `None` when it cannot be read.
    pub started: Option<jiff::Timestamp>,
    /// Touches in it.
    pub touches: usize,
    /// Why it cannot be used.
    pub problem: Option<String>,
}

/// A model that was in use.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlierModel {
    /// Which kind; `None`: no model.
    pub method: Option<Method>,
    /// When it was accepted.
    pub accepted: jiff::Timestamp,
}

/// A model over the table, robot frame. Errors are what remains at touches that the model was
/// not trained on (held out), before and after.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelMap {
    /// Which kind.
    pub method: Option<Method>,
    /// Whether it is a proposal.
    pub proposed: bool,
    /// One per touch: place on the screen (x, y), error without a model, error with it held out;
    /// m. Empty when the model was imported without its touches.
    pub touches: Vec<MapTouch>,
    /// Mean error in the plane without a model, m: as the screen lay for the training, if the model tells, else as
    /// the touches are drawn. `None` without touches.
    pub without_m: Option<f64>,
    /// The border of the data: lines around its parts and around the holes in them, the largest part
    /// first, each its corners on the table (x, y), m. A place inside an odd number of lines is inside.
    /// Empty when the model was imported without its touches.
    pub border_m: Vec<Vec<[f64; 2]>>,
    /// The touchscreen, on the table, m.
    pub screen_m: Vec<[f64; 2]>,
    /// Standard deviation in the plane over the table around the screen.
    pub sd: Field,
    /// Length of the correction in the plane.
    pub shift: Field,
    /// Mean length of the correction inside and outside the border, m.
    pub mean_shift_m: (Option<f64>, Option<f64>),
}

/// A touch on the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapTouch {
    /// Place on the table (x, y), m.
    pub at_m: [f64; 2],
    /// Without a model: where the model-free target would have gone minus what was needed, m.
    pub before_m: [f64; 3],
    /// With the model, this touch held out, m.
    pub after_m: [f64; 3],
}

/// Values over a rectangle of the table, row by row from small x, in each row from small y.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// Range of x, m.
    pub x_m: [f64; 2],
    /// Range of y, m.
    pub y_m: [f64; 2],
    /// Values per row (along y).
    pub columns: usize,
    /// Values, m.
    pub values_m: Vec<Option<f64>>,
}

/// The tables of grasp height and yaw.
#[derive(Clone, Debug, Default)]
pub struct TablesView {
    /// Height over (x, y); `None`: none was read or made yet.
    pub height: Option<Arc<HeightTable>>,
    /// Leave-one-out error of each of its points, m; empty while it is being computed or cannot be.
    pub height_errors_m: Vec<f64>,
    /// Interpolated over the table.
    pub height_field: Field,
    /// Yaw over (x, y, z).
    pub yaw: Option<Arc<YawTable>>,
    /// Leave-one-out error of each of its points, rad; empty while it is being computed or cannot be.
    pub yaw_errors_rad: Vec<f64>,
    /// Whether a change can be taken back.
    pub can_undo: bool,
    /// What the operator should know, a sentence each: a table that cannot be used yet, and why.
    pub remarks: Vec<String>,
    /// Where the palm is now, robot frame, m, and its yaw, rad; `None` when not connected.
    pub palm: Option<([f64; 3], f64)>,
}

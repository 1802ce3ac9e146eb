//! Drift, for the window.

use std::path::PathBuf;
use std::sync::Arc;

pub use plumbline_drift::{Mover as DriftMover, PlaceError, Row as TableRow, Verdict as DriftVerdict};

use crate::ground::step::StepState;

/// Watching drift.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriftView {
    /// For the rail.
    pub step: StepState,
    /// Whether it watches.
    pub is_watching: bool,
    /// Why it does not look just now, a sentence; `None`: it does, or does not watch.
    pub waits_because: Option<String>,
    /// Why nothing came of the last look, a sentence.
    pub failed: Option<String>,
    /// What was seen since watching began; `None`: it never did.
    pub course: Option<Arc<DriftCourse>>,
    /// Whether a session is being made of it, or it is told with another model.
    pub is_busy: bool,
    /// Why it cannot be explained now, a part of a sentence; `None`: it can.
    pub unexplained: Option<&'static str>,
    /// The session that was made of it last, to be explained.
    pub log: Option<PathBuf>,
}

/// What was seen since watching began.
#[derive(Clone, Debug, PartialEq)]
pub struct DriftCourse {
    /// Whether times count from when the cameras were switched on; else from when watching began.
    pub from_switching_on: bool,
    /// Looks, oldest first.
    pub points: Vec<DriftPoint>,
    /// How far from where they were places may come out near, in the middle and far, m; `None`: not learned yet.
    pub band_m: Option<[f64; 3]>,
    /// What is the matter.
    pub verdict: DriftVerdict,
    /// The same as a sentence.
    pub sentence: String,
    /// How far off places on the table come out, by row from near to far.
    pub table: [[PlaceError; 3]; 3],
    /// How the left and the right eye have turned since watching began, rad, own axes: nod, pan, roll.
    pub turns_rad: [[f64; 3]; 2],
    /// How far places leave the epipolar planes of the calibration in use, rms, px; of the last look that told.
    pub epipolar_px: Option<f64>,
    /// References of the last look and how far they come out from where they were, m; `None`: gone or covered.
    pub references: Vec<(String, Option<f64>)>,
    /// What moved that should not have, oldest first: when (s) and a sentence.
    pub alarms: Vec<(f64, String)>,
    /// What was moved by hand or sagged, oldest first: when (s) and a sentence.
    pub own_motions: Vec<(f64, String)>,
}

/// A look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftPoint {
    /// When, s.
    pub at_s: f64,
    /// How far places are from where they came out in the first minutes near, in the middle and far, m.
    pub off_m: [f64; 3],
    /// The part along the line of sight, since watching began, m; positive: too far away.
    pub along_m: [f64; 3],
    /// The part across it, m; positive: too far to the left.
    pub across_m: [f64; 3],
}

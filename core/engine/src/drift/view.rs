//! Drift, for the window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

pub use plumbline_drift::{GridCorrection, GridErrors, GridPlace, Judged};
pub use plumbline_drift::{Mover as DriftMover, PlaceError, Row as TableRow, Verdict as DriftVerdict};

pub use super::Unjudged as GridUnjudged;
use super::Unjudged;
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
    /// When it looked last and when it looks next, where it is neither waiting nor called off.
    pub looks_at: Option<[Instant; 2]>,
    /// Why nothing came of the last look, a sentence.
    pub failed: Option<String>,
    /// What was seen since watching began; `None`: it never did.
    pub course: Option<Arc<DriftCourse>>,
    /// That watching began anew without being asked to; `None`: it did not.
    pub anew: Option<Anew>,
    /// Whether a session is being made of it, or it is told with another model.
    pub is_busy: bool,
    /// Why it cannot be explained now, a part of a sentence; `None`: it can.
    pub unexplained: Option<&'static str>,
    /// Where a correction by time is in use, how well places are known with it near, in the middle and far: half of the
    /// longest axis of what holds 95 % of them, m; `None`: none is, or what it states is not known.
    pub stated_m: Option<[f64; 3]>,
    /// The session that was made of it last, to be explained.
    pub log: Option<PathBuf>,
    /// The 9 by 4 evaluation.
    pub grid: GridView,
}

/// Watching began anew by itself: what it tells is of the time since.
#[derive(Clone, Debug, PartialEq)]
pub struct Anew {
    /// Why.
    pub why: BeganAnew,
    /// What had moved before, a sentence; `None`: nothing was seen to.
    pub moved_before: Option<String>,
}

/// Why what comes cannot be compared with what was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeganAnew {
    /// Another source was opened, or the same again.
    Opened,
    /// The time since the cameras were switched on was set: times before and after are of different clocks.
    ClockSet,
    /// It became known, or is not any more.
    ClockKnown,
    /// The cameras were switched off and on.
    SwitchedOn,
    /// A recording was wound back.
    WoundBack,
    /// What was seen cannot be told with the model that is in use now.
    OtherModel,
}

impl BeganAnew {
    /// What the operator is told when it happens, a sentence; `None`: nothing, he did it or is told elsewhere.
    pub(super) fn notice(self) -> Option<&'static str> {
        match self {
            Self::ClockSet => {
                Some("The time since the cameras were switched on was set: watching drift begins anew.")
            }
            Self::WoundBack => Some("The recording was wound back: watching drift begins anew."),
            Self::SwitchedOn => Some("The cameras were switched on again: watching drift begins anew."),
            Self::Opened | Self::ClockKnown | Self::OtherModel => None,
        }
    }
}

/// The 9 by 4 evaluation: a thing at known places, and how far off it comes out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridView {
    /// Why it cannot begin now, a part of a sentence; `None`: it can.
    pub unable: Option<&'static str>,
    /// The one under way, else the last one; `None`: there was none.
    pub run: Option<GridRunView>,
    /// Left and right.
    pub figures: [Option<GridFigure>; 2],
    /// Sessions that can be shown and their names, newest first.
    pub sessions: Arc<[(PathBuf, String)]>,
}

impl GridView {
    /// The evaluation under way.
    pub fn under_way(&self) -> Option<&GridRunView> {
        self.run.as_ref().filter(|run| run.doing != GridDoing::Ended)
    }
}

/// How far it is.
#[derive(Clone, Debug, PartialEq)]
pub struct GridRunView {
    /// Class of the thing.
    pub object: &'static str,
    /// Number of the place where it is, from 1.
    pub place: usize,
    /// Of so many.
    pub of: usize,
    /// Where that is (x, y), robot frame, m.
    pub at_m: [f64; 2],
    /// Whether nobody has to lay it.
    pub places_by_itself: bool,
    /// What is done just now.
    pub doing: GridDoing,
    /// Places at which it was seen.
    pub measured: usize,
    /// The session, once it is on disk.
    pub session: Option<PathBuf>,
    /// Why what was measured last is not on disk; it is tried again by itself.
    pub unkept: Option<String>,
}

/// What is done at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridDoing {
    /// A person is to lay the thing down, and to say so.
    Asks,
    /// It comes to rest.
    Lays,
    /// It is looked at.
    Looks {
        /// So often by now.
        looks: usize,
        /// Of so many.
        of: usize,
    },
    /// Nothing is being detected: there is no detector, or it hangs.
    NoDetector,
    /// It was not found there: it is to be laid again, or the place left out.
    NotSeen,
    /// No more places.
    Ended,
}

/// An evaluation with a correction.
#[derive(Clone, Debug, PartialEq)]
pub struct GridFigure {
    /// The session.
    pub session: PathBuf,
    /// Its name.
    pub title: String,
    /// What was made of its places.
    pub correction: GridCorrection,
    /// What came out, or why nothing did (a sentence); `None`: it is being judged.
    pub judged: Option<Result<Arc<Judged>, Unjudged>>,
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

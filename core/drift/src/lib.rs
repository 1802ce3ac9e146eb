//! Places wander while the eyes warm up, or when somebody knocks against one: how far, since when, what it
//! is that moves, and what it costs where the robot works.
//!
//! [`Watcher`] looks at a pair now and then and says how each eye has turned since the first one, and what
//! of the references (the touchscreen, things on the table, a hand at rest) moved by itself. [`Monitor`]
//! keeps what was seen, learns in the first minutes how far it scatters, and says what is the matter. It
//! reads images, encoders and detections and nothing else.

mod cost;
mod evaluation;
mod grid;
mod log;
mod monitor;
mod warm_up;
mod watch;
pub mod words;

pub use cost::{PlaceError, Row, TableError, errors};
pub use evaluation::{GridCorrection, Judged, NotJudged, evaluation_places_m, judge};
pub use grid::{GridErrors, GridPlace, PivotCorrection, grid_places};
pub use log::{LogError, is_too_short, log_of};
pub use monitor::{Alarm, Band, Monitor, Mover, OwnMotion, Sample, Verdict};
pub use warm_up::{Approach, ToGo, WarmUp, fit_warm_up};
pub use watch::{Look, Reference, ReferenceKind, ReferenceSeen, WatchError, Watcher, WatcherSetup};

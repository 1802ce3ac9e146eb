//! Finds where measurement and model disagree, names the missing effect, sizes it, and shows the
//! gap shrink.

mod beforehand;
mod bounds;
mod compare;
mod covariates;
mod error;
mod file;
mod find;
pub mod finding;
mod floor;
mod floor_source;
mod marker;
mod next;
mod offer;
mod options;
mod search;
mod seen;
mod sentence;
mod servos;
mod show;
mod statistics;
pub mod titles;
mod watched;

pub use error::{GapError, Turns};
pub use file::FindingFileError;
pub use find::find;
pub use finding::{Finding, Verdict};
pub use next::plan_for;
pub use options::Options;
pub use plumbline_model::{number, parameter_units, parameter_words};

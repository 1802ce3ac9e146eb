//! The effects: names, sites, usual sizes, what each does to arm, screen or eyes, which of them
//! rows can show, and their parameters as people read them.
//!
//! All that is known of a kind stands in one entry (`kinds`).
//!
//! Sizes follow one rule: the standard deviation of a parameter is half of the upper end of the
//! range that is plausible for a robot of this kind, so that none is favored.

mod act;
mod effect;
mod entry;
mod kind;
mod kinds;
mod known;
mod present;
mod press;
mod report;
mod situation;
mod surface;

pub use effect::{Effect, Growth, across};
pub(crate) use entry::Shape;
pub use kind::{Kind, Parameter};
pub(crate) use known::{Known, MOST_MOMENTS, differ, moments, sorted, thinned, with_shapes};
pub use present::Present;
pub use report::Reported;
pub use situation::Situation;
pub use surface::Surface;

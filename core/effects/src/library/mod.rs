//! The effects that touches can show: names, sites, usual sizes, and what each does to the arm.
//!
//! Sizes follow one rule: the standard deviation of a parameter is half of the upper end of the
//! range that is plausible for a robot of this kind, so that none is favored.

mod effect;
mod kind;
mod situation;
mod surface;

pub use effect::Effect;
pub use kind::{Kind, Parameter};
pub use situation::Situation;
pub use surface::Surface;

//! Everything that was ever found out of a robot, on one line: each calibration, model and finding that
//! was put in use or taken back, and everything that was measured, with its error before and after.
//!
//! No workflow writes here. The state looks after every change at what is in use in all of them, and
//! hands that in; what differs from what was in use before becomes an entry. So nothing is put in use
//! past the timeline, also what another program put there while this one was closed.

mod around;
pub mod command;
mod entries;
mod kept;
mod page;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use around::{Finding, Measured, Standing, TimelineAround};
pub use plumbline_report::tile::{Picture as PagePicture, Tile as TilePage, tile_pdf};
pub use workflow::{StepBack, TimelineWorkflow};

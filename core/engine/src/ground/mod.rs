//! What all workflows stand on: jobs, messages, signs of life, slots, worlds. Nothing here knows
//! any of them.

pub mod bell;
pub mod context;
pub mod data_folder;
pub mod jobs;
#[cfg(all(test, target_os = "linux"))]
pub mod kept;
pub mod notice;
pub mod own_file;
pub mod sessions;
pub mod shelf;
pub mod slot;
pub mod stage;
pub mod statistics;
pub mod step;
pub mod text;
pub mod time;
pub mod warming;
pub mod watched;
pub mod work;
mod workers;
pub mod workflow;
pub mod world;

pub use context::{Asked, Context};
pub use time::{Clock, Time};
pub use work::{LongWork, Nothing};
pub use workflow::{Moment, Workflow};
pub use world::{PerWorld, World};

/// Program and version, as written into results.
pub fn software() -> String {
    concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned()
}

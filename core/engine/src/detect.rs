//! Detection, live: which detector, read in the background; what is shown of what it finds; how
//! reliably it finds it.
//!
//! [`DetectState`] is driven by commands, by finished work and by the stage of the live pipeline;
//! it owns no thread.

mod detector;
mod file;
mod objects;
mod state;
mod store;
mod work;

pub use detector::{Detects, LoadedDetector, OpenDetector, SHOWN_FROM};
pub use objects::{FoundObjects, Objects};
pub use state::{Around, DetectState};
pub use work::{DetectResult, DetectWork};

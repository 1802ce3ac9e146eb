//! What the detector sees live: boxes over the eyes, the object that is pointed at or chosen, and
//! what is known about it.

mod classes;
mod details;
mod detector;
mod drawing;
mod inspector;
mod key;
mod list;
mod order;
pub mod state;

pub(crate) use drawing::{raw, raw_boxes, rectified, stale};
pub(crate) use inspector::show_inspector;
pub(crate) use state::objects as found;

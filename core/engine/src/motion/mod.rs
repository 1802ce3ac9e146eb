//! Ways of the hand that were looked at before anything moves: above a place, down, and back.

mod no_way;
mod path;

pub use no_way::NoWay;
pub use path::{Hold, Planner, ScreenPlace, TouchPace, TouchPath, touch_allowances};

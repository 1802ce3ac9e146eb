//! Ways of the hand that were looked at before anything moves: above a place, down, and back.

mod no_way;
mod path;
mod planner;
mod ways;

pub use no_way::NoWay;
pub use path::{Hold, ScreenPlace, TouchPace, TouchPath, Wanted};
pub use planner::{Planner, is_believed, touch_allowances};

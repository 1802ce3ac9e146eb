//! Ways of the hand that were looked at before anything moves: above a place, down, and back.

mod path;

pub use path::{Planner, ScreenPlace, TouchPace, TouchPath, touch_allowances};

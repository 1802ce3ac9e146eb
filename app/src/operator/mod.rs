//! What the operator can ask for, is told and may look at: the ground that panels and window stand
//! on. It draws nothing, and knows neither of them.

pub mod actions;
mod faults;
mod gamepad;
pub mod guidance;
mod outbox;
mod screens;
pub mod shortcuts;
pub mod snapshot;
mod table;
mod touch_monitor;
pub mod words;

pub use actions::{
    Action, CommissionAction, DetectAction, GapAction, GraspAction, GridAction, HandEyeAction, LabelsAction,
    ModelsAction, MountAction, Preset, RobotAction, ScoresAction, TimelineAction, TouchAction, TrialsAction,
    USUAL_THING, default_scenario, format_name, gap_plan, gap_proof, is_under_way, led_by, needs_window,
    screen_of, usual_area,
};
pub use gamepad::{GamepadState, STOP_BUTTONS};
pub use guidance::{
    Course, Press, Verdict, capture_waits_for, course, done_of, is_held_by_a_person, is_of_choice, minutes,
    other_board, verdict, wanted, wanted_board, what_moves,
};
pub use outbox::{Outbox, Taken};
pub use screens::{Pane, Screen};
pub use shortcuts::{StopKeys, shortcut_text};
pub use table::Table;
pub use touch_monitor::{Monitor, window_problem};

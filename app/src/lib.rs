//! The program: a window and a command line over the same engine.

mod cli;
mod operator;
mod panels;
mod window;

pub use cli::{run, understands};
pub use operator::{Action, Outbox, Pane, Screen};
pub use window::{
    Backend, LaunchOptions, LogStore, PlumblineWindow, ScriptStep, Stopper, ThemeChoice, TouchSurface,
    WindowOptions, WindowSettings, launch, start_log, touch_surface,
};

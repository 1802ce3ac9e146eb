//! The program: a window and a command line over the same engine.

mod cli;
mod panels;
mod window;

pub use cli::{run, understands};
pub use window::{
    Action, Backend, LaunchOptions, LogStore, Outbox, Pane, PlumblineWindow, Screen, ScriptStep, Stopper,
    ThemeChoice, TouchSurface, WindowOptions, WindowSettings, launch, start_log, touch_surface,
};

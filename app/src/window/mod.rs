//! The window: its frame, and what holds the panels together.
//!
//! Once per frame it takes the engine's newest view, draws it, and hands over what the operator
//! asked for. It computes nothing, opens no file and waits for nothing.

mod about;
mod answers;
mod apply;
mod arrangement;
mod ask;
mod backend;
mod closing;
mod commission;
mod connect;
mod dialogs;
mod drop;
mod faults;
mod follow;
mod frame;
mod frame_time;
mod frame_times_overlay;
mod gamepad;
mod health;
mod icon;
mod inspector;
mod jogging;
mod lamps;
mod launch;
mod lerobot;
mod log_lines;
mod log_panel;
mod manual;
mod narrow;
mod notices;
mod palette;
mod rail;
pub mod renderer;
mod robot_lamps;
mod running_lamp;
mod saving;
mod script;
mod script_step;
mod settings;
mod sheet;
mod source_menu;
mod status_line;
mod taking;
mod tile_menu;
mod tiles;
mod touch_window;
mod transport;
mod truth_band;
mod unaccepted;
mod undo;
mod world_menu;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use plumbline_engine::{JobId, Products, View};

pub use backend::{Backend, Stopper};
pub use launch::{LaunchOptions, launch};
pub use log_lines::{LogStore, start as start_log};
pub use script_step::ScriptStep;
pub use settings::{ThemeChoice, WindowSettings};
pub use touch_window::{TouchSurface, touch_surface};

use crate::operator::{Action, Pane};
use crate::panels::PanelState;
use crate::panels::rest::Rest;
use ask::Ask;
use dialogs::Dialogs;
use frame_time::FrameTimes;
use gamepad::Gamepads;
use jogging::Jogging;
use log_panel::LogPanel;
use manual::Manual;
use narrow::NarrowTabs;
use notices::NoticeList;
use palette::Palette;
use script::Script;
use status_line::BegunOn;
use taking::Taking;
use touch_window::TouchWindow;

/// What the window is made with.
pub struct WindowOptions {
    /// What it remembers.
    pub settings: WindowSettings,
    /// Where that is kept; `None` forgets it.
    pub settings_file: Option<PathBuf>,
    /// Whether the desktop's file dialogs are used.
    pub native_dialogs: bool,
    /// The program's log.
    pub log: Arc<LogStore>,
    /// Things to do without an operator, for pictures and measurements.
    pub script: Vec<ScriptStep>,
    /// Why the script came to no end, once it has not.
    pub script_failure: Arc<OnceLock<String>>,
    /// Where the frame times are written at exit, as JSON.
    pub frame_report: Option<PathBuf>,
    /// Said in the frame times overlay and in the report.
    pub renderer: String,
    /// Whether gamepads are looked for.
    pub gamepads: bool,
    /// Whether commissioning is opened where nothing was ever commissioned.
    pub opens_commissioning: bool,
}

impl Default for WindowOptions {
    fn default() -> Self {
        Self {
            settings: WindowSettings::default(),
            settings_file: None,
            native_dialogs: false,
            log: Arc::default(),
            script: Vec::new(),
            script_failure: Arc::default(),
            frame_report: None,
            renderer: "none".to_owned(),
            gamepads: false,
            opens_commissioning: false,
        }
    }
}

/// The window.
pub struct PlumblineWindow {
    backend: Box<dyn Backend>,
    view: Arc<View>,
    settings: WindowSettings,
    saved: WindowSettings,
    settings_file: Option<PathBuf>,
    panels: PanelState,
    narrow: NarrowTabs,
    dialogs: Dialogs,
    ask: Option<Ask>,
    palette: Palette,
    manual: Manual,
    notices: NoticeList,
    /// As it was drawn last, pt.
    inspector_width: f32,
    log: LogPanel,
    frame_times: FrameTimes,
    processor_time_before: Option<Duration>,
    frame_times_open: bool,
    frame_report: Option<PathBuf>,
    resident_before_mb: Option<f64>,
    renderer: String,
    script: Script,
    script_failure: Arc<OnceLock<String>>,
    started: Instant,
    stopped_at: Option<Instant>,
    /// Where the tiles lay that were in front in the last frame.
    tile_rects: BTreeMap<Pane, egui::Rect>,
    taking: Taking,
    /// Whether it closes although something moves: that was asked, or nobody is there to be.
    closes: bool,
    dismissed: Vec<JobId>,
    wanted: Option<Products>,
    gamepads: Gamepads,
    jogging: Jogging,
    /// When a motion was asked for last.
    motion_asked: Option<Instant>,
    /// When the one button of commissioning was pressed last.
    commission_pressed: Option<Instant>,
    /// Whether commissioning is still to be opened where nothing was ever commissioned.
    may_open_commissioning: bool,
    /// The one button of the bottom line, and that of commissioning, when they mean something new.
    primary_rest: Rest<Action>,
    /// Where what failed is said.
    begun_on: BegunOn,
    commission_rest: Rest<Vec<Action>>,
    undo_rest: Rest<()>,
    touch_window: TouchWindow,
    /// When monitors were looked for last, by the clock of the window, s.
    monitors_found_s: f64,
}

impl PlumblineWindow {
    /// A window over a running engine.
    pub fn new(ctx: &egui::Context, backend: Box<dyn Backend>, options: WindowOptions) -> Self {
        plumbline_widgets::theme::apply(ctx, options.settings.theme.preference());
        ctx.set_zoom_factor(options.settings.zoom);
        let view = backend.view();
        let gamepads = match options.gamepads {
            true => Gamepads::start(ctx, backend.stopper()),
            false => Gamepads::default(),
        };
        Self {
            backend,
            view,
            saved: options.settings.clone(),
            settings: options.settings,
            settings_file: options.settings_file,
            panels: PanelState::default(),
            narrow: NarrowTabs::default(),
            dialogs: Dialogs::new(options.native_dialogs, ctx.clone()),
            ask: None,
            palette: Palette::default(),
            manual: Manual::default(),
            notices: NoticeList::default(),
            inspector_width: 248.0,
            log: LogPanel::new(options.log),
            frame_times: FrameTimes::default(),
            processor_time_before: None,
            frame_times_open: false,
            frame_report: options.frame_report,
            resident_before_mb: None,
            renderer: options.renderer,
            script: Script::new(options.script),
            script_failure: options.script_failure,
            started: Instant::now(),
            stopped_at: None,
            tile_rects: BTreeMap::new(),
            taking: Taking::default(),
            closes: false,
            dismissed: Vec::new(),
            wanted: None,
            gamepads,
            jogging: Jogging::default(),
            motion_asked: None,
            commission_pressed: None,
            may_open_commissioning: options.opens_commissioning,
            primary_rest: Rest::default(),
            begun_on: BegunOn::default(),
            commission_rest: Rest::default(),
            undo_rest: Rest::default(),
            touch_window: TouchWindow::default(),
            monitors_found_s: f64::NEG_INFINITY,
        }
    }

    /// The tiles that were in front in the last frame.
    pub fn tiles(&self) -> impl Iterator<Item = Pane> {
        self.tile_rects.keys().copied()
    }

    /// The snapshot that the last frame drew.
    pub fn view(&self) -> &Arc<View> {
        &self.view
    }
}

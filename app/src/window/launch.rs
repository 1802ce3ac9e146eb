//! Opening the window.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use plumbline_engine::{Engine, EngineSettings, SourceCommand, SourceSpec};

use super::renderer::{self, RendererChoice};
use super::settings::{ThemeChoice, WindowSettings, settings_file};
use super::{PlumblineWindow, ScriptStep, WindowOptions, log_lines};
use crate::operator::Screen;

/// What the command line says about the window.
#[derive(Clone, Debug, Default)]
pub struct LaunchOptions {
    /// Folders or files to open: none, one, or two (left eye first).
    pub paths: Vec<PathBuf>,
    /// Numbers of two cameras.
    pub cameras: Option<(u32, u32)>,
    /// Scenario of the twin that runs when nothing else is opened; `None`: no twin.
    pub twin: Option<String>,
    /// Which renderer.
    pub renderer: RendererChoice,
    /// Colors, in place of the remembered ones.
    pub theme: Option<ThemeChoice>,
    /// First screen, in place of the remembered one.
    pub screen: Option<Screen>,
    /// Inner size in points, in place of the remembered one.
    pub size: Option<[f32; 2]>,
    /// Where settings are kept, in place of the user's configuration folder.
    pub config_dir: Option<PathBuf>,
    /// Where calibrations are kept, in place of the user's data folder.
    pub data_dir: Option<PathBuf>,
    /// Things to do without an operator.
    pub script: Vec<ScriptStep>,
    /// Where the frame times are written at exit.
    pub frame_report: Option<PathBuf>,
}

/// Opens the window and returns when it is closed.
pub fn launch(options: LaunchOptions) -> anyhow::Result<()> {
    let log = log_lines::start(log::LevelFilter::Warn);
    let chosen = renderer::choose(options.renderer, &renderer::adapters());
    log::info!("the window is drawn by {}", chosen.reason);
    let file = settings_file(options.config_dir.as_deref());
    let (mut settings, trouble) = match &file {
        Some(file) => match WindowSettings::load(file) {
            Ok(settings) => (settings, None),
            Err(error) => (WindowSettings::default(), Some(error.to_string())),
        },
        None => (WindowSettings::default(), None),
    };
    settings.theme = options.theme.unwrap_or(settings.theme);
    settings.screen = options.screen.unwrap_or(settings.screen);
    settings.size = options.size.unwrap_or(settings.size);

    let nothing_else = options.paths.is_empty() && options.cameras.is_none();
    let news_may_wait = chosen.news_may_wait();
    let native = native_options(&settings, chosen.renderer);
    let script_failure = Arc::new(OnceLock::new());
    let failure = script_failure.clone();
    // The closure runs once, but eframe's type cannot say so.
    let parts = Mutex::new(Some((settings, options)));
    let result = eframe::run_native(
        "Plumbline",
        native,
        Box::new(move |creation| {
            let ctx = creation.egui_ctx.clone();
            let taken = parts.lock().unwrap_or_else(PoisonError::into_inner).take();
            let (settings, options) = taken.ok_or("the window was made twice")?;
            let window_options = WindowOptions {
                settings,
                settings_file: file,
                native_dialogs: options.script.is_empty(),
                log,
                script: options.script.clone(),
                script_failure: failure,
                frame_report: options.frame_report.clone(),
                renderer: chosen.reason,
                gamepads: options.script.is_empty(),
                opens_commissioning: options.screen.is_none() && options.script.is_empty() && nothing_else,
            };
            let engine = start_engine(&ctx, &options, news_may_wait);
            if let Some(trouble) = trouble {
                engine.send(super::apply::warning(trouble));
            }
            Ok(Box::new(PlumblineWindow::new(&ctx, Box::new(engine), window_options)))
        }),
    );
    result.map_err(|error| {
        anyhow::anyhow!(
            "the window cannot be opened: {error}. Without a screen use the verbs (plumbline --help), or a virtual screen (xvfb-run plumbline)"
        )
    })?;
    // Whoever started the script reads what it returns.
    match script_failure.get() {
        Some(said) => Err(anyhow::anyhow!("{said}")),
        None => Ok(()),
    }
}

fn start_engine(ctx: &egui::Context, options: &LaunchOptions, news_may_wait: Duration) -> Engine {
    let wake = ctx.clone();
    let source =
        options.cameras.map(|(left, right)| SourceSpec::Cameras { left_index: left, right_index: right });
    let nothing_else = options.paths.is_empty() && source.is_none();
    let twin = options.twin.clone().filter(|_| nothing_else);
    let settings = EngineSettings { data_dir: options.data_dir.clone(), source, twin };
    let engine = Engine::start(settings, Arc::new(move || wake.request_repaint_after(news_may_wait)));
    if !options.paths.is_empty() {
        // Remembered sources have to be found from another folder too.
        let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        engine.send(SourceCommand::OpenPaths(options.paths.iter().map(absolute).collect()));
    }
    engine
}

fn native_options(settings: &WindowSettings, renderer: eframe::Renderer) -> eframe::NativeOptions {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Plumbline")
        .with_app_id("plumbline")
        .with_icon(super::icon::icon())
        .with_inner_size(settings.size)
        .with_min_inner_size([960.0, 600.0])
        .with_drag_and_drop(true);
    eframe::NativeOptions { viewport, renderer, persist_window: false, ..Default::default() }
}

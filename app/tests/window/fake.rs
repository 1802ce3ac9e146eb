//! A window without an engine: it draws what the test made up and notes what was asked for.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{Backend, PlumblineWindow, ScriptStep, Stopper, ThemeChoice, WindowOptions, WindowSettings};
use plumbline_engine::{Command, View};

/// What the test can see and change from outside.
#[derive(Clone, Default)]
pub struct Fake {
    view: Arc<Mutex<Arc<View>>>,
    sent: Arc<Mutex<Vec<Command>>>,
    stops: Arc<AtomicUsize>,
    heartbeats: Arc<AtomicUsize>,
}

impl Backend for Fake {
    fn view(&self) -> Arc<View> {
        self.view.lock().expect("no test panics with the lock").clone()
    }

    fn send(&self, command: Command) {
        self.sent.lock().expect("no test panics with the lock").push(command);
    }

    fn stop(&self) {
        self.stops.fetch_add(1, Ordering::SeqCst);
    }

    fn stopper(&self) -> Stopper {
        let stops = self.stops.clone();
        Arc::new(move || {
            stops.fetch_add(1, Ordering::SeqCst);
        })
    }

    fn heartbeat(&self) {
        self.heartbeats.fetch_add(1, Ordering::SeqCst);
    }
}

impl Fake {
    pub fn over(view: View) -> Self {
        let fake = Self::default();
        *fake.view.lock().expect("fresh") = Arc::new(view);
        fake
    }

    /// Shows another view from the next frame on.
    pub fn show(&self, view: View) {
        *self.view.lock().expect("no test panics with the lock") = Arc::new(view);
    }

    /// How often STOP was called since the last call.
    pub fn take_stops(&self) -> usize {
        self.stops.swap(0, Ordering::SeqCst)
    }

    /// Signs of life so far.
    pub fn heartbeats(&self) -> usize {
        self.heartbeats.load(Ordering::SeqCst)
    }

    /// What was asked for since the last call, without what the window asks for by itself.
    pub fn take_sent(&self) -> Vec<Command> {
        let mut sent = self.sent.lock().expect("no test panics with the lock");
        let all = std::mem::take(&mut *sent);
        all.into_iter().filter(|command| !matches!(command, Command::Live(_))).collect()
    }

    /// The same with what it asks for by itself.
    pub fn take_all_sent(&self) -> Vec<Command> {
        std::mem::take(&mut *self.sent.lock().expect("no test panics with the lock"))
    }

    pub fn window(&self, settings: WindowSettings) -> Harness<'static, PlumblineWindow> {
        self.window_of_size(settings, [1280.0, 800.0])
    }

    pub fn window_of_size(
        &self,
        settings: WindowSettings,
        size: [f32; 2],
    ) -> Harness<'static, PlumblineWindow> {
        self.window_with(settings, size, false)
    }

    /// With a renderer when it shall be looked at.
    pub fn window_with(
        &self,
        settings: WindowSettings,
        size: [f32; 2],
        picture: bool,
    ) -> Harness<'static, PlumblineWindow> {
        let theme = if settings.theme == ThemeChoice::Light { egui::Theme::Light } else { egui::Theme::Dark };
        let backend = self.clone();
        let options =
            WindowOptions { settings, script: Vec::<ScriptStep>::new(), ..WindowOptions::default() };
        let builder = Harness::builder().with_size(size).with_theme(theme);
        let builder = if picture { builder.wgpu() } else { builder };
        let mut harness = builder
            .build_eframe(|creation| PlumblineWindow::new(&creation.egui_ctx, Box::new(backend), options));
        // The first frames only measure.
        harness.run_steps(3);
        self.take_sent();
        self.take_stops();
        harness
    }
}

/// Where pictures for people go.
pub fn picture_folder() -> std::path::PathBuf {
    std::env::var_os("PLUMBLINE_WINDOW_PICTURES").expect("set PLUMBLINE_WINDOW_PICTURES to a folder").into()
}

/// Clicks what has this label; the first one if there are several.
pub fn click(harness: &mut Harness<'_, PlumblineWindow>, label: &str) {
    let found = harness.get_all_by_label(label).next();
    found.unwrap_or_else(|| panic!("nothing is called {label:?}")).click();
    harness.run_steps(3);
}

/// Clicks what has these words in its label: a menu's line has its shortcut there, too.
pub fn click_containing(harness: &mut Harness<'_, PlumblineWindow>, words: &str) {
    let found = harness.get_all_by_label_contains(words).next();
    found.unwrap_or_else(|| panic!("nothing says {words:?}")).click();
    harness.run_steps(3);
}

/// A short press with the pointer, on whatever lies there.
pub fn click_at(harness: &mut Harness<'_, PlumblineWindow>, at: egui::Pos2) {
    harness.hover_at(at);
    harness.run_steps(2);
    harness.drag_at(at);
    harness.drop_at(at);
    harness.run_steps(3);
}

/// Whether something has this label.
pub fn shows(harness: &Harness<'_, PlumblineWindow>, label: &str) -> bool {
    harness.query_all_by_label(label).next().is_some()
}

/// Whether something has this text in its label.
pub fn says(harness: &Harness<'_, PlumblineWindow>, text: &str) -> bool {
    harness.query_all_by_label_contains(text).next().is_some()
}

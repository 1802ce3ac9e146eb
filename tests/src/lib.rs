//! What whole-application tests share: the window over the real engine, clicks by label, and
//! waiting until something holds.

#![allow(clippy::print_stderr, reason = "says why a test was skipped")]

mod replay;

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, WindowOptions};
use plumbline_engine::watched::Trial;
use plumbline_engine::{Engine, EngineSettings, View};
use plumbline_twin::eyes::{EyeOptions, EyeRenderer, RenderError};

pub use replay::Beginning;

/// The window, drawn in memory.
pub type Window = Harness<'static, PlumblineWindow>;

/// A run of touches takes minutes, and drawing on the processor is slow.
const PATIENCE: Duration = Duration::from_secs(600);

/// `PLUMBLINE_PATIENCE_S` for who looks for what a test waits for.
fn patience() -> Duration {
    let wanted = std::env::var("PLUMBLINE_PATIENCE_S").ok().and_then(|s| s.parse().ok());
    wanted.map_or(PATIENCE, Duration::from_secs)
}

/// The window over the real engine; with the twin of a scenario, if one is named.
pub fn window(data_dir: &Path, twin: Option<&str>) -> Window {
    window_on_trial(data_dir, twin, Trial::default())
}

/// The same over threads that the test can let fail.
pub fn window_on_trial(data_dir: &Path, twin: Option<&str>, trial: Trial) -> Window {
    built(data_dir, twin, trial, egui::vec2(1280.0, 800.0))
}

/// The same in another size, pt.
pub fn window_of_size(data_dir: &Path, twin: Option<&str>, size: egui::Vec2) -> Window {
    built(data_dir, twin, Trial::default(), size)
}

fn built(data_dir: &Path, twin: Option<&str>, trial: Trial, size: egui::Vec2) -> Window {
    let settings =
        EngineSettings { data_dir: Some(data_dir.to_owned()), source: None, twin: twin.map(str::to_owned) };
    Harness::builder().with_size(size).build_eframe(move |creation| {
        let engine = Engine::start_on_trial(settings, Arc::new(|| {}), trial);
        PlumblineWindow::new(&creation.egui_ctx, Box::new(engine), WindowOptions::default())
    })
}

/// Processor time that this thread has used so far; `None` where the system does not tell.
pub fn thread_processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// What the window shows just now.
pub fn view(window: &Window) -> Arc<View> {
    window.state().view().clone()
}

/// Draws frames until something holds.
///
/// # Panics
/// When it does not within ten minutes; the messages of the window are told.
pub fn until(window: &mut Window, what: &str, holds: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    loop {
        window.step();
        if holds(window) {
            return;
        }
        if start.elapsed() > patience() {
            let view = view(window);
            panic!(
                "waited in vain for {what}; robot {:?}, jobs {:?}, messages {:?}; it shows {:?}",
                view.robot.motion,
                view.jobs,
                view.notices,
                labels(window)
            );
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// What the window says, top to bottom as it was drawn; what cannot be pressed in brackets.
fn labels(window: &Window) -> Vec<String> {
    let all = window.query_all_by(|node| node.label().is_some_and(|label| !label.is_empty()));
    let told = all.map(|node| {
        let label = node.accesskit_node().label().unwrap_or_default();
        if is_enabled(node) { label } else { format!("[{label}]") }
    });
    told.collect()
}

/// Draws frames for some time.
pub fn for_a_while(window: &mut Window, time: Duration) {
    let start = Instant::now();
    until(window, "time to pass", |_| start.elapsed() > time);
}

/// Clicks what has exactly this label, once it is there and can be.
pub fn click(window: &mut Window, label: &str) {
    press(window, label, |window, label| window.query_all_by_label(label).next());
}

/// Clicks the first thing whose label has these words, once it is there and can be.
pub fn click_containing(window: &mut Window, words: &str) {
    press(window, words, |window, words| window.query_all_by_label_contains(words).next());
}

/// Presses what is found as a hand would: again, if it moved away or began to rest while the finger was
/// on its way, which the engine's threads decide and not the test. `what` is given to `find`.
pub fn press(
    window: &mut Window,
    what: &str,
    find: impl for<'w> Fn(&'w Window, &'w str) -> Option<Node<'w>>,
) {
    let place = |window: &Window| find(window, what).filter(|node| is_enabled(*node)).map(|node| node.rect());
    let start = Instant::now();
    while start.elapsed() < patience() {
        until(window, what, |window| place(window).is_some());
        let aimed = place(window).expect("just seen");
        window.event(egui::Event::PointerMoved(aimed.center()));
        window.event(finger(aimed, true));
        window.step();
        // What is pressed may be drawn a little larger.
        let stayed = place(window).is_some_and(|now| now.center().distance(aimed.center()) < 3.0);
        if !stayed {
            window.event(egui::Event::PointerGone);
        }
        window.event(finger(aimed, false));
        window.step();
        let pressed = stayed && is_click_taken(window);
        window.run_steps(2);
        if pressed {
            return;
        }
    }
    panic!("{what} moved away from the finger, or began to rest, for as long as anybody waits");
}

fn finger(aimed: egui::Rect, pressed: bool) -> egui::Event {
    let (pos, button) = (aimed.center(), egui::PointerButton::Primary);
    egui::Event::PointerButton { pos, button, pressed, modifiers: egui::Modifiers::default() }
}

/// Whether a widget was told of the click that the last frame brought.
fn is_click_taken(window: &Window) -> bool {
    let clicked = window.ctx.interaction_snapshot(|snapshot| snapshot.clicked);
    clicked.and_then(|id| window.ctx.read_response(id)).is_some_and(|response| response.clicked())
}

fn is_enabled(node: Node<'_>) -> bool {
    !node.accesskit_node().is_disabled()
}

/// Types a path, or other text, into the field that has the focus, in place of what stands there.
pub fn type_over(window: &mut Window, text: impl AsRef<OsStr>) {
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.run_steps(1);
    window.event(egui::Event::Text(text.as_ref().to_str().expect("text in letters").to_owned()));
    window.run_steps(2);
}

/// Draws what the twin's eyes see; `None`, with a word on the console, where nothing can draw.
///
/// # Panics
/// When there is something to draw with, and it does not work.
pub fn eye_renderer() -> Option<EyeRenderer> {
    match EyeRenderer::new(EyeOptions::default()) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter) => {
            plumbline_model::measured_data::left_out("no Vulkan device on this machine");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

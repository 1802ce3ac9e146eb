//! The touch window among the others: opening it on the right monitor, and handing on what it felt.

use egui::{Key, ViewportBuilder, ViewportClass, ViewportCommand, ViewportId};
use plumbline_engine::{Command, ScreenWindow, TouchCommand};
use plumbline_model::session::Touchscreen;

use super::{TouchSurface, prompt, touch_surface};
use crate::operator::{Action, Monitor, Screen, StopKeys, screen_of, shortcuts};
use crate::window::{PlumblineWindow, icon};

/// Size of the window where it is only tried out, points.
const TRIED_OUT: [f32; 2] = [960.0, 540.0];

/// What was asked for in it during a frame.
#[derive(Default)]
struct Asked {
    commands: Vec<TouchCommand>,
    window: Option<ScreenWindow>,
    stop: bool,
    close: bool,
    answered: Option<Action>,
}

impl PlumblineWindow {
    /// Draws the touch window while it is open, and tells the engine of it.
    pub(crate) fn show_touch_window(&mut self, ctx: &egui::Context) {
        if !self.panels.touch.window_open {
            if self.touch_window.told.take().is_some() {
                self.backend.send(TouchCommand::Window(None).into());
                self.touch_window.surface = TouchSurface::default();
            }
            return;
        }
        let view = self.view.clone();
        let screen = screen_of(&view).cloned();
        let surface = &mut self.touch_window.surface;
        let builder = builder(self.panels.touch.monitor);
        let id = ViewportId::from_hash_of("touch window");
        let asked = ctx.show_viewport_immediate(id, builder, |ui, class| {
            let window = window_of(ui, class);
            let (commands, answered) = match prompt::prompt(&view) {
                Some(prompt) => (vec![], prompt::show(ui, &prompt)),
                None => (touch_surface(ui, &view.touch, screen.as_ref(), &window, surface), None),
            };
            let stop =
                class != ViewportClass::EmbeddedWindow && shortcuts::stop_asked(ui.ctx(), StopKeys::ALWAYS);
            keys(ui, class, window.full_screen);
            let close = ui.input(|input| input.viewport().close_requested());
            Asked {
                commands,
                window: Some(window),
                stop,
                close: close && class != ViewportClass::EmbeddedWindow,
                answered,
            }
        });
        if let Some(action) = asked.answered {
            self.act(ctx, action);
        }
        self.take_asked(asked);
    }

    fn take_asked(&mut self, asked: Asked) {
        if asked.stop {
            self.stop();
        }
        for command in asked.commands {
            self.backend.send(Command::Touch(command));
        }
        if asked.close {
            self.panels.touch.window_open = false;
        } else if asked.window != self.touch_window.told {
            self.touch_window.told = asked.window.clone();
            self.backend.send(TouchCommand::Window(asked.window).into());
        }
    }

    /// Looks for monitors while they can be chosen.
    pub(crate) fn find_monitors(&mut self, frame: &eframe::Frame, now_s: f64) {
        let touch = &mut self.panels.touch;
        if self.settings.screen != Screen::Touch || touch.window_open || now_s < self.monitors_found_s + 2.0 {
            return;
        }
        self.monitors_found_s = now_s;
        let Some(window) = frame.winit_window() else { return };
        let ours = window.current_monitor().and_then(|monitor| monitor.name());
        let describe = |(i, name, size): (usize, Option<String>, [u32; 2])| Monitor {
            is_ours: name.is_some() && name == ours,
            name: name.unwrap_or_else(|| format!("monitor {}", i + 1)),
            size_px: size,
        };
        let found = window.available_monitors().enumerate();
        let found = found.map(|(i, monitor)| (i, monitor.name(), monitor.size().into()));
        touch.monitors = found.map(describe).collect();
        if !touch.monitor_chosen {
            touch.monitor = likely(&touch.monitors, screen_of(&self.view));
        }
    }
}

/// The touch monitor, as far as can be told: another one than ours, of the screen's size.
fn likely(monitors: &[Monitor], screen: Option<&Touchscreen>) -> Option<usize> {
    let others = || monitors.iter().enumerate().filter(|(_, monitor)| !monitor.is_ours);
    let size = screen.map(|screen| [screen.width_px, screen.height_px]);
    let fits = others().find(|(_, monitor)| Some(monitor.size_px) == size);
    fits.or_else(|| others().next()).map(|(i, _)| i).filter(|_| monitors.len() > 1)
}

fn builder(monitor: Option<usize>) -> ViewportBuilder {
    let builder = ViewportBuilder::default()
        .with_title("Plumbline touch window")
        .with_app_id("plumbline")
        .with_icon(icon::icon())
        .with_inner_size(TRIED_OUT);
    match monitor {
        Some(index) => builder.with_monitor(index),
        None => builder,
    }
}

/// As the window system has it, in physical pixels.
fn window_of(ui: &egui::Ui, class: ViewportClass) -> ScreenWindow {
    let embedded = class == ViewportClass::EmbeddedWindow;
    let rect = if embedded { ui.available_rect_before_wrap() } else { ui.ctx().viewport_rect() };
    let size = rect.size() * ui.ctx().pixels_per_point();
    let full_screen = !embedded && ui.input(|input| input.viewport().fullscreen).unwrap_or(false);
    ScreenWindow { width_px: size.x.round() as u32, height_px: size.y.round() as u32, full_screen }
}

fn keys(ui: &egui::Ui, class: ViewportClass, full_screen: bool) {
    if class != ViewportClass::EmbeddedWindow && ui.input(|input| input.key_pressed(Key::F11)) {
        ui.ctx().send_viewport_cmd(ViewportCommand::Fullscreen(!full_screen));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitor(name: &str, size_px: [u32; 2], is_ours: bool) -> Monitor {
        Monitor { name: name.to_owned(), size_px, is_ours }
    }

    fn screen() -> Touchscreen {
        plumbline_model::robot::Rig::built_in("nico").expect("comes with the program").touchscreen
    }

    #[test]
    fn the_other_monitor_of_the_right_size_is_the_likely_one() {
        let screen = screen();
        let fitting = [screen.width_px, screen.height_px];
        let ours = monitor("A", fitting, true);
        let small = monitor("B", [1280, 800], false);
        let touch = monitor("C", fitting, false);
        let of = |monitors: &[Monitor]| likely(monitors, Some(&screen));
        assert_eq!(of(&[ours.clone(), small.clone(), touch]), Some(2));
        assert_eq!(of(&[small, ours.clone()]), Some(0));
        assert_eq!(of(&[ours]), None);
    }
}

//! What is done once per frame.

use std::path::PathBuf;
use std::time::Duration;

use plumbline_engine::view::MotionState;
use plumbline_model::duration;

use super::{
    PlumblineWindow, apply, commission, drop, frame_time, frame_times_overlay, health, inspector, jogging,
    rail, status_line, tiles, transport, truth_band,
};
use crate::operator::{Outbox, Screen, StopKeys, shortcuts};

/// The arm holds without a sign of life from the window; this often it gets one while something
/// moves.
const SIGN_OF_LIFE: Duration = Duration::from_millis(100);
/// For this long after a motion was asked for, the window expects it to begin.
const BEGINS_WITHIN: Duration = Duration::from_secs(2);

impl PlumblineWindow {
    fn before_frame(&mut self, ctx: &egui::Context) {
        // Before anything that takes time.
        if shortcuts::stop_asked(ctx, self.stop_keys(ctx)) {
            self.backend.stop();
        }
        self.ask_before_closing(ctx);
        self.backend.heartbeat();
        self.view = self.backend.view();
        if let Some(answer) = self.dialogs.poll() {
            self.take_answer(ctx, answer);
        }
        self.notices.take(&self.view.notices);
        self.notices.see_stop(self.view.robot.stopped);
        self.go_on_taking(ctx);
        self.log.refresh(self.settings.log_open);
        self.follow_the_work();
        match self.script.next(&self.view, ctx) {
            Ok(Some(step)) => self.do_script_step(ctx, step),
            Ok(None) => {}
            Err(stuck) => self.script_stuck(&stuck),
        }
        self.poll_gamepad(ctx);
        // Ages and clocks move on although nothing else does.
        ctx.request_repaint_after(if self.may_move() { SIGN_OF_LIFE } else { Duration::from_secs(1) });
    }

    /// Whether something moves or is about to, so that the window has to keep drawing.
    fn may_move(&self) -> bool {
        matches!(self.view.robot.motion, MotionState::Moving { .. })
            || self.jogging.active()
            || self.motion_asked.is_some_and(|asked| asked.elapsed() < BEGINS_WITHIN)
    }

    /// Whether something moves, or goes on moving by itself.
    pub(super) fn moves(&self) -> bool {
        status_line::moves(&self.view) || self.may_move()
    }

    /// Esc closes what lies on top; it stops where nothing does, and always where something moves. Space
    /// always stops, but where nothing moves a text that is typed gets it.
    fn stop_keys(&self, ctx: &egui::Context) -> StopKeys {
        let lies_on_top = self.ask.is_some()
            || self.palette.is_open()
            || self.manual.is_open()
            || self.notices.is_history_open()
            || egui::Popup::is_any_open(ctx);
        let moves = self.moves();
        StopKeys { escape: moves || !lies_on_top, moves }
    }

    /// Only the robot's screen is jogged with one; its STOP counts everywhere.
    fn poll_gamepad(&mut self, ctx: &egui::Context) {
        if self.gamepads.take_stop() {
            self.stop();
        }
        if let Some(trouble) = self.gamepads.take_trouble() {
            self.backend.send(apply::warning(trouble));
        }
        let wanted = self.settings.screen == Screen::Robot;
        let is_focused = ctx.input(|input| input.focused);
        let state = wanted.then(|| self.gamepads.newest(is_focused)).flatten();
        if let Some(pad) = &state {
            ctx.request_repaint_after(if pad.enabled { jogging::RENEW } else { SIGN_OF_LIFE });
        }
        self.panels.robot.gamepad = state;
    }

    /// What the last frame took: everything that this thread did since the one before.
    fn measure_frame(&mut self, clock_s: Option<f32>) {
        let used = frame_time::thread_processor_time();
        let took = match (used, self.processor_time_before) {
            (Some(now), Some(before)) => now.checked_sub(before),
            (Some(_), None) => None,
            (None, _) => clock_s.and_then(|clock_s| duration::seconds(clock_s.into())),
        };
        self.processor_time_before = used;
        if let Some(took) = took {
            self.frame_times.add(took);
        }
    }

    fn draw(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let escape_pressed = ctx.input(|input| input.key_pressed(egui::Key::Escape));
        let mut outbox = Outbox::default();
        if self.settings.screen == Screen::Images && self.ask.is_none() && !self.palette.is_open() {
            for action in shortcuts::take_label_keys(&ctx, &self.view) {
                outbox.act(action);
            }
        }
        for action in shortcuts::take_shortcuts(&ctx, self.stop_keys(&ctx)) {
            outbox.act(action);
        }
        self.draw_frame(ui, &mut outbox);
        // A click beside a sheet closes the sheet and does nothing else: what lies below may move the arm.
        let is_covered = self.ask.is_some() || self.palette.is_open() || self.notices.is_history_open();
        if is_covered && ctx.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
            outbox.keep_what_halts();
        }
        self.show_touch_window(&ctx);
        self.draw_sheets(&ctx, escape_pressed, &mut outbox);
        self.take_drops(&ctx, &mut outbox);
        self.carry_out(&ctx, outbox);
        self.save_settings_if_changed(&ctx);
    }

    fn draw_frame(&mut self, ui: &mut egui::Ui, outbox: &mut Outbox) {
        health::show(self, ui, outbox);
        truth_band::show(self, ui, outbox);
        commission::show(self, ui, outbox);
        status_line::show(self, ui, outbox);
        if self.settings.log_open {
            self.log.show(ui);
        }
        rail::show(self, ui, outbox);
        if self.settings.inspector_open {
            inspector::show(self, ui, outbox);
        }
        if self.view.source.replay.is_some() {
            transport::show(&self.view, ui, outbox);
        }
        tiles::show(self, ui, outbox);
    }

    fn draw_sheets(&mut self, ctx: &egui::Context, escape_pressed: bool, outbox: &mut Outbox) {
        if let Some(action) = self.palette.show(ctx, &self.view, escape_pressed) {
            outbox.act(action);
        }
        // They would lie in the picture of a tile.
        if !self.taking.waits_for_picture() {
            let beside = self.settings.inspector_open.then_some(self.inspector_width);
            self.notices.show_new(ctx, beside);
        }
        self.notices.show_history(ctx, escape_pressed, outbox);
        // Esc closes what lies on top of help first.
        let on_top = self.ask.is_some() || self.palette.is_open() || self.notices.is_history_open();
        self.manual.show(ctx, self.settings.screen, escape_pressed && !on_top);
        self.show_ask(ctx, escape_pressed, outbox);
        if self.frame_times_open {
            frame_times_overlay::show(ctx, &self.frame_times, &self.renderer);
        }
    }

    fn take_drops(&mut self, ctx: &egui::Context, outbox: &mut Outbox) {
        let (hovered, dropped) = ctx.input(|input| {
            let hovered: Vec<PathBuf> =
                input.raw.hovered_files.iter().filter_map(|file| file.path.clone()).collect();
            let dropped: Vec<PathBuf> =
                input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect();
            (hovered, dropped)
        });
        if !hovered.is_empty() {
            drop::paint_preview(ctx, &drop::preview(&hovered, self.settings.screen));
        }
        if !dropped.is_empty() {
            match drop::command_for(&dropped, self.settings.screen) {
                Ok(command) => outbox.send(command),
                Err(why) => outbox.send(apply::warning(why)),
            }
        }
    }
}

impl eframe::App for PlumblineWindow {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        self.measure_frame(frame.info().cpu_usage);
        self.before_frame(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.find_monitors(frame, ui.input(|input| input.time));
        self.draw(ui);
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.save_settings();
        self.write_frame_report();
    }
}

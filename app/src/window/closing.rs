//! What is asked before the window closes: whether what moves is held first, and whether what was solved and not
//! accepted may be lost, and what a hand holds may be left to itself.

use super::PlumblineWindow;
use super::ask::Ask;
use super::unaccepted::lost_by_closing;

impl PlumblineWindow {
    /// A window that closes would leave what moves to itself, and forget what was not accepted.
    pub(super) fn ask_before_closing(&mut self, ctx: &egui::Context) {
        if self.closes || !ctx.input(|input| input.viewport().close_requested()) {
            return;
        }
        let ask = if self.moves() {
            Ask::CloseWhileMoving
        } else if lost_by_closing(&self.view).is_some() {
            Ask::CloseUnaccepted
        } else {
            return;
        };
        ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        self.ask = Some(ask);
    }

    /// Holds what moves, and closes.
    pub(super) fn hold_and_close(&mut self, ctx: &egui::Context) {
        self.stop();
        self.close(ctx);
    }

    /// Closes without asking again.
    pub(super) fn close(&mut self, ctx: &egui::Context) {
        self.closes = true;
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

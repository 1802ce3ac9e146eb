//! A sheet that floats over the window. It has no backdrop: nothing may ever cover STOP.

use egui::{Align2, Area, Button, Context, Frame, Id, Margin, Order, RichText, Ui, Vec2};
use plumbline_engine::Command;
use plumbline_widgets::buttons::accent_button;
use plumbline_widgets::theme::{self, Role, space};

use super::dialogs::Answer;

/// What came of a sheet in this frame.
pub struct SheetResponse<R> {
    /// What its contents returned.
    pub inner: R,
    /// Escape was pressed, or a click went elsewhere.
    pub close: bool,
}

/// Draws a sheet of `width` points.
pub fn sheet<R>(
    ctx: &Context,
    name: &str,
    anchor: (Align2, Vec2),
    width: f32,
    escape_pressed: bool,
    contents: impl FnOnce(&mut Ui) -> R,
) -> SheetResponse<R> {
    let area = Area::new(Id::unique(("sheet", name)))
        .order(Order::Foreground)
        .anchor(anchor.0, anchor.1)
        .show(ctx, |ui| {
            let frame = Frame::popup(ui.style()).inner_margin(Margin::same(space::M as i8));
            frame
                .show(ui, |ui| {
                    ui.set_width(width);
                    contents(ui)
                })
                .inner
        });
    let close = escape_pressed || area.response.clicked_elsewhere() && !egui::Popup::is_any_open(ctx);
    SheetResponse { inner: area.inner, close }
}

/// What a sheet ended with.
#[derive(Debug)]
pub enum Asked {
    /// Goes on.
    Open,
    /// Closed without an answer.
    Closed,
    /// For the engine.
    Command(Command),
    /// For the engine; the sheet shows what comes of it.
    CommandKeepOpen(Command),
    /// What moves is held, then the window closes.
    HoldAndClose,
    /// The window closes, whatever is open.
    Close,
    /// Paths for the window to use.
    Answer(Answer),
}

/// What is asked, and what to know about it.
pub(super) fn title(ui: &mut Ui, title: &str, hint: &str) {
    ui.heading(title);
    ui.label(theme::weak(ui, hint));
    ui.add_space(space::S);
}

/// Height of the row of buttons at the end of a sheet, points.
const BUTTON_ROW_HEIGHT: f32 = 36.0;

/// The one button of a sheet that asks nothing.
pub(super) fn close_button(ui: &mut Ui) -> bool {
    ui.add_space(space::S);
    let row = egui::vec2(ui.available_width(), BUTTON_ROW_HEIGHT);
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    ui.allocate_ui_with_layout(row, layout, |ui| ui.add(accent_button(ui, "Close")).clicked()).inner
}

/// `Some(true)` when the work was asked for, `Some(false)` when it was called off.
pub(super) fn buttons(ui: &mut Ui, verb: &str, enabled: bool) -> Option<bool> {
    let accent = accent_button(ui, verb);
    let cancel = Button::new("Cancel");
    row_of(ui, accent, enabled, cancel)
}

/// The one button of a sheet on which nothing is left to do.
pub(super) fn done_button(ui: &mut Ui) -> bool {
    ui.add_space(space::S);
    let row = egui::vec2(ui.available_width(), BUTTON_ROW_HEIGHT);
    let right = egui::Layout::right_to_left(egui::Align::Center);
    ui.allocate_ui_with_layout(row, right, |ui| ui.add(accent_button(ui, "Done")).clicked()).inner
}

/// As [`buttons`], where what was asked for may hurt or cannot be taken back: calling it off is what stands out.
pub(super) fn buttons_with_care(ui: &mut Ui, verb: &str) -> Option<bool> {
    let color = Role::Warning.color(theme::tokens(ui));
    let cancel = accent_button(ui, "Cancel");
    row_of(ui, Button::new(RichText::new(verb).color(color)), true, cancel)
}

fn row_of(ui: &mut Ui, done: Button<'_>, enabled: bool, cancel: Button<'_>) -> Option<bool> {
    ui.add_space(space::S);
    // One row high: left alone, the layout would take all the height there is and push the rest out.
    let row = egui::vec2(ui.available_width(), BUTTON_ROW_HEIGHT);
    ui.allocate_ui_with_layout(row, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let done = ui.add_enabled(enabled, done).clicked();
        let cancelled = ui.add(cancel).clicked();
        if done { Some(true) } else { cancelled.then_some(false) }
    })
    .inner
}

//! A sheet that floats over the window. It has no backdrop: nothing may ever cover STOP.

use egui::{Align2, Area, Context, Frame, Id, Margin, Order, Ui, Vec2};
use plumbline_widgets::theme::space;

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

//! Mouse and keyboard of an image view.

use egui::{EventFilter, Key, Rect, Response, Ui, Vec2, vec2};

use super::ViewState;

/// Points on the screen per press of an arrow key.
const KEY_STEP: f32 = 40.0;
/// Scroll distance, in points, that magnifies e times.
const SCROLL_PER_E: f64 = 240.0;

/// Wheel and pinch zoom towards the pointer, drag moves, double click fits; with keyboard
/// focus: + and -, arrows, 0.
pub(super) fn handle(
    ui: &mut Ui,
    response: &Response,
    rect: Rect,
    view: &mut ViewState,
    size_px: [usize; 2],
) {
    if let Some(pointer) = response.hover_pos() {
        // Taken away, so that a scroll area around the view does not scroll as well.
        let (scroll, pinch) = ui.input_mut(|input| {
            (std::mem::take(&mut input.smooth_scroll_delta), f64::from(input.zoom_delta()))
        });
        let factor = pinch * (f64::from(scroll.y) / SCROLL_PER_E).exp();
        if factor != 1.0 {
            view.zoom(factor, pointer, size_px, rect);
        }
    }
    if response.dragged() && response.drag_delta() != Vec2::ZERO && !view.is_fit() {
        view.pan(response.drag_delta(), size_px, rect);
    }
    if response.double_clicked() {
        view.fit();
    }
    if response.has_focus() {
        keys(ui, response, rect, view, size_px);
    }
}

fn keys(ui: &Ui, response: &Response, rect: Rect, view: &mut ViewState, size_px: [usize; 2]) {
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let presses = |key| ui.input(|input| input.num_presses(key)) as i32;
    let nearer = presses(Key::Plus) + presses(Key::Equals) - presses(Key::Minus);
    if nearer != 0 {
        view.zoom(1.5f64.powi(nearer), rect.center(), size_px, rect);
    }
    let step = |less, more| (presses(less) - presses(more)) as f32 * KEY_STEP;
    let by = vec2(step(Key::ArrowLeft, Key::ArrowRight), step(Key::ArrowUp, Key::ArrowDown));
    if by != Vec2::ZERO && !view.is_fit() {
        view.pan(by, size_px, rect);
    }
    if presses(Key::Num0) > 0 {
        view.fit();
    }
}

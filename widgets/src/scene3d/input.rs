//! Mouse and keyboard of the scene.

use egui::{EventFilter, Key, PointerButton, Response, Ui, Vec2, vec2};

use super::camera::{SceneCamera, ViewPreset};

/// Radians per point of dragging: across a usual view is half a turn.
const ORBIT_PER_POINT: f64 = 0.006;
/// Scroll distance, in points, that goes e times nearer.
const SCROLL_PER_E: f64 = 300.0;
/// Per press of an arrow key.
const KEY_ORBIT_RAD: f64 = 0.13;
const KEY_PAN: f32 = 40.0;
const KEY_ZOOM: f64 = 1.25;

/// Drag turns; drag with shift or the middle button moves; wheel and pinch go nearer. With
/// keyboard focus: arrows turn, with shift move, + and − go nearer and away, 0 resets.
pub(super) fn handle(ui: &mut Ui, response: &Response, camera: &mut SceneCamera) {
    if response.hover_pos().is_some() {
        // Taken away, so that a scroll area around the view does not scroll as well.
        let (scroll, pinch) = ui.input_mut(|input| {
            (std::mem::take(&mut input.smooth_scroll_delta), f64::from(input.zoom_delta()))
        });
        let factor = pinch * (f64::from(scroll.y) / SCROLL_PER_E).exp();
        if factor != 1.0 {
            camera.zoom(factor);
        }
    }
    let shift = ui.input(|input| input.modifiers.shift);
    let by = response.drag_delta();
    if by != Vec2::ZERO {
        let left = response.dragged_by(PointerButton::Primary);
        if response.dragged_by(PointerButton::Middle) || (left && shift) {
            camera.pan(by, response.rect.size());
        } else if left {
            orbit(camera, by);
        }
    }
    if response.has_focus() {
        keys(ui, response, camera, shift);
    }
}

/// The scene turns with the pointer: to the right, the camera goes to the left.
fn orbit(camera: &mut SceneCamera, by: Vec2) {
    camera.orbit(-f64::from(by.x) * ORBIT_PER_POINT, f64::from(by.y) * ORBIT_PER_POINT);
}

fn keys(ui: &Ui, response: &Response, camera: &mut SceneCamera, shift: bool) {
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let presses = |key| ui.input(|input| input.num_presses(key)) as i32;
    let nearer = presses(Key::Plus) + presses(Key::Equals) - presses(Key::Minus);
    if nearer != 0 {
        camera.zoom(KEY_ZOOM.powi(nearer));
    }
    let net = |less, more| (presses(more) - presses(less)) as f32;
    let by = vec2(net(Key::ArrowLeft, Key::ArrowRight), net(Key::ArrowUp, Key::ArrowDown));
    if by != Vec2::ZERO && shift {
        camera.pan(-by * KEY_PAN, response.rect.size());
    } else if by != Vec2::ZERO {
        camera.orbit(f64::from(by.x) * KEY_ORBIT_RAD, -f64::from(by.y) * KEY_ORBIT_RAD);
    }
    if presses(Key::Num0) > 0 {
        *camera = SceneCamera::preset(ViewPreset::Home);
    }
}

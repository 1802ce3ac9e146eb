//! The aimed pair, side by side or one above the other: rows are epipolar lines.

use egui::{Align, Layout, Ui, vec2};
use plumbline_engine::view::RectifiedView;
use plumbline_engine::{ProbePoint, Products, View};
use plumbline_model::Eye;
use plumbline_widgets::compare::epipolar_lines;
use plumbline_widgets::empty::Message;
use plumbline_widgets::image_view::{Content, ImageView, ViewState};
use plumbline_widgets::overlay::Overlay;
use plumbline_widgets::theme::Role;

use super::{PanelContext, objects, picture, source_state};
use crate::operator::{Action, Outbox, Pane, Screen};

const PAIR: &str = "Rectified pair";
/// Between the two pictures, pt.
const GAP: f32 = 2.0;
/// By so much the pictures must grow to stand one above the other.
const MUCH_LARGER: f32 = 1.3;
/// Distance of the lines, pixels.
const LINES_EVERY_PX: usize = 40;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { rectified: true, ..Products::default() });
    let view = cx.view;
    let Some(rectified) = &view.live.rectified else {
        return show_missing(ui, cx, PAIR);
    };
    let stale = source_state::stale_sentence(view);
    let room = ui.available_size();
    let across = is_across([rectified.left.width(), rectified.left.height()], room);
    let size = match across {
        true => vec2((room.x - GAP) / 2.0, room.y),
        false => vec2(room.x, (room.y - GAP) / 2.0),
    };
    ui.spacing_mut().item_spacing = vec2(GAP, GAP);
    let layout = match across {
        true => Layout::left_to_right(Align::Min),
        false => Layout::top_down(Align::Min),
    };
    ui.with_layout(layout, |ui| {
        for eye in Eye::BOTH {
            one_eye(ui, cx, rectified, eye, size, stale.as_deref());
        }
    });
}

/// Whether the two stand side by side, where their rows meet, rather than one above the other: where that
/// makes them much larger.
fn is_across([width, height]: [u32; 2], room: egui::Vec2) -> bool {
    let scale = |room: egui::Vec2| (room.x / width.max(1) as f32).min(room.y / height.max(1) as f32);
    let (beside, above) = (scale(vec2(room.x / 2.0, room.y)), scale(vec2(room.x, room.y / 2.0)));
    above < MUCH_LARGER * beside
}

fn one_eye(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    rectified: &RectifiedView,
    eye: Eye,
    size: egui::Vec2,
    stale: Option<&str>,
) {
    let (key, label, image) = match eye {
        Eye::Left => ("rectified left", "Left", &rectified.left),
        Eye::Right => ("rectified right", "Right", &rectified.right),
    };
    let picture = cx.state.textures.rgb(key, picture::seq(&rectified.stamp), image);
    let mut overlay = Overlay::new();
    if cx.state.live.epipolar_lines {
        overlay.append(epipolar_lines(picture.size_px(), LINES_EVERY_PX));
    }
    if cx.screen == Screen::Live {
        overlay.append(objects::rectified(cx.view, &cx.state.objects, eye));
    }
    overlay.append(probe_mark(cx.view, eye));
    let shown = ImageView::new(label, Content::Picture(picture))
        .overlay(&overlay)
        .stale(stale)
        .size(size)
        .crop()
        .show(ui, cx.state.views.entry((cx.screen, Pane::Rectified)).or_default());
    if eye == Eye::Left {
        take_probe(cx, shown.hover_px, shown.clicked_px);
    }
}

/// Measures under the mouse in the rectified left image, or keeps the clicked point.
pub fn take_probe(cx: &mut PanelContext<'_>, hover_px: Option<[f64; 2]>, clicked_px: Option<[f64; 2]>) {
    if cx.screen != Screen::Live {
        return;
    }
    let point = |at: [f64; 2]| ProbePoint::Rectified { u_px: at[0], v_px: at[1] };
    cx.outbox.probe = hover_px.map(point).or(cx.outbox.probe);
    if let Some(at) = clicked_px {
        cx.state.probe.toggle_pin(point(at));
    }
}

/// The measured point in one of the rectified images.
pub fn probe_mark(view: &View, eye: Eye) -> Overlay {
    let mut overlay = Overlay::new();
    let reading = view.live.probe.as_ref().and_then(|probe| probe.reading.as_ref().ok());
    if let Some((left, disparity_px)) = reading.and_then(|r| r.left_rectified.zip(r.disparity_px)) {
        let shift = if eye == Eye::Left { 0.0 } else { disparity_px };
        overlay.plus([left.u_px - shift, left.v_px], Role::Measured);
    }
    overlay
}

/// What stands in a panel that needs the rectified pair while there is none.
pub fn show_missing(ui: &mut Ui, cx: &mut PanelContext<'_>, label: &str) {
    let view = cx.view;
    let (content, calibrate) = missing(view, label == PAIR);
    let clicked = ImageView::new(label, content).show(ui, &mut ViewState::default()).button_clicked;
    if clicked {
        press(view, calibrate, cx.outbox);
    }
}

fn missing(view: &View, first: bool) -> (Content<'_>, bool) {
    // The button stands once on the screen.
    let eye = if first { Eye::Left } else { Eye::Right };
    if view.eyes.in_use.is_none() {
        let message = Message::new(
            "The eyes are not calibrated",
            "Distances need a calibration: collect pairs of a chessboard and solve them, or import a file.",
        );
        let message = if first { message.button("Calibrate the eyes") } else { message };
        return (Content::Empty(message), true);
    }
    if view.live.raw.is_none() {
        return (source_state::without_image(view, eye), false);
    }
    match &view.live.no_rectified_because {
        Some(why) => (Content::Failed(Message::new("The pair cannot be rectified", why)), false),
        None => (Content::Loading("Rectifying"), false),
    }
}

fn press(view: &View, calibrate: bool, outbox: &mut Outbox) {
    if calibrate {
        outbox.act(Action::Go(Screen::Collect));
    } else {
        source_state::button_clicked(view, outbox);
    }
}

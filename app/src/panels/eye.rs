//! One eye as its camera delivers it: with the measured point on the Live screen, with the
//! corners of the board and where to hold it next while collecting.

use egui::Ui;
use plumbline_engine::view::{CaptureHint, CollectedPair};
use plumbline_engine::{ProbePoint, Products};
use plumbline_model::{Eye, Pixel, Raw};
use plumbline_widgets::ghost::{Ghost, ghost};
use plumbline_widgets::image_view::{Content, ImageView};
use plumbline_widgets::overlay::{Mark, Overlay, PointShape};
use plumbline_widgets::theme::Role;

use super::{PanelContext, grasp, objects, picture, residuals, source_state};
use crate::operator::{Pane, Screen, wanted_board};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>, eye: Eye) {
    let collecting = matches!(cx.screen, Screen::Collect | Screen::Mount);
    let chosen = cx.state.chosen_pair.as_deref().filter(|_| cx.screen == Screen::Collect);
    if let Some(pair) = chosen.and_then(|name| residuals::collected(&cx.view.eyes, name)) {
        return collected_pair(ui, cx, &pair, eye);
    }
    if collecting {
        cx.outbox.want(Products { corners: true, ..Products::default() });
    }
    let on_live = cx.screen == Screen::Live;
    let grasping = cx.screen == Screen::Grasp;
    if (on_live && cx.state.objects.shown) || (grasping && grasp::wants_detections(cx.view)) {
        cx.outbox.want(Products { detections: true, ..Products::default() });
    }
    let pane = if eye == Eye::Left { Pane::LeftEye } else { Pane::RightEye };
    let view = cx.view;
    let label = if eye == Eye::Left { "Left eye, as delivered" } else { "Right eye, as delivered" };
    let mut overlay = if collecting { board_marks(cx, eye) } else { probe_marks(cx, eye) };
    let stale = source_state::stale_sentence(view);
    let mut note = None;
    if on_live {
        let mut boxes = objects::raw(view, &cx.state.objects, eye);
        boxes.append(overlay);
        overlay = boxes;
        note = objects::stale(view, &cx.state.objects);
    }
    if grasping {
        let boxes = grasp::overlay(view, eye);
        let focused = grasp::focused(view, &cx.state.objects);
        overlay = boxes.unwrap_or_else(|| objects::raw_boxes(view, &cx.state.objects, eye, focused));
    }
    let picture = view.live.raw.as_ref().map(|frame| {
        let image = if eye == Eye::Left { &frame.left } else { &frame.right };
        cx.state.textures.rgb(picture::eye_key(eye), picture::seq(&frame.stamp), image)
    });
    let content = picture.map_or_else(|| source_state::without_image(view, eye), Content::Picture);
    let shown = ImageView::new(label, content)
        .caption(false)
        .overlay(&overlay)
        .stale(stale.as_deref())
        .note(note.as_deref().filter(|_| eye == Eye::Left))
        .crop()
        .show(ui, cx.state.views.entry((cx.screen, pane)).or_default());
    if shown.button_clicked {
        source_state::button_clicked(view, cx.outbox);
    }
    if grasping {
        grasp::hover(cx, eye, &shown);
        grasp::click(view, cx.outbox, eye, shown.clicked_px);
    } else if !collecting {
        let point = |at: [f64; 2]| ProbePoint::Raw { eye, u_px: at[0], v_px: at[1] };
        cx.outbox.probe = shown.hover_px.map(point).or(cx.outbox.probe);
        // A click on a box chooses the object; a point below it is measured by pointing at it.
        let on_box = on_live && cx.state.objects.point(view, eye, shown.hover_px, shown.clicked_px.is_some());
        if let Some(at) = shown.clicked_px.filter(|_| !on_box) {
            cx.state.probe.toggle_pin(point(at));
        }
    }
}

/// A collected pair in place of the live picture, until it is let go.
fn collected_pair(ui: &mut Ui, cx: &mut PanelContext<'_>, pair: &CollectedPair, eye: Eye) {
    let columns = cx.view.eyes.board.inner_columns as usize;
    let mut overlay = Overlay::new();
    if let Some(corners) = pair.corners(eye) {
        let measured: Option<Vec<Pixel<Raw>>> = corners.iter().copied().collect();
        match measured {
            Some(all) => overlay.append(corner_marks(&all, columns, Role::Measured)),
            None => {
                corners.iter().flatten().for_each(|corner| {
                    overlay.point(at(corner), PointShape::Dot, 2.0, Role::Measured);
                });
                &mut overlay
            }
        };
    }
    let label = format!("Pair {}, {eye} eye (choose it again in the list to go back)", pair.name);
    let size = ui.available_size();
    residuals::collected_image(ui, cx, Some(pair), eye, &label, &overlay, size);
}

fn at(pixel: &Pixel<Raw>) -> [f64; 2] {
    [pixel.u_px, pixel.v_px]
}

fn probe_marks(cx: &PanelContext<'_>, eye: Eye) -> Overlay {
    let mut overlay = Overlay::new();
    let Some(probe) = &cx.view.live.probe else { return overlay };
    match &probe.reading {
        Ok(reading) => {
            let pixel = if eye == Eye::Left { &reading.left_raw } else { &reading.right_raw };
            overlay.plus(at(pixel), Role::Measured);
        }
        Err(_) => {
            if let ProbePoint::Raw { eye: asked, u_px, v_px } = probe.asked
                && asked == eye
            {
                overlay.cross([u_px, v_px], Role::Warning);
            }
        }
    }
    overlay
}

/// Corners seen in this eye, and the outline where the board is wanted next.
fn board_marks(cx: &PanelContext<'_>, eye: Eye) -> Overlay {
    let eyes = &cx.view.eyes;
    let mut overlay = Overlay::new();
    if let Some(wanted) = wanted_board(cx.view).filter(|_| cx.screen == Screen::Collect) {
        let outline = if eye == Eye::Left { &wanted.left } else { &wanted.right };
        let outline_px: Vec<[f64; 2]> = outline.iter().map(at).collect();
        overlay.append(ghost(&outline_px, Ghost::Wanted, ""));
    }
    let newest = cx.view.live.raw.as_ref().map(|frame| frame.stamp);
    // Corners of a pair just before still lie about right in a moving picture, but not in the
    // next photograph.
    let behind = if cx.view.source.photographs { 0 } else { 3 };
    let seen =
        cx.view.live.corners.as_ref().filter(|corners| {
            newest.is_some_and(|stamp| stamp.seq.saturating_sub(corners.stamp.seq) <= behind)
        });
    if let Some(corners) = seen.and_then(|seen| seen.corners(eye)) {
        let role = match eyes.hint {
            Some(CaptureHint::Ready | CaptureHint::Captured { .. }) => Role::Accepted,
            _ => Role::Measured,
        };
        overlay.append(corner_marks(corners, eyes.board.inner_columns as usize, role));
    }
    overlay
}

/// Corners in the board's order, joined in the order in which they are numbered, so that a
/// board that was read the wrong way round is seen at once.
pub fn corner_marks(corners: &[Pixel<Raw>], columns: usize, role: Role) -> Overlay {
    let mut overlay = Overlay::new();
    for row in corners.chunks(columns.max(1)) {
        let points_px: Vec<[f64; 2]> = row.iter().map(at).collect();
        if points_px.len() > 1 {
            overlay.push(Mark::Line {
                points_px,
                closed: false,
                dashed: false,
                width_pt: 1.0,
                ink: role.into(),
            });
        }
    }
    for (i, corner) in corners.iter().enumerate() {
        let (shape, radius) = if i == 0 { (PointShape::Ring, 5.0) } else { (PointShape::Dot, 2.0) };
        overlay.point(at(corner), shape, radius, role);
    }
    overlay
}

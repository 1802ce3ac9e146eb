//! What the eyes show while grasping: what is detected, what an attempt saw, and clicks on things.

use plumbline_engine::view::{GraspPhase, SeenThing};
use plumbline_engine::{GraspCommand, View};
use plumbline_model::Eye;
use plumbline_widgets::class_color;
use plumbline_widgets::image_view::ImageViewResponse;
use plumbline_widgets::overlay::{Emphasis, LabeledBox, Mark, Overlay, PointShape};
use plumbline_widgets::theme::Role;

use super::things::click_chooses;
use crate::operator::Outbox;
use crate::panels::PanelContext;

/// While something is under way the attempt looks for itself.
pub fn wants_detections(view: &View) -> bool {
    view.grasp.phase == GraspPhase::Idle
}

/// Boxes of what the attempt under way saw last; `None` when what is detected live is to be drawn.
pub fn overlay(view: &View, eye: Eye) -> Option<Overlay> {
    if wants_detections(view) {
        return None;
    }
    let run = view.grasp.run.as_ref()?;
    let boxes = run.seen.iter().enumerate().filter_map(|(i, thing)| {
        let [x0, y0, x1, y1] = thing.boxes_px[eye.index()]?.map(|edge| f64::from(edge) - 0.5);
        let emphasis = if run.chosen == Some(i) { Emphasis::Chosen } else { Emphasis::Faded };
        Some(LabeledBox {
            outline_px: vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
            text: words(thing),
            color: class_color(&thing.class, i),
            emphasis,
            dashed: false,
        })
    });
    let mut overlay = Overlay::new();
    overlay.push(Mark::Boxes(boxes.collect()));
    if let Some(wanted_px) = run.wanted_px[eye.index()] {
        overlay.point(wanted_px, PointShape::Ring, 7.0, Role::Predicted);
    }
    if let Some(hand_px) = run.hand_px[eye.index()] {
        overlay.plus(hand_px, Role::Measured);
    }
    Some(overlay)
}

fn words(thing: &SeenThing) -> String {
    format!("{} {:.2}", thing.class, thing.confidence)
}

/// What is pointed at is strong in both eyes and in the scene, and it is said what a click would do.
pub fn hover(cx: &mut PanelContext<'_>, eye: Eye, shown: &ImageViewResponse) {
    let is_idle = cx.view.grasp.phase == GraspPhase::Idle;
    if !is_idle || !cx.state.objects.point(cx.view, eye, shown.hover_px, false) {
        return;
    }
    let can_be_held = |name: &str| cx.view.grasp.classes.iter().any(|class| class.eq_ignore_ascii_case(name));
    if let Some(object) = cx.state.objects.under_pointer(cx.view).filter(|object| can_be_held(&object.name)) {
        shown.response.clone().on_hover_text_at_pointer(click_chooses(&object.name));
    }
}

/// What is clicked on is grasped.
pub fn click(view: &View, outbox: &mut Outbox, eye: Eye, clicked_px: Option<[f64; 2]>) {
    if let Some([u_px, v_px]) = clicked_px.filter(|_| view.grasp.phase == GraspPhase::Idle) {
        outbox.send(GraspCommand::Point { eye, u_px, v_px });
    }
}

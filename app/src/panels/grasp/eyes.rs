//! What the eyes show while grasping: what is detected, what an attempt saw, and clicks on things.

use plumbline_engine::view::{GraspPhase, SeenThing};
use plumbline_engine::{GraspCommand, View};
use plumbline_model::Eye;
use plumbline_widgets::class_color;
use plumbline_widgets::overlay::{Emphasis, LabeledBox, Mark, Overlay, PointShape};
use plumbline_widgets::theme::Role;

use crate::operator::Outbox;

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

/// What is clicked on is grasped.
pub fn click(view: &View, outbox: &mut Outbox, eye: Eye, clicked_px: Option<[f64; 2]>) {
    if let Some([u_px, v_px]) = clicked_px.filter(|_| view.grasp.phase == GraspPhase::Idle) {
        outbox.send(GraspCommand::Point { eye, u_px, v_px });
    }
}

//! Boxes, epipolar lines and voting pixels over the pictures.

use egui::Color32;
use plumbline_engine::View;
use plumbline_engine::view::{ObjectView, SeenBox};
use plumbline_model::{Eye, Pixel, PixelSpace};
use plumbline_widgets::overlay::{Emphasis, LabeledBox, Mark, Overlay};
use plumbline_widgets::theme::Role;
use plumbline_widgets::{class_color, class_words};

use super::state::{ObjectsPanels, objects};

/// Strength of the color on pixels that voted: what lies below must stay visible.
const VOTED: f32 = 0.45;

/// Over the raw image of an eye.
pub fn raw(view: &View, panels: &ObjectsPanels, eye: Eye) -> Overlay {
    let mut overlay = Overlay::new();
    if !panels.shown {
        return overlay;
    }
    let focused = panels.focused(view);
    if let Some(object) = focused {
        let color = color(object);
        if eye == Eye::Left {
            for cell in object.voted.iter() {
                let [x0, y0, x1, y1] = [cell.x0_px, cell.y0_px, cell.x1_px, cell.y1_px].map(edge);
                let points_px = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
                overlay.push(Mark::Area { points_px, opacity: VOTED, ink: color.into() });
            }
        }
        if let Some(seen) = object.seen(other(eye)) {
            line(&mut overlay, seen, color);
        }
    }
    overlay.append(raw_boxes(view, panels, eye, focused));
    overlay
}

/// The boxes alone over the raw image of an eye, one of them strong.
pub fn raw_boxes(view: &View, panels: &ObjectsPanels, eye: Eye, focused: Option<&ObjectView>) -> Overlay {
    let mut overlay = Overlay::new();
    if !panels.shown {
        return overlay;
    }
    let boxes = objects(view).iter().filter_map(|object| {
        let seen = object.seen(eye)?;
        let [x0, y0, x1, y1] = [seen.area.x0_px, seen.area.y0_px, seen.area.x1_px, seen.area.y1_px].map(edge);
        let outline_px = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        Some(labeled(view, object, seen, outline_px, focused))
    });
    overlay.push(Mark::Boxes(boxes.collect()));
    overlay
}

/// Over the rectified image of an eye.
pub fn rectified(view: &View, panels: &ObjectsPanels, eye: Eye) -> Overlay {
    let mut overlay = Overlay::new();
    // Outlines of an older aim would lie elsewhere.
    if !panels.shown || view.detect.stale.is_some() {
        return overlay;
    }
    let focused = panels.focused(view);
    if let (Some(object), Some(aim)) = (focused, &view.live.aim)
        && let Some(seen) = object.seen(other(eye))
        && !seen.rectified.is_empty()
    {
        // The rows are the epipolar lines.
        let row = middle(&seen.rectified)[1];
        overlay.push(Mark::Line {
            points_px: vec![[-0.5, row], [f64::from(aim.size_px.0) - 0.5, row]],
            closed: false,
            dashed: true,
            width_pt: 1.5,
            ink: color(object).into(),
        });
    }
    let boxes = objects(view).iter().filter_map(|object| {
        let seen = object.seen(eye).filter(|seen| !seen.rectified.is_empty())?;
        let outline_px = seen.rectified.iter().map(at).collect();
        Some(labeled(view, object, seen, outline_px, focused))
    });
    overlay.push(Mark::Boxes(boxes.collect()));
    overlay
}

/// What a picture says about its boxes: that they are old, or why there are none.
pub fn stale(view: &View, panels: &ObjectsPanels) -> Option<String> {
    let detect = &view.detect;
    let said = detect.failed.as_ref().or(detect.stale.as_ref())?;
    panels.shown.then(|| said.clone())
}

fn labeled(
    view: &View,
    object: &ObjectView,
    seen: &SeenBox,
    outline_px: Vec<[f64; 2]>,
    focused: Option<&ObjectView>,
) -> LabeledBox {
    let emphasis = match focused {
        None => Emphasis::Usual,
        Some(focused) if std::ptr::eq(focused, object) => Emphasis::Chosen,
        Some(_) => Emphasis::Faded,
    };
    let mut text = format!("{} {:.2}", class_words(&object.name), seen.confidence);
    if object.leak.is_some() {
        text.push_str(" · depth doubtful");
    }
    let dashed = !object.in_both() || view.detect.stale.is_some();
    LabeledBox { outline_px, text, color: color(object), emphasis, dashed }
}

/// Where the thing can be in the picture of one eye, by what the other sees.
fn line(overlay: &mut Overlay, seen: &SeenBox, color: Color32) {
    let points_px: Vec<[f64; 2]> = seen.line_in_other.iter().map(at).collect();
    if points_px.len() < 2 {
        return;
    }
    overlay.push(Mark::Line { points_px, closed: false, dashed: true, width_pt: 1.5, ink: color.into() });
}

/// The color of an object is that of its class.
pub fn color(object: &ObjectView) -> Color32 {
    class_color(&object.name, object.class.0)
}

/// The role of a doubt in lists.
pub const DOUBT: Role = Role::Warning;

/// From edges, which count from the corner of the first pixel, to pixels, which count from its middle.
fn edge(edge_px: f32) -> f64 {
    f64::from(edge_px) - 0.5
}

fn at<S: PixelSpace>(pixel: &Pixel<S>) -> [f64; 2] {
    [pixel.u_px, pixel.v_px]
}

fn middle<S: PixelSpace>(outline: &[Pixel<S>]) -> [f64; 2] {
    let count = outline.len().max(1) as f64;
    let sum = outline.iter().fold([0.0, 0.0], |sum, pixel| [sum[0] + pixel.u_px, sum[1] + pixel.v_px]);
    sum.map(|sum| sum / count)
}

fn other(eye: Eye) -> Eye {
    match eye {
        Eye::Left => Eye::Right,
        Eye::Right => Eye::Left,
    }
}

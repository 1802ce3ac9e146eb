//! The objects as a list: what, how sure, where.

use egui::{Align2, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_engine::View;
use plumbline_engine::view::ObjectView;
use plumbline_model::Eye;
use plumbline_widgets::class_words;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::theme::{self, space};

use super::drawing::{DOUBT, color};
use super::order::in_order;
use super::state::{ObjectsPanels, in_hand, objects};

const ROW_HEIGHT: f32 = 38.0;
const SWATCH: f32 = 10.0;

/// Draws the list; pointing at a line highlights its boxes, a click chooses.
pub fn show(ui: &mut Ui, view: &View, panels: &mut ObjectsPanels) {
    let places = objects(view).iter().filter_map(|object| object.place.as_ref().ok());
    if let Some(why) = places.filter_map(|place| place.wide_because).next() {
        ui.label(theme::small(ui, why));
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        for object in in_order(&panels.listed, objects(view)) {
            row(ui, view, object, panels);
        }
    });
}

fn row(ui: &mut Ui, view: &View, object: &ObjectView, panels: &mut ObjectsPanels) {
    let tokens = theme::tokens(ui);
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::click());
    let chosen = panels.chosen.as_ref().is_some_and(|chosen| chosen.is(object));
    response.widget_info(|| {
        WidgetInfo::selected(
            egui::Role::ListBoxOption,
            true,
            chosen,
            format!("{}, {}", class_words(&object.name), whereabouts(view, object)),
        )
    });
    if response.hovered() {
        panels.hover(object);
    }
    if response.clicked() {
        panels.toggle(object);
    }
    let fill = match (chosen, response.hovered() || response.has_focus()) {
        (true, _) => Some(tokens.selected),
        (false, true) => Some(tokens.raised_hover.gamma_multiply(0.6)),
        (false, false) => None,
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 4.0, fill);
    }
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let left = rect.left() + space::XS;
    let swatch = egui::Rect::from_min_size(pos2(left, rect.top() + 6.0), vec2(SWATCH, SWATCH));
    plumbline_widgets::class_swatch(ui.painter(), swatch, color(object), tokens.text_weak);
    let text = left + SWATCH + space::S;
    let painter = ui.painter().with_clip_rect(rect);
    let doubtful = is_doubtful(view, object);
    let name = class_words(&object.name);
    let name = if doubtful { format!("{name}  !") } else { name.to_owned() };
    painter.text(pos2(text, rect.top() + 2.0), Align2::LEFT_TOP, name, body.clone(), tokens.text_strong);
    let right = rect.right() - space::XS;
    painter.text(
        pos2(right, rect.top() + 3.0),
        Align2::RIGHT_TOP,
        confidences(object),
        small.clone(),
        tokens.text_weak,
    );
    let ink = if object.place.is_ok() && !doubtful { tokens.text } else { tokens.text_weak };
    let ink = if doubtful { DOUBT.color(tokens) } else { ink };
    painter.text(pos2(text, rect.bottom() - 3.0), Align2::LEFT_BOTTOM, whereabouts(view, object), small, ink);
}

fn is_doubtful(view: &View, object: &ObjectView) -> bool {
    object.leak.is_some() || !object.doubts.is_empty() || in_hand(view, object).is_some()
}

/// "L 0.91  R 0.88".
fn confidences(object: &ObjectView) -> String {
    let of = |eye: Eye, letter: &str| match object.seen(eye) {
        Some(seen) => format!("{letter} {:.2}", seen.confidence),
        None => format!("{letter} {}", format::NONE),
    };
    format!("{}   {}", of(Eye::Left, "L"), of(Eye::Right, "R"))
}

/// Where it is, on one line.
fn whereabouts(view: &View, object: &ObjectView) -> String {
    match object.best_place() {
        Ok(place) => {
            let at = place.point_in_robot.coords;
            let number = |m: f64| format::fixed(Quantity::Length.on_screen(m), 0);
            let at = format!("{}, {}, {}", number(at.x), number(at.y), number(at.z));
            // What speaks against the place is in no ±.
            match is_doubtful(view, object) {
                true => format!("{at} mm, doubtful"),
                false => format!("{at} ± {} mm", number(place.within_m())),
            }
        }
        Err(_) => match (object.left.is_some(), object.right.is_some()) {
            (true, false) => "only the left eye: no place".to_owned(),
            (false, true) => "only the right eye: no place".to_owned(),
            _ => "no place".to_owned(),
        },
    }
}

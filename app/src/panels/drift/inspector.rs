//! What moved: the eyes' turns, the references, and what was told; and whether the calibration still holds.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, group_heading, space};

use crate::operator::Outbox;
use crate::panels::health;

pub fn show(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    moved(ui, view);
    health::show(ui, view, outbox);
}

fn moved(ui: &mut Ui, view: &View) {
    let Some(course) = &view.drift.course else {
        group_heading(ui, "What this is for");
        let text = "Eyes turn in their mounts while they warm up, and when somebody knocks against one. Then \
            places come out wrong, the farther the more. Watching says so, names what moved, and says what it costs.";
        ui.label(theme::weak(ui, text));
        return;
    };
    group_heading(ui, "Moved at the far end");
    let far_m = course.points.last().map_or(0.0, |point| point.off_m[2]);
    let (when, role) = match super::age(view).filter(|age| view.drift.is_watching && *age <= super::OLD) {
        Some(_) => ("since watching began, now", Role::Measured),
        None => ("since watching began, at the last look", Role::Weak),
    };
    big_figure(ui, when, &format::mm(far_m), role);
    if let Some(age) = super::age(view).filter(|age| *age > super::OLD) {
        ui.label(theme::small(ui, format!("That was {}.", format::age(age))));
    }
    if let Some(band_m) = course.band_m {
        ui.label(theme::small(ui, format!("Up to {} is scatter.", format::mm(band_m[2]))));
    }
    for (name, turn_rad) in ["Left eye has turned", "Right eye has turned"].into_iter().zip(course.turns_rad)
    {
        group_heading(ui, name);
        let rows = ["Nod", "Pan", "Roll"].into_iter().zip(turn_rad);
        let rows: Vec<KeyValue> =
            rows.map(|(axis, angle_rad)| KeyValue::quantity(axis, Quantity::Angle, angle_rad)).collect();
        key_value_grid(ui, name, &rows);
    }
    if let Some(vertical_px) = course.epipolar_px {
        group_heading(ui, "Between the eyes");
        let row = KeyValue::text("Matches off, as told last", format::px(vertical_px))
            .help("How far matched places leave the epipolar lines of the calibration in use. They are matched some ten times less finely than corners of a board");
        key_value_grid(ui, "drift between the eyes", &[row]);
    }
    if !course.references.is_empty() {
        group_heading(ui, "References");
        let rows: Vec<KeyValue> = course
            .references
            .iter()
            .map(|(name, off_m)| {
                KeyValue::text(name.clone(), off_m.map_or_else(|| "not seen".to_owned(), format::mm))
            })
            .collect();
        key_value_grid(ui, "drift references", &rows);
    }
    told(ui, "What moved", &course.alarms, Role::Warning);
    told(ui, "Moved by itself, or not seen", &course.own_motions, Role::Ink);
}

fn told(ui: &mut Ui, heading: &str, told: &[(f64, String)], role: Role) {
    if told.is_empty() {
        return;
    }
    group_heading(ui, heading);
    let color = role.color(theme::tokens(ui));
    for (_, sentence) in told.iter().rev().take(8) {
        ui.label(RichText::new(sentence).color(color));
        ui.add_space(space::XS);
    }
}

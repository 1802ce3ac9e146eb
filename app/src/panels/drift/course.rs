//! How far places wander over the minutes: near, in the middle, far, with the band.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{DriftCourse, DriftVerdict};
use plumbline_widgets::theme::{self, Role, space};

use super::chart::{Chart, Line};
use super::{explain, nothing_yet, old};
use crate::operator::words;
use crate::panels::{PanelContext, padded};

/// Colors of the rows of the table, from near to far.
pub(super) const ROWS: [(&str, Role); 3] =
    [("near", Role::Predicted), ("middle", Role::HeldOut), ("far", Role::Measured)];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let drift = &cx.view.drift;
    let Some(course) = &drift.course else { return nothing_yet(ui, cx.view) };
    padded(ui, |ui| {
        headline(ui, course, cx.view);
        let times = cx.view.twin.warm_up_pace;
        if cx.view.twin.running && times > 1.0 {
            let text = format!("The twin's eyes warm up {times} times as fast as everything else.");
            ui.label(theme::small(ui, text));
        }
        explain::show(ui, cx);
        ui.add_space(space::XS);
        let height = ui.available_height();
        let minutes = |at_s: f64| at_s / 60.0;
        let lines = |of: fn(&plumbline_engine::view::DriftPoint) -> [f64; 3]| -> Vec<Line> {
            let of_row = |(row, (name, role)): (usize, (&str, Role))| Line {
                name: name.to_owned(),
                role,
                points: course.points.iter().map(|p| [minutes(p.at_s), of(p)[row] * 1e3]).collect(),
            };
            ROWS.into_iter().enumerate().map(of_row).collect()
        };
        let axis = if course.from_switching_on {
            "minutes since the cameras were switched on"
        } else {
            "minutes since watching began"
        };
        let marks: Vec<f64> = course.alarms.iter().map(|(at_s, _)| minutes(*at_s)).collect();
        let chart =
            |label, lines, band_mm: Option<[f64; 2]>| Chart { label, axis, lines, band_mm, marks: &marks };
        let off = lines(|point| point.off_m);
        let band_mm = course.band_m.map(|band_m| [0.0, band_m[2] * 1e3]);
        chart("How far places are off, mm", &off, band_mm).show(ui, height * 0.44);
        let along = lines(|point| point.along_m);
        chart("Along the line of sight, mm (up: too far away)", &along, None).show(ui, height * 0.28);
        let across = lines(|point| point.across_m);
        chart("Across it, mm (up: too far to the left)", &across, None).show(ui, height * 0.28 - space::M);
    });
}

fn headline(ui: &mut Ui, course: &DriftCourse, view: &View) {
    let tokens = theme::tokens(ui);
    let color = match course.verdict {
        DriftVerdict::Moved(_) | DriftVerdict::Warming { .. } => Role::Warning.color(tokens),
        _ => tokens.text_strong,
    };
    ui.label(RichText::new(&course.sentence).color(color));
    if let Some(anew) = &view.drift.anew {
        ui.label(RichText::new(words::drift::anew(anew)).color(Role::Warning.color(tokens)));
    }
    if !view.drift.is_watching {
        ui.label(theme::small(ui, "Not watched any more: old."));
    } else if let Some(old) = old(view) {
        ui.label(RichText::new(old).color(Role::Warning.color(tokens)));
    }
}

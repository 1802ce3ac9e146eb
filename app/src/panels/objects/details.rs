//! What is known about the object that is looked at.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{ObjectPlaceView, ObjectView};
use plumbline_widgets::class_words;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, space};

use super::drawing::DOUBT;
use super::state::{ObjectsPanels, in_hand};
use crate::panels::parts::warning;

/// Draws it; a hint while nothing is looked at.
pub fn show(ui: &mut Ui, view: &View, panels: &mut ObjectsPanels) {
    let Some(object) = panels.described(view) else {
        match &panels.chosen {
            Some(gone) => ui.label(theme::weak(
                ui,
                format!("The {} that was chosen is not seen on this pair.", gone.name.to_lowercase()),
            )),
            None => ui.label(theme::weak(
                ui,
                "Point at a box to see its partner in the other eye; click to keep it.",
            )),
        };
        return;
    };
    ui.add_space(space::XS);
    match object.best_place() {
        Ok(place) => placed(ui, object, place),
        Err(why) => {
            ui.label(
                RichText::new(format!("{}: no place", class_words(&object.name)))
                    .color(DOUBT.color(theme::tokens(ui))),
            );
            let why = why.to_string();
            ui.label(&why);
            if let Some(alone) = object.alone_because.as_ref().filter(|alone| **alone != why) {
                ui.label(theme::weak(ui, alone));
            }
        }
    }
    let held = in_hand(view, object);
    let doubts: Vec<&String> = object.leak.iter().chain(&object.doubts).chain(&held).collect();
    if !doubts.is_empty() && object.best_place().is_ok() {
        ui.add_space(space::XS);
        ui.label(theme::weak(ui, "Not in the ±:"));
    }
    for doubt in doubts {
        ui.add_space(space::XS);
        ui.label(RichText::new(doubt).color(DOUBT.color(theme::tokens(ui))));
    }
    if panels.chosen.is_some() && ui.button("Let the object go").clicked() {
        panels.chosen = None;
    }
}

fn placed(ui: &mut Ui, object: &ObjectView, place: &ObjectPlaceView) {
    let label = format!("{}, from the left eye", class_words(&object.name));
    big_figure(ui, &label, &format::mm_with(place.range_m, place.range_sigma_m), Role::Ink);
    ui.add_space(space::S);
    ui.label(theme::small(ui, format!("Middle, robot frame, robot {}", place.model)));
    let at = place.point_in_robot.coords;
    let rows: Vec<KeyValue> = ["x", "y", "z"]
        .into_iter()
        .zip([at.x, at.y, at.z])
        .zip(place.sigma_m)
        .map(|((name, value), sigma)| KeyValue::uncertain(name, Quantity::Length, value, sigma))
        .collect();
    key_value_grid(ui, "object place", &rows);
    if let Some(why) = place.wide_because {
        warning(ui, why);
    }
    ui.label(theme::weak(ui, place_from(object)));
    let voted = object.voted.iter().map(|cell| cell.area_px2()).sum::<f32>();
    let share = object.left.as_ref().map(|seen| f64::from(voted / seen.area.area_px2().max(1.0)));
    key_value_grid(
        ui,
        "object evidence",
        &[
            KeyValue::optional("Vertical error", Quantity::Pixels, object.epipolar_px)
                .help("How far the two boxes lie from each other's epipolar line"),
            KeyValue::optional("Pixels that voted", Quantity::Ratio, share)
                .help("Share of its box in the left eye whose pixels decided the distance; they are colored in the picture"),
        ],
    );
}

/// What its place rests on.
fn place_from(object: &ObjectView) -> String {
    let (Some(stands), Ok(seen)) = (&object.stands, &object.place) else {
        return "By its pixels and boxes in both eyes.".to_owned();
    };
    let apart_m = stands.point_in_robot.distance_m(&seen.point_in_robot);
    format!(
        "By its outline, standing on the table. Its pixels in both eyes alone say {} beside.",
        format::mm_with(apart_m, seen.range_sigma_m)
    )
}

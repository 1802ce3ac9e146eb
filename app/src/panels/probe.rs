//! The measured point: which one is asked for, and what is said about it.

use egui::{RichText, Ui};
use plumbline_engine::view::{ProbeReading, ProbeView};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, space};

use super::parts::warning;
use crate::operator::words::capitalized;

/// What is known about the measured point, for the inspector.
pub fn probe_readout(ui: &mut Ui, probe: Option<&ProbeView>) {
    let Some(probe) = probe else {
        ui.label(theme::weak(ui, "Point at an image to measure; click to keep the point."));
        return;
    };
    match &probe.reading {
        Err(why) => {
            ui.label(RichText::new("Not measured").color(Role::Warning.color(theme::tokens(ui))));
            ui.label(capitalized(&why.to_string()));
        }
        Ok(reading) => {
            let range_m = reading.point_in_left.range_m();
            big_figure(ui, "from the left eye", &format::mm_with(range_m, reading.range_sigma_m), Role::Ink);
            ui.add_space(space::S);
            let robot = reading.point_in_robot.coords;
            let hint =
                "The robot with what was calibrated, and with the effects that were added to its model";
            ui.label(theme::small(ui, format!("Robot frame, robot {}", reading.model))).on_hover_text(hint);
            coordinates(ui, "robot", [robot.x, robot.y, robot.z]);
            key_value_grid(ui, "robot within", &[place_sigma(reading)]);
            if let Some(why) = reading.wide_because {
                warning(ui, why);
            }
            let left = reading.point_in_left.coords;
            ui.add_space(space::XS);
            ui.label(theme::small(ui, "Left eye's frame"));
            coordinates(ui, "left eye", [left.x, left.y, left.z]);
            ui.add_space(space::XS);
            ui.label(theme::small(ui, "Image"));
            key_value_grid(ui, "probe image", &image_rows(reading));
        }
    }
}

fn coordinates(ui: &mut Ui, id: &str, meters: [f64; 3]) {
    let rows = ["x", "y", "z"]
        .into_iter()
        .zip(meters)
        .map(|(name, value)| KeyValue::quantity(name, Quantity::Length, value))
        .collect::<Vec<_>>();
    key_value_grid(ui, id, &rows);
}

fn place_sigma(reading: &ProbeReading) -> KeyValue {
    KeyValue::quantity("±", Quantity::Length, format::NORMAL_95 * reading.sigma_m)
        .help("It lies within this with 95 % along the worst direction: from the match, the calibrations, the effects of the model, and what nobody measured")
}

fn image_rows(reading: &ProbeReading) -> Vec<KeyValue> {
    let at = |u: f64, v: f64| format::pixel_position([u, v]);
    vec![
        KeyValue::text("Left", at(reading.left_raw.u_px, reading.left_raw.v_px)).unit("px"),
        KeyValue::text("Right", at(reading.right_raw.u_px, reading.right_raw.v_px)).unit("px"),
        KeyValue::optional("Disparity", Quantity::Pixels, reading.disparity_px),
    ]
}

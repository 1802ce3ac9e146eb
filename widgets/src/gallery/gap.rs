//! Pages of the gap: probabilities, shares, what is left against what it may depend on.

use egui::Ui;

use super::{GalleryState, sample};
use crate::format::Quantity;
use crate::intervals::{IntervalRow, Intervals, Level};
use crate::probability::{ShareRow, probability_bar, share_rows};
use crate::scatter::{Scatter, ScatterSeries};
use crate::theme::{self, Role, space};

pub(super) fn gap(ui: &mut Ui, _: &mut GalleryState) {
    theme::group_heading(ui, "How sure");
    for (label, probability) in [("Elbow: zero position off", 0.974), ("Shoulder: bracket gives way", 0.31)] {
        ui.label(label);
        probability_bar(ui, label, probability, Role::Predicted);
    }
    theme::group_heading(ui, "Shares of the gap");
    let row = |name: &str, share: f64, note: &str| ShareRow {
        name: name.to_owned(),
        share,
        note: note.to_owned(),
        role: Role::Difference,
    };
    share_rows(
        ui,
        &[
            row("along u", 0.62, "7.41 mm, noise 1.10 mm"),
            row("along v", 0.35, "5.02 mm, noise 1.22 mm"),
            row("height over the glass", 0.03, "1.03 mm, noise 0.90 mm"),
        ],
    );
    theme::group_heading(ui, "Before and after");
    let mean = |name: &str, mean: f64, interval, role| IntervalRow {
        name: name.to_owned(),
        note: String::new(),
        mean: Some(mean),
        interval,
        role,
    };
    let rows = [
        mean("Before", 0.0067, None, Role::Difference),
        mean("After", 0.0034, Some([0.0030, 0.0039]), Role::HeldOut),
    ];
    let levels = [Level { name: "noise alone", value: 0.003, role: Role::NoiseFloor }];
    Intervals::new("Gap on held-out rows", &rows, Quantity::Length).levels(&levels).show(ui);
    theme::group_heading(ui, "What gave it away");
    let points = |slope: f64, seed: usize| -> Vec<[f64; 2]> {
        (0..160)
            .map(|i| {
                let angle = 35.0 + 60.0 * (i as f64 / 160.0);
                [angle, slope * (angle - 65.0) * 1e-4 + 0.0012 * sample::noise(i + seed)]
            })
            .collect()
    };
    let series = [
        ScatterSeries { name: "before", points: points(2.2, 0), role: Role::Difference },
        ScatterSeries { name: "after", points: points(0.0, 900), role: Role::HeldOut },
    ];
    ui.horizontal(|ui| {
        let size = egui::vec2((ui.available_width() - space::M) / 2.0, 220.0);
        Scatter::new("Residual", "angle of the elbow, °", &series, Quantity::Length)
            .floor(Some(0.0012))
            .size(size)
            .show(ui);
        let none = [ScatterSeries { name: "before", points: vec![], role: Role::Difference }];
        Scatter::new("Residual", "servo temperature, °C", &none, Quantity::Length).size(size).show(ui);
    });
}

//! Pages of correction models: how they are trained, where they may be trusted, points to drag.

use egui::Ui;

use super::{GalleryState, sample};
use crate::colormap::{ColorScale, Colormap};
use crate::format::{self, Quantity};
use crate::intervals::{IntervalRow, Intervals, Level};
use crate::loss_curves::{LossCurve, LossCurves, loss_legend, loss_range};
use crate::overlay::Ink;
use crate::table_map::{BeforeAfter, Border, Outline, Place, ScalarField, TableMap, TablePoint, TableScene};
use crate::theme::{Role, space};

pub(super) fn training(ui: &mut Ui, state: &mut GalleryState) {
    let curves = |networks: usize, floor: f64| -> Vec<LossCurve> {
        (0..networks)
            .map(|network| {
                let loss = |epoch: usize, floor: f64| {
                    let shake = 1.0 + 0.06 * sample::noise(epoch + 1000 * network);
                    (epoch as f64, shake * (floor + 0.9 * (-(epoch as f64) / 18.0).exp()))
                };
                LossCurve {
                    name: format!("network {}", network + 1),
                    train: (0..200).map(|epoch| loss(epoch, floor)).collect(),
                    held_out: (0..200).step_by(5).map(|epoch| loss(epoch, 1.6 * floor)).collect(),
                }
            })
            .collect()
    };
    let (m2, m3) = (curves(1, 0.02), curves(5, 0.006));
    let range = loss_range(&[m2.clone(), m3.clone()].concat());
    loss_legend(ui);
    ui.horizontal(|ui| {
        let width = (ui.available_width() - 2.0 * space::M) / 3.0;
        for (name, curves, caption) in [
            ("M2", &m2, "held out 31.1 mm"),
            ("M3", &m3, "held out 9.42 mm"),
            ("M4", &Vec::new(), "nothing trained yet"),
        ] {
            let range = range.filter(|_| !curves.is_empty());
            LossCurves::new(name, curves, Quantity::Length)
                .caption(caption)
                .range(range)
                .size(egui::vec2(width, 220.0))
                .show(ui);
        }
    });
    ui.add_space(space::L);
    let row = |name: &str, note: &str, mean: f64, half: f64, role| IntervalRow {
        name: name.to_owned(),
        note: note.to_owned(),
        mean: Some(mean),
        interval: Some([mean - half, mean + half]),
        role,
    };
    let rows = [
        row("No model", "", 0.0213, 0.0016, Role::Weak),
        row("M1", "in use", 0.0086, 0.0011, Role::Predicted),
        row("M2", "proposed", 0.0047, 0.0005, Role::Predicted),
        row("M3", "proposed, best", 0.0044, 0.0005, Role::Predicted),
    ];
    let levels = [Level { name: "repeats, rms", value: 0.0021, role: Role::NoiseFloor }];
    let shown = Intervals::new("Mean error of the methods", &rows, Quantity::Length)
        .levels(&levels)
        .band(Some(3))
        .selected(state.chosen_point)
        .show(ui);
    if let Some(row) = shown {
        state.chosen_point = Some(row);
        state.last = rows[row].name.clone();
    }
}

fn touchscreen() -> Outline {
    Outline::rectangle(Place::Touchscreen, "touchscreen", [0.24, 0.47], [-0.20, 0.20])
}

pub(super) fn map(ui: &mut Ui, state: &mut GalleryState) {
    let mut scene = TableScene { x_m: [0.15, 0.56], y_m: [-0.3, 0.3], ..TableScene::new() };
    scene.outlines.push(touchscreen());
    scene.border = Some(Border {
        name: "border of the data".to_owned(),
        rings_m: vec![
            vec![[0.26, -0.15], [0.25, 0.06], [0.29, 0.17], [0.42, 0.18], [0.455, 0.02], [0.43, -0.16]],
            vec![[0.33, 0.02], [0.33, 0.07], [0.37, 0.07], [0.37, 0.02]],
        ],
    });
    scene.vector_scale = 5.0;
    scene.before_after = (0..30)
        .map(|i| BeforeAfter {
            at_m: [0.355 + 0.08 * sample::noise(i), 0.13 * sample::noise(i + 30)],
            before_m: Some([0.008 + 0.002 * sample::noise(i + 60), 0.003 * sample::noise(i + 90)]),
            after_m: Some([0.002 * sample::noise(i + 120), 0.002 * sample::noise(i + 150)]),
        })
        .collect();
    let field = ScalarField::sample(
        "Uncertainty",
        Quantity::Length,
        [0.15, 0.56],
        [-0.3, 0.3],
        [25, 33],
        |[x, y]| Some(0.002 + 0.35 * ((x - 0.35).powi(2) + 0.5 * y * y)),
    );
    let scale = ColorScale::new(Colormap::Viridis, [0.0, 0.02]);
    TableMap::new("Where M3 may be trusted", &scene).field(&field, scale).height(370.0).show(ui);
    ui.add_space(space::M);

    if state.points_m.is_empty() {
        state.points_m =
            (0..14).map(|i| [0.34 + 0.11 * sample::noise(i + 300), 0.2 * sample::noise(i + 330)]).collect();
    }
    let points: Vec<TablePoint> = state
        .points_m
        .iter()
        .enumerate()
        .map(|(i, at_m)| TablePoint {
            at_m: *at_m,
            radius: 5.0 + 2.0 * sample::noise(i).abs() as f32,
            ink: if i % 5 == 0 { Ink::Role(Role::Warning) } else { Ink::Role(Role::Measured) },
            label: format!("point {}: {}", i + 1, format::mm(0.04 + 0.001 * i as f64)),
            faint: i > 11,
        })
        .collect();
    let mut scene = TableScene { x_m: [0.15, 0.56], y_m: [-0.3, 0.3], ..TableScene::new() };
    scene.outlines.push(touchscreen());
    let shown = TableMap::new("Points of the height table", &scene)
        .points(&points, state.chosen_point)
        .height(300.0)
        .show(ui);
    state.chosen_point = shown.points.chosen.or(state.chosen_point);
    if let Some((point, at_m)) = shown.points.moved {
        state.points_m[point] = at_m;
        state.last = format!("moved point {}", point + 1);
    }
    if shown.clicked_m.is_some() {
        state.last = "clicked beside the points".to_owned();
    }
}

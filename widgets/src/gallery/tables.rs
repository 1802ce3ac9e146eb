//! Pages with charts, maps and figures.

use egui::Ui;
use plumbline_model::Eye;

use super::{GalleryState, sample};
use crate::bars::PairBars;
use crate::colormap::{ColorScale, Colormap};
use crate::coverage::{Coverage, coverage_view};
use crate::format::Quantity;
use crate::key_value::{KeyValue, big_figure, key_value_grid};
use crate::table_map::{Outline, Place, ScalarField, TableMap, TableMark, TableScene};
use crate::theme::{self, Role, space};

pub(super) fn bars(ui: &mut Ui, state: &mut GalleryState) {
    bars_of_height(ui, state, 180.0);
}

pub(super) fn bars_of_height(ui: &mut Ui, state: &mut GalleryState, height: f32) {
    ui.checkbox(&mut state.sorted, "Worst first");
    let pairs = sample::pairs();
    let response = PairBars::new("Error per pair", &pairs)
        .threshold(Some(0.15))
        .sorted(state.sorted)
        .height(height)
        .selected(state.selected_pair)
        .show(ui);
    if let Some(bar) = response.clicked {
        state.selected_pair = Some(bar.pair);
        state.last = format!("{} {}", pairs[bar.pair].name, bar.eye);
    }
}

pub(super) fn coverage(ui: &mut Ui, _: &mut GalleryState) {
    let mut coverage = Coverage::new([640, 480]);
    let inside = |at: [f64; 2]| (at[0] - 320.0).hypot(at[1] - 240.0) < 330.0;
    for eye in Eye::BOTH {
        let grid = coverage.grid(eye).clone().with_reachable(inside);
        *coverage.grid_mut(eye) = grid;
    }
    for pair in 0..18 {
        let (u, v) = (270.0 + 190.0 * sample::noise(pair), 220.0 + 130.0 * sample::noise(pair + 40));
        for corner in 0..40 {
            let at = [u + 14.0 * (corner % 8) as f64, v + 14.0 * (corner / 8) as f64];
            coverage.left.add(at);
            coverage.right.add([at[0] - 60.0, at[1]]);
        }
        coverage.distance_m.add(0.36 + 0.14 * sample::noise(pair + 80));
        coverage.tilt_rad.add(0.35 + 0.3 * sample::noise(pair + 120));
    }
    coverage_view(ui, &coverage, f32::INFINITY);
}

pub(super) fn table_map(ui: &mut Ui, _: &mut GalleryState) {
    let mut scene = TableScene::new();
    scene.outlines = vec![
        Outline::rectangle(Place::Patch, "workspace", [0.20, 0.60], [-0.45, 0.45]),
        Outline::rectangle(Place::Touchscreen, "touchscreen", [0.24, 0.47], [-0.20, 0.20]),
    ];
    let field = ScalarField::sample(
        "Uncertainty",
        Quantity::Length,
        [0.20, 0.60],
        [-0.45, 0.45],
        [25, 49],
        |[x, y]| Some(0.0006 + 0.011 * x * x + 0.004 * y * y),
    );
    let scale = ColorScale::new(Colormap::Viridis, [0.0, 0.005]);
    TableMap::new("Uncertainty at the table", &scene).field(&field, scale).height(300.0).show(ui);
    ui.add_space(space::M);

    let difference = ScalarField::sample(
        "Difference",
        Quantity::Length,
        [0.20, 0.60],
        [-0.45, 0.45],
        [25, 49],
        |[x, y]| Some(0.004 * (x - 0.42) + 0.003 * y - 0.006 * y * y),
    );
    let marks = (0..5).flat_map(|i| (0..4).map(move |j| [0.24 + 0.1 * j as f64, -0.4 + 0.2 * i as f64]));
    let mark = |at_m: [f64; 2]| TableMark {
        at_m,
        vector_m: Some([0.003 * (at_m[0] - 0.4), 0.002 * at_m[1]]),
        ink: Role::Difference.into(),
        text: String::new(),
    };
    let mut arrows = scene.clone();
    arrows.marks = marks.map(mark).collect();
    arrows.vector_scale = 60.0;
    TableMap::new("Difference to the calibration in use", &arrows)
        .field(&difference, ColorScale::symmetric(0.002))
        .height(300.0)
        .show(ui);
    ui.add_space(space::M);

    let touches = (0..24).map(|i| TableMark {
        at_m: [0.355 + 0.1 * sample::noise(i), 0.18 * sample::noise(i + 30)],
        vector_m: Some([0.002 * sample::noise(i + 60), 0.002 * sample::noise(i + 90)]),
        ink: if i % 6 == 0 { Role::HeldOut.into() } else { Role::Difference.into() },
        text: String::new(),
    });
    scene.marks = touches.collect();
    scene.vector_scale = 20.0;
    TableMap::new("Touches", &scene).height(300.0).show(ui);
}

pub(super) fn inspector(ui: &mut Ui, _: &mut GalleryState) {
    ui.set_max_width(ui.available_width().min(300.0));
    theme::heading(ui, "Calibration");
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        big_figure(ui, "stereo rms", &Quantity::Pixels.text(0.0955), Role::Ink);
        big_figure(ui, "at 450 mm", &Quantity::LengthPerPixel.text(0.00301), Role::Ink);
    });
    theme::group_heading(ui, "Left eye");
    key_value_grid(
        ui,
        "left eye",
        &[
            KeyValue::uncertain("focal length x", Quantity::Pixels, 152.33, 0.041)
                .help("Pixels per radian at the optical axis."),
            KeyValue::uncertain("focal length y", Quantity::Pixels, 152.61, 0.043),
            KeyValue::uncertain("center x", Quantity::Pixels, 321.9, 0.08),
            KeyValue::uncertain("center y", Quantity::Pixels, 238.4, 0.07),
        ],
    );
    theme::group_heading(ui, "Pair");
    key_value_grid(
        ui,
        "pair",
        &[
            KeyValue::uncertain("baseline", Quantity::Length, 0.068_24, 0.000_031),
            KeyValue::quantity("vergence", Quantity::Angle, 0.0213),
            KeyValue::quantity("epipolar error", Quantity::Pixels, 0.111).role(Role::Accepted),
            KeyValue::quantity("worst pair", Quantity::Pixels, 0.21).role(Role::Warning),
            KeyValue::optional("cross-validated", Quantity::Pixels, None)
                .help("Not computed: fewer than ten pairs."),
            KeyValue::text("lens model", "fisheye"),
        ],
    );
}

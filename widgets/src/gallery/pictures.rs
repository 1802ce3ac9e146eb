//! Pages with images.

use egui::{Ui, vec2};
use plumbline_model::Eye;

use super::{GalleryState, sample};
use crate::colormap::{ColorScale, Colormap, Orientation, ScaleBar, colorize};
use crate::compare;
use crate::empty::Message;
use crate::format::{self, Quantity};
use crate::ghost::{Ghost, ghost};
use crate::image_view::{Content, ImageView};
use crate::overlay::Overlay;
use crate::residuals::{arrow_scale, residual_arrows};
use crate::theme::{self, Role, space};

/// Two square-ish tiles over the available width.
fn tile(ui: &Ui) -> egui::Vec2 {
    let width = ((ui.available_width() - space::S) / 2.0).max(120.0);
    vec2(width, width * 0.75)
}

pub(super) fn linked(ui: &mut Ui, state: &mut GalleryState) {
    ui.label(theme::weak(ui, "Wheel zooms, drag moves, double click fits. Both eyes move together."));
    let size = tile(ui);
    let lines = compare::epipolar_lines(sample::SIZE.map(|n| n as usize), 40);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        for (label, shift) in [("Left eye, rectified", 0.0), ("Right eye, rectified", 12.0)] {
            let picture =
                state.textures.get(label, 1, || crate::texture::color_image(&sample::eye(shift))).clone();
            let view = ImageView::new(label, Content::Picture(&picture)).overlay(&lines).size(size);
            let shown = view.show(ui, &mut state.pair_view);
            if let Some(at_px) = shown.clicked_px {
                state.last = format!("clicked {label} at {}", format::pixel_position(at_px));
            }
        }
    });
}

pub(super) fn deep(ui: &mut Ui, state: &mut GalleryState) {
    if state.deep_view.is_fit() {
        state.deep_view.look_at([152.0, 106.0], 56.0);
    }
    let picture = state.textures.get("deep", 1, || crate::texture::color_image(&sample::eye(0.0))).clone();
    let mut corner = Overlay::new();
    corner.plus(sample::corner_px(1, 1), Role::Measured);
    let size = vec2(ui.available_width(), 420.0);
    ImageView::new("Left eye, raw", Content::Picture(&picture))
        .overlay(&corner)
        .size(size)
        .show(ui, &mut state.deep_view);
}

pub(super) fn states(ui: &mut Ui, state: &mut GalleryState) {
    let size = tile(ui);
    let picture = state.textures.get("stale", 1, sample::gray_ramp).clone();
    let empty = Message::new("No image pairs yet", "Open a folder of pairs, or plug in both cameras.")
        .button("Open folder…");
    let failed = Message::new(
        "The left camera does not answer",
        "Check its cable. The program tries again every second; everything else goes on.",
    );
    let contents = [
        [("Empty", Content::Empty(empty)), ("Loading", Content::Loading("Reading 30 pairs…"))],
        [("Failed", Content::Failed(failed)), ("Stale", Content::Picture(&picture))],
    ];
    for row in contents {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = space::S;
            for (label, content) in row {
                let view = ImageView::new(label, content).size(size);
                let old = (label == "Stale").then_some("3 s old: the camera is lost, trying again");
                if view.stale(old).show(ui, &mut state.single_view).button_clicked {
                    state.last = "open folder".to_owned();
                }
            }
        });
    }
}

pub(super) fn comparison(ui: &mut Ui, state: &mut GalleryState) {
    let (left, right) = (sample::eye(0.0), sample::eye(6.0));
    let size = tile(ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        if let Ok(image) = compare::anaglyph(&left, &right) {
            let picture = state.textures.get("anaglyph", 1, || image).clone();
            ImageView::new("Anaglyph", Content::Picture(&picture))
                .size(size)
                .show(ui, &mut state.single_view);
        }
        let time_s = ui.input(|input| input.time);
        let eye = compare::blink(time_s, 0.6);
        let shown = if eye == Eye::Left { &left } else { &right };
        let picture = state.textures.rgb("blink", eye.index() as u64, shown).clone();
        let label = format!("Blink, {eye} eye");
        ImageView::new(&label, Content::Picture(&picture)).size(size).show(ui, &mut state.single_view);
    });
    if let Ok(image) = compare::side_by_side(&left, &right, 24) {
        let picture = state.textures.get("side by side", 1, || image).clone();
        let size = vec2(ui.available_width(), ui.available_width() * 0.375);
        ImageView::new("Side by side", Content::Picture(&picture)).size(size).show(ui, &mut state.pair_view);
    }
}

pub(super) fn depth(ui: &mut Ui, state: &mut GalleryState) {
    let values = sample::depth_m();
    let [w, h] = sample::SIZE.map(|n| n as usize);
    let range = ColorScale::range_of(&values).unwrap_or([0.0, 1.0]);
    let mut height = 0.0;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        let size = tile(ui);
        height = size.y;
        for map in [Colormap::Viridis, Colormap::Spectrum] {
            let scale = ColorScale::new(map, range).reversed();
            let key = format!("Depth, {}", map.name());
            let picture = state.textures.get(&key, 1, || colorize(&values, [w, h], &scale)).clone();
            let text = |column: usize, row: usize| {
                let depth = values.get(row * w + column).filter(|depth| depth.is_finite())?;
                Some(format::depth(f64::from(*depth)))
            };
            ImageView::new(&key, Content::Picture(&picture))
                .value_text(&text)
                .size(size)
                .show(ui, &mut state.single_view);
        }
    });
    ui.add_space(space::S);
    for map in Colormap::ALL {
        let scale = match map {
            Colormap::Difference => ColorScale::symmetric(0.004),
            _ => ColorScale::new(map, range).reversed(),
        };
        let (name, quantity) = match map {
            Colormap::Difference => ("Difference at the table", Quantity::Length),
            _ => ("Depth", Quantity::Depth),
        };
        ScaleBar::new(name, scale, quantity, Orientation::Horizontal).marker(Some(0.45)).show(ui);
    }
}

pub(super) fn board(ui: &mut Ui, state: &mut GalleryState) {
    let picture = state.textures.get("board", 1, || crate::texture::color_image(&sample::eye(0.0))).clone();
    let size = tile(ui);
    let outline = [[30.0, 60.0], [150.0, 40.0], [158.0, 122.0], [38.0, 150.0]];
    let mut seen = ghost(&outline, Ghost::Wanted, "Hold the board here");
    for i in 0..40 {
        seen.dot(sample::corner_px(i % 8, i / 8), Role::Measured);
    }
    let residuals = sample::residuals();
    let scale = arrow_scale(&residuals, 8.0);
    let arrows = residual_arrows(&residuals, Eye::Left, scale);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        ImageView::new("Collect, left eye", Content::Picture(&picture))
            .overlay(&seen)
            .size(size)
            .show(ui, &mut state.single_view);
        let label = format!("pair-09, left eye, residuals × {scale}");
        ImageView::new(&label, Content::Picture(&picture))
            .overlay(&arrows)
            .size(size)
            .show(ui, &mut state.single_view);
    });
}

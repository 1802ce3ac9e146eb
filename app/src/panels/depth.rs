//! Disparity and depth as colors, with their scale.

use egui::{Color32, ColorImage, Ui, vec2};
use plumbline_engine::view::DisparityView;
use plumbline_engine::{DisparityOrigin, Products};
use plumbline_model::Eye;
use plumbline_widgets::colormap::{ColorScale, Orientation, ScaleBar, colorize, colorize_with};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::image_view::{Content, ImageView};

use super::rectified::{probe_mark, show_missing, take_probe};
use super::{PanelContext, picture, source_state};
use crate::operator::Pane;

/// Width of the strip with the scale, points.
const SCALE_WIDTH: f32 = 68.0;

pub fn disparity(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { disparity: true, ..Products::default() });
    let Some(values) = &cx.view.live.disparity else { return show_missing(ui, cx, "Disparity") };
    let range = [values.search_px.0 as f32, values.search_px.1 as f32];
    let scale = ColorScale::new(cx.state.live.colormap, range);
    let text = |u: usize, v: usize| {
        let text = format::px(values.disparity_px(u as u32, v as u32)?);
        Some(with_origin(values, u, v, text))
    };
    let look = Look {
        pane: Pane::Disparity,
        key: "disparity",
        label: "Disparity of the left eye",
        scale_label: "Disparity",
        quantity: Quantity::Pixels,
    };
    let value = |u: u32, v: u32| values.disparity_px(u, v);
    draw(ui, cx, values, scale, &look, &text, &value, &|| colorize(&values.values_px, size(values), &scale));
}

pub fn depth(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { disparity: true, ..Products::default() });
    let Some(values) = &cx.view.live.disparity else { return show_missing(ui, cx, "Depth") };
    let reach = (values.focal_px * values.baseline_m) as f32;
    let depth_m = |disparity: f32| if disparity > 0.0 { reach / disparity } else { f32::NAN };
    // Fitted when asked and then kept: colors that change their meaning by themselves cannot be learnt.
    let range_m =
        *cx.state.live.depth_range_m.get_or_insert_with(|| fitted_range_m(&values.values_px, depth_m));
    let scale = ColorScale::new(cx.state.live.colormap, range_m).reversed();
    let text = |u: usize, v: usize| {
        let text = format::depth(values.depth_m(u as u32, v as u32)?);
        Some(with_origin(values, u, v, text))
    };
    let look = Look {
        pane: Pane::Depth,
        key: "depth",
        label: "Depth seen by the left eye",
        scale_label: "Depth",
        quantity: Quantity::Depth,
    };
    let value = |u: u32, v: u32| values.depth_m(u, v);
    draw(ui, cx, values, scale, &look, &text, &value, &|| {
        let colors = colorize_with(&values.values_px, size(values), &scale, |disparity| depth_m(*disparity));
        dim_filled(colors, values)
    });
}

/// Places that were guessed from their surroundings are good to look at, not to measure.
fn dim_filled(mut colors: ColorImage, values: &DisparityView) -> ColorImage {
    let width = colors.size[0].max(1);
    for (i, pixel) in colors.pixels.iter_mut().enumerate() {
        let (u, v) = ((i % width) as u32, (i / width) as u32);
        if values.map.origin(u, v) == Some(DisparityOrigin::Filled) {
            *pixel = pixel.lerp_to_gamma(Color32::from_gray(40), 0.7);
        }
    }
    colors
}

/// A value under the pointer, and whether it was measured.
fn with_origin(values: &DisparityView, u: usize, v: usize, text: String) -> String {
    match values.map.origin(u as u32, v as u32) {
        Some(DisparityOrigin::Filled) => format!("{text}, filled in"),
        _ => text,
    }
}

/// Round depths around what is seen, meters.
fn fitted_range_m(values_px: &[f32], depth_m: impl Fn(f32) -> f32) -> [f32; 2] {
    let depths: Vec<f32> = values_px.iter().step_by(17).map(|d| depth_m(*d)).collect();
    let step = 0.05;
    match ColorScale::range_of(&depths) {
        Some([near, far]) => {
            let near = (near / step).floor() * step;
            [near, ((far.min(2.0) / step).ceil() * step).max(near + step)]
        }
        None => [0.2, 1.0],
    }
}

fn size(values: &DisparityView) -> [usize; 2] {
    [values.size_px.0 as usize, values.size_px.1 as usize]
}

struct Look {
    pane: Pane,
    key: &'static str,
    label: &'static str,
    scale_label: &'static str,
    quantity: Quantity,
}

#[expect(clippy::too_many_arguments, reason = "the two callers differ in exactly these")]
fn draw(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    values: &DisparityView,
    scale: ColorScale,
    look: &Look,
    text: &dyn Fn(usize, usize) -> Option<String>,
    value: &dyn Fn(u32, u32) -> Option<f64>,
    make: &dyn Fn() -> ColorImage,
) {
    let range_bits = scale.range.map(f32::to_bits);
    let seq = picture::seq_with(&values.stamp, (range_bits, scale.map));
    let picture = cx.state.textures.get(look.key, seq, make).clone();
    let overlay = probe_mark(cx.view, Eye::Left);
    let stale = source_state::stale_sentence(cx.view);
    let full = ui.available_size();
    let shown = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let shown = ImageView::new(look.label, Content::Picture(&picture))
            .caption(false)
            .overlay(&overlay)
            .stale(stale.as_deref())
            .value_text(text)
            .size(vec2((full.x - SCALE_WIDTH - 8.0).max(48.0), full.y))
            .show(ui, cx.state.views.entry((cx.screen, look.pane)).or_default());
        let under = shown.hover_px.and_then(|at| {
            let [u, v] = shown.transform.as_ref()?.pixel_at(at)?;
            value(u as u32, v as u32)
        });
        ui.allocate_ui(vec2(SCALE_WIDTH - 4.0, full.y), |ui| {
            ScaleBar::new(look.scale_label, scale, look.quantity, Orientation::Vertical)
                .marker(under.map(|v| v as f32))
                .show(ui);
        });
        shown
    });
    take_probe(cx, shown.inner.hover_px, shown.inner.clicked_px);
}

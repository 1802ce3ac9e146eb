//! The chosen pair: both images with what is left of their errors.

use std::sync::Arc;

use egui::{Ui, vec2};
use plumbline_engine::view::{CollectedPair, EyesView};
use plumbline_model::{Eye, PairFit};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::image_view::{Content, ImageView, ViewState};
use plumbline_widgets::overlay::{Overlay, bounds_px};
use plumbline_widgets::residuals::{arrow_scale, residual_arrows};

use super::PanelContext;

/// How long a typical arrow is drawn, image pixels.
const ARROW_PX: f64 = 12.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(fit) = chosen_fit(cx.view, cx.state.chosen_pair.as_deref()) else {
        let message =
            Message::new("No pair is chosen", "Click a bar to see the pair with what is left of its errors.");
        EmptyState::empty(message).show(ui);
        return;
    };
    let scale = arrow_scale(&fit.residuals, ARROW_PX);
    let pair = collected(&cx.view.eyes, &fit.name);
    let key = format!("{}{}", fit.name, fit.residuals.len());
    let look = cx.state.residuals_of.as_ref() != Some(&key);
    if look {
        cx.state.residuals_of = Some(key);
    }
    let gap = 2.0;
    let size = vec2((ui.available_width() - gap) / 2.0, ui.available_height());
    ui.spacing_mut().item_spacing.x = gap;
    ui.horizontal(|ui| {
        for eye in Eye::BOTH {
            let error_px = if eye == Eye::Left { fit.left_px } else { fit.right_px };
            let error = error_px.map_or("board not seen".to_owned(), format::px);
            let label = format!("{eye} eye {error}");
            if look {
                look_at_board(&mut cx.state.chosen[eye.index()], fit, eye, size);
            }
            let overlay = residual_arrows(&fit.residuals, eye, scale);
            collected_image(ui, cx, pair.as_deref(), eye, &label, &overlay, size);
        }
    });
}

/// Fills the view with the board, where the arrows are; a double click shows the whole image.
fn look_at_board(view: &mut ViewState, fit: &PairFit, eye: Eye, size: egui::Vec2) {
    let corners: Vec<[f64; 2]> =
        fit.residuals.iter().filter(|r| r.eye == eye).map(|r| [r.measured.u_px, r.measured.v_px]).collect();
    match bounds_px(&corners) {
        Some(bounds) => {
            let room = 1.35;
            let zoom = (size.x / bounds.width().max(1.0)).min(size.y / bounds.height().max(1.0)) / room;
            let center = bounds.center();
            view.look_at([f64::from(center.x), f64::from(center.y)], f64::from(zoom));
        }
        None => view.fit(),
    }
}

/// The fit of the chosen pair, or of the worst one while none is chosen.
pub(crate) fn chosen_fit<'a>(view: &'a plumbline_engine::View, chosen: Option<&str>) -> Option<&'a PairFit> {
    let fits = &super::shown_calibration_ref(&view.eyes)?.per_pair;
    let worst = |fit: &PairFit| fit.left_px.unwrap_or(0.0).max(fit.right_px.unwrap_or(0.0));
    fits.iter()
        .find(|fit| Some(fit.name.as_str()) == chosen)
        .or_else(|| fits.iter().max_by(|a, b| worst(a).total_cmp(&worst(b))))
}

/// A collected pair by its name.
pub fn collected(eyes: &EyesView, name: &str) -> Option<Arc<CollectedPair>> {
    eyes.collected.iter().find(|pair| pair.name == name).cloned()
}

/// One image of a collected pair with marks on it.
pub fn collected_image(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    pair: Option<&CollectedPair>,
    eye: Eye,
    label: &str,
    overlay: &Overlay,
    size: egui::Vec2,
) {
    let key = if eye == Eye::Left { "chosen left" } else { "chosen right" };
    let content = match pair.and_then(|pair| pair.image(eye)) {
        Some(image) => Content::Picture(cx.state.textures.gray_of(key, image)),
        None => Content::Empty(Message::new(
            "The image is not at hand",
            "Only its corners are known, from a file: open the pairs and collect them to see the images.",
        )),
    };
    ImageView::new(label, content)
        .overlay(overlay)
        .size(size)
        .crop()
        .show(ui, &mut cx.state.chosen[eye.index()]);
}

//! Where the board has been: over both images, in distance and in tilt.

use std::sync::Arc;

use egui::Ui;
use image::GrayImage;
use plumbline_engine::view::CollectedPair;
use plumbline_model::Eye;
use plumbline_widgets::Seen;
use plumbline_widgets::coverage::{Coverage, coverage_view};
use plumbline_widgets::empty::{EmptyState, Message};

use super::PanelContext;

/// So many images tell what the lens shows.
const LOOKED_AT: usize = 12;
/// Outside the image circle of a fisheye a camera delivers less than this, gray levels.
const DARK: u8 = 20;

/// Whether the image is not black at a place.
fn is_lit(image: &GrayImage, [u_px, v_px]: [f64; 2]) -> bool {
    let (u, v) = (u_px.max(0.0) as u32, v_px.max(0.0) as u32);
    u < image.width() && v < image.height() && image.get_pixel(u, v)[0] >= DARK
}

/// `None` without pairs.
fn count(pairs: &[Arc<CollectedPair>], image_size_px: Option<(u32, u32)>) -> Option<Coverage> {
    pairs.first()?;
    let mut coverage = Coverage::new(image_size_px?.into());
    for eye in Eye::BOTH {
        let images: Vec<&GrayImage> =
            pairs.iter().filter_map(|pair| pair.image(eye)).map(Arc::as_ref).take(LOOKED_AT).collect();
        if !images.is_empty() {
            let grid = coverage.grid_mut(eye);
            *grid =
                grid.clone().with_reachable(|center_px| images.iter().any(|image| is_lit(image, center_px)));
        }
    }
    for pair in pairs {
        for eye in Eye::BOTH {
            for corner in pair.corners(eye).into_iter().flatten().flatten() {
                coverage.grid_mut(eye).add([corner.u_px, corner.v_px]);
            }
        }
        if let Some(place) = pair.place {
            coverage.distance_m.add(place.distance_m);
            // The angle of two turns about perpendicular axes.
            let tilt_rad = (place.tilt_up_down_rad.cos() * place.tilt_left_right_rad.cos()).acos();
            coverage.tilt_rad.add(tilt_rad);
        }
    }
    Some(coverage)
}

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    // The images themselves know best; pairs from a file have none.
    let from_pairs = cx.view.eyes.collected.iter().find_map(|pair| pair.left_image.as_ref());
    let image_size_px = from_pairs.map(|image| image.dimensions()).or(cx.view.source.image_size_px);
    let pairs = &cx.view.eyes.collected;
    let counted = cx.state.coverage.get(Seen::of(pairs), || count(pairs, image_size_px));
    let Some(coverage) = &*counted else {
        let message = Message::new(
            "No pairs yet",
            "Collected pairs show here which parts of both images, which distances and which tilts are still missing.",
        );
        EmptyState::empty(message).show(ui);
        return;
    };
    super::padded(ui, |ui| {
        let height = ui.available_height();
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| coverage_view(ui, coverage, height));
    });
}

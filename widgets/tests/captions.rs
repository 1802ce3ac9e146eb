//! What stands on a picture and words of its boxes never lie on each other.

use egui::epaint::{ClippedShape, Shape};
use egui::{Color32, Rect};
use egui_kittest::Harness;
use image::{Rgb, RgbImage};
use plumbline_widgets::image_view::{Content, ImageView, ViewState};
use plumbline_widgets::overlay::{Emphasis, LabeledBox, Mark, Overlay};
use plumbline_widgets::texture::TextureCache;
use plumbline_widgets::theme;

/// Boxes so that their words would lie where the name, the sentence below it and the button are.
fn overlay(size: [f64; 2]) -> Overlay {
    let [width, height] = size;
    let corners = [[4.0, 24.0], [width - 34.0, 24.0], [70.0, 40.0], [width / 2.0, height / 2.0]];
    let mut overlay = Overlay::new();
    overlay.push(Mark::Boxes(
        corners
            .map(|[x, y]| LabeledBox {
                outline_px: vec![[x, y], [x + 30.0, y], [x + 30.0, y + 24.0], [x, y + 24.0]],
                text: format!("toy {x:.0}"),
                color: Color32::GREEN,
                emphasis: Emphasis::Usual,
                dashed: false,
            })
            .to_vec(),
    ));
    overlay
}

fn texts(shape: &Shape, found: &mut Vec<(String, Rect)>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
        Shape::Text(text) => {
            found.push((text.galley.text().to_owned(), text.galley.rect.translate(text.pos.to_vec2())));
        }
        _ => {}
    }
}

#[test]
fn words_of_boxes_keep_off_the_name_the_warning_and_the_button_of_a_picture() {
    // Dark at both sides, as a fisheye lens leaves it, so that there is a button.
    let image = RgbImage::from_fn(360, 200, |x, _| Rgb([if (40..320).contains(&x) { 90 } else { 0 }; 3]));
    let mut cache = TextureCache::default();
    let mut view = ViewState::default();
    let mut harness = Harness::builder()
        .with_size([400.0, 240.0])
        .with_context_setup(|ctx| theme::apply(ctx, egui::Theme::Dark))
        .build_ui(move |ui| {
            let picture = cache.rgb("left", 1, &image);
            ImageView::new("Left", Content::Picture(picture))
                .overlay(&overlay([360.0, 200.0]))
                .note(Some("Boxes are 2 s old"))
                .crop()
                .show(ui, &mut view);
        });
    harness.run_steps(3);
    let mut found = vec![];
    for ClippedShape { shape, .. } in &harness.output().shapes {
        texts(shape, &mut found);
    }
    let has = |start: &str| found.iter().filter(|(text, _)| text.starts_with(start)).count();
    assert!(has("Left") >= 1 && has("Boxes are") >= 1 && has("All") >= 1 && has("toy") >= 3, "{found:?}");
    for (i, (a, on)) in found.iter().enumerate() {
        for (b, other) in &found[i + 1..] {
            assert!(a == b || !on.intersects(*other), "{a} at {on} lies on {b} at {other}");
        }
    }
}

//! Both eyes in one picture: red and cyan, or in turns.

use egui::Ui;
use plumbline_engine::Products;
use plumbline_model::{Eye, duration};
use plumbline_widgets::compare;
use plumbline_widgets::empty::Message;
use plumbline_widgets::image_view::{Content, ImageView};

use super::rectified::{probe_mark, show_missing, take_probe};
use super::{PanelContext, picture, source_state};
use crate::operator::Pane;

/// How long each eye is shown, seconds.
const BLINK_S: f64 = 0.5;

pub fn anaglyph(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { rectified: true, ..Products::default() });
    let Some(rectified) = &cx.view.live.rectified else { return show_missing(ui, cx, "Anaglyph") };
    let seq = picture::seq(&rectified.stamp);
    let mixed = if cx.state.textures.last("anaglyph").is_some_and(|picture| picture.seq() == Some(seq)) {
        Ok(None)
    } else {
        compare::anaglyph(&rectified.left, &rectified.right).map(Some)
    };
    let why;
    let content = match mixed {
        Ok(image) => {
            let picture = cx.state.textures.get("anaglyph", seq, || image.unwrap_or_default());
            Content::Picture(picture)
        }
        Err(error) => {
            why = error.to_string();
            Content::Failed(Message::new("No anaglyph", &why))
        }
    };
    let stale = source_state::stale_sentence(cx.view);
    let shown = ImageView::new("Left eye red, right eye cyan", content)
        .stale(stale.as_deref())
        .show(ui, cx.state.views.entry((cx.screen, Pane::Anaglyph)).or_default());
    take_probe(cx, shown.hover_px, shown.clicked_px);
}

pub fn blink(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { rectified: true, ..Products::default() });
    let Some(rectified) = &cx.view.live.rectified else { return show_missing(ui, cx, "Blink") };
    let now_s = ui.input(|input| input.time);
    let eye = compare::blink(now_s, BLINK_S);
    let remaining = duration::seconds(compare::blink_remaining_s(now_s, BLINK_S));
    ui.ctx().request_repaint_after(remaining.unwrap_or_default());
    let (image, label) = match eye {
        Eye::Left => (&rectified.left, "Left"),
        Eye::Right => (&rectified.right, "Right"),
    };
    let picture = cx.state.textures.rgb("blink", picture::seq_with(&rectified.stamp, eye), image);
    let overlay = probe_mark(cx.view, eye);
    let stale = source_state::stale_sentence(cx.view);
    ImageView::new(label, Content::Picture(picture))
        .overlay(&overlay)
        .stale(stale.as_deref())
        .show(ui, cx.state.views.entry((cx.screen, Pane::Blink)).or_default());
}

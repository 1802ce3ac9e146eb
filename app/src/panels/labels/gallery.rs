//! The images as a strip of small pictures.

use egui::{Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use plumbline_engine::LabelsCommand;
use plumbline_widgets::glyph;
use plumbline_widgets::texture::Sampling;
use plumbline_widgets::theme::{self, Role};

use super::parts::sign;
use crate::panels::PanelContext;

const GAP: f32 = 6.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let images = &view.labels.images;
    if images.is_empty() {
        return;
    }
    let height = (ui.available_height() - 22.0).clamp(40.0, 160.0);
    let size = vec2(height * 4.0 / 3.0, height);
    let step = size.x + GAP;
    let shown = view.labels.shown.as_ref();
    let name = shown.map(|shown| shown.name.clone()).unwrap_or_default();
    let mut area = ScrollArea::horizontal().auto_shrink(false);
    if cx.state.labels.scrolled[1] != name {
        cx.state.labels.scrolled[1] = name;
        if let Some(shown) = shown {
            let middle = shown.index as f32 * step - 0.5 * (ui.available_width() - step);
            area = area.horizontal_scroll_offset(middle.max(0.0));
        }
    }
    area.show_viewport(ui, |ui, viewport| {
        ui.set_width(images.len() as f32 * step + GAP);
        ui.set_height(size.y + 8.0);
        let origin = ui.max_rect().min;
        let first = (viewport.left() / step).floor().max(0.0) as usize;
        let last = ((viewport.right() / step).ceil().max(0.0) as usize).min(images.len());
        for index in first..last {
            let rect = Rect::from_min_size(origin + vec2(GAP + index as f32 * step, 6.0), size);
            thumbnail(ui, cx, index, rect, shown.is_some_and(|shown| shown.index == index));
        }
    });
}

fn thumbnail(ui: &mut Ui, cx: &mut PanelContext<'_>, index: usize, rect: Rect, shown: bool) {
    let image = &cx.view.labels.images[index];
    let tokens = theme::tokens(ui);
    let response = ui.interact(rect, ui.scope_id().with(("thumbnail", index)), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::Image, true, shown, format!("Picture of {}", image.name))
    });
    ui.painter().rect_filled(rect, 3.0, tokens.backdrop);
    if let Some(small) = cx.view.labels.thumbnails.get(&image.name) {
        let key = format!("label thumbnail {index}");
        let picture = cx.state.textures.rgb_of(&key, small);
        let texture = picture.texture(ui.ctx(), Sampling::Smooth);
        let [w, h] = picture.size_px().map(|n| n as f32);
        let scale = (rect.width() / w).min(rect.height() / h);
        let inside = Rect::from_center_size(rect.center(), vec2(w * scale, h * scale));
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture, inside, whole, egui::Color32::WHITE);
    }
    let (symbol, role) =
        if image.unusable.is_some() { (glyph::Glyph::Cross, Role::Warning) } else { sign(image.state) };
    let badge = rect.right_top() + vec2(-11.0, 11.0);
    ui.painter().circle_filled(badge, 8.5, tokens.panel.gamma_multiply(0.85));
    glyph::paint(ui.painter(), badge, 11.0, symbol, role.color(tokens));
    if shown || response.hovered() || response.has_focus() {
        let color = if shown { tokens.accent } else { tokens.text_weak };
        ui.painter().rect_stroke(rect.expand(1.0), 3.0, Stroke::new(2.0, color), StrokeKind::Outside);
    }
    if response.on_hover_text(&image.name).clicked() {
        cx.outbox.send(LabelsCommand::Choose { image: image.name.clone() });
    }
}

//! "Good: …" or "Do not accept: …", with its sign.

use egui::{RichText, Sense, Ui, Vec2};
use plumbline_widgets::glyph::{self, Glyph};
use plumbline_widgets::theme::{self, Role};

use crate::operator::Verdict;

pub fn show(ui: &mut Ui, verdict: &Verdict) {
    let (sign, role) =
        if verdict.good { (Glyph::Check, Role::Accepted) } else { (Glyph::Warning, Role::Warning) };
    let tokens = theme::tokens(ui);
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::new(18.0, 20.0), Sense::hover());
        glyph::paint(ui.painter(), rect.center(), 14.0, sign, role.color(tokens));
        let text = RichText::new(&verdict.sentence)
            .text_style(theme::strong_style(ui))
            .color(if verdict.good { tokens.text_strong } else { role.color(tokens) });
        ui.add(egui::Label::new(text).wrap());
    });
}

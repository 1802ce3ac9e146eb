//! Errors over the table as arrows: which ones, how long, and what they mean.

use egui::{Sense, Stroke, Ui, vec2};
use plumbline_widgets::theme::{self, Role};
use serde::Deserialize;

/// Which errors are drawn as arrows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Errors {
    /// Without a model, or without the effects.
    Before,
    /// With it.
    After,
    /// Both.
    #[default]
    Both,
}

/// Half of the arrows are longer than this on the table, m.
const ARROW_M: f64 = 0.018;

/// A round magnification that makes half of the arrows easy to see: 1, 2, 5, 10, …
pub(crate) fn arrow_scale(lengths: impl Iterator<Item = f64>) -> f64 {
    let mut lengths: Vec<f64> = lengths.collect();
    lengths.sort_by(f64::total_cmp);
    let median = lengths.get(lengths.len() / 2).copied().filter(|median| *median > 0.0);
    let wanted = median.map_or(1.0, |median| (ARROW_M / median).clamp(1.0, 100.0));
    [100.0, 50.0, 20.0, 10.0, 5.0, 2.0].into_iter().find(|scale| *scale <= wanted).unwrap_or(1.0)
}

/// A line in the color that it has on a bare map, and what it means.
pub(crate) fn entry(ui: &mut Ui, role: Role, text: &str) {
    entry_in(ui, theme::tokens(ui), role, text);
}

/// The same on a map with a field of colors.
pub(crate) fn entry_on_field(ui: &mut Ui, role: Role, text: &str) {
    entry_in(ui, &theme::ON_IMAGE, role, text);
}

fn entry_in(ui: &mut Ui, tokens: &theme::Tokens, role: Role, text: &str) {
    ui.spacing_mut().interact_size.y = 14.0;
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(26.0, 14.0), Sense::hover());
        ui.painter().rect_filled(rect, 3.0, tokens.backdrop);
        let stroke = Stroke::new(2.0, role.color(tokens));
        ui.painter().hline(rect.shrink(5.0).x_range(), rect.center().y, stroke);
        ui.add(egui::Label::new(theme::small(ui, text)).wrap());
    });
}

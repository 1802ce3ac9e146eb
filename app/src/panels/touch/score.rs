//! What a plan will be able to tell apart, in plain words.

use egui::{CollapsingHeader, Ui};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::snapshot::touch::{EffectVisibility, PlanScore};

/// So many rows are enough to judge by.
const ROWS: usize = 12;

pub fn show(ui: &mut Ui, score: &PlanScore) {
    let seen = score.seen.iter().filter(|effect| effect.is_seen()).count();
    ui.add_space(space::XS);
    if seen == 0 {
        let none = "No cause of errors would stand out of the noise: more targets are needed.";
        ui.label(theme::weak(ui, none));
    }
    if let Some(advice) = score.advice.first() {
        ui.label(theme::weak(ui, format!("To learn more: {}", uncapitalized(&advice.sentence))));
    }
    let shown = CollapsingHeader::new("What the touches will tell").id_salt("plan score");
    shown.show(ui, |ui| {
        if seen > 0 {
            ui.label(theme::small(ui, told_apart(score, seen)));
        }
        ui.label(theme::small(ui, "Cause, and how far a usual one stands out of the noise"));
        for effect in score.seen.iter().take(ROWS) {
            row(ui, effect);
        }
        let rest = score.seen.len().saturating_sub(ROWS);
        if rest > 0 {
            ui.label(theme::small(ui, format!("and {rest} that show less")));
        }
    });
}

/// A mixture of causes is told where no other one looks like it: a sum over all of them, not a part of those that show.
fn told_apart(score: &PlanScore, seen: usize) -> String {
    let alike: usize = score.alike.iter().map(Vec::len).sum();
    let told = format!("These touches tell {} of causes apart.", format::count(score.directions, "mixture"));
    match alike {
        0 => told,
        _ => format!("Of the {seen}, {alike} look like another one on the glass. {told}"),
    }
}

fn row(ui: &mut Ui, effect: &EffectVisibility) {
    ui.horizontal(|ui| {
        let role = if effect.is_seen() { Role::Ink } else { Role::Weak };
        let color = role.color(theme::tokens(ui));
        let times = format!("{} ×", format::significant(effect.sigmas, 2));
        ui.add_sized([52.0, 16.0], egui::Label::new(egui::RichText::new(times).color(color)));
        let title = egui::Label::new(egui::RichText::new(&effect.title).color(color)).truncate();
        ui.add(title).on_hover_text(format!(
            "{}: doubt left when every other cause may be there, too: {}",
            effect.title,
            format::percent(effect.doubt_left)
        ));
    });
}

fn uncapitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

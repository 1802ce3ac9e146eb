//! What is missing, by name: cards of the effects that were found, and what the data say about every
//! other candidate.

use egui::{Checkbox, Frame, Grid, Margin, RichText, ScrollArea, Ui};
use plumbline_engine::GapCommand;
use plumbline_engine::view::ShownFinding;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::glyph::Glyph;
use plumbline_widgets::probability::{self, ShareRow, probability_bar, share_rows};
use plumbline_widgets::theme::{self, Role, space};
use plumbline_widgets::{format, parameter};

use super::parts::{finding, line, state};
use super::state::Sort;
use crate::operator::GapAction;
use crate::operator::snapshot::gap::{Candidate, Finding, NamedEffect, Shown, Verdict};
use crate::operator::words::gap as words;
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "Choose sessions, then look for what the model does not have: a joint's zero, play, something that gives way. Nothing moves.";
    let Some(shown) = finding(ui, cx, what) else { return };
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            state(ui, cx.view);
            verdict(ui, &shown.finding);
            ui.add_space(space::S);
            for i in 0..shown.finding.effects.len() {
                card(ui, cx, &shown, i);
                ui.add_space(space::S);
            }
            unexplained(ui, &shown.finding);
            ui.add_space(space::S);
            add(ui, cx, &shown);
        });
    });
}

/// The answer in a word and in a sentence.
fn verdict(ui: &mut Ui, finding: &Finding) {
    let (sign, role) = match finding.verdict {
        Verdict::NoGap => (Glyph::Check, Role::Accepted),
        Verdict::Named => (Glyph::Disc, Role::Accepted),
        Verdict::Class => (Glyph::Info, Role::Ink),
        Verdict::NotInLibrary => (Glyph::Warning, Role::Warning),
    };
    let tokens = theme::tokens(ui);
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 20.0), egui::Sense::hover());
        plumbline_widgets::glyph::paint(ui.painter(), rect.center(), 14.0, sign, role.color(tokens));
        ui.label(theme::strong(ui, words::verdict(finding.verdict)));
    });
    ui.label(&finding.sentence);
    let more = match finding.verdict {
        Verdict::NoGap => {
            "Nothing has to be added. Measure again when something was changed or after some weeks."
        }
        Verdict::Named => "",
        Verdict::Class => {
            "These data fit several names equally well. Adding the most probable one corrects what was measured; the experiment says which one is right elsewhere, too."
        }
        Verdict::NotInLibrary if finding.partial => {
            "What is listed below is no name, but it closes a part of the gap on rows that were not used. It can be added as that; the rest stays."
        }
        Verdict::NotInLibrary => {
            "What is listed below is what the rest looks partly like; it is not a name, and it cannot be added. The map and the charts say where it shows."
        }
    };
    if !more.is_empty() {
        ui.label(theme::small(ui, more));
    }
}

/// One effect: what it is, how large, how sure, and what else it could be.
fn card(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding, i: usize) {
    let effect = &shown.finding.effects[i];
    let added = shown.added.get(i).copied().unwrap_or(false);
    let tokens = theme::tokens(ui);
    let frame = Frame::new()
        .fill(tokens.raised.gamma_multiply(0.35))
        .corner_radius(6.0)
        .inner_margin(Margin::symmetric(12, 8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            head(ui, cx, shown, i);
            if added {
                let text = RichText::new("in the model").color(Role::Accepted.color(tokens));
                ui.label(text);
            }
        });
        sizes(ui, effect, &shown.finding.shown);
        let role = if shown.finding.verdict == Verdict::NotInLibrary { Role::Weak } else { Role::Predicted };
        if effect.class.len() > 1 {
            probability_bar(ui, &format!("{}, class", effect.title), effect.class_probability, role)
                .on_hover_text("Probability that it is one of the names below");
            class(ui, effect, role);
        } else {
            probability_bar(ui, &effect.title, effect.probability, role)
                .on_hover_text("Probability that this name is right");
        }
        if let Some((runner_up, margin)) = &effect.runner_up {
            ui.label(theme::small(ui, format!("Runner-up: {runner_up}, {}.", odds(*margin))));
        }
        if let Some(why) = &effect.not_addable {
            line(ui, Glyph::Warning, Role::Warning, &format!("Cannot be added: {why}"));
        }
    });
}

/// The title, with a check mark where it can be added beside others.
fn head(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding, i: usize) {
    let effect = &shown.finding.effects[i];
    let addable = cx.view.gap.addable();
    if addable.len() > 1 && addable.contains(&i) {
        let left_out = &mut cx.state.gap.left_out;
        let mut wanted = !left_out.contains(&i);
        let check = ui.add(Checkbox::new(&mut wanted, theme::strong(ui, &effect.title)));
        if check.on_hover_text("Whether it is added with the others").changed() {
            if wanted { left_out.retain(|other| *other != i) } else { left_out.push(i) }
        }
        return;
    }
    ui.label(theme::strong(ui, &effect.title));
}

/// Parameters with their intervals, and what the effect does on the table.
fn sizes(ui: &mut Ui, effect: &NamedEffect, shown: &Shown) {
    Grid::new(("size", &effect.id, &effect.site)).num_columns(3).spacing([space::M, 2.0]).show(ui, |ui| {
        for found in &effect.parameters {
            ui.label(theme::weak(ui, parameter::words(&found.name)));
            match &found.text {
                Some(text) => {
                    ui.label(text);
                    ui.label("");
                }
                None => {
                    ui.label(theme::strong(ui, parameter::value(&found.name, found.value)));
                    let interval = parameter::interval(&found.name, found.low, found.high);
                    ui.label(theme::weak(ui, format!("{interval} (95 %)")));
                }
            }
            ui.end_row();
        }
        if effect.size_m > 0.0 {
            ui.label(theme::weak(ui, "does"));
            ui.label(words::error(shown, effect.size_m));
            let sigmas = format::significant(effect.size_sigmas, 2);
            ui.label(theme::weak(ui, format!("rms, {sigmas} × the noise")));
            ui.end_row();
        }
    });
}

/// All names that cannot be told apart, with their shares, and what would tell them apart.
fn class(ui: &mut Ui, effect: &NamedEffect, role: Role) {
    let n = effect.class.len();
    ui.label(theme::small(ui, format!("One of {n} names that these data cannot tell apart:")));
    let rows: Vec<ShareRow> = effect
        .class
        .iter()
        .map(|member| ShareRow {
            name: member.title.clone(),
            share: member.probability,
            note: String::new(),
            role,
        })
        .collect();
    share_rows(ui, &rows);
    if let Some(split) = &effect.split_by {
        line(ui, Glyph::Info, Role::Ink, &format!("To tell them apart: {split}."));
    }
}

/// "200 times less probable".
fn odds(margin_log10: f64) -> String {
    let odds = 10f64.powf(margin_log10);
    if !odds.is_finite() || odds > 1e4 {
        return "more than 10 000 times less probable".to_owned();
    }
    if odds < 1.5 {
        return "about as probable".to_owned();
    }
    format!("{} times less probable", format::significant(odds, 2))
}

/// What stays.
fn unexplained(ui: &mut Ui, finding: &Finding) {
    if finding.verdict == Verdict::NoGap {
        return;
    }
    let left = &finding.unexplained;
    theme::group_heading(ui, "What stays unexplained");
    let enough = left.p_value > 0.05 && finding.verdict != Verdict::NotInLibrary;
    let (sign, role, said) = if enough {
        (Glyph::Check, Role::Accepted, "The rest is what noise alone would leave.".to_owned())
    } else {
        let share = format::percent(left.share);
        (Glyph::Info, Role::Ink, format!("{share} of the gap stays, and noise alone does not explain it."))
    };
    line(ui, sign, role, &said);
    ui.label(theme::small(
        ui,
        format!(
            "Probability that something outside of the library is at work: {}.",
            probability::percent(left.probability)
        ),
    ));
    for on in &left.depends_on {
        let formula = on.formula.as_ref().map_or_else(String::new, |formula| format!(" — {formula}"));
        let share = format::percent(on.share);
        ui.label(theme::small(ui, format!("{} depends on {}: {share} of the rest{formula}.", on.of, on.on)));
    }
}

/// What will change, and the button that does it.
fn add(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding) {
    let addable = cx.view.gap.addable();
    let wanted: Vec<usize> = addable.iter().copied().filter(|i| !cx.state.gap.left_out.contains(i)).collect();
    theme::group_heading(ui, "The model");
    let in_use = format!("In use: {}.", cx.view.gap.model.name);
    ui.label(theme::weak(ui, in_use));
    if !addable.is_empty() {
        let what = match wanted.len() {
            0 => "Choose above what is added.".to_owned(),
            _ => "Nothing moves. From then on all predictions, previews and targets of this robot use the corrected model; touches go elsewhere than before.".to_owned(),
        };
        ui.label(theme::small(ui, what));
        ui.horizontal_wrapped(|ui| {
            let text = words::add_label(cx.view, &wanted);
            let button = ui.add_enabled(!wanted.is_empty(), egui::Button::new(text));
            if button.clicked() {
                cx.outbox.send(GapCommand::Add { effects: wanted });
            }
        });
    } else if shown.added.iter().any(|added| *added) {
        ui.label(theme::small(
            ui,
            "Its effects are in the model. Look for what is left, or prove it by touching new targets.",
        ));
    }
    if addable.is_empty() && cx.view.gap.sizes_arm {
        let what = "No name can be added. Small shares of all that usually is wrong with arms may still correct this one; touches held out tell whether they do. Nothing moves.";
        ui.label(theme::small(ui, what));
        action_button(ui, cx, GapAction::Size, GapAction::Size.label());
    }
    ui.horizontal_wrapped(|ui| {
        if !cx.view.gap.model.effects.is_empty() {
            action_button(ui, cx, GapAction::Prove, "Prove it");
        }
        if cx.view.gap.model.can_undo {
            action_button(ui, cx, GapAction::Undo, "Back to the model before");
        }
        if !cx.view.gap.model.effects.is_empty() {
            action_button(ui, cx, GapAction::UseNominal, "Take all effects out");
        }
    });
}

/// Every candidate with what the data say about it.
pub fn show_candidates(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "Every effect of the library is tried. Here stands what the data can say about each.";
    let Some(shown) = finding(ui, cx, what) else { return };
    let mut candidates: Vec<&Candidate> = shown.finding.candidates.iter().collect();
    if candidates.is_empty() {
        let text = "Model and measurement agree, so no candidate was tried.";
        EmptyState::empty(Message::new("No candidates", text)).show(ui);
        return;
    }
    padded(ui, |ui| {
        let options = [(Sort::Probability, "Probability"), (Sort::Score, "Pull"), (Sort::Name, "Name")];
        ui.horizontal(|ui| {
            ui.label(theme::weak(ui, "Sorted by"));
            choice(ui, "Sorted by", &mut cx.state.gap.sort, &options);
        });
        match cx.state.gap.sort {
            Sort::Probability => candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability)),
            Sort::Score => candidates.sort_by(|a, b| b.score_sigmas.abs().total_cmp(&a.score_sigmas.abs())),
            Sort::Name => candidates.sort_by(|a, b| a.title.cmp(&b.title)),
        }
        ui.add_space(space::XS);
        table(ui, &candidates);
    });
}

const CANDIDATE_ROW: f32 = 20.0;

fn table(ui: &mut Ui, candidates: &[&Candidate]) {
    let width = ui.available_width();
    let columns = [width - 230.0, 70.0, 60.0, 84.0].map(|w: f32| w.max(50.0));
    let header = ["", "probability", "pull, σ", "the data"];
    candidate_row(ui, columns, header.map(|text| (text.to_owned(), true)), None);
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, CANDIDATE_ROW, candidates.len(), |ui, shown| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for candidate in &candidates[shown] {
            let (word, meaning) = words::knowledge(&candidate.knowledge);
            let cells = [
                (candidate.title.clone(), false),
                (probability::percent(candidate.probability), candidate.probability < 0.05),
                (format::fixed(candidate.score_sigmas, 1), candidate.score_sigmas.abs() < 3.0),
                (word.to_owned(), word != "known"),
            ];
            let name = if candidate.site.is_empty() {
                candidate.id.clone()
            } else {
                format!("{}@{}", candidate.id, candidate.site)
            };
            candidate_row(ui, columns, cells, Some(format!("{name}\n{meaning}")));
        }
    });
}

fn candidate_row(ui: &mut Ui, columns: [f32; 4], cells: [(String, bool); 4], help: Option<String>) {
    let height = CANDIDATE_ROW;
    let size = egui::vec2(ui.available_width(), height);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    let words = cells.iter().map(|(text, _)| text.as_str()).filter(|t| !t.is_empty()).collect::<Vec<_>>();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, words.join(", ")));
    let tokens = theme::tokens(ui);
    if response.hovered() && help.is_some() {
        ui.painter().rect_filled(rect, 3.0, tokens.raised.gamma_multiply(0.6));
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut x = rect.left();
    for (i, ((text, weak), width)) in cells.into_iter().zip(columns).enumerate() {
        let color = if weak { tokens.text_weak } else { tokens.text };
        let mut job = egui::text::LayoutJob::simple_singleline(text, font.clone(), color);
        job.wrap = egui::text::TextWrapping::truncate_at_width(width - 6.0);
        let galley = ui.painter().layout_job(job);
        // Numbers end below each other.
        let left = if matches!(i, 1 | 2) { x + width - 14.0 - galley.size().x } else { x };
        ui.painter().galley(egui::pos2(left, rect.center().y - galley.size().y / 2.0), galley, color);
        x += width;
    }
    if let Some(help) = help {
        response.on_hover_text(help);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_are_said_in_words() {
        assert_eq!(odds(0.05), "about as probable");
        assert_eq!(odds(2.0), "100 times less probable");
        assert!(odds(f64::INFINITY).starts_with("more than"));
    }
}

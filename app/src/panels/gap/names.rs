//! What is missing, by name: the verdict, and cards of the effects that were found.

use egui::{Checkbox, Frame, Margin, Panel, RichText, ScrollArea, Ui};
use plumbline_engine::view::{ShownFinding, Subject};
use plumbline_engine::{GapCommand, View};
use plumbline_widgets::glyph::Glyph;
use plumbline_widgets::probability::{self, ShareRow, probability_bar, share_rows};
use plumbline_widgets::theme::{self, Role, space};
use plumbline_widgets::{format, parameter};

use super::parts::{finding, line, state};
use super::sizes::sizes;
use crate::operator::guidance::guidance;
use crate::operator::snapshot::gap::{Finding, NamedEffect, Verdict};
use crate::operator::words::effect::runner_up;
use crate::operator::words::gap as words;
use crate::operator::words::proof::{Proof, Worth, proven_before};
use crate::operator::words::sentence;
use crate::operator::{Action, GapAction, Screen};
use crate::panels::parts::{action_button, undo_button};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "Choose sessions, then look for what the model does not have: a joint's zero, play, something that gives way. Nothing moves.";
    let Some(shown) = finding(ui, cx, what) else { return };
    offer(ui, cx);
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            state(ui, cx.view);
            proven(ui, cx.view);
            verdict(ui, &shown.finding);
            ui.add_space(space::S);
            cards(ui, cx, &shown);
            unexplained(ui, &shown.finding);
            ui.add_space(space::S);
            model(ui, cx, &shown);
        });
    });
}

/// What touches with the effects and without them say of those in use: more than any finding.
fn proven(ui: &mut Ui, view: &View) {
    let Some(proof) = Proof::of_model(view) else {
        if let Some(before) = proven_before(view) {
            line(ui, Glyph::Check, Role::Accepted, &before);
            ui.add_space(space::S);
        }
        return;
    };
    let (sign, role) = match proof.worth() {
        Worth::Help => (Glyph::Check, Role::Accepted),
        Worth::Untold => (Glyph::Info, Role::Ink),
        Worth::Harm => (Glyph::Warning, Role::Warning),
    };
    line(ui, sign, role, &proof.headline());
    ui.label(theme::small(ui, proof.figures()));
    let closure = view.gap.finding().and_then(|finding| finding.told_closure());
    if let Some(why) = proof.beside_held_out(closure) {
        ui.label(theme::small(ui, why));
    }
    ui.add_space(space::S);
}

/// So many effects have a card at once, the largest; the others are behind "more".
const MOST_CARDS: usize = 3;
/// So many warnings stand beside the verdict; all of them are on the tab Compare.
const MOST_WARNINGS: usize = 3;

/// The effects, the largest first.
fn cards(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding) {
    let count = shown.finding.effects.len();
    for i in 0..count.min(MOST_CARDS) {
        card(ui, cx, shown, i);
        ui.add_space(space::S);
    }
    if count > MOST_CARDS {
        let title = format!("{} more", count - MOST_CARDS);
        egui::CollapsingHeader::new(title).id_salt("more effects").show(ui, |ui| {
            for i in MOST_CARDS..count {
                card(ui, cx, shown, i);
                ui.add_space(space::S);
            }
        });
        ui.add_space(space::S);
    }
}

/// The answer in a word and in a sentence, and what is odd about the data that it rests on.
fn verdict(ui: &mut Ui, finding: &Finding) {
    let (sign, role) = match finding.verdict {
        Verdict::NoGap if finding.is_all_clear() => (Glyph::Check, Role::Accepted),
        Verdict::NoGap => (Glyph::Info, Role::Ink),
        Verdict::Named => (Glyph::Disc, Role::Accepted),
        Verdict::Class => (Glyph::Info, Role::Ink),
        Verdict::NotInLibrary => (Glyph::Warning, Role::Warning),
    };
    let tokens = theme::tokens(ui);
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 20.0), egui::Sense::hover());
        plumbline_widgets::glyph::paint(ui.painter(), rect.center(), 14.0, sign, role.color(tokens));
        ui.label(theme::strong(ui, words::heading(finding)));
    });
    ui.label(&finding.sentence);
    let more = match finding.verdict {
        // The sentence says that nothing tells the noise, and what would.
        Verdict::NoGap if !finding.is_all_clear() => "",
        Verdict::NoGap => {
            "Nothing has to be added. Measure again when something was changed or after some weeks."
        }
        Verdict::Named => "",
        Verdict::Class if finding.many.is_some() => {
            "Adding corrects the arm all the same: the names below and small shares of everything else. To repair something that is not sure, measure more first: with repeats, at other heights, with a weight."
        }
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
    for warning in finding.warnings.iter().take(MOST_WARNINGS) {
        line(ui, Glyph::Warning, Role::Warning, &sentence(warning));
    }
    if finding.warnings.len() > MOST_WARNINGS {
        let rest = format::count(finding.warnings.len() - MOST_WARNINGS, "more warning");
        ui.label(theme::small(ui, format!("{rest} under Compare.")));
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
        // Below each other: titles are long, and a tile is narrow.
        head(ui, cx, shown, i);
        if added {
            let text = in_model(cx.view, effect);
            ui.label(RichText::new(text).color(Role::Accepted.color(tokens)));
        }
        sizes(ui, effect, &shown.finding);
        let is_weak = shown.finding.verdict == Verdict::NotInLibrary || shown.finding.many.is_some();
        let role = if is_weak { Role::Weak } else { Role::Predicted };
        if effect.class.len() > 1 {
            ui.label(theme::small(ui, "One of the names below is right with"));
            probability_bar(ui, &format!("{}, class", effect.title), effect.class_probability, role)
                .on_hover_text("Probability that it is one of the names below");
            class(ui, effect, role);
        } else {
            ui.label(theme::small(ui, "This name is right with"));
            probability_bar(ui, &effect.title, effect.probability, role)
                .on_hover_text("Probability that this name is right");
        }
        if let Some(said) = runner_up(effect, &shown.finding.candidates) {
            ui.label(theme::small(ui, said));
        }
        if let Some(why) = &effect.not_addable {
            line(ui, Glyph::Warning, Role::Warning, &format!("Cannot be added: {why}"));
        }
    });
}

/// That an effect is in the model, and how large it is there where that is another size than here: what was measured
/// later, such as the hands, is taken into it.
fn in_model(view: &View, found: &NamedEffect) -> String {
    let name = format!("{}@{}", found.id, found.site);
    let there = view.gap.model.effects.iter().find(|there| there.name == name || there.name == found.id);
    let Some(there) = there else { return "in the model".to_owned() };
    let told: Vec<String> = found
        .parameters
        .iter()
        .filter(|found| found.is_told() && found.text.is_none())
        .filter_map(|found| {
            let (name, now, _) = there.parameters.iter().find(|(name, ..)| *name == found.name)?;
            let [was, now] = [found.value, *now].map(|value| parameter::value(name, value));
            (was != now).then(|| format!("{} {now}", parameter::words(name)))
        })
        .collect();
    match told.as_slice() {
        [] => "in the model".to_owned(),
        told => format!("in the model, by what was measured since: {}", told.join(", ")),
    }
}

/// The title, with a check mark where it can be added beside others.
fn head(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding, i: usize) {
    let effect = &shown.finding.effects[i];
    let addable = cx.view.gap.addable();
    if addable.len() > 1 && addable.contains(&i) {
        let mut wanted = !shown.left_out.contains(&i);
        let check = ui.add(Checkbox::new(&mut wanted, theme::strong(ui, &effect.title)));
        if check.on_hover_text("Whether it is added with the others").changed() {
            cx.outbox.send(GapCommand::LeaveOut { effect: i, is_left_out: !wanted });
        }
        return;
    }
    ui.label(theme::strong(ui, &effect.title));
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

/// What stays.
fn unexplained(ui: &mut Ui, finding: &Finding) {
    if finding.verdict == Verdict::NoGap {
        return;
    }
    let left = &finding.unexplained;
    theme::group_heading(ui, "What stays unexplained");
    let (is_noise, said) = words::rest(finding);
    let (sign, role) = if is_noise { (Glyph::Check, Role::Accepted) } else { (Glyph::Info, Role::Ink) };
    line(ui, sign, role, &said);
    // Where nothing tells the noise, a rest that looks like none excludes nothing.
    if finding.comparison.is_noise_known() || finding.verdict == Verdict::NotInLibrary {
        ui.label(theme::small(
            ui,
            format!(
                "Probability that something outside of the library is at work: {}.",
                probability::percent(left.probability)
            ),
        ));
    }
    for on in &left.depends_on {
        let formula = on.formula.as_ref().map_or_else(String::new, |formula| format!(" — {formula}"));
        let share = format::percent(on.share);
        ui.label(theme::small(ui, format!("{} depends on {}: {share} of the rest{formula}.", on.of, on.on)));
    }
}

/// Adds what is ticked: at the foot, where it is seen however much is found, also while the big button offers
/// an experiment.
fn offer(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.view.gap.addable().is_empty() {
        return;
    }
    // Twice above each other would be one too many; on the way through commissioning the big button has its own.
    let by_big_button = guidance(cx.view, Screen::Gap).next.map(|next| next.action);
    if by_big_button == Some(Action::Gap(GapAction::Add)) && !cx.view.commission.is_on {
        return;
    }
    let wanted = cx.view.gap.wanted();
    let margin = Margin::symmetric(space::M as i8, space::S as i8);
    Panel::bottom("gap offer").frame(Frame::new().inner_margin(margin)).resizable(false).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            let label = match wanted.is_empty() {
                true => "Add what is ticked".to_owned(),
                false => words::add_label(cx.view, &wanted),
            };
            action_button(ui, cx, GapAction::Add, &label);
            ui.label(theme::small(ui, "Nothing moves; touches go elsewhere than before."));
        });
    });
}

/// What is in the model, and what can be made of it.
fn model(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownFinding) {
    let addable = cx.view.gap.addable();
    theme::group_heading(ui, "The model");
    let in_use = format!("In use: {}.", cx.view.gap.model.name);
    ui.label(theme::weak(ui, in_use));
    if !addable.is_empty() {
        let what = "Once effects are added, all predictions, previews and targets of this robot use the corrected model.";
        ui.label(theme::small(ui, what));
    } else if shown.added.iter().any(|added| *added) {
        ui.label(theme::small(
            ui,
            "Its effects are in the model. Prove it by touching new targets with them and without them, or look for what is left.",
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
            undo_button(ui, cx, Subject::Effects);
        }
        if !cx.view.gap.model.effects.is_empty() {
            action_button(ui, cx, GapAction::UseNominal, "Take all effects out");
        }
    });
}

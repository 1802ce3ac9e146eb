//! Models so far with their gaps, and findings, any two of which can be seen side by side.

use egui::{Button, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::GapCommand;
use plumbline_engine::view::{AddedEffect, FindingEntry, GapModelView, Subject};
use plumbline_widgets::format::Quantity;
use plumbline_widgets::intervals::{IntervalRow, Intervals, Level};
use plumbline_widgets::parameter;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::GapAction;
use crate::operator::words::effect::moved;
use crate::operator::words::gap as words;
use crate::operator::words::{capitalized, clock};
use crate::panels::parts::{action_button, undo_button};
use crate::panels::{PanelContext, padded};

const ROW_HEIGHT: f32 = 26.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let gap = cx.view.gap.clone();
            model(ui, &gap.model);
            ui.horizontal_wrapped(|ui| {
                if gap.model.can_undo {
                    undo_button(ui, cx, Subject::Effects);
                }
                if !gap.model.effects.is_empty() {
                    action_button(ui, cx, GapAction::Prove, "Prove it");
                    action_button(ui, cx, GapAction::UseNominal, "Take all effects out");
                }
            });
            ui.add_space(space::S);
            steps(ui, &gap.model);
            ui.add_space(space::S);
            theme::group_heading(ui, "Findings");
            if gap.findings.is_empty() {
                ui.label(theme::weak(ui, "None yet. Every search is kept here with its numbers."));
            }
            for entry in gap.findings.iter() {
                finding_row(ui, cx, entry);
            }
            side_by_side(ui, cx);
        });
    });
}

fn model(ui: &mut Ui, model: &GapModelView) {
    theme::group_heading(ui, "Model in use");
    ui.label(if model.effects.is_empty() {
        "Nominal: the robot's description as it is.".to_owned()
    } else {
        format!("{}:", capitalized(&model.name))
    });
    let (named, shares): (Vec<_>, Vec<_>) = model.effects.iter().partition(|effect| effect.is_named);
    named.iter().for_each(|effect| sizes(ui, effect));
    if named.iter().any(|effect| effect.is_small()) {
        ui.label(theme::small(ui, SMALL_NAMED));
    }
    if shares.is_empty() {
        return;
    }
    let title = format!("Small shares of {}", plumbline_model::counted(shares.len(), "effect"));
    egui::CollapsingHeader::new(title).id_salt("small shares").show(ui, |ui| {
        ui.label(theme::small(ui, SMALL_SHARES));
        shares.into_iter().for_each(|effect| sizes(ui, effect));
    });
}

/// Why small effects with a name stay.
const SMALL_NAMED: &str = "Small effects stay in the model because the measurements tell them from noise; nobody would see the difference.";
/// Why effects without a name are there.
const SMALL_SHARES: &str = "No name is due to these. Each is drawn to zero as far as robots usually have it; they stay because together they let the arm err less on touches held out.";

/// The errors of a model that was fitted to touches with all that is usually wrong with arms.
const RMS: &str = "rms, with height";

/// An effect, its parameters on a line, and what they are worth.
fn sizes(ui: &mut Ui, effect: &AddedEffect) {
    let mut sizes: Vec<String> = effect
        .parameters
        .iter()
        .map(|(name, value, _)| format!("{} {}", parameter::words(name), parameter::value(name, *value)))
        .collect();
    sizes.extend(moved(effect));
    if effect.is_left_out {
        sizes.push("not in force: found with other eyes".to_owned());
    }
    let title = capitalized(&effect.title);
    let text = if sizes.is_empty() { title } else { format!("{title}: {}", sizes.join(", ")) };
    ui.label(text);
}

/// The gap of each model on the data that it was found on.
fn steps(ui: &mut Ui, model: &GapModelView) {
    if model.history.is_empty() {
        return;
    }
    theme::group_heading(ui, "Models so far");
    let mut rows: Vec<IntervalRow> = vec![];
    let mut floor = None;
    let pixels = model.history.iter().any(|step| step.in_pixels);
    let quantity = if pixels { Quantity::Pixels } else { Quantity::Length };
    for step in &model.history {
        let Some([before, after, noise]) = step.errors else { continue };
        if rows.is_empty() {
            rows.push(IntervalRow {
                name: "Nominal".to_owned(),
                note: if step.is_rms { RMS.to_owned() } else { String::new() },
                mean: Some(before),
                interval: None,
                role: Role::Difference,
            });
        }
        floor = Some(noise).filter(|_| !step.is_rms);
        rows.push(IntervalRow {
            name: clock(step.at),
            note: match (step.undone, step.is_rms) {
                (true, _) => "taken back".to_owned(),
                (false, true) => RMS.to_owned(),
                (false, false) => String::new(),
            },
            mean: Some(after),
            interval: None,
            role: if step.undone { Role::Weak } else { Role::HeldOut },
        });
    }
    let levels: Vec<Level<'_>> =
        floor.map(|value| Level { name: "noise alone", value, role: Role::NoiseFloor }).into_iter().collect();
    if rows.len() > 1 {
        Intervals::new("Gap of the models so far", &rows, quantity).levels(&levels).show(ui);
    }
    for step in model.history.iter().rev() {
        let undone = if step.undone { " (taken back)" } else { "" };
        let text = format!("{} · {}{undone}", clock(step.at), step.title);
        ui.label(theme::small(ui, text)).on_hover_text(step.sessions.join("\n"));
    }
}

/// A finding: shown by a click, put beside by another.
fn finding_row(ui: &mut Ui, cx: &mut PanelContext<'_>, entry: &FindingEntry) {
    let gap = &cx.view.gap;
    let is = |of: &Option<std::sync::Arc<plumbline_engine::view::ShownFinding>>| {
        of.as_ref().is_some_and(|shown| shown.entry.id == entry.id)
    };
    let (shown, beside) = (is(&gap.shown), is(&gap.beside));
    let what = match entry.named.as_slice() {
        [] => words::verdict(entry.verdict).to_owned(),
        [one] => one.clone(),
        several => format!("{} effects", several.len()),
    };
    let text = format!("{} · {} · {what}", clock(entry.made), entry.model);
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        let size = vec2((ui.available_width() - 84.0).max(80.0), ROW_HEIGHT);
        let layout = egui::Layout::top_down_justified(egui::Align::Min);
        let button = Button::selectable(shown, RichText::new(&text)).truncate();
        let response = ui.allocate_ui_with_layout(size, layout, |ui| ui.add(button)).inner;
        let help = format!("{}\n{}", words::verdict(entry.verdict), entry.sessions.join("\n"));
        if response.on_hover_text(help).clicked() {
            cx.outbox.send(GapCommand::Show { id: entry.id.clone() });
        }
        if shown {
            return;
        }
        let beside_button = ui
            .add(Button::selectable(beside, "Beside"))
            .on_hover_text("Puts its numbers beside the shown ones");
        if beside_button.clicked() {
            let id = (!beside).then(|| entry.id.clone());
            cx.outbox.send(GapCommand::Beside { id });
        }
    });
}

/// The numbers of two findings.
fn side_by_side(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let gap = &cx.view.gap;
    let (Some(shown), Some(beside)) = (&gap.shown, &gap.beside) else { return };
    ui.add_space(space::S);
    theme::group_heading(ui, "Side by side");
    // Names of sessions are long: each column wraps in its third of the tile.
    let column = (ui.available_width() - 2.0 * space::M) / 3.0;
    let grid = egui::Grid::new("side by side").num_columns(3).spacing([space::M, 2.0]).max_col_width(column);
    grid.show(ui, |ui| {
        ui.label("");
        ui.label(theme::strong(ui, "shown"));
        ui.label(theme::strong(ui, "the other"));
        ui.end_row();
        let of = |f: &dyn Fn(&plumbline_engine::view::ShownFinding) -> String| [f(shown), f(beside)];
        let rows = [
            ("model", of(&|s| s.entry.model.clone())),
            ("sessions", of(&|s| s.entry.sessions.join(", "))),
            ("verdict", of(&|s| words::heading(&s.finding).to_owned())),
            ("before", of(&|s| words::error(&s.finding.shown, s.finding.shown.before))),
            ("after", of(&|s| words::error(&s.finding.shown, s.finding.shown.after))),
            (
                "noise alone",
                of(&|s| {
                    let known = s.finding.comparison.is_noise_known();
                    if known {
                        words::error(&s.finding.shown, s.finding.shown.floor)
                    } else {
                        "not known".to_owned()
                    }
                }),
            ),
            (
                "unexplained, p",
                of(&|s| plumbline_widgets::format::significant(s.finding.unexplained.p_value, 2)),
            ),
        ];
        for (name, values) in rows {
            ui.label(theme::weak(ui, name));
            for value in values {
                ui.label(value);
            }
            ui.end_row();
        }
    });
}

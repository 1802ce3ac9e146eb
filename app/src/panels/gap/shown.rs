//! The gap before and after on rows that were not used, and what gave the effects away.

use std::sync::Arc;

use egui::{ComboBox, ScrollArea, Ui, vec2};
use plumbline_engine::view::ShownFinding;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::intervals::{IntervalRow, Intervals, Level};
use plumbline_widgets::scatter::Scatter;
use plumbline_widgets::seen::Seen;
use plumbline_widgets::theme::{self, Role, space};

use super::parts::finding;
use super::points::{Along, points};
use crate::operator::GapAction;
use crate::operator::snapshot::gap::{Finding, Shown, Verdict, What};
use crate::operator::words::gap as words;
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "The gap is then judged on rows that were not used, before and after.";
    let Some(shown) = finding(ui, cx, what) else { return };
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            bars(ui, cx, &shown);
            ui.add_space(space::S);
            against(ui, cx, &shown);
            ui.add_space(space::S);
            ui.horizontal_wrapped(|ui| {
                action_button(ui, cx, GapAction::ReportHtml, "Report (HTML)…");
                action_button(ui, cx, GapAction::ReportPdf, "Report (PDF)…");
            });
        });
    });
}

/// Before, after, unseen, with the floor.
fn bars(ui: &mut Ui, cx: &PanelContext<'_>, shown: &ShownFinding) {
    let held_out = &shown.finding.shown;
    if held_out.rows == 0 {
        ui.label(theme::weak(ui, "This finding was not judged on held-out rows."));
        return;
    }
    if let Some(closed) = words::closure(&shown.finding) {
        ui.label(theme::strong(ui, closed));
    } else if shown.finding.verdict == Verdict::NotInLibrary {
        ui.label(theme::strong(ui, "Nothing can be added, so nothing is closed."));
    } else if shown.finding.verdict == Verdict::NoGap && !shown.finding.is_all_clear() {
        ui.label(theme::strong(ui, "The noise is not known, so nobody knows what could be closed."));
    } else {
        ui.label(theme::strong(ui, "There is nothing to close: before is what noise alone would leave."));
    }
    let quantity = words::held_out(held_out.unit);
    let row = |name: &str, note: &str, value: f64, interval: Option<[f64; 2]>, role| IntervalRow {
        name: name.to_owned(),
        note: note.to_owned(),
        mean: Some(value),
        interval,
        role,
    };
    let mut rows = vec![
        row("Before", "", held_out.before, None, Role::Difference),
        row("After", "", held_out.after, after_range(held_out), Role::HeldOut),
    ];
    if let Some(unseen) = &held_out.unseen {
        rows.push(row("Before", "unseen", unseen.before, None, Role::Difference));
        rows.push(row("After", "unseen", unseen.after, None, Role::HeldOut));
    }
    if let Some(beside) = &cx.view.gap.beside
        && beside.finding.shown.unit == held_out.unit
        && beside.finding.shown.rows > 0
    {
        let other = &beside.finding.shown;
        rows.push(row("Before", "the other", other.before, None, Role::Weak));
        rows.push(row("After", "the other", other.after, after_range(other), Role::Weak));
    }
    let levels =
        [Level { name: words::floor_name(&shown.finding), value: held_out.floor, role: Role::NoiseFloor }];
    let of_rows = if shown.finding.effects.is_empty() { "Gap of all rows" } else { "Gap on held-out rows" };
    Intervals::new(of_rows, &rows, quantity).levels(&levels).show(ui);
    let worst = held_out.worst_tenth.map(|error| words::error(held_out, error));
    let count = format::count(held_out.rows, "row");
    // Without an effect nothing was held out, and nothing predicted an interval.
    let mut said = if shown.finding.effects.is_empty() {
        format!("Mean error of {count} ({}). Worst tenth: {}.", held_out.blocks, worst[0])
    } else {
        format!(
            "Mean error of {count} that were held out ({}). Worst tenth: {} before, {} after. {} of the coordinates lie within their predicted 95 %.",
            held_out.blocks,
            worst[0],
            worst[1],
            format::percent(held_out.inside_95),
        )
    };
    if shown.finding.comparison.kinds.iter().any(|kind| kind.what == What::Touch) {
        said.push_str(" Before, too, the screen lies where it fits these touches best.");
    }
    if let Some(unseen) = &held_out.unseen {
        said.push_str(&format!(
            " Unseen: {}, {} held out as a whole; {}: {}.",
            unseen.what,
            format::count(unseen.rows, "row"),
            words::floor_name(&shown.finding),
            words::error(held_out, unseen.floor)
        ));
    }
    ui.label(theme::small(ui, said));
}

/// The interval of the closure as one of what is left.
fn after_range(shown: &Shown) -> Option<[f64; 2]> {
    let [low, high] = shown.closure_range?;
    let left = |closure: f64| shown.before - closure * (shown.before - shown.floor);
    let (a, b) = (left(high), left(low));
    (a.is_finite() && b.is_finite()).then_some([a.max(0.0), b])
}

/// Residuals against what gave the effects away, or anything else.
fn against(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &Arc<ShownFinding>) {
    let finding = &shown.finding;
    let covariates = &finding.shown.covariates;
    if covariates.is_empty() {
        return;
    }
    let told = finding.shown.telling.first().copied().unwrap_or(0);
    let mut chosen = cx.state.gap.covariate.unwrap_or(told).min(covariates.len() - 1);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::weak(ui, "Against"));
        let name = |i: usize| covariates.get(i).map_or_else(String::new, |(name, _)| name.clone());
        let combo = ComboBox::from_id_salt("covariate").selected_text(name(chosen)).width(190.0);
        let response = combo.show_ui(ui, |ui| {
            for i in order(finding) {
                let telling = finding.shown.telling.contains(&i);
                let text = if telling { format!("{} · gave it away", name(i)) } else { name(i) };
                ui.selectable_value(&mut chosen, i, text);
            }
        });
        response
            .response
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Residuals against"));
    });
    // Beside the list it would not fit where the tile is narrow.
    let options = [(Along::X, "Forward"), (Along::Y, "Left"), (Along::Z, "Up")];
    ui.horizontal(|ui| choice(ui, "Part of the residual", &mut cx.state.gap.along, &options));
    cx.state.gap.covariate = Some(chosen);
    let along = cx.state.gap.along;
    let key = (Seen::of(shown), chosen, along);
    let points = cx.state.gap.scatter.get(key, || points(finding, chosen, along as usize));
    Scatter::new("Residual", &points.name, &points.series, Quantity::Length)
        .size(vec2(ui.available_width(), 190.0))
        .show(ui);
}

/// Those that gave it away first.
fn order(finding: &Finding) -> Vec<usize> {
    let telling = finding.shown.telling.iter().copied();
    let others = (0..finding.shown.covariates.len()).filter(|i| !finding.shown.telling.contains(i));
    telling.chain(others).collect()
}

//! Detectors compared: the scores that are usually published, with intervals.

use egui::{Grid, Label, RichText, ScrollArea, Ui};
use plumbline_engine::view::{ModelScores, ScoreRow, ScoreTable};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::parts::{figure, interval, judged, map50_95};
use crate::operator::ScoresAction;
use crate::panels::PanelContext;
use crate::panels::parts::action_button;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "Choose detectors and a labeled data set, then Evaluate. The table has a row per detector.";
    let Some(table) = judged(ui, cx, what) else { return };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        grid(ui, cx, &table);
        ui.add_space(space::S);
        action_button(ui, cx, ScoresAction::ExportCsv, "Export CSV…");
        ui.add_space(space::S);
        notes(ui, &table);
    });
}

fn grid(ui: &mut Ui, cx: &mut PanelContext<'_>, table: &ScoreTable) {
    Grid::new("score table").striped(true).spacing([space::M, 4.0]).show(ui, |ui| {
        let heads = ["Detector", "Tomato", "Hands", "All", "All", "Network"];
        for head in heads {
            ui.label(theme::strong(ui, head));
        }
        ui.end_row();
        for unit in ["", "mAP50–95", "mAP50–95", "mAP50–95", "mAP50", "ms"] {
            ui.label(theme::small(ui, unit));
        }
        ui.end_row();
        for (place, row) in table.rows.iter().enumerate() {
            let chosen = cx.state.scores.model == place;
            let hint = "Shows its confusion matrix";
            if ui.selectable_label(chosen, &*row.model).on_hover_text(hint).clicked() {
                cx.state.scores.model = place;
            }
            match &row.scores {
                Ok(scores) => model(ui, scores),
                Err(_) => {
                    ui.label(RichText::new("not judged").color(Role::Warning.color(theme::tokens(ui))));
                }
            }
            ui.end_row();
        }
    });
}

fn model(ui: &mut Ui, scores: &ModelScores) {
    let own = scores.judged_by_itself.as_deref();
    for score in [scores.tomato.as_ref(), scores.hands.as_ref(), Some(&scores.all)] {
        let (value, ends) = map50_95(score);
        with_interval(ui, value, ends, own);
    }
    with_interval(ui, Some(scores.all.map50), scores.all.map50_interval, own);
    let network = format::significant(scores.times_ms[1], 3);
    let [before, _, after] = scores.times_ms.map(|ms| format::significant(ms, 2));
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.label(network);
        let around = Label::new(theme::small(ui, format!("+ {before} + {after}"))).extend();
        ui.add(around).on_hover_text("before the network (fitting the image) and after it (its boxes)");
    });
}

/// `own`: why the figure says nothing of how good the detector is; an interval of it would say nothing either.
fn with_interval(ui: &mut Ui, value: Option<f64>, ends: Option<[f64; 2]>, own: Option<&str>) {
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if let Some(own) = own.filter(|_| value.is_some()) {
            let color = Role::Warning.color(theme::tokens(ui));
            ui.label(RichText::new(figure(value)).color(color)).on_hover_text(own);
            ui.add(Label::new(RichText::new("own labels").small().color(color)).extend()).on_hover_text(own);
            return;
        }
        ui.label(figure(value));
        let text = interval(ends);
        let small = Label::new(theme::small(ui, text)).extend();
        ui.add(small).on_hover_text("95 % interval over scenes drawn again");
    });
}

/// On what, and what was not as it should be.
fn notes(ui: &mut Ui, table: &ScoreTable) {
    let boxes: usize = table.instances.iter().sum();
    let set = super::parts::set_name(&table.set);
    ui.label(theme::small(
        ui,
        format!("{} with {} of {set}.", format::count(table.images, "image"), format::count(boxes, "box")),
    ));
    for row in &table.rows {
        for text in said_of(row) {
            let color = Role::Warning.color(theme::tokens(ui));
            ui.add(Label::new(RichText::new(format!("{}: {text}", row.model)).color(color)).wrap());
        }
    }
    for text in &table.left_out {
        ui.add(Label::new(theme::weak(ui, format!("Left out: {text}"))).wrap());
    }
}

/// What has to be known of a model to read its scores.
pub fn said_of(row: &ScoreRow) -> Vec<String> {
    let scores = match &row.scores {
        Err(why) => return vec![why.to_string()],
        Ok(scores) => scores,
    };
    let mut said: Vec<String> = scores.judged_by_itself.iter().cloned().collect();
    if scores.other_order {
        said.push("its classes have another order; they are matched by name.".to_owned());
    }
    if !scores.unknown_to_model.is_empty() {
        said.push(format!(
            "does not know {}; such things count as missed.",
            scores.unknown_to_model.join(", ")
        ));
    }
    if !scores.unknown_to_set.is_empty() {
        said.push(format!(
            "also knows {}, which the data set does not have; what it finds of them is left out.",
            scores.unknown_to_set.join(", ")
        ));
    }
    said
}

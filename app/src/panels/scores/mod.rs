//! Judging detectors on a labeled data set: choosing, the table, each class, what was taken for what.

mod cell;
mod choice;
mod classes;
mod confusion;
mod inspector;
mod table;

pub use inspector::show as show_inspector;

use std::path::Path;

use egui::Ui;
use plumbline_engine::view::{ModelScores, Score, ScoreTable};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::image_view::ViewState;

use super::{PanelContext, padded};
use crate::operator::{Action, Pane, ScoresAction};
use crate::panels::parts::progress;

/// How scores are looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct ScoresPanels {
    /// The model whose confusion matrix is shown, by place in the table.
    pub model: usize,
    /// Whether the matrix shows shares of the row rather than counts.
    pub shares: bool,
    /// Zoom of the large picture.
    pub view: ViewState,
}

/// Draws one of the panes of this screen.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    if let Some(table) = &cx.view.scores.table {
        cx.state.scores.model = cx.state.scores.model.min(table.rows.len().saturating_sub(1));
    }
    match pane {
        Pane::ScoreTable => padded(ui, |ui| table::show(ui, cx)),
        Pane::ScoreClasses => padded(ui, |ui| classes::show(ui, cx)),
        Pane::ScoreConfusion => padded(ui, |ui| confusion::show(ui, cx)),
        Pane::ScoreCell => cell::show(ui, cx),
        _ => padded(ui, |ui| choice::show(ui, cx)),
    }
}

/// The table, or what stands in its place.
fn judged(ui: &mut Ui, cx: &mut PanelContext<'_>, what: &str) -> Option<std::sync::Arc<ScoreTable>> {
    let scores = &cx.view.scores;
    if let Some((fraction, doing)) = progress(cx.view, cx.view.scores.evaluating) {
        let percent = plumbline_widgets::format::percent(fraction);
        EmptyState::loading(&format!("Judging: {doing} ({percent}).")).show(ui);
        return None;
    }
    if let Some(why) = &scores.failed {
        let message = Message::new("The detectors could not be judged", why);
        if EmptyState::failed(message.button("Try again")).show(ui) {
            cx.outbox.act(Action::Scores(ScoresAction::Evaluate));
        }
        return None;
    }
    if scores.table.is_none() {
        EmptyState::empty(Message::new("Nothing was judged yet", what)).show(ui);
    }
    scores.table.clone()
}

/// Scores of the chosen model, where it could be judged.
fn chosen<'a>(cx: &PanelContext<'_>, table: &'a ScoreTable) -> Option<(&'a str, &'a ModelScores)> {
    let row = table.rows.get(cx.state.scores.model)?;
    Some((&row.model, row.scores.as_ref().ok()?))
}

/// What a data set is called: its folder, or that of its `data.yaml`.
fn set_name(path: &Path) -> String {
    let is_file = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    let folder = if is_file { path.parent().unwrap_or(path) } else { path };
    folder.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// "0.806".
fn figure(score: Option<f64>) -> String {
    score.map_or_else(|| "–".to_owned(), |score| format!("{score:.3}"))
}

/// "0.74 to 0.86".
fn interval(ends: Option<[f64; 2]>) -> String {
    ends.map_or_else(String::new, |[low, high]| format!("{low:.2}–{high:.2}"))
}

fn map50_95(score: Option<&Score>) -> (Option<f64>, Option<[f64; 2]>) {
    (score.map(|score| score.map50_95), score.and_then(|score| score.map50_95_interval))
}

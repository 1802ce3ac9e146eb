//! What the panes of this folder share.

use std::path::Path;

use egui::Ui;
use plumbline_engine::view::{ModelScores, Score, ScoreTable};
use plumbline_widgets::empty::{EmptyState, Message};

use crate::operator::{Action, ScoresAction};
use crate::panels::PanelContext;
use crate::panels::parts::progress;

/// The table, or what stands in its place.
pub fn judged(ui: &mut Ui, cx: &mut PanelContext<'_>, what: &str) -> Option<std::sync::Arc<ScoreTable>> {
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
pub fn chosen<'a>(cx: &PanelContext<'_>, table: &'a ScoreTable) -> Option<(&'a str, &'a ModelScores)> {
    let row = table.rows.get(cx.state.scores.model)?;
    Some((&row.model, row.scores.as_ref().ok()?))
}

/// What a data set is called: its folder, or that of its `data.yaml`.
pub fn set_name(path: &Path) -> String {
    let is_file = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    let folder = if is_file { path.parent().unwrap_or(path) } else { path };
    folder.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// "0.806".
pub fn figure(score: Option<f64>) -> String {
    score.map_or_else(|| "–".to_owned(), |score| format!("{score:.3}"))
}

/// "0.74 to 0.86".
pub fn interval(ends: Option<[f64; 2]>) -> String {
    ends.map_or_else(String::new, |[low, high]| format!("{low:.2}–{high:.2}"))
}

pub fn map50_95(score: Option<&Score>) -> (Option<f64>, Option<[f64; 2]>) {
    (score.map(|score| score.map50_95), score.and_then(|score| score.map50_95_interval))
}

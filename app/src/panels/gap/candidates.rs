//! What the data say about every candidate, named or not.

use std::collections::HashMap;

use egui::{ScrollArea, Ui};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme::{self, space};
use plumbline_widgets::{format, probability, steady};

use super::parts::finding;
use super::state::Sort;
use crate::operator::snapshot::gap::{Candidate, Finding};
use crate::operator::words::gap as words;
use crate::operator::words::{capitalized, effect};
use crate::panels::{PanelContext, padded};

/// Every candidate with what the data say about it.
pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "Every effect of the library is tried. Here stands what the data can say about each.";
    let Some(shown) = finding(ui, cx, what) else { return };
    let mut candidates: Vec<&Candidate> = shown.finding.candidates.iter().collect();
    if candidates.is_empty() {
        let text = if shown.finding.is_all_clear() {
            "Model and measurement agree, so no candidate was tried."
        } else {
            "No candidate was tried on these data. The verdict says why."
        };
        EmptyState::empty(Message::new("No candidates", text)).show(ui);
        return;
    }
    padded(ui, |ui| {
        let options = [(Sort::Probability, "Probability"), (Sort::Score, "Pull"), (Sort::Name, "Name")];
        ui.horizontal(|ui| {
            ui.label(theme::weak(ui, "Sorted by"));
            choice(ui, "Sorted by", &mut cx.state.gap.sort, &options);
        });
        if words::is_unsure(&shown.finding) {
            let text = "Of these: the share of a name among those of the library alone. How sure it is stands on its card, which also \
                        counts that something else may be at work.";
            ui.label(theme::small(ui, text));
        }
        match cx.state.gap.sort {
            Sort::Probability => candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability)),
            Sort::Score => candidates.sort_by(|a, b| b.score_sigmas.abs().total_cmp(&a.score_sigmas.abs())),
            Sort::Name => candidates.sort_by(|a, b| a.title.cmp(&b.title)),
        }
        let list = ui.scope_id().with("candidates");
        let names = candidates.iter().map(|candidate| (candidate.id.clone(), candidate.site.clone()));
        let order = steady::in_order(ui, list, names.collect(), cx.state.gap.sort);
        let places: HashMap<_, _> = order.iter().enumerate().map(|(place, name)| (name, place)).collect();
        candidates.sort_by_cached_key(|candidate| {
            places.get(&(candidate.id.clone(), candidate.site.clone())).copied()
        });
        ui.add_space(space::XS);
        let area = table(ui, &candidates, &shown.finding);
        steady::keep(ui, list, order, area);
    });
}

const CANDIDATE_ROW: f32 = 20.0;
/// Narrower than this there is room for names and probabilities only.
const NARROW: f32 = 400.0;

/// All candidates of the finding give names to what one trades against. Where its rows are drawn.
fn table(ui: &mut Ui, candidates: &[&Candidate], finding: &Finding) -> egui::Rect {
    let all = &finding.candidates;
    let width = ui.available_width();
    // Where there is no room for all, the name counts for more; what is left out stands where a row is pointed at.
    let columns = match width < NARROW {
        true => [width - 68.0, 68.0, 0.0, 0.0],
        false => [width - 198.0, 68.0, 54.0, 76.0],
    };
    let probability = if words::is_unsure(finding) { "of these" } else { "probability" };
    let header = ["", probability, "size, σ", "the data"];
    candidate_row(ui, columns, header.map(|text| (text.to_owned(), true)), None);
    let area = ScrollArea::vertical().auto_shrink(false);
    let shown = area.show_rows(ui, CANDIDATE_ROW, candidates.len(), |ui, shown| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for candidate in &candidates[shown] {
            let (word, meaning) = words::knowledge(&candidate.knowledge, all);
            let cells = [
                (candidate.title.clone(), false),
                (probability::percent(candidate.probability), candidate.probability < 0.05),
                (format::fixed(candidate.score_sigmas, 1), candidate.score_sigmas.abs() < 3.0),
                (word.to_owned(), word != "known"),
            ];
            let name = capitalized(&effect::named(&candidate.id, &candidate.site, &candidate.title));
            let pull = format::fixed(candidate.score_sigmas, 1);
            candidate_row(
                ui,
                columns,
                cells,
                Some(format!("{name}. What the rest leaves points its way by {pull} σ. {meaning}")),
            );
        }
    });
    shown.inner_rect
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
    let shown = cells.into_iter().zip(columns).filter(|(_, width)| *width > 0.0);
    for (i, ((text, weak), width)) in shown.enumerate() {
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

//! Shares and probabilities as bars with their words, below each other.

use egui::{Align2, Rect, Response, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::format;
use crate::theme::{self, Role, space};

const ROW: f32 = 22.0;
const BAR: f32 = 8.0;
const FIGURE_WIDTH: f32 = 52.0;
const NAME_ROW: f32 = 16.0;
const LEAST_BAR: f32 = 24.0;

/// A share of a whole with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct ShareRow {
    /// Its name: "along u", "joint zero of the elbow".
    pub name: String,
    /// 0..=1.
    pub share: f64,
    /// More about it, right of the bar; empty for none.
    pub note: String,
    /// Color of the bar.
    pub role: Role,
}

/// Draws a probability as one bar over the available width, with its figure; the label for tests is
/// `"{label}: 97.0 %"`.
pub fn probability_bar(ui: &mut Ui, label: &str, probability: f64, role: Role) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    let figure = percent(probability);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("{label}: {figure}")));
    if ui.is_rect_visible(rect) {
        let bar = Rect::from_min_max(rect.min, pos2(rect.right() - FIGURE_WIDTH, rect.bottom()));
        fill(ui, bar, probability, role);
        let font = theme::strong_font(ui);
        let color = theme::tokens(ui).text_strong;
        ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, figure, font, color);
    }
    response
}

/// Draws rows of shares on one scale from 0 to 100 %. Labels for tests: `"{name}: 62.0 %, {note}"`.
pub fn share_rows(ui: &mut Ui, rows: &[ShareRow]) {
    let small = theme::font(ui, &TextStyle::Small);
    let width = |text: &str| {
        ui.painter().layout_no_wrap(text.to_owned(), small.clone(), egui::Color32::WHITE).size().x
    };
    let whole = ui.available_width();
    let names = rows.iter().map(|row| width(&row.name)).fold(0.0, f32::max) + space::S;
    let notes = rows.iter().map(|row| width(&row.note)).fold(0.0, f32::max);
    // Where a line is too short for all of it, names stand above their bars.
    let is_stacked = names + LEAST_BAR + FIGURE_WIDTH + space::S + notes > whole;
    let (above, names) = if is_stacked { (NAME_ROW, 0.0) } else { (0.0, names) };
    let notes = notes.min(whole * 0.6);
    for row in rows {
        let (rect, response) = ui.allocate_exact_size(vec2(whole, above + ROW), Sense::hover());
        let figure = percent(row.share);
        let comma = if row.note.is_empty() { "" } else { ", " };
        let words = format!("{}: {figure}{comma}{}", row.name, row.note);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &words));
        if !ui.is_rect_visible(rect) {
            continue;
        }
        let tokens = theme::tokens(ui);
        let left = rect.left() + names;
        let right = (rect.right() - notes - space::S - FIGURE_WIDTH).max(left + LEAST_BAR);
        let bar = Rect::from_min_max(pos2(left, rect.top() + above), pos2(right, rect.bottom()));
        fill(ui, bar, row.share, row.role);
        let painter = ui.painter_at(rect);
        let room = if is_stacked { whole } else { names - space::S };
        let name = elided(ui, &row.name, &small, room, tokens.text);
        let middle = if is_stacked { rect.top() + above / 2.0 } else { bar.center().y };
        painter.galley(pos2(rect.left(), middle - name.size().y / 2.0), name, tokens.text);
        let figure_at = pos2(right + FIGURE_WIDTH - 4.0, bar.center().y);
        painter.text(figure_at, Align2::RIGHT_CENTER, figure, small.clone(), tokens.text_strong);
        let note_at = pos2(right + FIGURE_WIDTH + space::S, bar.center().y);
        let note = elided(ui, &row.note, &small, rect.right() - note_at.x, tokens.text_weak);
        painter.galley(note_at - vec2(0.0, note.size().y / 2.0), note, tokens.text_weak);
        response.on_hover_text(words);
    }
}

/// Text that ends in … where there is no room for more.
fn elided(
    ui: &Ui,
    text: &str,
    font: &egui::FontId,
    width: f32,
    color: egui::Color32,
) -> std::sync::Arc<egui::Galley> {
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font.clone(), color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(20.0));
    ui.painter().layout_job(job)
}

fn fill(ui: &Ui, room: Rect, share: f64, role: Role) {
    let tokens = theme::tokens(ui);
    let track = Rect::from_center_size(room.center(), vec2(room.width(), BAR));
    ui.painter().rect_filled(track, BAR / 2.0, tokens.raised);
    let share = share.clamp(0.0, 1.0) as f32;
    if share > 0.0 {
        let end = vec2((track.width() * share).max(BAR / 2.0), BAR);
        ui.painter().rect_filled(Rect::from_min_size(track.min, end), BAR / 2.0, role.color(tokens));
    }
}

/// Nothing is quite certain: 0.9996 is "> 99.9 %", 0.0002 is "< 0.1 %".
pub fn percent(share: f64) -> String {
    if share > 0.999 && share < 1.0 {
        return "> 99.9 %".to_owned();
    }
    if share > 0.0 && share < 0.001 {
        return "< 0.1 %".to_owned();
    }
    format::percent(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_rounded_to_certainty() {
        assert_eq!(percent(0.99985), "> 99.9 %");
        assert_eq!(percent(0.0004), "< 0.1 %");
        assert_eq!(percent(0.0), "0 %");
    }
}

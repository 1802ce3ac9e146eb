//! The goal as a number that can be typed.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Align2, Id, Margin, Rect, TextEdit, Ui, vec2};

use super::JointRow;
use crate::format;

/// Draws the number; what was typed, once the operator is done: an angle in radians inside the
/// limits, or why it cannot be.
pub(super) fn show(row: &JointRow<'_>, ui: &mut Ui, rect: Rect, base: Id) -> Option<Result<f64, String>> {
    let id = base.with("number");
    let shown = row
        .state
        .proposed_rad
        .or(row.state.goal_rad)
        .map_or_else(|| format::NONE.to_owned(), format::joint_degrees);
    let editing: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = editing.clone().unwrap_or_else(|| shown.clone());
    let edit =
        TextEdit::singleline(&mut text).id(id).align(Align2::RIGHT_CENTER).margin(Margin::symmetric(6, 1));
    let rect = rect.shrink2(vec2(0.0, 2.0));
    // A `Ui` of its own: the row has its height already, and egui's least height is larger.
    let mut inner = ui.new_child(egui::UiBuilder::new().id_salt(id).max_rect(rect));
    inner.spacing_mut().interact_size.y = rect.height();
    let response = inner.put(rect, edit.desired_width(rect.width()).min_size(rect.size()));
    let response = response.accessible_name(format!("{} goal in degrees", row.name));
    if response.gained_focus() {
        select_all(ui, id, text.chars().count());
    }
    if response.lost_focus() {
        ui.data_mut(|data| data.remove_temp::<String>(id));
        let changed = editing.is_some_and(|before| before != shown) || text != shown;
        return changed.then(|| parsed(&text).and_then(|angle_rad| row.check(angle_rad)));
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// What is typed first replaces the old number.
fn select_all(ui: &Ui, id: Id, length: usize) {
    if let Some(mut state) = TextEditState::load(ui.ctx(), id) {
        let [start, end] = [0, length].map(CCursor::new);
        state.cursor.set_char_range(Some(CCursorRange::two(start, end)));
        state.store(ui.ctx(), id);
    }
}

/// Degrees as people write them.
fn parsed(text: &str) -> Result<f64, String> {
    let plain = text.trim().trim_end_matches('°').trim_end().replace(',', ".").replace('−', "-");
    match plain.parse::<f64>() {
        Ok(degrees) if degrees.is_finite() => Ok(degrees.to_radians()),
        _ => Err(format!("“{}” is not an angle; type degrees, for example 12.5", text.trim())),
    }
}

/// The refusal that stands below the row: the new one, or the old one while nothing valid was
/// asked for and nothing new is being typed.
pub(super) fn refusal(ui: &Ui, base: Id, accepted: bool, new: Option<String>) -> Option<String> {
    let id = base.with("refusal");
    ui.data_mut(|data| {
        if let Some(reason) = new {
            data.insert_temp(id, reason);
        } else if accepted {
            data.remove_temp::<String>(id);
        }
        data.get_temp(id)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_read_as_people_write_them() {
        for (text, degrees) in [("12.5", 12.5), (" −10° ", -10.0), ("3,5", 3.5), ("-0.25 °", -0.25)] {
            let found = parsed(text).expect(text).to_degrees();
            assert!((found - degrees).abs() < 1e-12, "{text}: {found}");
        }
        for text in ["", "abc", "1e999", "NaN", "12°30"] {
            assert!(parsed(text).is_err(), "{text}");
        }
    }
}

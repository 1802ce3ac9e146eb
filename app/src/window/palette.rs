//! The command palette: everything that can be done, by typing a part of its name.

use std::borrow::Cow;

use egui::{Key, Modifiers, RichText, ScrollArea, TextEdit, Ui};
use plumbline_engine::View;
use plumbline_widgets::theme::{self, Role, space};

use super::sheet::sheet;
use crate::operator::{Action, actions, shortcut_text};

/// Open or closed, and what was typed.
#[derive(Debug, Default)]
pub struct Palette {
    open: bool,
    typed: String,
    chosen: usize,
    just_opened: bool,
}

impl Palette {
    /// Opens it empty, or closes it.
    pub fn toggle(&mut self) {
        *self = Self { open: !self.open, just_opened: true, ..Self::default() };
    }

    /// Whether it is open.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Draws it while it is open; returns what was chosen.
    pub fn show(&mut self, ctx: &egui::Context, view: &View, escape_pressed: bool) -> Option<Action> {
        if !self.open {
            return None;
        }
        let top = (egui::Align2::CENTER_TOP, egui::vec2(0.0, 72.0));
        let shown = sheet(ctx, "commands", top, 520.0, escape_pressed, |ui| self.contents(ui, view));
        if shown.close || shown.inner.is_some() {
            self.open = false;
        }
        shown.inner
    }

    fn contents(&mut self, ui: &mut Ui, view: &View) -> Option<Action> {
        let (down, up, enter) = ui.input_mut(|input| {
            (
                input.consume_key(Modifiers::NONE, Key::ArrowDown),
                input.consume_key(Modifiers::NONE, Key::ArrowUp),
                input.consume_key(Modifiers::NONE, Key::Enter),
            )
        });
        let edit = TextEdit::singleline(&mut self.typed)
            .hint_text("Type what you want to do")
            .desired_width(f32::INFINITY);
        let edit = ui.add(edit);
        edit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search commands"));
        if std::mem::take(&mut self.just_opened) {
            edit.request_focus();
        }
        if edit.changed() {
            self.chosen = 0;
        }
        // Also between two words that are typed here.
        if super::status_line::moves(view) {
            let warning = Role::Warning.color(theme::tokens(ui));
            ui.label(
                RichText::new("The robot moves: space and Esc stop it, here, too. One word finds it.")
                    .color(warning),
            );
        }
        let found = matching(&self.typed);
        if down {
            self.chosen = (self.chosen + 1).min(found.len().saturating_sub(1));
        }
        if up {
            self.chosen = self.chosen.saturating_sub(1);
        }
        ui.add_space(space::XS);
        let mut picked = enter.then(|| found.get(self.chosen).copied()).flatten();
        ScrollArea::vertical().max_height(380.0).auto_shrink([false, true]).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (i, &action) in found.iter().enumerate() {
                let row = row(ui, action, view, i == self.chosen);
                if i == self.chosen && (down || up) {
                    row.scroll_to_me(None);
                }
                if row.clicked() {
                    picked = Some(action);
                }
            }
            if found.is_empty() {
                ui.add_space(space::S);
                ui.label(theme::weak(ui, "Nothing is called that. Try one word of it."));
            }
        });
        picked.filter(|action| action.refusal(view).is_none())
    }
}

fn row(ui: &mut Ui, action: Action, view: &View, chosen: bool) -> egui::Response {
    let refusal = action.refusal(view);
    let (rect, response) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 28.0), egui::Sense::click());
    let label = action.label();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, refusal.is_none(), &label));
    let tokens = theme::tokens(ui);
    if chosen || response.hovered() {
        ui.painter().rect_filled(rect, 4.0, if chosen { tokens.selected } else { tokens.raised });
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let color = if refusal.is_some() { tokens.text_weak } else { tokens.text_strong };
    let left = rect.left_center() + egui::vec2(space::S, 0.0);
    let right = rect.right_center() - egui::vec2(space::S, 0.0);
    ui.painter().text(left, egui::Align2::LEFT_CENTER, label, font, color);
    let hint = refusal.map(Cow::into_owned).or_else(|| shortcut_text(ui.ctx(), action));
    if let Some(hint) = hint {
        ui.painter().text(right, egui::Align2::RIGHT_CENTER, hint, small, tokens.text_weak);
    }
    response
}

/// Actions whose name contains every typed word, those that begin with the text first.
fn matching(typed: &str) -> Vec<Action> {
    let typed = typed.to_lowercase();
    let words: Vec<&str> = typed.split_whitespace().collect();
    let mut found: Vec<Action> = actions::all()
        .filter(|action| {
            let label = action.label().to_lowercase();
            *action != Action::Palette && words.iter().all(|word| label.contains(word))
        })
        .collect();
    found.sort_by_key(|action| !action.label().to_lowercase().starts_with(typed.trim()));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_in_any_order() {
        assert_eq!(matching("pairs solve"), [Action::Solve]);
        assert!(matching("teapot").is_empty());
        assert_eq!(matching("").len(), actions::all().count() - 1);
    }

    #[test]
    fn what_begins_with_the_text_comes_first() {
        assert_eq!(matching("open")[0], Action::OpenFolder);
    }
}

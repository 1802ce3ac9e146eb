//! The pose library: what is there, to look at, to go to, to keep.

use egui::{Button, Response, RichText, TextEdit, TextStyle, Ui, vec2};

use crate::glyph::{self, Glyph};
use crate::theme::{self, space};

/// One pose as it stands in the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseCard<'a> {
    /// "home", "above the tomato".
    pub name: &'a str,
    /// What it is for, in a few words.
    pub description: &'a str,
    /// Why the arm cannot go there now, and what to do.
    pub why_not: Option<&'a str>,
    /// Its ghost is in the scene.
    pub previewed: bool,
    /// The arm is there.
    pub reached: bool,
}

/// What the operator asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PoseIntent {
    /// Show the pose with this index as a ghost.
    Preview(usize),
    /// Take its ghost away.
    HidePreview(usize),
    /// Go there.
    MoveThere(usize),
    /// Replace it by where the arm is now.
    SavePresent(usize),
    /// Keep where the arm is now under a new name.
    SaveAs(String),
}

/// The list, with a line below it to keep the present pose under a new name.
pub struct PoseList<'a> {
    poses: &'a [PoseCard<'a>],
    why_not_save: Option<&'a str>,
}

impl<'a> PoseList<'a> {
    /// A list in the order given.
    pub fn new(poses: &'a [PoseCard<'a>]) -> Self {
        Self { poses, why_not_save: None }
    }

    /// Why the present pose cannot be kept: it is not known.
    pub fn why_not_save(mut self, why_not: Option<&'a str>) -> Self {
        self.why_not_save = why_not;
        self
    }

    /// Draws it. `new_name` is what is being typed; it is emptied when it was used. Buttons are
    /// found as "Preview {name}", "Move to {name}", "Save present as {name}".
    pub fn show(self, ui: &mut Ui, new_name: &mut String) -> Option<PoseIntent> {
        let mut intent = None;
        ui.spacing_mut().item_spacing.x = space::S;
        if self.poses.is_empty() {
            ui.label(theme::weak(ui, "No poses yet. Move the arm to where it is useful and save it below."));
        }
        for (index, pose) in self.poses.iter().enumerate() {
            intent = self.card(ui, index, pose).or(intent);
            ui.add_space(space::XS);
        }
        ui.add_space(space::XS);
        self.save_line(ui, new_name).or(intent)
    }

    fn card(&self, ui: &mut Ui, index: usize, pose: &PoseCard<'_>) -> Option<PoseIntent> {
        let tokens = theme::tokens(ui);
        let mut intent = None;
        let fill = if pose.previewed { tokens.selected } else { tokens.raised.gamma_multiply(0.45) };
        let frame = egui::Frame::new().fill(fill).corner_radius(4.0).inner_margin(space::S);
        frame.show(ui, |ui| {
            ui.spacing_mut().item_spacing = vec2(space::XS, 2.0);
            ui.horizontal(|ui| {
                // The buttons take their place first, so that a long name cannot push them out.
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    intent = self.buttons(ui, index, pose);
                    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| name(ui, pose));
                });
            });
            description(ui, pose);
        });
        intent
    }

    /// From right to left.
    fn buttons(&self, ui: &mut Ui, index: usize, pose: &PoseCard<'_>) -> Option<PoseIntent> {
        let mut intent = None;
        let named = |response: Response, name: String| response.accessible_name(name);
        let save = ui.add_enabled(self.why_not_save.is_none(), Button::new("Save present"));
        let save = named(save, format!("Save present as {}", pose.name));
        if save.clicked() {
            intent = Some(PoseIntent::SavePresent(index));
        }
        explain(save, self.why_not_save, "Replace this pose by where the arm is now.");
        let go = ui.add_enabled(pose.why_not.is_none(), Button::new("Move there"));
        let go = named(go, format!("Move to {}", pose.name));
        if go.clicked() {
            intent = Some(PoseIntent::MoveThere(index));
        }
        explain(go, pose.why_not, "Moves the arm. The way is shown as a ghost first.");
        let text = if pose.previewed { "Hide preview" } else { "Preview" };
        let preview = named(ui.button(text), format!("{text} {}", pose.name));
        if preview.clicked() {
            intent = Some(if pose.previewed {
                PoseIntent::HidePreview(index)
            } else {
                PoseIntent::Preview(index)
            });
        }
        intent
    }

    fn save_line(&self, ui: &mut Ui, new_name: &mut String) -> Option<PoseIntent> {
        let name = new_name.trim().to_owned();
        let taken = self.poses.iter().any(|pose| pose.name == name);
        let why_not = match self.why_not_save {
            Some(why_not) => Some(why_not.to_owned()),
            None if name.is_empty() => Some("Type a name first.".to_owned()),
            None if taken => Some(format!("There is a pose “{name}” already; use its own button.")),
            None => None,
        };
        let mut intent = None;
        ui.horizontal(|ui| {
            let hint = RichText::new("name of a new pose").color(theme::tokens(ui).text_weak);
            let edit = TextEdit::singleline(new_name).hint_text(hint).desired_width(180.0);
            let edit = ui.add(edit.min_size(vec2(180.0, 28.0))).accessible_name("Name of a new pose");
            let entered = edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let button = ui.add_enabled(why_not.is_none(), Button::new("Save present pose"));
            if (button.clicked() || entered) && why_not.is_none() {
                intent = Some(PoseIntent::SaveAs(name));
                new_name.clear();
            }
            if let Some(why_not) = why_not.filter(|_| taken || self.why_not_save.is_some()) {
                ui.label(theme::small(ui, why_not));
            }
        });
        intent
    }
}

fn explain(response: Response, why_not: Option<&str>, what: &str) {
    response.on_hover_text(what).on_disabled_hover_text(why_not.unwrap_or_default());
}

fn name(ui: &mut Ui, pose: &PoseCard<'_>) {
    ui.add(egui::Label::new(theme::strong(ui, pose.name)).truncate());
    if pose.reached {
        let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
        glyph::paint(ui.painter(), rect.center(), 10.0, Glyph::Check, theme::tokens(ui).accepted);
        ui.label(theme::small(ui, "the arm is here"));
    }
}

fn description(ui: &mut Ui, pose: &PoseCard<'_>) {
    let tokens = theme::tokens(ui);
    let (text, color) = match pose.why_not {
        Some(why_not) => (why_not, tokens.warning),
        None => (pose.description, tokens.text_weak),
    };
    let text = RichText::new(text).text_style(TextStyle::Small).color(color);
    ui.add(egui::Label::new(text).wrap());
}

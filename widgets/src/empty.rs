//! What stands in a panel that has nothing to show: a sentence and how to go on.

use egui::{Align, Layout, RichText, Spinner, TextStyle, Ui, UiBuilder, Vec2};

use crate::glyph::{self, Glyph};
use crate::theme::{self, space};

/// Widest line of text, in points; longer lines are hard to read.
const LINE_WIDTH: f32 = 360.0;
const GLYPH_SIZE: f32 = 18.0;

/// A title, what to do, and optionally the button that does it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// What is (not) there: "No pairs yet".
    pub title: &'a str,
    /// How to go on: "Hold the board into both eyes, or open a folder of pairs."
    pub what_to_do: &'a str,
    /// Text of a button, if one can do it.
    pub button: Option<&'a str>,
}

impl<'a> Message<'a> {
    /// Without a button.
    pub fn new(title: &'a str, what_to_do: &'a str) -> Self {
        Self { title, what_to_do, button: None }
    }

    /// With a button.
    pub fn button(mut self, text: &'a str) -> Self {
        self.button = Some(text);
        self
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Empty,
    Loading,
    Failed,
}

/// A panel without content, drawn in the middle of the available space.
#[derive(Clone, Copy, Debug)]
pub struct EmptyState<'a> {
    kind: Kind,
    message: Message<'a>,
}

/// Draws an empty panel; `true` when its button was pressed.
pub fn empty_state(ui: &mut Ui, title: &str, what_to_do: &str, button: Option<&str>) -> bool {
    EmptyState::empty(Message { title, what_to_do, button }).show(ui)
}

impl<'a> EmptyState<'a> {
    /// Nothing there yet, and how to fill it.
    pub fn empty(message: Message<'a>) -> Self {
        Self { kind: Kind::Empty, message }
    }

    /// On its way; a sentence that says what.
    pub fn loading(what: &'a str) -> Self {
        Self { kind: Kind::Loading, message: Message::new(what, "") }
    }

    /// Did not work: what failed, and what to do.
    pub fn failed(message: Message<'a>) -> Self {
        Self { kind: Kind::Failed, message }
    }

    /// Draws it; `true` when its button was pressed.
    pub fn show(&self, ui: &mut Ui) -> bool {
        let rect = ui.available_rect_before_wrap();
        let width = (rect.width() - 2.0 * space::M).clamp(80.0, LINE_WIDTH);
        let height = self.height(ui, width).min(rect.height());
        let inner = egui::Rect::from_center_size(rect.center(), Vec2::new(width, height));
        let layout = Layout::top_down(Align::Center);
        let builder = UiBuilder::new().id_salt("empty").max_rect(inner).layout(layout);
        let clicked = ui.scope_builder(builder, |ui| self.content(ui)).inner;
        ui.advance_cursor_after_rect(rect);
        clicked
    }

    fn content(&self, ui: &mut Ui) -> bool {
        let tokens = theme::tokens(ui);
        ui.spacing_mut().item_spacing.y = space::S;
        match self.kind {
            Kind::Empty => {}
            Kind::Loading => {
                ui.add(Spinner::new().size(GLYPH_SIZE).color(tokens.text_weak));
            }
            Kind::Failed => {
                let (rect, _) = ui.allocate_exact_size(Vec2::splat(GLYPH_SIZE), egui::Sense::hover());
                glyph::paint(ui.painter(), rect.center(), GLYPH_SIZE, Glyph::Warning, tokens.warning);
            }
        }
        ui.label(theme::strong(ui, self.message.title));
        if !self.message.what_to_do.is_empty() {
            ui.label(RichText::new(self.message.what_to_do).color(tokens.text_weak));
        }
        self.message.button.is_some_and(|text| {
            ui.add_space(space::XS);
            ui.button(text).clicked()
        })
    }

    fn height(&self, ui: &Ui, width: f32) -> f32 {
        let text_height = |text: &str, style: &TextStyle| {
            let font = theme::font(ui, style);
            ui.painter().layout(text.to_owned(), font, theme::tokens(ui).text, width).size().y
        };
        let mut height = text_height(self.message.title, &theme::strong_style(ui));
        if self.kind != Kind::Empty {
            height += GLYPH_SIZE + space::S;
        }
        if !self.message.what_to_do.is_empty() {
            height += text_height(self.message.what_to_do, &TextStyle::Body) + space::S;
        }
        if self.message.button.is_some() {
            height += ui.spacing().interact_size.y + space::XS + 2.0 * space::S;
        }
        height
    }
}

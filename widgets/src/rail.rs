//! The rail: the steps of the work in order, each with its state.

use egui::{Align2, Color32, Response, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::glyph::{self, Glyph};
use crate::theme::{self, Tokens, space};

const HEIGHT: f32 = 32.0;
const LEAST_HEIGHT: f32 = 26.0;
const GLYPH_SIZE: f32 = 11.0;

/// How far a step is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepState<'a> {
    /// Has no state of its own (Live, Sessions).
    Always,
    /// Not begun.
    NotDone,
    /// Under way by a fraction of 0..=1.
    Running(f32),
    /// A part of it is done, a fraction of 0..=1; nothing is under way.
    Partly(f32),
    /// Done and valid.
    Done,
    /// Done, but something it depends on changed; a sentence that says what.
    Stale(&'a str),
    /// Did not work; a sentence that says why and what to do.
    Failed(&'a str),
}

impl StepState<'_> {
    /// The state in a word.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Always => "",
            Self::NotDone => "not done",
            Self::Running(_) => "running",
            Self::Partly(_) => "partly done",
            Self::Done => "done",
            Self::Stale(_) => "stale",
            Self::Failed(_) => "failed",
        }
    }

    fn sign(&self, tokens: &Tokens) -> Option<(Glyph, Color32)> {
        match self {
            Self::Always => None,
            Self::NotDone => Some((Glyph::Ring, tokens.text_weak)),
            Self::Running(fraction) => Some((Glyph::Progress(*fraction), tokens.text_strong)),
            Self::Partly(fraction) => Some((Glyph::Progress(*fraction), tokens.accepted)),
            Self::Done => Some((Glyph::Check, tokens.accepted)),
            Self::Stale(_) => Some((Glyph::Clock, tokens.warning)),
            Self::Failed(_) => Some((Glyph::Warning, tokens.warning)),
        }
    }

    fn hover(&self) -> Option<String> {
        match self {
            Self::Always => None,
            Self::Stale(reason) => Some(format!("Stale: {reason}")),
            Self::Failed(reason) => Some(format!("Failed: {reason}")),
            Self::Running(fraction) => {
                Some(format!("Running, {}", crate::format::percent(f64::from(*fraction))))
            }
            // What it waits for is said by who knows.
            Self::NotDone | Self::Partly(_) => None,
            Self::Done => Some("Done".to_owned()),
        }
    }
}

/// One step of the rail.
pub struct RailStep<'a> {
    name: &'a str,
    number: Option<u32>,
    state: StepState<'a>,
    selected: bool,
    height: f32,
}

impl<'a> RailStep<'a> {
    /// A step by its name.
    pub fn new(name: &'a str, state: StepState<'a>) -> Self {
        Self { name, number: None, state, selected: false, height: HEIGHT }
    }

    /// Its place in the order of work.
    pub fn number(mut self, number: u32) -> Self {
        self.number = Some(number);
        self
    }

    /// Whether it is the one on screen.
    pub fn selected(mut self, selected: bool) -> Self {
        self.selected = selected;
        self
    }

    /// Less high than usual by so much, down to what is still easy to hit: where all steps shall be in sight.
    pub fn lower_by(mut self, less: f32) -> Self {
        self.height = (HEIGHT - less.max(0.0)).max(LEAST_HEIGHT);
        self
    }

    /// Draws it over the available width. The label for tests is the name; the value is the
    /// state in a word.
    pub fn show(self, ui: &mut Ui) -> Response {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), self.height), Sense::click());
        response.widget_info(|| {
            let mut info = WidgetInfo::selected(egui::Role::Tab, ui.is_enabled(), self.selected, self.name);
            info.current_text_value = Some(self.state.word().to_owned());
            info
        });
        if ui.is_rect_visible(rect) {
            self.paint(ui, rect, &response);
        }
        match self.state.hover() {
            Some(text) => response.on_hover_text(text),
            None => response,
        }
    }

    fn paint(&self, ui: &Ui, rect: egui::Rect, response: &Response) {
        let tokens = theme::tokens(ui);
        let painter = ui.painter();
        if self.selected {
            painter.rect_filled(rect, 4.0, tokens.selected);
        }
        theme::paint_hover(ui, response, rect);
        let y = rect.center().y;
        if let Some(number) = self.number {
            let font = theme::font(ui, &TextStyle::Small);
            let at = pos2(rect.left() + space::M, y);
            painter.text(at, Align2::CENTER_CENTER, number.to_string(), font, tokens.text_weak);
        }
        let (font, color) = if self.selected {
            (theme::strong_font(ui), tokens.text_strong)
        } else {
            (theme::font(ui, &TextStyle::Body), tokens.text)
        };
        painter.text(pos2(rect.left() + 28.0, y), Align2::LEFT_CENTER, self.name, font, color);
        if let Some((sign, color)) = self.state.sign(tokens) {
            let at = pos2(rect.right() - space::M, y);
            glyph::paint(painter, at, GLYPH_SIZE, sign, color);
        }
    }
}

//! A health lamp: a word, a value, and a reason when it is not good.

use egui::{Response, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::glyph::{self, Glyph};
use crate::theme::{self, Tokens, space};

const GLYPH_SIZE: f32 = 10.0;
/// Between sign, name and value.
const GAP: f32 = space::XS + 1.0;

/// How something is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Health {
    /// Works.
    Good,
    /// Under way by a fraction of 0..=1: warming up, connecting.
    Working(f32),
    /// Works, but look at it.
    Warning,
    /// Does not work.
    Failed,
    /// Can hurt robot or people.
    Danger,
    /// Not there, not asked for.
    Off,
}

impl Health {
    /// The word that stands for it where color and shape do not reach.
    pub fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Working(_) => "under way",
            Self::Warning => "warning",
            Self::Failed => "failed",
            Self::Danger => "danger",
            Self::Off => "off",
        }
    }

    pub(crate) fn sign(self, tokens: &Tokens) -> (Glyph, egui::Color32) {
        match self {
            Self::Good => (Glyph::Disc, tokens.accepted),
            Self::Working(fraction) => (Glyph::Progress(fraction), tokens.text),
            Self::Warning => (Glyph::Warning, tokens.warning),
            Self::Failed => (Glyph::Cross, tokens.warning),
            Self::Danger => (Glyph::Octagon, tokens.danger),
            Self::Off => (Glyph::Ring, tokens.text_weak),
        }
    }
}

/// How much of a lamp is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LampWords {
    /// Its sign; the rest is shown on hover.
    Sign,
    /// Its sign and its name.
    Name,
    /// All of it.
    #[default]
    All,
}

/// One lamp of the top line. A click opens what is behind it.
pub struct Lamp<'a> {
    name: &'a str,
    value: &'a str,
    health: Health,
    reason: Option<&'a str>,
    words: LampWords,
}

impl<'a> Lamp<'a> {
    /// `name` in a word ("eyes"), `value` with its unit ("30.0 Hz").
    pub fn new(name: &'a str, value: &'a str, health: Health) -> Self {
        Self { name, value, health, reason: None, words: LampWords::All }
    }

    /// Why it is not good and what to do, shown on hover.
    pub fn reason(mut self, reason: Option<&'a str>) -> Self {
        self.reason = reason;
        self
    }

    /// Less of it, where room is short; what is left out is shown on hover.
    #[must_use]
    pub fn words(mut self, words: LampWords) -> Self {
        self.words = words;
        self
    }

    /// How wide it will be, points.
    pub fn width(&self, ui: &Ui) -> f32 {
        let sign = space::S + GLYPH_SIZE + space::S;
        let body = theme::font(ui, &TextStyle::Body);
        let wide = |text: &str| {
            ui.painter().layout_no_wrap(text.to_owned(), body.clone(), egui::Color32::PLACEHOLDER).size().x
        };
        match self.words {
            LampWords::Sign => sign,
            LampWords::Name => sign + GAP + 2.0 + wide(self.name),
            LampWords::All => sign + GAP + 2.0 + wide(self.name) + GAP + wide(self.value),
        }
    }

    /// Draws it. The label for tests is `"{name} {value}"`.
    pub fn show(self, ui: &mut Ui) -> Response {
        let tokens = theme::tokens(ui);
        let body = theme::font(ui, &TextStyle::Body);
        let layout = |text: &str, color| ui.painter().layout_no_wrap(text.to_owned(), body.clone(), color);
        let name = layout(self.name, tokens.text_weak);
        let value = layout(self.value, tokens.text_strong);
        let size = vec2(self.width(ui), ui.spacing().interact_size.y);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| {
            let mut info =
                WidgetInfo::labeled(egui::Role::Button, true, format!("{} {}", self.name, self.value));
            info.current_text_value = Some(self.health.word().to_owned());
            info
        });
        if ui.is_rect_visible(rect) {
            theme::paint_hover(ui, &response, rect);
            let painter = ui.painter();
            let y = rect.center().y;
            let mut x = rect.left() + space::S;
            let (sign, color) = self.health.sign(tokens);
            glyph::paint(painter, egui::pos2(x + GLYPH_SIZE / 2.0, y), GLYPH_SIZE, sign, color);
            x += GLYPH_SIZE + GAP + 2.0;
            let shown = match self.words {
                LampWords::Sign => 0,
                LampWords::Name => 1,
                LampWords::All => 2,
            };
            for galley in [name, value].into_iter().take(shown) {
                let width = galley.size().x;
                painter.galley(egui::pos2(x, y - galley.size().y / 2.0), galley, tokens.text);
                x += width + GAP;
            }
        }
        let shown = if self.words == LampWords::All { String::new() } else { format!(" {}", self.value) };
        let mut hover = format!("{}{shown}: {}", self.name, self.health.word());
        if let Some(reason) = self.reason {
            hover.push_str(&format!("\n{reason}"));
        }
        response.on_hover_text(hover)
    }
}

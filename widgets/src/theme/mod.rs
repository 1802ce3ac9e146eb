//! Colors, type sizes and spacing: the only place where they are decided.
//!
//! Widgets ask [`tokens`] for colors by meaning. A meaning has the same color everywhere, stays
//! apart from the others with any of the common color deficiencies, and is readable on the
//! background of its theme; the tests of this module hold that.

mod apply;
mod class_color;
#[cfg(test)]
mod distinct;
mod tokens;

pub use apply::{apply, fonts};
pub use class_color::{class_color, class_swatch, class_words};
pub(crate) use tokens::{CROSSHAIR, INVALID, PIXEL_GRID, RIM, STALE_FADE, STALE_TINT, readable_on};
pub use tokens::{DARK, LIGHT, ON_IMAGE, Surfaces, Tokens};

use egui::{Color32, FontId, RichText, TextStyle, Ui};

/// Spacing grid in points. Everything is a multiple of 4.
pub mod space {
    /// Between a label and what it names.
    pub const XS: f32 = 4.0;
    /// Between things of one group.
    pub const S: f32 = 8.0;
    /// Between columns, and inside margins.
    pub const M: f32 = 16.0;
    /// Between groups.
    pub const L: f32 = 24.0;
}

/// The three type sizes, in points.
pub mod size {
    /// Axis labels, units, hints.
    pub const SMALL: f32 = 11.5;
    /// Everything else.
    pub const BODY: f32 = 13.5;
    /// The one heading of a panel, and the figure that decides.
    pub const HEADING: f32 = 18.0;
}

/// What a color stands for. The same meaning has the same color everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// What a sensor reported.
    Measured,
    /// What a model says, and what is asked for.
    Predicted,
    /// Measured minus predicted, or one calibration minus another: residuals, errors.
    Difference,
    /// Data that was kept out of the fit.
    HeldOut,
    /// What cannot be told apart from noise; dropped or left-out data.
    NoiseFloor,
    /// Done, in use, good.
    Accepted,
    /// Look here before you go on.
    Warning,
    /// Stop, and what can hurt robot or people. Nothing else is red.
    Danger,
    /// Ordinary text and lines.
    Ink,
    /// Secondary text and lines.
    Weak,
}

impl Role {
    /// Every role.
    pub const ALL: [Self; 10] = [
        Self::Measured,
        Self::Predicted,
        Self::Difference,
        Self::HeldOut,
        Self::NoiseFloor,
        Self::Accepted,
        Self::Warning,
        Self::Danger,
        Self::Ink,
        Self::Weak,
    ];

    /// Its color among a set of tokens.
    pub fn color(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Measured => tokens.measured,
            Self::Predicted => tokens.predicted,
            Self::Difference => tokens.difference,
            Self::HeldOut => tokens.held_out,
            Self::NoiseFloor => tokens.noise_floor,
            Self::Accepted => tokens.accepted,
            Self::Warning => tokens.warning,
            Self::Danger => tokens.danger,
            Self::Ink => tokens.text,
            Self::Weak => tokens.text_weak,
        }
    }
}

/// The tokens of the theme that `ui` is drawn in.
pub fn tokens(ui: &Ui) -> &'static Tokens {
    of_visuals(ui.visuals())
}

/// The tokens of the theme that is active in a context.
pub fn tokens_of(ctx: &egui::Context) -> &'static Tokens {
    match ctx.theme() {
        egui::Theme::Dark => &DARK,
        egui::Theme::Light => &LIGHT,
    }
}

pub(crate) fn of_visuals(visuals: &egui::Visuals) -> &'static Tokens {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// Name of the semi-bold text style and font family.
const STRONG: &str = "strong";

/// The text style of emphasized text at body size. Falls back to the body style where
/// [`apply`] has not been called.
pub fn strong_style(ui: &Ui) -> TextStyle {
    let strong = TextStyle::Name(STRONG.into());
    if ui.style().text_styles.contains_key(&strong) { strong } else { TextStyle::Body }
}

/// Emphasized text at body size.
pub fn strong(ui: &Ui, text: impl Into<String>) -> RichText {
    RichText::new(text).text_style(strong_style(ui)).color(tokens(ui).text_strong)
}

/// The heading of a panel. One per panel.
pub fn heading(ui: &mut Ui, text: &str) -> egui::Response {
    let text = RichText::new(text).heading().color(tokens(ui).text_strong);
    ui.label(text)
}

/// Text in the color of secondary information.
pub fn weak(ui: &Ui, text: impl Into<String>) -> RichText {
    RichText::new(text).color(tokens(ui).text_weak)
}

/// Small text in the color of secondary information.
pub fn small(ui: &Ui, text: impl Into<String>) -> RichText {
    RichText::new(text).text_style(TextStyle::Small).color(tokens(ui).text_weak)
}

/// A heading for a group inside a panel: small, semi-bold, with room above.
pub fn group_heading(ui: &mut Ui, text: &str) -> egui::Response {
    let text = RichText::new(text).text_style(strong_style(ui)).color(tokens(ui).text_strong);
    ui.add_space(space::S);
    let response = ui.label(text);
    ui.add_space(space::XS);
    response
}

/// Font of one of egui's text styles, as set by [`apply`].
pub(crate) fn font(ui: &Ui, style: &TextStyle) -> FontId {
    style.resolve(ui.style())
}

/// Semi-bold font at body size.
pub(crate) fn strong_font(ui: &Ui) -> FontId {
    font(ui, &strong_style(ui))
}

/// Background of something clickable under the pointer, and its ring with keyboard focus.
pub(crate) fn paint_hover(ui: &Ui, response: &egui::Response, rect: egui::Rect) {
    let tokens = tokens(ui);
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, tokens.raised_hover.gamma_multiply(0.6));
    }
    if response.has_focus() {
        let ring = egui::Stroke::new(1.5, tokens.accent);
        ui.painter().rect_stroke(rect, 4.0, ring, egui::StrokeKind::Inside);
    }
}

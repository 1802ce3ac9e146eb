//! Gives egui's own widgets the colors, sizes and fonts of the theme.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Shadow, Stroke, Style,
    TextStyle, ThemePreference, Visuals,
    style::{Selection, Spacing, TextCursorStyle, WidgetVisuals, Widgets},
    vec2,
};

use super::{DARK, LIGHT, STRONG, Tokens, size};

const REGULAR: &[u8] = include_bytes!("../../../assets/fonts/Inter-Regular.ttf");
const SEMI_BOLD: &[u8] = include_bytes!("../../../assets/fonts/Inter-SemiBold.ttf");

/// Sets fonts, sizes and the colors of both themes, and chooses one of them. Call it once when
/// the window is made; call `ctx.set_theme` to change between dark and light later.
pub fn apply(ctx: &egui::Context, preference: impl Into<ThemePreference>) {
    ctx.set_fonts(fonts());
    ctx.set_style_of(egui::Theme::Dark, style(&DARK, Visuals::dark()));
    ctx.set_style_of(egui::Theme::Light, style(&LIGHT, Visuals::light()));
    ctx.set_theme(preference);
}

/// Inter with digits of equal width, so that changing numbers do not jump; egui's fonts behind
/// it for symbols that it does not have.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    for (name, bytes) in [("Inter", REGULAR), ("Inter SemiBold", SEMI_BOLD)] {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
    }
    let proportional = fonts.families.entry(FontFamily::Proportional).or_default();
    let fallbacks = proportional.clone();
    proportional.insert(0, "Inter".to_owned());
    let strong = std::iter::once("Inter SemiBold".to_owned()).chain(fallbacks).collect();
    fonts.families.insert(FontFamily::Name(STRONG.into()), strong);
    fonts
}

fn style(tokens: &Tokens, base: Visuals) -> Style {
    Style {
        text_styles: text_styles(),
        drag_value_text_style: TextStyle::Body,
        spacing: spacing(),
        visuals: visuals(tokens, base),
        animation_time: 0.1,
        ..Style::default()
    }
}

fn text_styles() -> BTreeMap<TextStyle, FontId> {
    let strong = FontFamily::Name(STRONG.into());
    BTreeMap::from([
        (TextStyle::Small, FontId::proportional(size::SMALL)),
        (TextStyle::Body, FontId::proportional(size::BODY)),
        (TextStyle::Button, FontId::proportional(size::BODY)),
        (TextStyle::Monospace, FontId::monospace(size::BODY - 0.5)),
        (TextStyle::Heading, FontId::new(size::HEADING, strong.clone())),
        (TextStyle::Name(STRONG.into()), FontId::new(size::BODY, strong)),
    ])
}

fn spacing() -> Spacing {
    Spacing {
        item_spacing: vec2(8.0, 6.0),
        button_padding: vec2(10.0, 5.0),
        interact_size: vec2(40.0, 28.0),
        window_margin: Margin::same(16),
        menu_margin: Margin::same(6),
        indent: 16.0,
        icon_width: 16.0,
        icon_width_inner: 10.0,
        icon_spacing: 6.0,
        combo_width: 96.0,
        slider_width: 140.0,
        slider_rail_height: 4.0,
        tooltip_width: 360.0,
        ..Spacing::default()
    }
}

fn visuals(tokens: &Tokens, base: Visuals) -> Visuals {
    let shadow = |blur, offset| Shadow { offset: [0, offset], blur, spread: 0, color: tokens.shadow };
    Visuals {
        override_text_color: None,
        weak_text_color: Some(tokens.text_weak),
        widgets: widgets(tokens),
        selection: Selection { bg_fill: tokens.selected, stroke: Stroke::new(1.0, tokens.text_strong) },
        hyperlink_color: tokens.text_strong,
        faint_bg_color: tokens.grid,
        extreme_bg_color: tokens.background,
        text_edit_bg_color: Some(tokens.background),
        code_bg_color: tokens.raised,
        warn_fg_color: tokens.warning,
        error_fg_color: tokens.warning,
        window_corner_radius: CornerRadius::same(8),
        window_shadow: shadow(24, 8),
        window_fill: tokens.panel,
        window_stroke: Stroke::new(1.0, tokens.line),
        menu_corner_radius: CornerRadius::same(6),
        panel_fill: tokens.panel,
        popup_shadow: shadow(16, 4),
        text_cursor: TextCursorStyle {
            stroke: Stroke::new(2.0, tokens.text_strong),
            ..base.text_cursor.clone()
        },
        indent_has_left_vline: false,
        slider_trailing_fill: true,
        handle_shape: egui::style::HandleShape::Circle,
        ..base
    }
}

fn widgets(tokens: &Tokens) -> Widgets {
    let state = |fill: Color32, outline: Stroke, text: Stroke| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: outline,
        corner_radius: CornerRadius::same(4),
        fg_stroke: text,
        expansion: 0.0,
    };
    let line = Stroke::new(1.0, tokens.line);
    Widgets {
        noninteractive: state(tokens.panel, line, Stroke::new(1.0, tokens.text)),
        inactive: state(tokens.raised, Stroke::NONE, Stroke::new(1.0, tokens.text)),
        hovered: state(tokens.raised_hover, Stroke::NONE, Stroke::new(1.5, tokens.text_strong)),
        // Also how egui shows keyboard focus, so it needs a visible ring.
        active: state(
            tokens.raised_hover,
            Stroke::new(1.5, tokens.accent),
            Stroke::new(1.5, tokens.text_strong),
        ),
        open: state(tokens.raised_hover, line, Stroke::new(1.0, tokens.text_strong)),
    }
}

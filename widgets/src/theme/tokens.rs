//! The color values.
//!
//! The data colors start from the Okabe–Ito family (sky blue, orange, purple, green, yellow,
//! vermilion) and were moved until every pair stays apart in Oklab under normal vision,
//! protanopia, deuteranopia and tritanopia. The controls have no hue, so that hue always
//! carries a meaning.

use egui::Color32;

/// Every color of a theme, by meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Tokens {
    /// Behind the panels: gaps, the window's edge.
    pub background: Color32,
    /// Panels and tiles.
    pub panel: Color32,
    /// Buttons, inputs, tracks of bars.
    pub raised: Color32,
    /// The same under the pointer.
    pub raised_hover: Color32,
    /// What is selected.
    pub selected: Color32,
    /// Behind images and maps.
    pub backdrop: Color32,
    /// Separators and frames.
    pub line: Color32,
    /// Grid lines inside charts.
    pub grid: Color32,
    /// Headings, chosen values.
    pub text_strong: Color32,
    /// Ordinary text.
    pub text: Color32,
    /// Secondary text; readable, not decorative.
    pub text_weak: Color32,
    /// Fill of the primary button, focus rings.
    pub accent: Color32,
    /// Text on `accent`.
    pub on_accent: Color32,
    /// See [`super::Role::Measured`].
    pub measured: Color32,
    /// See [`super::Role::Predicted`].
    pub predicted: Color32,
    /// See [`super::Role::Difference`].
    pub difference: Color32,
    /// See [`super::Role::HeldOut`].
    pub held_out: Color32,
    /// See [`super::Role::NoiseFloor`].
    pub noise_floor: Color32,
    /// See [`super::Role::Accepted`].
    pub accepted: Color32,
    /// See [`super::Role::Warning`].
    pub warning: Color32,
    /// See [`super::Role::Danger`].
    pub danger: Color32,
    /// Fill of the stop button.
    pub stop: Color32,
    /// The stop button under the pointer.
    pub stop_hover: Color32,
    /// Text on the stop button.
    pub on_stop: Color32,
    /// Shadow under popups.
    pub shadow: Color32,
    /// Bodies in three dimensions, before light. Whole bodies in a pure color would shout: these
    /// are the meanings moved towards gray.
    pub surface: Surfaces,
}

/// Colors of bodies in three dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    /// Parts without a meaning of their own.
    pub neutral: Color32,
    /// See [`super::Role::Measured`].
    pub measured: Color32,
    /// See [`super::Role::Predicted`].
    pub predicted: Color32,
    /// What is selected.
    pub selected: Color32,
    /// The table.
    pub table: Color32,
    /// The touchscreen: black in both themes, as it is.
    pub screen: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// Dark theme.
pub const DARK: Tokens = Tokens {
    background: rgb(0x0E1114),
    panel: rgb(0x15191D),
    raised: rgb(0x242A31),
    raised_hover: rgb(0x303841),
    selected: rgb(0x2E3740),
    backdrop: rgb(0x0A0C0E),
    line: rgb(0x2B3138),
    grid: rgb(0x22272D),
    text_strong: rgb(0xF4F6F8),
    text: rgb(0xD0D6DC),
    text_weak: rgb(0x9BA5AF),
    accent: rgb(0xEDF0F3),
    on_accent: rgb(0x0E1114),
    measured: rgb(0x3FC7F4),
    predicted: rgb(0xE69A1F),
    difference: rgb(0xC76BDB),
    held_out: rgb(0xE9F7C8),
    noise_floor: rgb(0x7A8088),
    accepted: rgb(0x4FB896),
    warning: rgb(0xFFD426),
    danger: rgb(0xEF3B2C),
    stop: rgb(0xD12B1F),
    stop_hover: rgb(0xE5392C),
    on_stop: rgb(0xFFFFFF),
    shadow: Color32::from_black_alpha(120),
    surface: Surfaces {
        neutral: rgb(0xACACAC),
        measured: rgb(0x6FC4DF),
        predicted: rgb(0xDEA13F),
        selected: rgb(0xEDF0F3),
        table: rgb(0x454C54),
        screen: rgb(0x181C21),
    },
};

/// Light theme.
pub const LIGHT: Tokens = Tokens {
    background: rgb(0xE6E9ED),
    panel: rgb(0xF7F8FA),
    raised: rgb(0xE3E7EB),
    raised_hover: rgb(0xD5DAE0),
    selected: rgb(0xD3DAE2),
    backdrop: rgb(0xDDE1E6),
    line: rgb(0xCFD5DB),
    grid: rgb(0xE1E5E9),
    text_strong: rgb(0x0B0F13),
    text: rgb(0x272E35),
    text_weak: rgb(0x545E68),
    accent: rgb(0x171C21),
    on_accent: rgb(0xFFFFFF),
    measured: rgb(0x3973BA),
    predicted: rgb(0xC67D26),
    difference: rgb(0x890988),
    held_out: rgb(0x1B063B),
    noise_floor: rgb(0x818B92),
    accepted: rgb(0x085F42),
    warning: rgb(0x966400),
    danger: rgb(0xA90000),
    stop: rgb(0xC4201A),
    stop_hover: rgb(0xA81812),
    on_stop: rgb(0xFFFFFF),
    shadow: Color32::from_black_alpha(40),
    surface: Surfaces {
        neutral: rgb(0xD6D6D6),
        measured: rgb(0x7599C5),
        predicted: rgb(0xC98F49),
        selected: rgb(0x2C333A),
        table: rgb(0xFFFFFF),
        screen: rgb(0x181C21),
    },
};

/// Marks drawn on top of camera images keep the dark theme's bright colors in both themes: the
/// picture is the background there, not the panel. A dark rim keeps them apart from bright
/// pictures.
pub const ON_IMAGE: Tokens = DARK;

/// Lines through the pointer on an image.
pub(crate) const CROSSHAIR: Color32 = Color32::from_rgba_premultiplied(70, 70, 70, 70);

/// Rim around marks on images, and ground of words on images.
pub(crate) const RIM: Color32 = Color32::from_black_alpha(170);

/// Pixels of a map that have no value: ground and hatch. Gray is in no color map but the gray
/// one, where the hatch tells them apart.
pub(crate) const INVALID: [Color32; 2] = [rgb(0x33383D), rgb(0x4A5057)];

/// Lines between single pixels.
pub(crate) const PIXEL_GRID: Color32 = Color32::from_gray(128);

/// Tint of a picture that is old.
pub(crate) const STALE_TINT: Color32 = Color32::from_gray(150);

/// Strength of a scene that is old: it fades into the background.
pub(crate) const STALE_FADE: Color32 = Color32::from_rgba_premultiplied(110, 110, 110, 110);

/// Black or white, whichever can be read on a color.
pub(crate) fn readable_on(back: Color32) -> Color32 {
    let luma = 0.3 * f32::from(back.r()) + 0.59 * f32::from(back.g()) + 0.11 * f32::from(back.b());
    if luma > 130.0 { Color32::from_black_alpha(230) } else { Color32::from_white_alpha(230) }
}

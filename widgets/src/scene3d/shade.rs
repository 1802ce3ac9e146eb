//! Colors of tints in the active theme, and how light falls on them.

use std::sync::OnceLock;

use egui::Color32;
use nalgebra::{Point3, Vector3};

use super::scene::Tint;
use crate::theme::Tokens;

/// Linear red, green, blue; 1 is white.
pub(super) type Linear = [f32; 3];

/// Translucency of a ghost: facing the camera, and more at its rim, so that its form is seen.
const GHOST_ALPHA: [f32; 2] = [0.34, 0.88];

impl Tint {
    /// The color of lines, dots and words: as it is everywhere in the program.
    pub(super) fn ink(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Measured => tokens.measured,
            Self::Predicted | Self::Ghost => tokens.predicted,
            Self::Neutral | Self::Screen | Self::Table => tokens.text_weak,
            Self::Object(color) => color,
            Self::Selected => tokens.text_strong,
            Self::Warning => tokens.warning,
        }
    }

    /// The color of surfaces, before light.
    pub(super) fn surface(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Measured => tokens.surface.measured,
            Self::Predicted => tokens.surface.predicted,
            Self::Ghost => tokens.predicted,
            Self::Neutral => tokens.surface.neutral,
            Self::Screen => tokens.surface.screen,
            Self::Table => tokens.surface.table,
            Self::Object(color) => color,
            Self::Selected => tokens.surface.selected,
            Self::Warning => tokens.warning,
        }
    }

    /// Whether it is see-through.
    pub(super) fn is_ghost(self) -> bool {
        self == Self::Ghost
    }

    /// Whether it drops a shadow: what lies on the plane itself does not.
    pub(super) fn casts_shadow(self) -> bool {
        !matches!(self, Self::Ghost | Self::Table | Self::Screen)
    }
}

/// Directions of the light, in the frame of the shape that it falls on.
pub(super) struct Light {
    key: Vector3<f32>,
    up: Vector3<f32>,
    eye: Point3<f32>,
}

impl Light {
    /// `shape_from_robot` turns directions; `eye` is the camera in the shape's frame.
    pub(super) fn new(turn: impl Fn(Vector3<f64>) -> Vector3<f64>, eye: Point3<f64>) -> Self {
        // From above, the robot's front and left: it lights what faces the usual views.
        let key = Vector3::new(0.50, -0.30, 0.81).normalize();
        Self { key: turn(key).cast::<f32>(), up: turn(Vector3::z()).cast::<f32>(), eye: eye.cast::<f32>() }
    }

    /// Linear color of a point of an opaque surface.
    pub(super) fn solid(&self, base: &Linear, at: &Point3<f32>, normal: &Vector3<f32>) -> Linear {
        let view = (self.eye - at).normalize();
        let facing = normal.dot(&view).max(0.0);
        let sky = 0.5 + 0.5 * normal.dot(&self.up);
        let key = normal.dot(&self.key).max(0.0);
        let half = (self.key + view).normalize();
        let gloss = normal.dot(&half).max(0.0).powi(24) * 0.07;
        let light = 0.16 + 0.26 * sky + 0.58 * key + 0.16 * facing;
        base.map(|c| c * light + gloss)
    }

    /// Linear color and alpha (0 to 1) of a point of a ghost.
    pub(super) fn ghost(&self, base: &Linear, at: &Point3<f32>, normal: &Vector3<f32>) -> (Linear, f32) {
        let view = (self.eye - at).normalize();
        let rim = (1.0 - normal.dot(&view).abs()).clamp(0.0, 1.0);
        let [inside, outline] = GHOST_ALPHA;
        let light = 0.62 + 0.38 * normal.dot(&self.key).max(0.0);
        (base.map(|c| c * light), inside + (outline - inside) * rim * rim)
    }
}

/// A color of the screen as light.
pub(super) fn linear(color: Color32) -> Linear {
    [color.r(), color.g(), color.b()].map(|byte| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// Light as a color of the screen, 0 to 255, with an alpha of 0 to 1.
pub(super) fn on_screen(color: &Linear, alpha: f32) -> [f32; 4] {
    const STEPS: usize = 4096;
    static TABLE: OnceLock<Vec<f32>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let curve = |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (0..=STEPS).map(|i| 255.0 * curve(i as f32 / STEPS as f32)).collect()
    });
    // `as` turns what is not a number into 0.
    let [r, g, b] = color.map(|c| table[((c * STEPS as f32) as usize).min(STEPS)]);
    [r, g, b, 255.0 * alpha]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theme::{DARK, LIGHT};

    #[test]
    fn the_screen_curve_is_undone() {
        for level in [0u8, 3, 40, 128, 255] {
            let [r, ..] = on_screen(&linear(Color32::from_gray(level)), 1.0);
            assert!((r - f32::from(level)).abs() < 1.5, "{level}: {r}");
        }
    }

    #[test]
    fn light_falls_from_above() {
        let light = Light::new(|v| v, Point3::new(3.0, 0.0, 1.0));
        let base = [0.5; 3];
        let lit = |normal| light.solid(&base, &Point3::origin(), &normal)[0];
        assert!(lit(Vector3::z()) > 1.5 * lit(-Vector3::z()));
        assert!(lit(Vector3::z()) <= 1.0);
    }

    #[test]
    fn a_ghost_is_denser_at_its_rim_and_never_opaque() {
        let light = Light::new(|v| v, Point3::new(1.0, 0.0, 0.0));
        let alpha = |normal| light.ghost(&[0.5; 3], &Point3::origin(), &normal).1;
        assert!(alpha(Vector3::x()) < alpha(Vector3::z()) && alpha(Vector3::z()) < 0.95);
    }

    #[test]
    fn measured_and_predicted_bodies_stay_apart() {
        for tokens in [&DARK, &LIGHT] {
            let [a, b] = [Tint::Measured, Tint::Predicted].map(|tint| tint.surface(tokens).to_array());
            let apart: i32 = (0..3).map(|i| (i32::from(a[i]) - i32::from(b[i])).abs()).sum();
            assert!(apart > 120, "{a:?} {b:?}");
        }
    }
}

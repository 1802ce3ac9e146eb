//! Numbers as colors: perceptual maps, pictures of whole arrays, and the scale that explains
//! them.

mod scale_bar;
mod table;

pub use scale_bar::{Orientation, ScaleBar};

use egui::{Color32, ColorImage};

use crate::theme::INVALID;

/// Which colors stand for small and large.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Colormap {
    /// Violet, green, yellow; even steps, lightness grows all the way. The default.
    #[default]
    Viridis,
    /// Violet, blue, green, yellow, orange: more steps can be told apart, less even.
    Spectrum,
    /// Black to white.
    Gray,
    /// Blue, gray, orange around zero, for signed differences.
    Difference,
}

impl Colormap {
    /// Every map.
    pub const ALL: [Self; 4] = [Self::Viridis, Self::Spectrum, Self::Gray, Self::Difference];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "Viridis",
            Self::Spectrum => "Spectrum",
            Self::Gray => "Gray",
            Self::Difference => "Difference",
        }
    }

    /// 256 colors from small to large.
    pub fn table(self) -> &'static [Color32; 256] {
        table::of(self)
    }
}

/// A color map over a range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    /// The colors.
    pub map: Colormap,
    /// Values at both ends. Values beyond an end have the color of that end; the scale bar shows
    /// its ends as open for that reason.
    pub range: [f32; 2],
    /// Large values get the first color (near is bright on a depth map).
    pub reversed: bool,
}

impl ColorScale {
    /// From small to large.
    pub fn new(map: Colormap, range: [f32; 2]) -> Self {
        Self { map, range, reversed: false }
    }

    /// Symmetric around zero, for differences.
    pub fn symmetric(largest: f32) -> Self {
        Self::new(Colormap::Difference, [-largest, largest])
    }

    /// Exchanges the ends of the colors.
    pub fn reversed(self) -> Self {
        Self { reversed: !self.reversed, ..self }
    }

    /// The range that covers all finite values but the outermost 1 % on each side, so that a few
    /// wild ones do not use up the colors; `None` without finite values.
    pub fn range_of(values: &[f32]) -> Option<[f32; 2]> {
        // Every n-th is enough for percentiles and keeps this below a millisecond.
        let stride = (values.len() / 8192).max(1);
        let mut finite: Vec<f32> =
            values.iter().step_by(stride).copied().filter(|value| value.is_finite()).collect();
        if finite.is_empty() {
            return None;
        }
        let last = finite.len() - 1;
        let cut = finite.len() / 100;
        let low = *finite.select_nth_unstable_by(cut, f32::total_cmp).1;
        let high = *finite.select_nth_unstable_by(last - cut, f32::total_cmp).1;
        Some([low, if high > low { high } else { low + 1e-6f32.max(low.abs() * 1e-3) }])
    }

    /// The color of a value; `None` for values that are not finite.
    pub fn color(&self, value: f32) -> Option<Color32> {
        value.is_finite().then(|| self.map.table()[self.index(value)])
    }

    fn index(&self, value: f32) -> usize {
        let [low, high] = if self.reversed { [self.range[1], self.range[0]] } else { self.range };
        // `as` saturates, which is what the ends of the scale mean.
        ((value - low) * (255.0 / (high - low)) + 0.5) as u8 as usize
    }
}

/// A picture of an array, row by row; values that are not finite are hatched gray.
///
/// # Panics
/// If there are not `width * height` values.
pub fn colorize(values: &[f32], size: [usize; 2], scale: &ColorScale) -> ColorImage {
    colorize_with(values, size, scale, |value| *value)
}

/// As [`colorize`], for other elements. `value` gives `f32::NAN` where there is none.
///
/// # Panics
/// If there are not `width * height` elements.
pub fn colorize_with<T>(
    elements: &[T],
    size: [usize; 2],
    scale: &ColorScale,
    value: impl Fn(&T) -> f32,
) -> ColorImage {
    assert_eq!(elements.len(), size[0] * size[1], "elements for an image of {size:?}");
    let table = scale.map.table();
    let mut pixels = Vec::with_capacity(elements.len());
    for (row, line) in elements.chunks_exact(size[0].max(1)).enumerate() {
        pixels.extend(line.iter().enumerate().map(|(column, element)| {
            let value = value(element);
            if value.is_finite() { table[scale.index(value)] } else { INVALID[hatch(column, row)] }
        }));
    }
    ColorImage::new(size, pixels)
}

/// Diagonal stripes: 0 or 1.
fn hatch(column: usize, row: usize) -> usize {
    usize::from((column + row) % 8 < 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn ends_and_middle_of_the_range() {
        let scale = ColorScale::new(Colormap::Gray, [1.0, 3.0]);
        let gray = |value| scale.color(value).map(|color| color.r());
        assert_eq!(gray(1.0), Some(0));
        assert_eq!(gray(2.0), Some(128));
        assert_eq!(gray(3.0), Some(255));
        assert_eq!(gray(-50.0), Some(0));
        assert_eq!(gray(50.0), Some(255));
        assert_eq!(gray(f32::NAN), None);
        assert_eq!(gray(f32::INFINITY), None);
        assert_eq!(scale.reversed().color(1.0).map(|color| color.r()), Some(255));
    }

    #[test]
    fn lightness_grows_where_it_is_promised() {
        let luma = |c: &Color32| 0.3 * f32::from(c.r()) + 0.59 * f32::from(c.g()) + 0.11 * f32::from(c.b());
        for map in [Colormap::Viridis, Colormap::Gray] {
            let table = map.table();
            assert!(table.windows(2).all(|pair| luma(&pair[1]) >= luma(&pair[0]) - 0.5), "{map:?}");
            assert!(luma(&table[255]) > luma(&table[0]) + 150.0);
        }
    }

    #[test]
    fn neighboring_colors_are_close_in_every_map() {
        for map in Colormap::ALL {
            for pair in map.table().windows(2) {
                let step = (0..3).map(|i| pair[0].to_array()[i].abs_diff(pair[1].to_array()[i])).max();
                assert!(step <= Some(10), "{map:?}: {pair:?}");
            }
        }
    }

    #[test]
    fn missing_values_are_hatched_and_nothing_else_is() {
        let scale = ColorScale::new(Colormap::Viridis, [0.0, 1.0]);
        let mut values = vec![f32::NAN; 64 * 4];
        values[5] = 0.5;
        let image = colorize(&values, [64, 4], &scale);
        assert_eq!(Some(image.pixels[5]), scale.color(0.5));
        let hatched = |i: usize| INVALID.contains(&image.pixels[i]);
        assert!((0..values.len()).filter(|i| *i != 5).all(hatched));
        assert!(INVALID.iter().all(|color| image.pixels.contains(color)));
    }

    #[test]
    fn the_range_ignores_a_few_wild_values() {
        let mut values: Vec<f32> = (0..1000).map(|i| i as f32 / 1000.0).collect();
        values[3] = 1e9;
        values[4] = f32::NAN;
        let range = ColorScale::range_of(&values).expect("finite values");
        assert!((0.0..0.05).contains(&range[0]) && (0.95..1.0).contains(&range[1]), "{range:?}");
        assert_eq!(ColorScale::range_of(&[f32::NAN]), None);
        let flat = ColorScale::range_of(&[2.0; 10]).expect("finite values");
        assert!(flat[1] > flat[0]);
    }

    #[test]
    fn a_camera_image_takes_a_fraction_of_a_frame() {
        let values: Vec<f32> =
            (0..640 * 480).map(|i| if i % 7 == 0 { f32::NAN } else { (i % 1000) as f32 }).collect();
        let scale = ColorScale::new(Colormap::Spectrum, [0.0, 1000.0]);
        let fastest = (0..20)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(colorize(&values, [640, 480], &scale));
                start.elapsed()
            })
            .min();
        assert!(fastest.is_some_and(|t| t.as_secs_f64() < 0.002), "{fastest:?}");
    }
}

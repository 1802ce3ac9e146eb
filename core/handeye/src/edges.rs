//! Edges in images to a fraction of a pixel: along a line across the place where an edge should be seen.

use image::GrayImage;
use nalgebra::Vector2;

/// Step along a profile, px.
pub(crate) const STEP_PX: f64 = 0.2;

/// Gray levels along a line through `pixel`, from `window_px` before it to as far behind it, in steps of
/// [`STEP_PX`]; each is the mean over places beside the line, px. `None` where the image ends.
pub(crate) fn profile(
    image: &GrayImage,
    pixel: &Vector2<f64>,
    toward: &Vector2<f64>,
    window_px: f64,
    beside_px: &[f64],
) -> Option<Vec<f64>> {
    let across = Vector2::new(-toward.y, toward.x);
    let steps = (2.0 * window_px / STEP_PX).round() as usize;
    (0..=steps)
        .map(|step| {
            let middle = pixel + toward * (step as f64 * STEP_PX - window_px);
            let levels = beside_px.iter().map(|off| sample(image, &(middle + across * *off)));
            levels.sum::<Option<f64>>().map(|sum| sum / beside_px.len() as f64)
        })
        .collect()
}

/// Gray level between pixels.
fn sample(image: &GrayImage, at: &Vector2<f64>) -> Option<f64> {
    let (x, y) = (at.x.floor(), at.y.floor());
    if x < 0.0 || y < 0.0 || x + 1.0 >= f64::from(image.width()) || y + 1.0 >= f64::from(image.height()) {
        return None;
    }
    let (fx, fy) = (at.x - x, at.y - y);
    let of = |dx: u32, dy: u32| f64::from(image.get_pixel(x as u32 + dx, y as u32 + dy).0[0]);
    let upper = of(0, 0) * (1.0 - fx) + of(1, 0) * fx;
    let lower = of(0, 1) * (1.0 - fx) + of(1, 1) * fx;
    Some(upper * (1.0 - fy) + lower * fy)
}

/// Half the width over which a slope is taken, px: about that of a lens's blur.
const HALF_PX: f64 = 1.0;
/// Weaker edges are not told from noise, gray levels over twice [`HALF_PX`].
const WEAKEST: f64 = 15.0;

/// Where along a profile it gets brighter (`sign` 1) or darker (−1) the most, px from its middle: the
/// middle of the step that is steepest there. `None`: there is no such step, or it lies at the end.
pub(crate) fn steepest(profile: &[f64], sign: f64) -> Option<f64> {
    let half = (HALF_PX / STEP_PX).round() as usize;
    let slope = |i: usize| sign * (profile[i + half] - profile[i - half]);
    let inner = half..profile.len().checked_sub(half)?;
    let (best, strength) = inner.map(|i| (i, slope(i))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    if strength < WEAKEST || best <= half + 1 || best + half + 2 >= profile.len() {
        return None;
    }
    // The middle of what is at least half as steep: less shaken by noise than the peak itself.
    let (mut weights, mut moment) = (0.0, 0.0);
    let mut add = |i: usize| {
        let weight = slope(i) - 0.5 * strength;
        if weight > 0.0 {
            weights += weight;
            moment += weight * i as f64;
        }
        weight > 0.0
    };
    add(best);
    (best + 1..profile.len() - half).take_while(|i| add(*i)).count();
    (half..best).rev().take_while(|i| add(*i)).count();
    Some((moment / weights - 0.5 * (profile.len() - 1) as f64) * STEP_PX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A blurred step between two gray levels at a known place.
    fn stepped(at_px: f64, from: f64, to: f64) -> GrayImage {
        GrayImage::from_fn(60, 40, |x, _| {
            let part = 0.5 * (1.0 + ((f64::from(x) - at_px) / 0.8).tanh());
            image::Luma([(from + part * (to - from)).round() as u8])
        })
    }

    #[test]
    fn a_step_is_found_to_a_few_hundredths_of_a_pixel_in_its_own_sense_only() {
        for at_px in [29.0, 30.3, 31.75] {
            let image = stepped(at_px, 60.0, 190.0);
            let found = |sign: f64| {
                let (pixel, toward) = (Vector2::new(30.0, 20.0), Vector2::new(1.0, 0.0));
                steepest(&profile(&image, &pixel, &toward, 6.0, &[-1.0, 0.0, 1.0]).expect("inside"), sign)
            };
            let off_px = found(1.0).expect("an edge");
            assert!((off_px - (at_px - 30.0)).abs() < 0.05, "{at_px}: {off_px}");
            assert_eq!(found(-1.0), None);
        }
    }

    #[test]
    fn nothing_is_found_on_an_even_image_or_beyond_it() {
        let even = GrayImage::from_pixel(60, 40, image::Luma([90]));
        let toward = Vector2::new(0.0, 1.0);
        let levels = profile(&even, &Vector2::new(30.0, 20.0), &toward, 6.0, &[0.0]).expect("inside");
        assert_eq!(steepest(&levels, 1.0), None);
        assert_eq!(profile(&even, &Vector2::new(30.0, 38.0), &toward, 6.0, &[0.0]), None);
    }
}

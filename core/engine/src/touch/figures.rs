//! How far touches land from their targets, and how much repeats of one target differ.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use plumbline_model::Pixel;
use plumbline_model::session::{Screen, Touchscreen};

use super::record::TouchRecord;
use super::view::TouchFigures;

/// Touched minus target in the glass, m along u and v.
pub fn error_m(touched: Pixel<Screen>, target: Pixel<Screen>, screen: &Touchscreen) -> [f64; 2] {
    let [u_m, v_m] = screen.pitch_m();
    [(touched.u_px - target.u_px) * u_m, (touched.v_px - target.v_px) * v_m]
}

/// Figures of touches that count; `None` before the second.
///
/// The interval of the mean is Student's, as if touches were independent; repeats of one target are
/// not, so that many repeats of few targets make it too narrow. The noise is
/// √(Σ|error − mean of its group|² / (touches − groups)) over groups of two and more: the root mean
/// square distance in the glass, free of the bias of small groups.
pub fn figures<'a>(
    touches: impl IntoIterator<Item = &'a TouchRecord>,
    screen: &Touchscreen,
) -> Option<TouchFigures> {
    let mut errors: Vec<Vector2<f64>> = vec![];
    let mut groups: BTreeMap<&str, Vec<Vector2<f64>>> = BTreeMap::new();
    for touch in touches {
        let error = Vector2::from(error_m(touch.touched, touch.target, screen));
        errors.push(error);
        groups.entry(&touch.group).or_default().push(error);
    }
    if errors.len() < 2 {
        return None;
    }
    let count = errors.len() as f64;
    let lengths: Vec<f64> = errors.iter().map(|error| error.norm()).collect();
    let mean_m = lengths.iter().sum::<f64>() / count;
    let variance = lengths.iter().map(|length| (length - mean_m).powi(2)).sum::<f64>() / (count - 1.0);
    let half_m = student_95(errors.len() - 1) * (variance / count).sqrt();
    let bias: Vector2<f64> = errors.iter().sum::<Vector2<f64>>() / count;
    let (noise_m, repeats) = noise(groups.values());
    Some(TouchFigures {
        count: errors.len(),
        mean_m,
        // A mean distance is never below zero.
        mean_interval_m: [(mean_m - half_m).max(0.0), mean_m + half_m],
        largest_m: lengths.iter().copied().fold(0.0, f64::max),
        bias_m: bias.into(),
        noise_m,
        repeats,
    })
}

/// Root mean square distance of repeats from the mean of their group, m, and their number.
fn noise<'a>(groups: impl Iterator<Item = &'a Vec<Vector2<f64>>>) -> (Option<f64>, usize) {
    let (mut sum, mut freedom, mut repeats) = (0.0, 0, 0);
    for group in groups.filter(|group| group.len() > 1) {
        let mean: Vector2<f64> = group.iter().sum::<Vector2<f64>>() / group.len() as f64;
        sum += group.iter().map(|error| (error - mean).norm_squared()).sum::<f64>();
        freedom += group.len() - 1;
        repeats += group.len();
    }
    ((freedom > 0).then(|| (sum / freedom as f64).sqrt()), repeats)
}

/// Two-sided 95 % quantile of Student's t distribution.
fn student_95(freedom: usize) -> f64 {
    const FEW: [f64; 8] = [f64::INFINITY, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365];
    if let Some(quantile) = FEW.get(freedom) {
        return *quantile;
    }
    // Cornish–Fisher expansion about the normal quantile (Abramowitz and Stegun 26.7.5).
    let (z, n) = (1.959_964_f64, freedom as f64);
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    z + terms[0] / n + terms[1] / n.powi(2) + terms[2] / n.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::touch::testing;

    #[test]
    fn student_quantiles_are_those_of_the_tables() {
        for (freedom, quantile) in
            [(1, 12.706), (5, 2.571), (8, 2.306), (10, 2.228), (30, 2.042), (1000, 1.962)]
        {
            assert!((student_95(freedom) - quantile).abs() < 2e-3, "{freedom}: {}", student_95(freedom));
        }
    }

    #[test]
    fn figures_of_known_touches() {
        let screen = testing::rig().touchscreen.clone();
        let [u_m, v_m] = screen.pitch_m();
        let touch = |group: &str, u_mm: f64, v_mm: f64| {
            let target = Pixel::new(500.0, 500.0);
            let touched = Pixel::new(500.0 + u_mm * 1e-3 / u_m, 500.0 + v_mm * 1e-3 / v_m);
            testing::record(1, group, target, touched)
        };
        // Two repeats 2 mm apart, and one touch alone: bias (3, 4) mm.
        let touches = [touch("a", 2.0, 4.0), touch("a", 4.0, 4.0), touch("b", 3.0, 4.0)];
        let figures = figures(&touches, &screen).expect("more than one touch");
        assert_eq!((figures.count, figures.repeats), (3, 2));
        assert!((figures.bias_m[0] - 3e-3).abs() < 1e-9 && (figures.bias_m[1] - 4e-3).abs() < 1e-9);
        assert!((figures.largest_m - 32.0_f64.sqrt() * 1e-3).abs() < 1e-9);
        // Each lies 1 mm from their mean; one degree of freedom.
        let noise_m = figures.noise_m.expect("there are repeats");
        assert!((noise_m - 2.0_f64.sqrt() * 1e-3).abs() < 1e-9, "{noise_m}");
        let [low, high] = figures.mean_interval_m;
        assert!(low < figures.mean_m && figures.mean_m < high);
    }

    #[test]
    fn one_touch_has_no_figures_and_no_repeats_have_no_noise() {
        let screen = testing::rig().touchscreen.clone();
        let target = Pixel::new(500.0, 500.0);
        let touches = [testing::record(1, "a", target, target), testing::record(2, "b", target, target)];
        assert_eq!(figures(&touches[..1], &screen), None);
        assert_eq!(figures(&touches, &screen).expect("two touches").noise_m, None);
    }

    #[test]
    fn the_interval_holds_the_true_mean_about_as_often_as_it_says() {
        let screen = testing::rig().touchscreen.clone();
        let [u_m, _] = screen.pitch_m();
        let mut state = 7_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        // Distances evenly between 0 and 10 mm: their mean is 5 mm.
        let trials = 400;
        let held = (0..trials)
            .filter(|_| {
                let touches: Vec<TouchRecord> = (0..20)
                    .map(|i| {
                        let target = Pixel::new(500.0, 500.0);
                        let touched = Pixel::new(500.0 + 0.01 * unit() / u_m, 500.0);
                        testing::record(i + 1, &i.to_string(), target, touched)
                    })
                    .collect();
                let [low, high] = figures(&touches, &screen).expect("twenty").mean_interval_m;
                low < 5e-3 && 5e-3 < high
            })
            .count();
        assert!((370..=396).contains(&held), "{held} of {trials}");
    }
}

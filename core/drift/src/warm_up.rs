//! How far the eyes are on their way to their temperature, from what was seen so far.

use nalgebra::Vector3;

/// Housings of eyes reach their temperature with about this time constant, s.
const USUAL_S: f64 = 400.0;
/// How far a time constant may be from the usual one: standard deviation of its logarithm.
const USUAL_SPREAD: f64 = 0.5;
/// Time constants that are tried, s.
const TRIED_S: [f64; 2] = [90.0, 1800.0];
const TRIALS: usize = 40;
/// Fewer looks, or a shorter time (s), do not show a bend.
const LEAST_LOOKS: usize = 8;
const LEAST_TIME_S: f64 = 60.0;
/// A law that leaves more than this share of the variance is none.
const MOST_LEFT: f64 = 0.25;

/// Places approach where they end, exponentially.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmUp {
    /// Time constant, s.
    pub time_constant_s: f64,
    /// How far places still go from the last look on, mean length, m.
    pub to_go_m: f64,
}

impl WarmUp {
    /// Time until places are within this distance (m) of where they end, s; 0: they are.
    pub fn until_within_s(&self, within_m: f64) -> f64 {
        (self.time_constant_s * (self.to_go_m / within_m.max(1e-9)).ln()).max(0.0)
    }
}

/// Fits the approach to errors of three places (m) at times (s); `None`: they do not show one. The usual
/// time constant counts as one observation, so that few looks do not lead far away from it.
pub fn fit_warm_up(seen: &[(f64, [Vector3<f64>; 3])]) -> Option<WarmUp> {
    let (first, last) = (seen.first()?, seen.last()?);
    if seen.len() < LEAST_LOOKS || last.0 - first.0 < LEAST_TIME_S {
        return None;
    }
    let total = about_mean(seen, |_| 0.0).0;
    let (mut best, mut least) = (None, f64::INFINITY);
    for k in 0..TRIALS {
        let share = k as f64 / (TRIALS - 1) as f64;
        let tau_s = TRIED_S[0] * (TRIED_S[1] / TRIED_S[0]).powf(share);
        let (left, slopes) = about_mean(seen, |t_s| 1.0 - (-(t_s - first.0) / tau_s).exp());
        let off = ((tau_s / USUAL_S).ln() / USUAL_SPREAD).powi(2);
        let loss = left * (1.0 + off / seen.len() as f64);
        if loss < least {
            let rest = (-(last.0 - first.0) / tau_s).exp();
            let to_go_m = slopes.iter().map(|slope| slope.norm()).sum::<f64>() / 3.0 * rest;
            (best, least) = (Some((left, WarmUp { time_constant_s: tau_s, to_go_m })), loss);
        }
    }
    best.filter(|(left, _)| *left < MOST_LEFT * total).map(|(_, warm_up)| warm_up)
}

/// Sum of squares that a line in `of` leaves, and its slope for each place.
fn about_mean(seen: &[(f64, [Vector3<f64>; 3])], of: impl Fn(f64) -> f64) -> (f64, [Vector3<f64>; 3]) {
    let count = seen.len() as f64;
    let mean_x = seen.iter().map(|(t_s, _)| of(*t_s)).sum::<f64>() / count;
    let spread: f64 = seen.iter().map(|(t_s, _)| (of(*t_s) - mean_x).powi(2)).sum();
    let (mut left, mut slopes) = (0.0, [Vector3::zeros(); 3]);
    for (place, slope) in slopes.iter_mut().enumerate() {
        let mean = seen.iter().map(|(_, places)| places[place]).sum::<Vector3<f64>>() / count;
        if spread > 1e-12 {
            let sum: Vector3<f64> =
                seen.iter().map(|(t_s, places)| (places[place] - mean) * (of(*t_s) - mean_x)).sum();
            *slope = sum / spread;
        }
        left += seen
            .iter()
            .map(|(t_s, places)| (places[place] - mean - *slope * (of(*t_s) - mean_x)).norm_squared())
            .sum::<f64>();
    }
    (left, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(tau_s: f64, until_s: f64, noise_m: f64) -> Vec<(f64, [Vector3<f64>; 3])> {
        (0..=(until_s / 5.0) as usize)
            .map(|k| {
                let t_s = 5.0 * k as f64;
                let rattle = noise_m * (17.0 * t_s).sin();
                let along_m = 0.04 * (1.0 - (-t_s / tau_s).exp()) + rattle;
                (t_s, [Vector3::new(along_m, 0.2 * along_m, 0.0); 3])
            })
            .collect()
    }

    #[test]
    fn a_time_constant_and_the_rest_of_the_way_are_found() {
        for tau_s in [250.0, 400.0, 700.0] {
            let found = fit_warm_up(&course(tau_s, 600.0, 2e-4)).expect("an approach");
            assert!((found.time_constant_s / tau_s).ln().abs() < 0.15, "{tau_s}: {found:?}");
            let to_go_m = 0.04 * 1.04_f64.sqrt() * (-600.0 / tau_s).exp();
            assert!((found.to_go_m / to_go_m).ln().abs() < 0.3, "{to_go_m}: {found:?}");
            let wait_s = tau_s * (to_go_m / 0.002).ln();
            assert!((found.until_within_s(0.002) - wait_s.max(0.0)).abs() < 120.0, "{wait_s}: {found:?}");
        }
    }

    #[test]
    fn nothing_is_made_of_noise_or_of_a_moment() {
        let rattle: Vec<_> = (0..100)
            .map(|k| (5.0 * f64::from(k), [Vector3::new(2e-4 * (f64::from(k) * 9.1).sin(), 0.0, 0.0); 3]))
            .collect();
        assert_eq!(fit_warm_up(&rattle), None);
        assert_eq!(fit_warm_up(&course(400.0, 30.0, 0.0)), None);
    }
}

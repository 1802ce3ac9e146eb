//! How far the eyes are on their way to their temperature, from what was seen so far.

#[cfg(test)]
mod tests;

use nalgebra::Vector3;

/// Housings of eyes reach their temperature with about this time constant, s.
const USUAL_S: f64 = 400.0;
/// How far a time constant may be from the usual one: standard deviation of its logarithm.
const USUAL_SPREAD: f64 = 0.35;
/// Time constants that are tried, s.
const TRIED_S: [f64; 2] = [120.0, 1400.0];
const TRIALS: usize = 40;
/// Heat reaches the housing late: time constants of what lies before it, s.
const LATE_S: [f64; 8] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0, 110.0];
/// Fewer looks, or a shorter time (s), do not show a bend.
const LEAST_LOOKS: usize = 8;
const LEAST_TIME_S: f64 = 60.0;
/// A law that leaves more than this share of the variance is none.
const MOST_LEFT: f64 = 0.25;
/// What a law leaves is the same for many looks: however many there are, they count as this many.
const MOST_COUNT: f64 = 6.0;
/// Laws that are this much worse than the best (of a sum of squares in standard deviations) are possible still.
const POSSIBLE: f64 = 3.0;
/// No law of two constants is followed nearer than this by an error, m: where looks scatter less, laws are as uncertain
/// as if they scattered so much, for what a real housing does besides them is the same for all looks.
const BESIDE_LAWS_M: f64 = 1.5e-4;
/// A shorter time to go is not told from none, s.
const SHORT_S: f64 = 30.0;

/// Places approach where they end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmUp {
    /// Time constant, s.
    pub time_constant_s: f64,
    /// How far places still go from the last look on, mean length, m.
    pub to_go_m: f64,
    /// Time constant of what is warmed before the housing, s; 0: there is no such.
    pub late_s: f64,
}

impl WarmUp {
    /// Time until places are within this distance (m) of where they end, s; 0: they are.
    pub fn until_within_s(&self, within_m: f64) -> f64 {
        (self.time_constant_s * (self.to_go_m / within_m.max(1e-9)).ln()).max(0.0)
    }

    /// Share of the way after this time, with a time constant and one of what lies before, s.
    fn share(t_s: f64, time_constant_s: f64, late_s: f64) -> f64 {
        let decay = |constant_s: f64| (-t_s.max(0.0) / constant_s).exp();
        if late_s <= 0.0 {
            return 1.0 - decay(time_constant_s);
        }
        let weighted = time_constant_s * decay(time_constant_s) - late_s * decay(late_s);
        1.0 - weighted / (time_constant_s - late_s)
    }
}

/// A time that is to come, and what is not known of it, s. All zero: it is over.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToGo {
    /// At least.
    pub least_s: f64,
    /// What is expected.
    pub about_s: f64,
    /// At most.
    pub most_s: f64,
}

impl ToGo {
    /// A time that is known as this, s.
    pub fn of(s: f64) -> Self {
        Self { least_s: s, about_s: s, most_s: s }
    }

    /// Whether nothing is to come any more.
    pub fn is_over(&self) -> bool {
        self.most_s <= 0.0
    }
}

/// What was seen of an approach, and the ways that it may go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// All laws that go about as well with what was seen, and how probable each is; not empty.
    pub possible: Vec<(WarmUp, f64)>,
}

impl Approach {
    /// Time until places are within this distance (m) of where they end: the shortest and the longest of all
    /// laws, and their mean.
    pub fn until_within(&self, within_m: f64) -> ToGo {
        let mut told = ToGo { least_s: f64::INFINITY, ..ToGo::default() };
        for (law, probability) in &self.possible {
            let s = law.until_within_s(within_m);
            told.least_s = told.least_s.min(s);
            told.about_s += probability * s;
            told.most_s = told.most_s.max(s);
        }
        if told.most_s < SHORT_S { ToGo::default() } else { told }
    }
}

/// Fits the approach to errors of three places (m) at times (s) that count from when the eyes were switched on,
/// where that is known; `None`: they do not show one. The housing is warmed by what lies before it, which is warm
/// sooner. The usual time constant counts as one observation, so that few looks do not lead far away from it.
pub fn fit_warm_up(seen: &[(f64, [Vector3<f64>; 3])]) -> Option<Approach> {
    let (first, last) = (seen.first()?, seen.last()?);
    if seen.len() < LEAST_LOOKS || last.0 - first.0 < LEAST_TIME_S {
        return None;
    }
    let total = about_mean(seen, |_| 0.0).0;
    let count = (seen.len() as f64).min(MOST_COUNT);
    let beside = 3.0 * seen.len() as f64 * BESIDE_LAWS_M * BESIDE_LAWS_M;
    let mut tried: Vec<(f64, f64, WarmUp)> = Vec::with_capacity(TRIALS * LATE_S.len());
    for k in 0..TRIALS {
        let share = k as f64 / (TRIALS - 1) as f64;
        let tau_s = TRIED_S[0] * (TRIED_S[1] / TRIED_S[0]).powf(share);
        let off = ((tau_s / USUAL_S).ln() / USUAL_SPREAD).powi(2);
        for late_s in LATE_S.into_iter().filter(|late_s| *late_s < 0.9 * tau_s) {
            let (left, slopes) = about_mean(seen, |t_s| WarmUp::share(t_s, tau_s, late_s));
            let left = left + beside;
            let loss = count * left.ln() + off;
            let rest = 1.0 - WarmUp::share(last.0, tau_s, late_s);
            let to_go_m = slopes.iter().map(|slope| slope.norm()).sum::<f64>() / 3.0 * rest;
            tried.push((loss, left, WarmUp { time_constant_s: tau_s, to_go_m, late_s }));
        }
    }
    let (least, left, _) = tried.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
    // The loss is twice the logarithm of how improbable a law is.
    let likely = |loss: f64| (0.5 * (least - loss)).exp();
    let possible = || tried.iter().filter(|(loss, ..)| *loss <= least + POSSIBLE);
    let sum: f64 = possible().map(|(loss, ..)| likely(*loss)).sum();
    let possible = possible().map(|(loss, _, law)| (*law, likely(*loss) / sum)).collect();
    (left < MOST_LEFT * total).then_some(Approach { possible })
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

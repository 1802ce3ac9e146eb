//! What is known of rows, and in which shapes an effect is looked for in them.

use super::effect::LEFT;
use super::entry::Shape;
use super::{Effect, Kind};

/// At most this many moments are tried for a step.
pub(crate) const MOST_MOMENTS: usize = 15;
/// Time constants that are tried, s.
const TIME_CONSTANTS_S: [f64; 6] = [60.0, 120.0, 240.0, 480.0, 900.0, 1800.0];
/// Time constants and delays that are tried for an eye that turns, s.
const YAW_CONSTANTS_S: [f64; 4] = [120.0, 240.0, 480.0, 960.0];
const YAW_DELAYS_S: [f64; 3] = [0.0, 90.0, 180.0];
/// The same where things were watched: their course shows them better. A housing is warmed by what lies before it,
/// with a time constant of its own.
const WATCHED_CONSTANTS_S: [f64; 16] = [
    120.0, 140.0, 163.0, 190.0, 222.0, 258.0, 301.0, 351.0, 410.0, 478.0, 557.0, 650.0, 758.0, 884.0, 1031.0,
    1202.0,
];
const WATCHED_LATE_S: [f64; 5] = [0.0, 30.0, 60.0, 90.0, 120.0];
/// A time law needs rows over this time, s.
const SHORTEST_SPAN_S: f64 = 60.0;
/// A joint must be held at least so long for it to creep, s. Repeats that follow each other closely
/// are not held in between.
const SHORTEST_HOLD_S: f64 = 180.0;
/// Teeth per turn that are tried, if rows resolve them: fewest, most, and how many orders at most.
const ORDERS: [f64; 2] = [10.0, 60.0];
const MOST_ORDERS: usize = 16;
/// Servos hold less than this with ease: no limit is looked for, N m.
const EASY_TORQUE_NM: f64 = 0.1;
/// Steps in angle or height below this are no difference.
const SAME: f64 = 1e-9;

/// What is known of the rows.
pub(crate) struct Known {
    pub(crate) touches: bool,
    pub(crate) arm: bool,
    pub(crate) eyes: bool,
    pub(crate) background: bool,
    /// The eyes watched things that stood still.
    pub(crate) watched: bool,
    /// Which joints of the neck moved.
    pub(crate) neck_moved: Vec<bool>,
    /// They watched nothing else: what is constant there has no name.
    pub(crate) only_watched: bool,
    /// Labels of the sets in which the eyes measured, where an eye may have turned from one to the next.
    pub(crate) eye_sets: Vec<String>,
    /// Some row starts from commanded angles, of one joint at least.
    pub(crate) commanded: bool,
    /// Some row has encoders that lag.
    pub(crate) lag: bool,
    pub(crate) directions: bool,
    /// The side of approach is known, if only one.
    pub(crate) direction: bool,
    pub(crate) speeds: bool,
    /// Times of the arm's rows in which it was held, longest, s.
    pub(crate) longest_hold_s: f64,
    /// Times of the arm's and the eyes' rows, sorted.
    pub(crate) arm_secs: Vec<f64>,
    pub(crate) eye_secs: Vec<f64>,
    /// Largest torques of each joint and the angles that it took, sorted.
    pub(crate) torques_nm: Vec<Vec<f64>>,
    pub(crate) angles_rad: Vec<Vec<f64>>,
}

impl Known {
    /// Time from the arm's first row to its last, s.
    pub(crate) fn arm_span_s(&self) -> f64 {
        span(&self.arm_secs)
    }

    /// Whether the arm's rows last long enough for a time law.
    pub(crate) fn arm_lasts(&self) -> bool {
        self.arm_span_s() >= SHORTEST_SPAN_S
    }

    /// Whether there are moments between the arm's rows at which something may have changed.
    pub(crate) fn has_moments(&self) -> bool {
        moments(&self.arm_secs).len() >= 4
    }

    /// Whether joints were held long enough to creep.
    pub(crate) fn is_held(&self) -> bool {
        self.longest_hold_s >= SHORTEST_HOLD_S
    }

    /// Whether an effect has a name of its own in these rows: the zero of a joint of the neck that stood still all the
    /// while is how the eyes are mounted.
    pub(crate) fn has_own_name(&self, effect: &Effect) -> bool {
        effect.kind != Kind::HeadJoint
            || effect.joint.is_none_or(|joint| self.neck_moved.get(joint).copied().unwrap_or(true))
    }

    /// The effect in every shape that is tried.
    pub(crate) fn shapes(&self, effect: Effect) -> Vec<Effect> {
        if self.only_watched && effect.kind.is_of_eyes() {
            let Shape::Growth(_) = effect.kind.entry().shape else { return vec![] };
            return self.grown(&effect);
        }
        match effect.kind.entry().shape {
            Shape::None => vec![effect],
            Shape::OnceOrTwice => vec![effect.clone(), effect.with_shape(Some(2.0))],
            Shape::Teeth => {
                let angles = effect.joint.and_then(|j| self.angles_rad.get(j));
                let orders: Vec<f64> = angles.map_or(vec![], |angles| resolved(angles));
                with_shapes(&effect, &orders, ORDERS)
            }
            Shape::Limit => {
                let torques = effect.joint.and_then(|j| self.torques_nm.get(j));
                let limits = torques.map_or(vec![], |torques| limits(torques));
                let most = torques.and_then(|torques| torques.last()).copied().unwrap_or(0.0);
                with_shapes(&effect, &limits, [EASY_TORQUE_NM, most])
            }
            Shape::TimeConstant(lasts_s) => with_shapes(&effect, &constants(lasts_s(self)), [30.0, 3600.0]),
            Shape::Moment => {
                let all = moments(&self.arm_secs);
                let ends = [all.first(), all.last()].map(|end| end.copied().unwrap_or(0.0));
                with_shapes(&effect, &thinned(&all, MOST_MOMENTS), ends)
            }
            Shape::AnotherJoint => {
                let others =
                    (1..effect.puller_count()).map(|other| effect.clone().with_shape(Some(other as f64)));
                std::iter::once(effect.clone()).chain(others).collect()
            }
            Shape::Growth(_) => {
                let grown = self.grown(&effect);
                [vec![effect], grown].concat()
            }
            Shape::OneOf(choices) => {
                let others = (1..choices.len()).map(|choice| effect.clone().with_shape(Some(choice as f64)));
                std::iter::once(effect.clone()).chain(others).collect()
            }
        }
    }
}

impl Known {
    /// An effect of the eyes with every time law that is tried.
    fn grown(&self, effect: &Effect) -> Vec<Effect> {
        if effect.site == LEFT {
            return vec![];
        }
        let span_s = span(&self.eye_secs);
        if span_s < SHORTEST_SPAN_S {
            return vec![];
        }
        let lasts = |constant: &f64| *constant <= 2.0 * span_s;
        let shapes: Vec<f64> = if self.watched {
            let of = |constant: f64| WATCHED_LATE_S.map(|late| (constant, late));
            let all = WATCHED_CONSTANTS_S.into_iter().filter(lasts).flat_map(of);
            all.filter(|(constant, late)| 2.0 * late <= *constant)
                .map(|(constant, late)| Effect::late_growth(constant, late))
                .collect()
        } else {
            let of = |constant: f64| YAW_DELAYS_S.map(|delay| Effect::yaw_growth(constant, delay));
            YAW_CONSTANTS_S.into_iter().filter(lasts).flat_map(of).collect()
        };
        shapes.into_iter().map(|shape| effect.clone().with_shape(Some(shape))).collect()
    }
}

/// One effect in several shapes, each with the range up to half of the way to its neighbors (the
/// whole way for moments: the step may be anywhere between the rows that were tried).
pub(crate) fn with_shapes(effect: &Effect, shapes: &[f64], ends: [f64; 2]) -> Vec<Effect> {
    let at = |i: usize| shapes[i];
    (0..shapes.len())
        .map(|i| {
            let low = if i == 0 { ends[0] } else { at(i - 1) };
            let high = if i + 1 == shapes.len() { ends[1] } else { at(i + 1) };
            let mut shaped = effect.clone().with_shape(Some(at(i)));
            shaped.shape_range = Some([low.min(at(i)), high.max(at(i))]);
            shaped
        })
        .collect()
}

pub(crate) fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

pub(crate) fn differ(mut values: impl Iterator<Item = f64>) -> bool {
    values.next().is_some_and(|first| values.any(|value| (value - first).abs() > SAME))
}

fn span(sorted: &[f64]) -> f64 {
    sorted.first().zip(sorted.last()).map_or(0.0, |(first, last)| last - first)
}

/// Moments between rows.
pub(crate) fn moments(sorted_s: &[f64]) -> Vec<f64> {
    sorted_s
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > 1e-6)
        .map(|pair| 0.5 * (pair[0] + pair[1]))
        .collect()
}

/// At most so many of them, evenly spread over the rows, the ends left out: a step there is seen
/// in too few rows.
pub(crate) fn thinned(values: &[f64], most: usize) -> Vec<f64> {
    if values.len() <= most {
        return values.to_vec();
    }
    (1..=most).map(|k| values[k * (values.len() - 1) / (most + 1)]).collect()
}

fn constants(span_s: f64) -> Vec<f64> {
    let kept: Vec<f64> = TIME_CONSTANTS_S.into_iter().filter(|constant| *constant <= 2.0 * span_s).collect();
    if kept.is_empty() { vec![TIME_CONSTANTS_S[0]] } else { kept }
}

/// Orders of a ripple that these angles resolve: several periods, and enough distinct angles in
/// each. Neighbors differ by about two radians of phase from one end of the angles to the other.
fn resolved(sorted_rad: &[f64]) -> Vec<f64> {
    let mut distinct = sorted_rad.to_vec();
    distinct.dedup_by(|a, b| (*a - *b).abs() < 1e-4);
    let range_rad = span(&distinct);
    let turns = range_rad / std::f64::consts::TAU;
    let step = (2.0 / range_rad.max(0.1)).round().max(1.0);
    let count = ((ORDERS[1] - ORDERS[0]) / step) as usize;
    let all: Vec<f64> = (0..=count)
        .map(|k| ORDERS[0] + step * k as f64)
        .filter(|order| turns * order >= 2.0 && distinct.len() as f64 >= 6.0 * turns * order)
        .collect();
    thinned(&all, MOST_ORDERS)
}

/// Torques above which a servo may give up: some rows must lie above, more below.
fn limits(sorted_nm: &[f64]) -> Vec<f64> {
    let at = |share: f64| sorted_nm[((sorted_nm.len() - 1) as f64 * share) as usize];
    if sorted_nm.last().is_none_or(|most| *most < EASY_TORQUE_NM) {
        return vec![];
    }
    let mut limits: Vec<f64> = [0.5, 0.7, 0.85].map(at).into_iter().filter(|nm| *nm > 0.0).collect();
    limits.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
    limits
}

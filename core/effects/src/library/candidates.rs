//! Which effects rows could show at all, and in which shapes.

use crate::measurements::{Measurements, Observation};

use super::entry::Shape;
use super::{Effect, Kind, Situation};

/// At most this many moments are tried for a step.
const MOST_MOMENTS: usize = 15;
/// Time constants that are tried, s.
const TIME_CONSTANTS_S: [f64; 6] = [60.0, 120.0, 240.0, 480.0, 900.0, 1800.0];
/// Time constants and delays that are tried for an eye that turns, s.
const YAW_CONSTANTS_S: [f64; 4] = [120.0, 240.0, 480.0, 960.0];
const YAW_DELAYS_S: [f64; 3] = [0.0, 90.0, 180.0];
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

impl Effect {
    /// Every effect, at every site and in every shape of a grid, that these rows could show: by
    /// the columns that are there. Whether they do show it is for the tangents to say.
    pub fn candidates(measurements: &Measurements) -> Vec<Self> {
        let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref());
        let eyes = measurements.apparatuses.iter().find_map(|apparatus| apparatus.eyes.as_ref());
        let known = Known::of(measurements);
        Kind::ALL
            .iter()
            .filter(|kind| (kind.entry().shown)(&known))
            .flat_map(|kind| Self::sites(*kind, arm, eyes))
            .flat_map(|effect| known.shapes(effect))
            .collect()
    }

    /// Shapes around this one, between its neighbors of the grid: to pin it down once it was
    /// found. Itself alone where its shape is not a matter of degree.
    pub fn refined(&self, measurements: &Measurements) -> Vec<Self> {
        let Some([low, high]) = self.shape_range.filter(|[low, high]| low < high) else {
            return vec![self.clone()];
        };
        let shapes: Vec<f64> = match self.kind.entry().shape {
            Shape::Moment => {
                let moments = moments(&Known::of(measurements).arm_secs);
                let inside: Vec<f64> = moments.into_iter().filter(|t| (low..=high).contains(t)).collect();
                thinned(&inside, MOST_MOMENTS)
            }
            Shape::TimeConstant(_) => (0..=6).map(|k| low * (high / low).powf(f64::from(k) / 6.0)).collect(),
            Shape::Limit => (0..=6).map(|k| low + (high - low) * f64::from(k) / 6.0).collect(),
            Shape::Teeth => (low.ceil() as i64..=high.floor() as i64).map(|order| order as f64).collect(),
            Shape::None | Shape::OnceOrTwice | Shape::Growth(_) | Shape::Either(_) => vec![],
        };
        if shapes.is_empty() {
            return vec![self.clone()];
        }
        with_shapes(self, &shapes, [low, high])
    }
}

/// What is known of the rows.
pub(super) struct Known {
    pub(super) touches: bool,
    pub(super) arm: bool,
    pub(super) eyes: bool,
    pub(super) background: bool,
    /// Some row starts from commanded angles.
    pub(super) commanded: bool,
    /// Some row has encoders that lag.
    pub(super) lag: bool,
    pub(super) directions: bool,
    /// The side of approach is known, if only one.
    pub(super) direction: bool,
    pub(super) speeds: bool,
    /// Times of the arm's rows in which it was held, longest, s.
    pub(super) longest_hold_s: f64,
    /// Times of the arm's and the eyes' rows, sorted.
    arm_secs: Vec<f64>,
    eye_secs: Vec<f64>,
    /// Largest torques of each joint and the angles that it took, sorted.
    torques_nm: Vec<Vec<f64>>,
    angles_rad: Vec<Vec<f64>>,
}

impl Known {
    fn of(measurements: &Measurements) -> Self {
        let rows = &measurements.rows;
        let of_arm: Vec<&Observation> = rows.iter().filter(|row| row.what.is_placed()).collect();
        let of_eyes: Vec<&Observation> = rows.iter().filter(|row| !row.what.is_placed()).collect();
        let secs = |rows: &[&Observation]| sorted(rows.iter().filter_map(|row| row.t_secs));
        let moves = |row: &&&Observation| row.move_secs.is_some();
        let durations = sorted(of_arm.iter().filter(moves).filter_map(|row| row.move_secs));
        let joints = of_arm.iter().map(|row| row.angles_rad().len()).max().unwrap_or(0);
        let situations: Vec<Vec<f64>> = of_arm.iter().filter_map(|row| torques(measurements, row)).collect();
        Self {
            touches: measurements.has(crate::What::Touch),
            arm: !of_arm.is_empty(),
            eyes: !of_eyes.is_empty(),
            background: of_eyes.iter().any(|row| row.background_m.is_some()),
            commanded: of_arm.iter().any(|row| row.encoder_rad.is_none()),
            lag: of_arm.iter().filter_map(|row| row.lag_rad()).flatten().any(|lag| lag.abs() > 1e-4),
            directions: differ(of_arm.iter().map(|row| row.direction.first().copied().unwrap_or(0.0))),
            direction: of_arm.iter().any(|row| row.direction.iter().any(|side| *side != 0.0)),
            speeds: differ(durations.iter().copied()),
            longest_hold_s: of_arm.iter().filter_map(|row| row.hold_secs).fold(0.0, f64::max),
            arm_secs: secs(&of_arm),
            eye_secs: secs(&of_eyes),
            torques_nm: (0..joints)
                .map(|j| sorted(situations.iter().filter_map(|nm| nm.get(j)).map(|nm| nm.abs())))
                .collect(),
            angles_rad: (0..joints)
                .map(|j| sorted(of_arm.iter().filter_map(|row| row.angles_rad().get(j).copied())))
                .collect(),
        }
    }

    /// Time from the arm's first row to its last, s.
    pub(super) fn arm_span_s(&self) -> f64 {
        span(&self.arm_secs)
    }

    /// Whether the arm's rows last long enough for a time law.
    pub(super) fn arm_lasts(&self) -> bool {
        self.arm_span_s() >= SHORTEST_SPAN_S
    }

    /// Whether there are moments between the arm's rows at which something may have changed.
    pub(super) fn has_moments(&self) -> bool {
        moments(&self.arm_secs).len() >= 4
    }

    /// Whether joints were held long enough to creep.
    pub(super) fn is_held(&self) -> bool {
        self.longest_hold_s >= SHORTEST_HOLD_S
    }

    /// The effect in every shape that is tried.
    fn shapes(&self, effect: Effect) -> Vec<Effect> {
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
            Shape::Growth(_) => {
                let span_s = span(&self.eye_secs);
                if span_s < SHORTEST_SPAN_S {
                    return vec![effect];
                }
                let grown = YAW_CONSTANTS_S
                    .iter()
                    .filter(|constant| **constant <= 2.0 * span_s)
                    .flat_map(|constant| YAW_DELAYS_S.map(|delay| Effect::yaw_growth(*constant, delay)));
                let grown: Vec<Effect> = grown.map(|shape| effect.clone().with_shape(Some(shape))).collect();
                [vec![effect], grown].concat()
            }
            Shape::Either(_) => vec![effect.clone(), effect.with_shape(Some(1.0))],
        }
    }
}

/// One effect in several shapes, each with the range up to half of the way to its neighbors (the
/// whole way for moments: the step may be anywhere between the rows that were tried).
fn with_shapes(effect: &Effect, shapes: &[f64], ends: [f64; 2]) -> Vec<Effect> {
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

fn torques(measurements: &Measurements, row: &Observation) -> Option<Vec<f64>> {
    let arm = measurements.apparatus(row).arm.as_ref()?;
    let up = nalgebra::Vector3::z();
    let situation = Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &up).during(row);
    Some(situation.torques_nm().to_vec())
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn differ(mut values: impl Iterator<Item = f64>) -> bool {
    values.next().is_some_and(|first| values.any(|value| (value - first).abs() > SAME))
}

fn span(sorted: &[f64]) -> f64 {
    sorted.first().zip(sorted.last()).map_or(0.0, |(first, last)| last - first)
}

/// Moments between rows.
fn moments(sorted_s: &[f64]) -> Vec<f64> {
    sorted_s
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > 1e-6)
        .map(|pair| 0.5 * (pair[0] + pair[1]))
        .collect()
}

/// At most so many of them, evenly spread over the rows, the ends left out: a step there is seen
/// in too few rows.
fn thinned(values: &[f64], most: usize) -> Vec<f64> {
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

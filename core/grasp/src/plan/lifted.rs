//! Up again with what is held.

use nalgebra::Vector3;
use plumbline_model::Point;
use plumbline_model::robot::Posture;

use super::{GraspPlanner, LIFT_M, STEP_M};

/// A palm more level than this (cosine of its inclination) holds what it holds.
const HOLDS_LEVEL: f64 = 0.9985;
/// An arm whose palm does not get level in the end is taken elsewhere only when that is more level by this.
const GAIN: f64 = 0.001;
/// What is lifted straight at first, until it is clear of the table, m.
const STRAIGHT_M: f64 = 0.04;
/// So far toward the shoulder a stretched arm may bring what it lifts, m.
const BACK_M: [f64; 5] = [0.03, 0.06, 0.09, 0.12, 0.15];
/// Headings that are tried there beside the one in which it was grasped, rad.
const BESIDE_RAD: [f64; 9] = [0.0, 0.2, -0.2, 0.4, -0.4, 0.6, -0.6, 0.8, -0.8];
/// No joint turns farther than this on the way there, rad.
const FARTHEST_RAD: f64 = 1.2;

impl GraspPlanner {
    /// How high things are usually lifted, m.
    pub const LIFT_M: f64 = LIFT_M;

    /// Up from where the hand closed, fingers as they are: straight; an arm that is stretched out and would
    /// tilt the palm on that way, out of which things creep then, takes what it has lifted a little nearer to its
    /// shoulder, where it can hold the palm level.
    pub fn lift(&self, closed: &Posture, heading_rad: f64, by_m: f64) -> Vec<Posture> {
        let mut straight = self.vertical(heading_rad, closed, by_m);
        let level = straight.last().map_or(-1.0, |top| self.arm().level(top));
        if level >= HOLDS_LEVEL {
            return straight;
        }
        let clear = ((STRAIGHT_M / STEP_M).round() as usize).min(straight.len());
        let low = straight.get(clear.wrapping_sub(1));
        let nearer = low.and_then(|low| self.nearer(low, heading_rad, by_m - STRAIGHT_M));
        if let Some(nearer) = nearer.filter(|nearer| self.arm().level(nearer) > level + GAIN) {
            straight.truncate(clear);
            straight.push(nearer);
        }
        straight
    }

    /// Where the palm is level, higher and nearer to the shoulder than where it is held now: as near to there as is
    /// level, else the most level.
    fn nearer(&self, from: &Posture, heading_rad: f64, by_m: f64) -> Option<Posture> {
        let arm = self.arm();
        let start = arm.palm(from).coords;
        let toward = arm.shoulder_m(from) - start.coords;
        let toward = Vector3::new(toward.x, toward.y, 0.0).try_normalize(1e-6)?;
        let mut best: Option<(f64, Posture)> = None;
        for back_m in BACK_M {
            let point = Point::from(start + Vector3::z() * by_m + toward * back_m);
            let reached = BESIDE_RAD.iter().filter_map(|beside_rad| {
                let there = arm.sent_to(point, heading_rad + beside_rad, from)?;
                let is_near = there.distance_rad(from) < FARTHEST_RAD;
                (is_near && matches!(self.is_free(from, std::slice::from_ref(&there)), Ok(None)))
                    .then(|| (arm.level(&there), there))
            });
            for (level, there) in reached {
                if level >= HOLDS_LEVEL {
                    return Some(there);
                }
                if best.as_ref().is_none_or(|(most, _)| level > *most) {
                    best = Some((level, there));
                }
            }
        }
        best.map(|(_, there)| there)
    }
}

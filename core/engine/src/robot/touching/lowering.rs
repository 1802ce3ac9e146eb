//! The way down: where the tip should be after so much of it, and which way the joints turn.

use plumbline_model::robot::{JointIndex, Posture};

use crate::robot::touch_order::TouchOrder;

/// Joints that turn by less over the last steps count as standing, rad.
const STANDING_RAD: f64 = 1e-5;
/// Steps over which the direction of the last motion is looked at.
const LAST_STEPS: usize = 3;

/// Postures of a lowering by the length of the tip's way.
#[derive(Clone, Debug)]
pub(super) struct Descent {
    postures: Vec<Posture>,
    /// Way of the tip to each posture, m.
    way_m: Vec<f64>,
}

impl Descent {
    /// `None` when the tip does not move at all.
    pub fn new(order: &TouchOrder) -> Option<Self> {
        let mut way_m = vec![0.0];
        for pair in order.lower_tip.windows(2) {
            way_m.push(way_m[way_m.len() - 1] + pair[0].distance_m(&pair[1]));
        }
        let whole_m = *way_m.last()?;
        let sound = whole_m > 0.0 && whole_m.is_finite() && way_m.len() == order.lower.len();
        sound.then(|| Self { postures: order.lower.clone(), way_m })
    }

    /// Length of the way, m.
    pub fn length_m(&self) -> f64 {
        self.way_m[self.way_m.len() - 1]
    }

    /// The posture after a part of the way; the last one beyond its end.
    pub fn at(&self, way_m: f64) -> Posture {
        let i = self.step(way_m);
        let Some(next) = self.postures.get(i + 1) else { return self.postures[i].clone() };
        let span_m = self.way_m[i + 1] - self.way_m[i];
        let part = if span_m > 0.0 { ((way_m - self.way_m[i]) / span_m).clamp(0.0, 1.0) } else { 1.0 };
        self.postures[i].toward(next, part)
    }

    /// Sign of each joint's motion just before a part of the way: −1, 0 or 1.
    pub fn direction(&self, way_m: f64, joints: &[JointIndex]) -> Vec<i8> {
        let now = &self.postures[(self.step(way_m) + 1).min(self.postures.len() - 1)];
        let before = &self.postures[self.step(way_m).saturating_sub(LAST_STEPS - 1)];
        let sign = |joint: &JointIndex| {
            let turn_rad = now[*joint] - before[*joint];
            if turn_rad.abs() < STANDING_RAD { 0 } else { turn_rad.signum() as i8 }
        };
        joints.iter().map(sign).collect()
    }

    /// The posture that was passed last.
    fn step(&self, way_m: f64) -> usize {
        self.way_m.partition_point(|passed_m| *passed_m <= way_m).saturating_sub(1)
    }
}

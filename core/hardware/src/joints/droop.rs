//! How far joints hang below their goals at rest, by their own weight: what is held where it was just read
//! would sink by that once more.

use std::time::{Duration, Instant};

use plumbline_model::robot::{JointIndex, Posture};

use super::chains::Chains;
use super::slot::Slot;

/// A joint that stands for so long, and is slower than that, rests.
const RESTS_AFTER: Duration = Duration::from_millis(200);
const AT_REST_RAD_S: f64 = 0.02;
/// Less is rounding to ticks, and more is not its weight but something that it presses against, rad.
const LEAST_RAD: f64 = 0.004;
const MOST_RAD: f64 = 0.035;
/// How far it hangs changes with the posture of its arm: so far from where it rested nothing is known of it, rad.
const KNOWN_WITHIN_RAD: f64 = 1.2;

/// Where a joint rested last.
#[derive(Clone, Debug)]
struct Rest {
    /// All joints, as measured.
    at: Posture,
    goal_rad: f64,
    /// How far it stood from its goal.
    hangs_rad: f64,
}

/// What is known of all servos, in the order of their slots.
#[derive(Debug)]
pub(super) struct Droop {
    rests: Vec<Option<Rest>>,
    stands_since: Option<Instant>,
}

impl Droop {
    pub fn of(count: usize) -> Self {
        Self { rests: vec![None; count], stands_since: None }
    }

    /// Takes how the joints stand; `stands`: nothing is on its way. `commanded` and `measured`: of all joints.
    pub fn note(
        &mut self,
        now: Instant,
        stands: bool,
        slots: &[Slot],
        commanded: &Posture,
        measured: &Posture,
    ) {
        if !stands {
            self.stands_since = None;
            return;
        }
        let since = *self.stands_since.get_or_insert(now);
        let rests_by_now = now.duration_since(since) >= RESTS_AFTER;
        for (slot, rest) in slots.iter().zip(&mut self.rests) {
            // Limp, or with less force than its own, it says nothing of its weight.
            if !slot.holds_torque() || slot.force.is_some() {
                *rest = None;
                continue;
            }
            let is_slow = slot.reading.speed_rad_s.is_some_and(|speed| speed.abs() < AT_REST_RAD_S);
            if rests_by_now && is_slow && slot.is_known() {
                let joint = slot.reading.joint;
                let (goal_rad, angle_rad) = (commanded[joint], measured[joint]);
                *rest = Some(Rest { at: measured.clone(), goal_rad, hangs_rad: goal_rad - angle_rad });
            }
        }
    }

    /// The goal at which a joint that was read at `angle_rad` stays there. It lies between where the joint rested
    /// last, where it is and where it was sent: nowhere else, so that its servo takes it.
    pub fn goal_rad(
        &self,
        i: usize,
        slot: &Slot,
        sent_rad: f64,
        measured: &Posture,
        chains: &Chains,
    ) -> Option<f64> {
        let angle_rad = slot.reading.angle_rad?;
        let Some(rest) = self.rests.get(i).and_then(Option::as_ref) else { return Some(angle_rad) };
        let joint = slot.reading.joint;
        let of_its_arm =
            (0..measured.len()).map(JointIndex).filter(|other| chains.are_together(joint, *other));
        let moved_rad = of_its_arm.map(|other| (measured[other] - rest.at[other]).abs()).fold(0.0, f64::max);
        let known = 1.0 - moved_rad / KNOWN_WITHIN_RAD;
        let is_weight = (LEAST_RAD..=MOST_RAD).contains(&rest.hangs_rad.abs());
        // NaN fails the comparison.
        if !is_weight || !(known > 0.0) {
            return Some(angle_rad);
        }
        let [low, high] = [f64::min, f64::max].map(|f| f(f(angle_rad, rest.goal_rad), sent_rad));
        Some((angle_rad + rest.hangs_rad * known).clamp(low, high))
    }
}

//! How far the joints of an arm hang below their goals at rest, by their own weight: what is held where it was just
//! read would sink by that once more.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::robot::{Arm, JointIndex, Posture, Rig};

use super::controller::FRESH;
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
    at: Arc<Posture>,
    /// What its servo was told.
    goal_rad: f64,
    /// How far it stood from that.
    hangs_rad: f64,
}

/// What is known of all servos, in the order of their slots.
#[derive(Debug)]
pub(super) struct Droop {
    rig: Arc<Rig>,
    rests: Vec<Option<Rest>>,
    stands_since: Option<Instant>,
}

impl Droop {
    pub fn of(rig: Arc<Rig>, count: usize) -> Self {
        Self { rig, rests: vec![None; count], stands_since: None }
    }

    /// Something is on its way.
    pub fn moves(&mut self) {
        self.stands_since = None;
    }

    /// Takes how the joints stand while nothing is on its way. `measured`: of all joints.
    pub fn stands(&mut self, now: Instant, slots: &[Slot], measured: Posture) {
        let since = *self.stands_since.get_or_insert(now);
        let rests_by_now = now.duration_since(since) >= RESTS_AFTER;
        let measured = Arc::new(measured);
        for (slot, rest) in slots.iter().zip(&mut self.rests) {
            // Limp, or with less force than its own, it says nothing of its weight.
            if !slot.holds_torque() || slot.has_no_force() || slot.force.is_some() {
                *rest = None;
                continue;
            }
            let is_slow = slot.reading.speed_rad_s.is_some_and(|speed| speed.abs() < AT_REST_RAD_S);
            let told = slot.goal_rad().filter(|_| rests_by_now && is_slow && slot.silence() < FRESH);
            if let Some(goal_rad) = told {
                let hangs_rad = goal_rad - measured[slot.reading.joint];
                *rest = Some(Rest { at: measured.clone(), goal_rad, hangs_rad });
            }
        }
    }

    /// The goal at which a joint that was just read stays where it is. It lies between where the joint rested last, where
    /// it is and where it was sent, nowhere else, so that its servo takes it; and never so that its hand would go down:
    /// what stood above its goal was carried, or pressed on something.
    pub fn goal_rad(&self, i: usize, slot: &Slot, sent_rad: f64, measured: &Posture) -> Option<f64> {
        let angle_rad = slot.reading.angle_rad?;
        let joint = slot.reading.joint;
        let rest = self.rests.get(i).and_then(Option::as_ref);
        let arm = self.rig.arms.iter().find(|arm| arm.joints.contains(&joint));
        let Some((rest, arm)) = rest.zip(arm) else { return Some(angle_rad) };
        let moved_rad = arm.joints.iter().map(|other| (measured[*other] - rest.at[*other]).abs());
        let known = 1.0 - moved_rad.fold(0.0, f64::max) / KNOWN_WITHIN_RAD;
        let is_weight = (LEAST_RAD..=MOST_RAD).contains(&rest.hangs_rad.abs());
        // NaN fails the comparison.
        if !is_weight || !(known > 0.0) {
            return Some(angle_rad);
        }
        let [low, high] = [f64::min, f64::max].map(|f| f(f(angle_rad, rest.goal_rad), sent_rad));
        let goal_rad = (angle_rad + rest.hangs_rad * known).clamp(low, high);
        Some(if self.lifts(arm, joint, goal_rad, measured) { goal_rad } else { angle_rad })
    }

    /// Whether the hand of an arm is higher where a joint is turned to there.
    fn lifts(&self, arm: &Arm, joint: JointIndex, goal_rad: f64, measured: &Posture) -> bool {
        let description = &self.rig.description;
        let tip = arm.tips.first().and_then(|tip| description.find_link(&tip.link).ok());
        let height_m = |posture: &Posture| {
            tip.map(|link| description.forward(posture).all()[link.0].translation.z).unwrap_or_default()
        };
        height_m(&measured.with(&[joint], &[goal_rad])) > height_m(measured)
    }
}

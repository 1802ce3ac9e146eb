//! Fingers that hold on for long get warm: together they press less, so that none gets so hot that it lets go.
//!
//! A servo that stands and presses turns all that it draws into heat, which grows with the square of its torque: half
//! the force is a quarter of the heat. Fingers and thumb of a hand are eased alike, by the warmest of them, because
//! what presses against less than before is pushed out.
//!
//! (Physics, `core/grasp/tests/tolerance.rs`, ten seconds as grasped and ten eased, 22 places: of usual tomatoes none is
//! lost with 0.7 or 0.5 of the force; of those with 0.72 of the friction, 1.3 of the mass and 8 % larger 11 are still held
//! with 0.7, 2 with 0.5, and 20 with all of it. So force is taken off late, and no more than keeps the hand from
//! being too hot.)

use plumbline_model::robot::Gate;

use super::controller::Controller;
use super::slot::{Force, Slot};

/// This share of its force is left to a hand whose warmest servo is as hot as may be.
const LEFT_WHEN_HOT: f64 = 0.5;
/// Force is taken off in tenths: a degree to and fro changes nothing.
const STEPS: f64 = 10.0;

/// The share of the force of a hand that is left at the temperature of its warmest servo, °C: all of it up to the middle
/// between where the operator is warned and where nothing moves any more.
fn left_at(warmest_c: f64, gate: &Gate) -> f64 {
    let from_c = 0.5 * (gate.warm_c + gate.hot_c);
    let warmed = ((warmest_c - from_c) / (gate.hot_c - from_c)).clamp(0.0, 1.0);
    let left = 1.0 - (1.0 - LEFT_WHEN_HOT) * warmed;
    (left * STEPS).ceil() / STEPS
}

impl Controller {
    /// Hands that press and got warm press less; what was eased stays so until the hand is told something else.
    pub(super) fn ease_warm_hands(&mut self) {
        let rig = &self.limiter.rig;
        for arm in &rig.arms {
            let presses = |slot: &Slot| slot.is_limited() && arm.hand.contains(&slot.reading.joint);
            let slots = self.exchange.slots.iter().filter(|slot| presses(slot));
            let warmest_c = slots.clone().filter_map(|slot| slot.reading.temperature_c).reduce(f64::max);
            let eased = slots.map(|slot| slot.eased).fold(1.0, f64::min);
            // Also where some of them were told anew, and others were not.
            let left = warmest_c.map_or(eased, |warmest_c| eased.min(left_at(warmest_c, &rig.gate)));
            for slot in self.exchange.slots.iter_mut().filter(|slot| presses(slot) && slot.eased > left) {
                (slot.eased, slot.force_tries) = (left, 0);
            }
        }
    }
}

impl Slot {
    /// Whether it presses with a force that was limited for it.
    pub(super) fn is_limited(&self) -> bool {
        matches!(self.force, Some(Force::Limited(_)))
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn a_warm_hand_presses_less_and_a_hot_one_half() {
        let gate = Rig::built_in("nico").expect("comes with the program").gate;
        assert_eq!((gate.warm_c, gate.hot_c), (55.0, 70.0));
        let left = [20.0, 55.0, 62.0, 64.0, 66.0, 68.0, 70.0, 90.0].map(|warm_c| left_at(warm_c, &gate));
        assert_eq!(left, [1.0, 1.0, 1.0, 0.9, 0.8, 0.7, 0.5, 0.5]);
    }
}

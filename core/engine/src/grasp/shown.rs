//! What the window sees of grasping.

use std::sync::Arc;

use plumbline_grasp::Hand;
use plumbline_grasp::things::Thing;

use super::area::area;
use super::around::GraspAround;
use super::gates::{full_hand, gates, may_hold};
use super::held::HeldWatch;
use super::method::methods;
use super::view::{Gate, GraspPhase, GraspView, HandChoice, HandWaits, InHand};
use super::waits::{Waits, stands_in_view};
use super::workflow::{GraspWorkflow, What};
use crate::ground::step::StepState;

impl GraspWorkflow {
    pub(super) fn shown(&self, around: &GraspAround) -> GraspView {
        let phase = self.phase();
        let step = match &phase {
            phase if phase.moves() => StepState::Running,
            _ if self.attempts.iter().any(super::view::AttemptView::is_success) => StepState::Done,
            _ => StepState::NotDone,
        };
        GraspView {
            step,
            methods: methods(&around.corrections).into(),
            method: Some(self.method),
            hands: hands(around).into(),
            hand: self.choice,
            classes: Thing::held().map(|thing| thing.class).collect(),
            target: self.target.clone(),
            stops_after_each: self.stops.is_on(),
            held: self.in_hand(),
            gives_way_rad: self.held.as_ref().and_then(HeldWatch::gives_way_rad),
            hand_waits: self.waits(around),
            may_hold: self.waits.as_ref().filter(|_| self.held.is_none()).and_then(Waits::may_hold),
            not_made: self.not_made.clone(),
            hand_moved: self.hand_moved,
            gates: self.gates(around, self.planned_hand()).into(),
            phase,
            plan: self.plan.clone(),
            run: self.progress.as_ref().map(|progress| Arc::new(progress.run())),
            attempts: self.attempts.clone().into(),
        }
    }

    /// What is in a hand, as far as that is known.
    pub fn in_hand(&self) -> Option<InHand> {
        self.held.as_ref().map(|held| InHand { object: held.object.clone(), hand: held.hand })
    }

    /// How a hand was left, unless it was moved since, or holds something that is known.
    pub fn waits(&self, around: &GraspAround) -> Option<HandWaits> {
        let (rig, robot) = (&around.described, &around.robot);
        let now = self.waits.as_ref().map(|waits| waits.now(rig, robot));
        if self.held.is_some() {
            return now.flatten().filter(|waits| *waits == HandWaits::Offers);
        }
        // Either hand, wherever it was brought or sank to.
        let is_in_view = || Hand::BOTH.into_iter().any(|hand| stands_in_view(rig, hand, robot));
        now.flatten().or_else(|| is_in_view().then_some(HandWaits::InView))
    }

    /// What is looked at before anything moves; what is in a hand is among it.
    pub(super) fn gates(&self, around: &GraspAround, choice: HandChoice) -> Vec<Gate> {
        let full = self.in_hand();
        // A hand that holds something is the one that has to be fit: it puts that down first.
        let choice = match full.as_ref().map(|held| HandChoice::from(held.hand)) {
            Some(hand) if choice == HandChoice::Auto && self.method.hands(hand).is_ok() => hand,
            _ => choice,
        };
        let area = self.stands_at_m(around).and_then(|at_m| area(around, self.method, at_m));
        let gates = gates(around, choice, self.method).into_iter();
        let may_hold = self.waits(around).filter(|_| full.is_none()).and_then(may_hold);
        gates.chain(area).chain(full.iter().map(full_hand)).chain(may_hold).collect()
    }

    /// Where what is to be grasped stands, as far as that is known before it is looked for, robot frame, m.
    fn stands_at_m(&self, around: &GraspAround) -> Option<[f64; 2]> {
        let seen = || {
            let class = self.target.class.as_ref()?;
            let of_class =
                around.found.as_ref()?.objects.iter().filter(|seen| seen.name.eq_ignore_ascii_case(class));
            let placed = of_class.filter_map(|seen| seen.best_place().ok());
            nearest_m(placed.map(|place| [place.point_in_robot.coords.x, place.point_in_robot.coords.y]))
        };
        self.plan.as_ref().map(|plan| plan.at_m).or(self.target.near_m).or_else(seen)
    }

    fn phase(&self) -> GraspPhase {
        let Some(running) = &self.running else { return GraspPhase::Idle };
        let paused = running.reins.is_tight();
        match running.what {
            What::Plan => GraspPhase::Planning,
            What::Grasp => GraspPhase::Grasping { paused, ending: running.ending },
            What::Hand(step) => GraspPhase::Hand { step, paused },
        }
    }
}

/// Of several things of a class the grasp takes the one that is nearest to the robot.
fn nearest_m(places_m: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let far_m = |[x_m, y_m]: &[f64; 2]| x_m.hypot(*y_m);
    places_m.min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
}

/// With which hands this robot may grasp; with both there is a choice.
fn hands(around: &GraspAround) -> Vec<HandChoice> {
    let has = |hand: &Hand| around.described.arm(hand.name()).is_some_and(|arm| !arm.tips.is_empty());
    let there: Vec<HandChoice> = Hand::BOTH.into_iter().filter(has).map(HandChoice::from).collect();
    if there.len() > 1 { HandChoice::ALL.to_vec() } else { there }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_things_the_one_nearest_to_the_robot_is_meant() {
        let places_m = [[0.45, 0.0], [0.3, -0.1], [0.25, 0.4]];
        assert_eq!(nearest_m(places_m.into_iter()), Some([0.3, -0.1]));
        assert_eq!(nearest_m([].into_iter()), None);
    }
}

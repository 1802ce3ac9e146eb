//! How something gets under way, and what follows when it has ended.

use plumbline_grasp::Hand;

use super::{GraspWorkflow, Running, What};
use crate::grasp::around::GraspAround;
use crate::grasp::attempt::Attempt;
use crate::grasp::body::{EyesOn, Ropes};
use crate::grasp::command::{GraspTarget, HandStep};
use crate::grasp::gates::{able, shut};
use crate::grasp::keeping::grasps_in;
use crate::grasp::progress::Progress;
use crate::grasp::refusal::Refusal;
use crate::grasp::steps::HandWork;
use crate::grasp::stepwise::StopAfterEach;
use crate::grasp::view::{HandChoice, Need};
use crate::grasp::work::{Context, GraspWork};
use crate::ground::jobs::JobId;
use crate::robot::{Leader, Reins, RobotControl};

impl GraspWorkflow {
    pub(super) fn begin(
        &mut self,
        what: What,
        around: &GraspAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.idle()?;
        let hand = match what {
            What::Hand(step) => self.hand_for(step, around),
            What::Plan | What::Grasp => self.hand(),
        };
        let choice = self.moves(what, hand);
        let needed = self.gates(around, choice);
        // A step of the hand needs neither eyes nor a method.
        let needed: Vec<_> = needed
            .into_iter()
            .filter(|gate| !matches!(what, What::Hand(_)) || Need::OF_A_HAND.contains(&gate.of))
            .collect();
        if let Some(gate) = shut(&needed) {
            return Err(Refusal::Shut(gate.text.clone()));
        }
        if let (What::Hand(HandStep::Open | HandStep::Place), Some(held)) = (&what, &mut self.held) {
            held.leaves();
        }
        self.not_made = None;
        let reins = Reins::default();
        let title = match what {
            What::Plan => "planning a grasp",
            What::Grasp => "grasping",
            What::Hand(_) => "a step of the hand",
        };
        let (leader, led) = Leader::pair(title, what != What::Plan, &reins);
        let eyes_on = around.eyes_on_min.map(|min| EyesOn { for_s: 60.0 * min, at: context.time.instant });
        let ropes = Ropes { leader, sights: self.sights.clone(), reins: reins.clone(), eyes_on };
        context.control(RobotControl::Lead(led));
        let job = match what {
            What::Hand(step) => context.start(GraspWork::Hand(Box::new(HandWork {
                step,
                rests_on: around.rests_on(),
                arm: hand.name().to_owned(),
                ropes,
                closed_at_m: self.closed_at_m,
            }))),
            What::Plan | What::Grasp => {
                let attempt = Box::new(self.attempt(ropes, choice, around, context));
                context.start(match what {
                    What::Plan => GraspWork::Plan(attempt),
                    _ => GraspWork::Grasp(attempt),
                })
            }
        };
        self.running = Some(Running { job, what, hand, reins, ending: false });
        Ok(())
    }

    /// As it was chosen; what was planned for is what is grasped.
    fn attempt(
        &mut self,
        ropes: Ropes,
        choice: HandChoice,
        around: &GraspAround,
        context: &Context<'_>,
    ) -> Attempt {
        let target = match &self.plan {
            Some(plan) => GraspTarget { class: Some(plan.object.clone()), near_m: Some(plan.at_m) },
            None => self.target.clone(),
        };
        let object = target.class.clone().unwrap_or_else(|| "what is seen best".to_owned());
        let progress = Progress::new(self.method, &object);
        self.progress = Some(progress.clone());
        let stops = self.stops_in(around);
        Attempt {
            rests_on: around.rests_on(),
            hand: able(around, choice, self.method),
            method: self.method,
            target,
            ropes,
            grasps: grasps_in(&self.folder),
            at: context.time.day,
            progress,
            stops,
        }
    }

    /// Which hand may move for it.
    pub(super) fn moves(&self, what: What, hand: Hand) -> HandChoice {
        match what {
            What::Hand(_) => hand.into(),
            What::Plan => self.choice,
            What::Grasp => self.planned_hand(),
        }
    }

    /// The hand whose way is shown, or the chosen one: what was shown is what moves.
    pub(in crate::grasp) fn planned_hand(&self) -> HandChoice {
        self.plan.as_ref().map_or(self.choice, |plan| plan.hand.into())
    }

    /// An experiment goes on by itself, and its attempts are compared: they hold nowhere.
    fn stops_in(&self, around: &GraspAround) -> StopAfterEach {
        if around.in_experiment { StopAfterEach::default() } else { self.stops.clone() }
    }

    /// What is under way has ended; what was to be done then begins.
    pub(super) fn ended(&mut self, id: JobId, around: &GraspAround, context: &mut Context<'_>) {
        if self.running.as_ref().is_none_or(|running| running.job != id) {
            return;
        }
        self.running = None;
        if let Some(step) = self.then.take()
            && let Err(why) = self.begin(What::Hand(step), around, context)
        {
            context.refuse(why);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn attempts_of_an_experiment_do_not_stop_after_each_step_and_the_switch_reaches_one_under_way() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let workflow = GraspWorkflow::new(Path::new("unused"));
        let by_hand = workflow.stops_in(&GraspAround::bare(&rig));
        let of_experiment =
            workflow.stops_in(&GraspAround { in_experiment: true, ..GraspAround::bare(&rig) });
        workflow.stops.set(true);
        assert!(by_hand.is_on() && !of_experiment.is_on());
    }
}

//! What the operator asks for.

use plumbline_grasp::things::Thing;

use super::{GraspWorkflow, Running, What};
use crate::grasp::around::GraspAround;
use crate::grasp::command::{GraspCommand, GraspTarget, HandStep};
use crate::grasp::pointing::pointed_at;
use crate::grasp::refusal::Refusal;
use crate::grasp::stepwise::go_on;
use crate::grasp::work::{Context, GraspWork};

impl GraspWorkflow {
    pub(super) fn obey(
        &mut self,
        command: GraspCommand,
        around: &GraspAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        match command {
            GraspCommand::Method(method) => {
                self.idle()?;
                self.method = method;
                self.plan = None;
            }
            GraspCommand::Arm(choice) => {
                self.idle()?;
                if let Some(hand) = choice.asked()
                    && around.described.arm(hand.name()).is_none()
                {
                    return Err(Refusal::NoArm(hand.name().to_owned()));
                }
                (self.choice, self.plan) = (choice, None);
            }
            GraspCommand::Target(target) => self.aim(target)?,
            GraspCommand::Point { eye, u_px, v_px } => {
                let target = pointed_at(around, eye, [u_px, v_px]).ok_or(Refusal::NothingThere)?;
                self.aim(target)?;
            }
            GraspCommand::Plan => self.begin(What::Plan, around, context)?,
            GraspCommand::Forget => {
                self.idle()?;
                self.plan = None;
            }
            GraspCommand::Grasp => self.begin(What::Grasp, around, context)?,
            GraspCommand::Pause => self.under_way()?.reins.hold_tight(true),
            GraspCommand::Resume => go_on(self.progress.as_ref(), &self.under_way()?.reins),
            GraspCommand::End => self.end()?,
            GraspCommand::StopAfterEachStep(on) => self.stops.set(on),
            GraspCommand::Hand(HandStep::Home) if self.running.is_some() => {
                self.end()?;
                self.then = Some(HandStep::Home);
            }
            GraspCommand::Hand(step) => self.begin(What::Hand(step), around, context)?,
            GraspCommand::Judge { attempt, held } => {
                let known = self.attempts.iter().find(|known| known.name == attempt);
                let folder = known.map(|known| known.folder.clone());
                let folder = folder.ok_or(Refusal::NoAttempt(attempt))?;
                context.start(GraspWork::Judge { folder, held });
            }
        }
        Ok(())
    }

    fn aim(&mut self, target: GraspTarget) -> Result<(), Refusal> {
        self.idle()?;
        if let Some(class) = &target.class
            && Thing::of_class(class).is_none()
        {
            return Err(Refusal::NoThing(class.clone()));
        }
        (self.target, self.plan) = (target, None);
        Ok(())
    }

    pub(super) fn idle(&self) -> Result<(), Refusal> {
        match self.running.as_ref().map(|running| running.what) {
            None => Ok(()),
            Some(What::Plan) => Err(Refusal::UnderWay("planning")),
            Some(What::Grasp) => Err(Refusal::UnderWay("grasping")),
            Some(What::Hand(_)) => Err(Refusal::UnderWay("a step of the hand")),
        }
    }

    fn under_way(&self) -> Result<&Running, Refusal> {
        self.running.as_ref().ok_or(Refusal::NothingUnderWay)
    }

    fn end(&mut self) -> Result<(), Refusal> {
        let running = self.running.as_mut().ok_or(Refusal::NothingUnderWay)?;
        running.reins.end();
        go_on(self.progress.as_ref(), &running.reins);
        running.ending = true;
        Ok(())
    }
}

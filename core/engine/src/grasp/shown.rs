//! What the window sees of grasping.

use std::sync::Arc;

use plumbline_grasp::things::Thing;

use super::around::GraspAround;
use super::gates::gates;
use super::method::methods;
use super::view::{GraspPhase, GraspView};
use super::workflow::{GraspWorkflow, What};
use crate::ground::step::StepState;

impl GraspWorkflow {
    pub(super) fn shown(&self, around: &GraspAround) -> GraspView {
        let arms = around.described.arms.iter().map(|arm| (arm.name.clone(), arm.title.clone()));
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
            arms: arms.collect(),
            arm: self.arm.clone(),
            classes: Thing::held().map(|thing| thing.class).collect(),
            target: self.target.clone(),
            gates: gates(around, &self.arm, self.method).into(),
            phase,
            plan: self.plan.clone(),
            run: self.progress.as_ref().map(|progress| Arc::new(progress.run())),
            attempts: self.attempts.clone().into(),
        }
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

//! From what is asked for to a plan, and from a plan to a run.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_correction::{CorrectionModel, Method};
use plumbline_model::robot::Rig;
use plumbline_model::touch_plan::PlanOptions;

use super::super::choice;
use super::super::command::Correction;
use super::super::plan::{Corrector, PlanRequest};
use super::super::refusal::Refusal;
use super::super::store;
use super::super::view::ContactSource;
use super::super::work::{Context, TouchWork};
use super::{TouchAround, TouchWorkflow, source};
use crate::ground::notice::NoticeLevel;
use crate::robot::RobotControl;

impl TouchWorkflow {
    pub(super) fn plan(
        &mut self,
        options: PlanOptions,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        // Chosen in an earlier run of the program, and taken back since.
        if self.correct_with == Some(Correction::Effects) && around.model.added().is_nominal() {
            self.correct_with = None;
        }
        let corrector = match self.correct_with {
            None => Corrector::None,
            Some(Correction::Model(method)) => Corrector::Model(model_of(around, method)?),
            Some(Correction::Effects) => Corrector::Effects(around.model.clone()),
        };
        if let Some(earlier) = self.planning.take() {
            context.cancel(earlier);
        }
        let screen = self.placed_screen(&around.rig);
        let rig = Arc::new(Rig { touchscreen: screen, ..(*around.rig).clone() });
        self.options = Some(options.clone());
        self.planning = Some(context.start(TouchWork::Plan(PlanRequest {
            rig,
            place: self.screen_place(),
            options,
            corrector,
        })));
        Ok(())
    }

    /// Targets are corrected by the model's effects from the moment that it has some, until the operator
    /// chooses otherwise; a run that is under way ends as it began.
    pub(super) fn follow_model(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let now = around.model.added();
        let same = self.follows.as_ref().is_some_and(|before| Arc::ptr_eq(before, now));
        if same || self.no_run_under_way().is_err() {
            return;
        }
        let before = self.follows.replace(now.clone());
        let had_effects = before.is_some_and(|before| !before.is_nominal());
        match (had_effects, !now.is_nominal(), self.correct_with) {
            (false, true, None) => self.correct_with = Some(Correction::Effects),
            (true, false, Some(Correction::Effects)) => self.correct_with = None,
            (true, true, Some(Correction::Effects)) => {}
            _ => return,
        }
        self.plan_anew(around, context);
    }

    /// Plans once more what is planned, because what it depends on has changed.
    pub(super) fn plan_anew(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let wanted = self.planned.is_some() || self.planning.is_some();
        if let (Some(options), true, None) = (self.options.clone(), wanted, self.active_run())
            && let Err(reason) = self.plan(options, around, context)
        {
            context.refuse(reason);
        }
    }

    pub(super) fn correct_with(
        &mut self,
        correction: Option<Correction>,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        if let Some(Correction::Model(method)) = correction {
            model_of(around, method)?;
        }
        self.correct_with = correction;
        let kept = choice::choice_in(&self.folder);
        context.start(TouchWork::KeepChoice { kept, correct_with: correction });
        self.plan_anew(around, context);
        Ok(())
    }

    pub(super) fn start(&mut self, around: &TouchAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        if self.planning.is_some() {
            return Err(Refusal::StillPlanning);
        }
        let (plan, of_screen) = self.planned.clone().ok_or(Refusal::NothingPlanned)?;
        if plan.reachable() == 0 {
            return Err(Refusal::NothingInReach);
        }
        if let Some(trouble) = self.trouble(around) {
            return Err(trouble.into());
        }
        let rig = Arc::new(Rig { touchscreen: of_screen, ..(*around.rig).clone() });
        let sessions = self.folder.join("sessions");
        self.starting =
            Some(context.start(TouchWork::Begin { sessions, rig, plan, started: context.time.day }));
        Ok(())
    }

    pub(super) fn open(
        &mut self,
        session: PathBuf,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let rig = around.rig.clone();
        self.starting = Some(context.start(TouchWork::Open { session, rig }));
        Ok(())
    }

    pub(super) fn close(&mut self, around: &TouchAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        if self.run.as_ref().is_some_and(|run| !run.is_on_disk()) {
            return Err(Refusal::NotOnDisk);
        }
        if let Some(id) = self.planning.take() {
            context.cancel(id);
        }
        (self.planned, self.options) = (None, None);
        // A run that gave way to a plan was closed by nobody: what it put away comes back, too.
        self.owes_room |= source(&around.robot) == ContactSource::Twin;
        let Some(run) = self.run.take() else { return Ok(()) };
        if run.touch.is_some() {
            context.control(RobotControl::AbandonTouch);
        }
        if run.is_active() && !run.progress.finished {
            if let Some(left) = run.left_to_put_back() {
                let text = format!(
                    "Before anything else moves: {left}, or open the run again, which goes on as it stands."
                );
                context.notices.add(NoticeLevel::Warning, text);
            }
            self.runs.unfinished.insert(0, store::unfinished(&run.session, &run.progress));
        }
        self.last_session = Some(run.session);
        if run.touch.is_none() {
            self.give_room_back(around, context);
        }
        Ok(())
    }
}

fn model_of(around: &TouchAround, method: Method) -> Result<Arc<CorrectionModel>, Refusal> {
    let model = around.models.iter().find(|model| model.method() == method).cloned();
    model.ok_or(Refusal::NoModel(method))
}

//! What is grasped and how, what is under way, what became of attempts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_grasp::things::Thing;
use plumbline_grasp::{Method, Outcome};
use plumbline_model::StereoFrame;

use super::around::GraspAround;
use super::attempt::{Attempt, Proposed};
use super::body::Ropes;
use super::command::{GraspCommand, GraspTarget, HandStep};
use super::gates::{gates, shut};
use super::keeping::grasps_in;
use super::pointing::pointed_at;
use super::progress::Progress;
use super::refusal::Refusal;
use super::sights::Sights;
use super::steps::HandWork;
use super::view::{AttemptView, GraspView, PlannedGrasp};
use super::work::{Context, GraspResult, GraspWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::robot::{Leader, Reins, RobotControl};

/// What is under way.
#[derive(Clone, Debug)]
pub(super) struct Running {
    pub job: JobId,
    pub what: What,
    pub reins: Reins,
    pub ending: bool,
}

/// Of which kind it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    Plan,
    Grasp,
    Hand(HandStep),
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct GraspWorkflow {
    folder: PathBuf,
    pub(super) method: Method,
    pub(super) arm: String,
    pub(super) target: GraspTarget,
    pub(super) running: Option<Running>,
    /// What is done when what is under way has ended.
    then: Option<HandStep>,
    pub(super) plan: Option<Arc<PlannedGrasp>>,
    /// The attempt under way, or the last one.
    pub(super) progress: Option<Progress>,
    /// What the operator said of it.
    pub(super) attempts: Vec<AttemptView>,
    sights: Sights,
    /// Height of the palm when the hand closed last, m.
    closed_at_m: Option<f64>,
}

impl GraspWorkflow {
    /// Nothing grasped. Attempts are kept in `folder/grasps`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            method: Method::M5,
            arm: "right".to_owned(),
            target: GraspTarget::default(),
            running: None,
            then: None,
            plan: None,
            progress: None,
            attempts: vec![],
            sights: Sights::default(),
            closed_at_m: None,
        }
    }

    /// A pair has come from the eyes.
    pub fn saw(&self, frame: &StereoFrame) {
        if self.running.is_some() {
            self.sights.put(frame);
        }
    }

    fn obey(
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
            GraspCommand::Arm(arm) => {
                self.idle()?;
                if around.described.arm(&arm).is_none() {
                    return Err(Refusal::NoArm(arm));
                }
                (self.arm, self.plan) = (arm, None);
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
            GraspCommand::Resume => self.under_way()?.reins.hold_tight(false),
            GraspCommand::End => self.end()?,
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

    fn idle(&self) -> Result<(), Refusal> {
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
        running.reins.hold_tight(false);
        running.ending = true;
        Ok(())
    }

    fn begin(&mut self, what: What, around: &GraspAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.idle()?;
        let needed = gates(around, &self.arm, self.method);
        // A step of the hand needs neither eyes nor a method.
        let of_arm = ["Robot", "STOP", "Arm"];
        let needed: Vec<_> = needed
            .into_iter()
            .filter(|gate| !matches!(what, What::Hand(_)) || of_arm.contains(&gate.name))
            .collect();
        if let Some(gate) = shut(&needed) {
            return Err(Refusal::Shut(gate.text.clone()));
        }
        let reins = Reins::default();
        let title = match what {
            What::Plan => "planning a grasp",
            What::Grasp => "grasping",
            What::Hand(_) => "a step of the hand",
        };
        let (leader, led) = Leader::pair(title, what != What::Plan, &reins);
        let ropes = Ropes { leader, sights: self.sights.clone(), reins: reins.clone() };
        context.control(RobotControl::Lead(led));
        let job = match what {
            What::Hand(step) => context.start(GraspWork::Hand(Box::new(HandWork {
                step,
                rests_on: around.rests_on(),
                arm: self.arm.clone(),
                ropes,
                closed_at_m: self.closed_at_m,
            }))),
            What::Plan | What::Grasp => {
                let attempt = Box::new(self.attempt(ropes, around, context));
                context.start(match what {
                    What::Plan => GraspWork::Plan(attempt),
                    _ => GraspWork::Grasp(attempt),
                })
            }
        };
        self.running = Some(Running { job, what, reins, ending: false });
        Ok(())
    }

    /// As it was chosen; what was planned for is what is grasped.
    fn attempt(&mut self, ropes: Ropes, around: &GraspAround, context: &Context<'_>) -> Attempt {
        let target = match &self.plan {
            Some(plan) => GraspTarget { class: Some(plan.object.clone()), near_m: Some(plan.at_m) },
            None => self.target.clone(),
        };
        let object = target.class.clone().unwrap_or_else(|| "what is seen best".to_owned());
        let progress = Progress::new(self.method, &object);
        self.progress = Some(progress.clone());
        Attempt {
            rests_on: around.rests_on(),
            arm: self.arm.clone(),
            method: self.method,
            target,
            ropes,
            grasps: grasps_in(&self.folder),
            at: context.time.day,
            progress,
        }
    }

    fn planned(&mut self, proposed: Proposed, context: &mut Context<'_>) {
        if let Some(progress) = &self.progress {
            progress.change(|run| (run.seen, run.chosen) = (proposed.seen, proposed.chosen));
        }
        match proposed.plan {
            Ok(plan) => {
                self.closed_at_m = None;
                self.plan = Some(plan);
            }
            Err(why) => {
                self.plan = None;
                context.notices.add(NoticeLevel::Warning, format!("No grasp is planned: {why}."));
            }
        }
    }

    fn grasped(&mut self, attempt: AttemptView, summary: &str, context: &mut Context<'_>) {
        let level = match attempt.outcome {
            Some(Outcome::Success) => NoticeLevel::Success,
            _ => NoticeLevel::Warning,
        };
        context.notices.add(level, summary);
        self.plan = None;
        self.closed_at_m = attempt.closed_at_m.or(self.closed_at_m);
        self.attempts.insert(0, attempt);
    }

    fn judged(&mut self, attempt: AttemptView) {
        if let Some(progress) = &self.progress {
            progress.change(|run| {
                if run.name == attempt.name {
                    run.told = attempt.told;
                }
            });
        }
        if let Some(known) = self.attempts.iter_mut().find(|known| known.name == attempt.name) {
            *known = attempt;
        }
    }

    /// What is under way has ended; what was to be done then begins.
    fn ended(&mut self, id: JobId, around: &GraspAround, context: &mut Context<'_>) {
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

impl Workflow for GraspWorkflow {
    type Command = GraspCommand;
    type Work = GraspWork;
    type Control = RobotControl;
    type Around = GraspAround;
    type View = GraspView;

    fn new(folder: &Path) -> Self {
        Self::new(folder)
    }

    fn view(&mut self, around: &GraspAround, _moment: &Moment) -> Arc<GraspView> {
        Arc::new(self.shown(around))
    }

    fn restore(&mut self, _around: &GraspAround, context: &mut Context<'_>) {
        context.start(GraspWork::Restore { grasps: grasps_in(&self.folder) });
    }

    fn apply(&mut self, command: GraspCommand, around: &GraspAround, context: &mut Context<'_>) {
        if let Err(why) = self.obey(command, around, context) {
            context.refuse(why);
        }
    }

    fn work_done(&mut self, id: JobId, result: GraspResult, around: &GraspAround, context: &mut Context<'_>) {
        let summary = result.summary();
        match result {
            GraspResult::Restored(attempts, problems) => {
                self.attempts.extend(attempts);
                for problem in problems {
                    context.notices.add(NoticeLevel::Warning, crate::ground::text::sentence(&problem));
                }
            }
            GraspResult::Planned(proposed) => self.planned(*proposed, context),
            GraspResult::Grasped(attempt) => self.grasped(*attempt, &summary, context),
            GraspResult::HandDone(_, done) => {
                self.plan = None;
                if done.is_err() {
                    context.notices.add(NoticeLevel::Warning, summary);
                }
            }
            GraspResult::Judged(attempt) => self.judged(*attempt),
        }
        self.ended(id, around, context);
    }

    fn work_ended(&mut self, id: JobId, _why: Option<&str>, around: &GraspAround, context: &mut Context<'_>) {
        self.ended(id, around, context);
    }
}

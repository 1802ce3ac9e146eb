//! What is grasped and how, what is under way, what became of attempts.

mod beginning;
mod commands;
mod results;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_grasp::{Halt, Hand, HandChoice, Method};
use plumbline_model::StereoFrame;

use super::around::GraspAround;
use super::command::{GraspCommand, GraspTarget, HandStep};
use super::held::HeldWatch;
use super::keeping::grasps_in;
use super::progress::Progress;
use super::sights::Sights;
use super::steps::NoStep;
use super::stepwise::StopAfterEach;
use super::view::{AttemptView, GraspView, PlannedGrasp, StepNotMade};
use super::waits::{Waits, stands_in_view};
use super::work::{Context, GraspResult, GraspWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::robot::{Reins, RobotControl};

/// What is under way.
#[derive(Clone, Debug)]
pub(in crate::grasp) struct Running {
    pub job: JobId,
    pub what: What,
    /// With which hand, of a step of one.
    pub hand: Hand,
    pub reins: Reins,
    pub ending: bool,
}

/// Of which kind it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::grasp) enum What {
    Plan,
    Grasp,
    Hand(HandStep),
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct GraspWorkflow {
    folder: PathBuf,
    pub(in crate::grasp) method: Method,
    pub(in crate::grasp) choice: HandChoice,
    pub(in crate::grasp) target: GraspTarget,
    /// Whether attempts hold after each step.
    pub(in crate::grasp) stops: StopAfterEach,
    pub(in crate::grasp) running: Option<Running>,
    /// What is done when what is under way has ended.
    then: Option<HandStep>,
    pub(in crate::grasp) plan: Option<Arc<PlannedGrasp>>,
    /// With which model of the robot.
    pub(in crate::grasp) planned_with: Option<Arc<RobotModel>>,
    /// The attempt under way, or the last one.
    pub(in crate::grasp) progress: Option<Progress>,
    /// What the operator said of it.
    pub(in crate::grasp) attempts: Vec<AttemptView>,
    sights: Sights,
    /// Where the palm belonged when the hand closed last, robot frame, m.
    closed_at_m: Option<[f64; 3]>,
    /// What the hand holds, while it is looked whether it still does.
    pub(super) held: Option<HeldWatch>,
    /// How a hand was left.
    pub(super) waits: Option<Waits>,
    /// The step of a hand that was asked for last and could not be made.
    pub(super) not_made: Option<StepNotMade>,
    /// Whether a hand was moved by itself since the last attempt.
    pub(super) hand_moved: bool,
}

/// What became of an attempt during which the program ended; `None`: it came to its end.
fn broken_off(attempt: &AttemptView) -> Option<String> {
    let reached = attempt.reached.filter(|_| attempt.outcome.is_none())?;
    Some(format!(
        "The program ended while it grasped the {} ({}, {}). The twin begins anew at home; a real arm holds as its \
         servos were told last: look what is in the hand, open it if you must, then press Arm home, on the screen Grasp.",
        attempt.object.to_lowercase(),
        attempt.method.name().to_uppercase(),
        reached.title().to_lowercase()
    ))
}

impl GraspWorkflow {
    /// Nothing grasped. Attempts are kept in `folder/grasps`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            method: Method::M5,
            choice: HandChoice::default(),
            target: GraspTarget::default(),
            stops: StopAfterEach::default(),
            running: None,
            then: None,
            plan: None,
            planned_with: None,
            progress: None,
            attempts: vec![],
            sights: Sights::default(),
            closed_at_m: None,
            held: None,
            waits: None,
            not_made: None,
            hand_moved: false,
        }
    }

    /// The hand that a step is of: the one that holds something, else the one that was chosen, else the one that grasped
    /// last or is about to.
    pub(in crate::grasp) fn hand(&self) -> Hand {
        if let Some(held) = &self.held {
            return held.hand;
        }
        if let Some(hand) = self.waits.as_ref().and_then(Waits::may_hold) {
            return hand;
        }
        let planned = self.plan.as_ref().map(|plan| plan.hand);
        let last = || self.attempts.first().map(|attempt| attempt.hand);
        self.choice.asked().or(planned).or_else(last).unwrap_or_default()
    }

    /// The hand that a step is made with: home goes the one that is not, first the one that other steps would be of.
    pub(in crate::grasp) fn hand_for(&self, step: HandStep, around: &GraspAround) -> Hand {
        let hand = self.hand();
        let is_away = |hand: &Hand| stands_in_view(&around.described, *hand, &around.robot);
        match step {
            HandStep::Home if !is_away(&hand) => Hand::BOTH.into_iter().find(is_away).unwrap_or(hand),
            _ => hand,
        }
    }

    /// What was planned with another calibration or model of the robot is not what would be sent now.
    fn forget_old_plan(&mut self, around: &GraspAround) {
        let is_old = |with: &Arc<RobotModel>| !Arc::ptr_eq(with, &around.model);
        if self.running.is_none() && self.planned_with.as_ref().is_some_and(is_old) {
            (self.plan, self.planned_with) = (None, None);
        }
    }

    /// A pair has come from the eyes.
    pub fn saw(&self, frame: &StereoFrame) {
        if self.running.is_some() {
            self.sights.put(frame);
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
        self.forget_old_plan(around);
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
                if let Some(said) = attempts.first().and_then(broken_off) {
                    context.notices.add(NoticeLevel::Warning, said);
                }
                if self.waits.is_none()
                    && let Some(last) = attempts.first()
                {
                    self.waits = Waits::after_restart(last);
                    self.closed_at_m = self.closed_at_m.or(last.closed_at_m.filter(|_| self.waits.is_some()));
                }
                self.attempts.extend(attempts);
                for problem in problems {
                    context.notices.add(NoticeLevel::Warning, crate::ground::text::sentence(&problem));
                }
            }
            GraspResult::Planned(proposed) => self.planned(*proposed, around, context),
            GraspResult::Grasped(done) => self.grasped(*done, &summary, around, context),
            GraspResult::HandDone(step, done) => {
                self.plan = None;
                self.hand_moved = true;
                match (&mut self.held, step, &done) {
                    // Held out it is there to be taken.
                    (Some(held), HandStep::Give, Ok(())) => held.leaves(),
                    (Some(held), HandStep::Home | HandStep::Lift, Ok(())) => held.stays(),
                    _ => {}
                }
                let of =
                    (&*around.described, self.running.as_ref().map_or(self.hand(), |running| running.hand));
                self.waits = Waits::after_step((step, &done), self.waits.as_ref(), of, &around.robot);
                if let Err(why) = &done {
                    // Who stopped it knows why.
                    let was_ended = matches!(why, NoStep::Halted(Halt::Stopped | Halt::Cancelled));
                    self.not_made = (!was_ended).then(|| StepNotMade { step, why: why.to_string() });
                    context.notices.add(NoticeLevel::Warning, summary);
                }
            }
            GraspResult::Judged(attempt) | GraspResult::SlipKept(attempt) => self.judged(*attempt),
        }
        self.ended(id, around, context);
    }

    fn work_ended(&mut self, id: JobId, _why: Option<&str>, around: &GraspAround, context: &mut Context<'_>) {
        self.ended(id, around, context);
    }
}

#[cfg(test)]
mod old_plan_tests {
    use std::time::{Duration, Instant};

    use plumbline_model::robot::Rig;

    use super::*;
    use crate::ground::stage::Skipped;

    #[test]
    fn a_plan_goes_with_the_model_it_was_made_with() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let mut around = GraspAround::bare(&rig);
        let mut room = GraspWorkflow::new(Path::new("nowhere"));
        let plan = PlannedGrasp {
            method: Method::M5,
            hand: Hand::Left,
            model: "as described".to_owned(),
            object: "Tomato".to_owned(),
            at_m: [0.3, -0.1],
            sigma_m: Some(0.03),
            heading_rad: 0.0,
            level: 1.0,
            postures: Arc::from([]),
            palm_way_m: Arc::from([]),
            turns: Arc::from([]),
            duration: Duration::from_secs(8),
        };
        (room.plan, room.planned_with) = (Some(Arc::new(plan)), Some(around.model.clone()));
        let moment = Moment { now: Instant::now(), skipped: Skipped::default() };
        assert!(room.view(&around, &moment).plan.is_some());
        // What was shown is what moves, whichever hand would be chosen by now.
        let moves = |what| room.moves(what, Hand::Right);
        assert_eq!([moves(What::Grasp), moves(What::Plan)], [HandChoice::Left, HandChoice::Auto]);
        assert_eq!(moves(What::Hand(HandStep::Home)), HandChoice::Right);
        // The eyes are brought back, or an effect is added: the robot is known otherwise.
        around.model = Arc::new(RobotModel::nominal(rig));
        assert!(room.view(&around, &moment).plan.is_none());
    }
}

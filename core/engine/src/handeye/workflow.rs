//! The look under way, what came of it, and what is in use.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_effects::RigModel;
use plumbline_handeye::Tied;
use plumbline_model::StereoFrame;
use plumbline_model::robot::Rig;

use super::around::HandEyeAround;
use super::command::HandEyeCommand;
use super::gates::gates;
use super::kept::{FILE, Kept};
use super::look::Look;
use super::progress::Progress;
use super::refusal::Refusal;
use super::view::{HandEyeSummary, HandEyeView};
use super::work::{Context, HandEyeResult, HandEyeWork};
use crate::grasp::gates::shut;
use crate::grasp::{EyesOn, Ropes, Sights};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::step::StepState;
use crate::ground::{Moment, Workflow};
use crate::robot::{Leader, Reins, RobotControl};
use crate::twin::command::TwinCommand;

/// The look under way.
#[derive(Clone, Debug)]
struct Running {
    job: JobId,
    reins: Reins,
    ending: bool,
    at: Timestamp,
    /// The model in use when it began.
    base: Arc<RigModel>,
    /// Toys of the twin that were put away, and where they stood, m.
    away: Vec<(String, [f64; 2])>,
}

/// What came of a look, and the model that it began with.
#[derive(Clone, Debug)]
struct Proposal {
    tied: Box<Tied>,
    kept: Box<Kept>,
    summary: Arc<HandEyeSummary>,
    base: Arc<RigModel>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct HandEyeWorkflow {
    file: PathBuf,
    sights: Sights,
    running: Option<Running>,
    progress: Option<Progress>,
    proposal: Option<Proposal>,
    /// What was accepted last.
    kept: Option<(Kept, Arc<HandEyeSummary>)>,
    /// The model that was asked of last, and whether it has what was accepted.
    asked: Option<(Arc<RigModel>, bool)>,
    /// A model that was accepted, to be put in use.
    accepted: Option<RigModel>,
}

impl HandEyeWorkflow {
    /// A pair has come from the eyes.
    pub fn saw(&self, frame: &StereoFrame) {
        if self.running.is_some() {
            self.sights.put(frame);
        }
    }

    /// Whether a look is under way.
    pub fn is_looking(&self) -> bool {
        self.running.is_some()
    }

    /// A model that was accepted; told once.
    pub fn take_accepted(&mut self) -> Option<RigModel> {
        self.accepted.take()
    }

    /// What the model in use came of; `None`: the arms are not tied to the eyes, or not any more.
    pub fn in_use(&self, added: Option<&Arc<RigModel>>) -> Option<&Arc<HandEyeSummary>> {
        let (kept, summary) = self.kept.as_ref()?;
        let has = |model: &Arc<RigModel>| match &self.asked {
            Some((asked, has)) if Arc::ptr_eq(asked, model) => *has,
            _ => kept.is_in(model),
        };
        added.is_some_and(has).then_some(summary)
    }

    /// Compares all values once for each model, not at every picture.
    fn ask(&mut self, added: Option<&Arc<RigModel>>) {
        let is_new =
            |(asked, _): &(Arc<RigModel>, bool)| added.is_none_or(|model| !Arc::ptr_eq(asked, model));
        if self.asked.as_ref().is_none_or(is_new) {
            let (kept, added) = (self.kept.as_ref(), added.cloned());
            self.asked = kept.zip(added).map(|((kept, _), model)| {
                let has = kept.is_in(&model);
                (model, has)
            });
        }
    }

    fn keep(&mut self, kept: Kept, summary: Arc<HandEyeSummary>) {
        self.kept = Some((kept, summary));
        self.asked = None;
    }

    fn begin(&mut self, around: &HandEyeAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        if self.running.is_some() {
            return Err(Refusal::UnderWay);
        }
        let gates = gates(around);
        if let Some(gate) = shut(&gates) {
            return Err(Refusal::Shut(gate.text.clone()));
        }
        let grasp = &around.grasp;
        let (Some(calibration), Some(touches), Some(base)) =
            (grasp.calibration.clone(), around.touches.clone(), around.added.clone())
        else {
            // The gates have looked at all of it.
            return Err(Refusal::Shut(
                "Calibrate eyes, mount and screen, and touch the screen first.".to_owned(),
            ));
        };
        let reins = Reins::default();
        let (leader, led) = Leader::pair("looking at the hands", true, &reins);
        let eyes_on = grasp.eyes_on_min.map(|min| EyesOn { for_s: 60.0 * min, at: context.time.instant });
        let ropes = Ropes { leader, sights: self.sights.clone(), reins: reins.clone(), eyes_on };
        let away = clear(around, context);
        context.control(RobotControl::Lead(led));
        let progress = Progress::new(&grasp.described);
        self.progress = Some(progress.clone());
        self.proposal = None;
        let look = Look {
            described: grasp.described.clone(),
            model: grasp.model.clone(),
            calibration,
            touches,
            ropes,
            at: context.time.day,
            progress,
        };
        let job = context.start(HandEyeWork::Look(Box::new(look)));
        self.running = Some(Running { job, reins, ending: false, at: context.time.day, base, away });
        Ok(())
    }

    fn accept(&mut self, around: &HandEyeAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        if around.is_changing {
            // It would be refused there, and what was seen would be lost.
            return Err(Refusal::Changing);
        }
        let Some(proposal) = self.proposal.take() else {
            return Err(Refusal::NothingToAccept);
        };
        if around.added.as_ref() != Some(&proposal.base) {
            return Err(Refusal::Changed);
        }
        let Proposal { tied, kept, summary, .. } = proposal;
        self.progress = None;
        context.start(HandEyeWork::Keep { file: self.file.clone(), kept: kept.clone() });
        self.keep(*kept, summary);
        self.accepted = Some(tied.model);
        Ok(())
    }

    /// What was under way has ended; what was put away is put back.
    fn ended(&mut self, id: JobId, context: &mut Context<'_>) -> Option<Running> {
        let running = self.running.take_if(|running| running.job == id)?;
        for (toy, [x_m, y_m]) in &running.away {
            context.control(TwinCommand::PlaceToy { toy: toy.clone(), x_m: *x_m, y_m: *y_m }.into());
        }
        Some(running)
    }

    /// Why hand and eyes go together worse than they did: what was learned of them is not in this model any more.
    pub fn lost(&self, added: Option<&Arc<RigModel>>) -> Option<&'static str> {
        (self.kept.is_some() && self.in_use(added).is_none()).then_some(STALE)
    }

    fn step(&self, around: &HandEyeAround) -> StepState {
        if self.running.is_some() {
            return StepState::Running;
        }
        let is_of_others = is_of_other_eyes(around.added.as_ref(), around.grasp.model.rig());
        match (&self.kept, self.in_use(around.added.as_ref())) {
            (_, Some(_)) if is_of_others => StepState::Stale { why: OTHER_EYES.to_owned() },
            (_, Some(_)) => StepState::Done,
            (Some(_), None) => StepState::Stale { why: STALE.to_owned() },
            (None, None) => StepState::NotDone,
        }
    }
}

/// Whether something of the eyes in a model was found with others than this robot's: it is not in force then.
pub fn is_of_other_eyes(added: Option<&Arc<RigModel>>, rig: &Rig) -> bool {
    added.is_some_and(|model| !model.effects_of_other_eyes(rig).is_empty())
}

/// What is not in force.
const OTHER_EYES: &str = "The hands were looked at with another calibration or mount of the eyes than the one in use. Bring that back on the timeline, or look again.";
/// What the model in use lost.
const STALE: &str = "What the eyes learned of the hands is not in the model in use any more: it was taken back, or the arm was learned anew. Put it back, or look again.";

/// The twin's table is cleared, as a person clears the robot's: what stood there, and where, m.
fn clear(around: &HandEyeAround, context: &mut Context<'_>) -> Vec<(String, [f64; 2])> {
    let Some(twin) = &around.twin else { return vec![] };
    context.control(TwinCommand::HideBoard.into());
    let mut away = vec![];
    for toy in &*twin.toys {
        let Some(place) = &toy.place else { continue };
        context.control(TwinCommand::RemoveToy { toy: toy.name.clone() }.into());
        away.push((toy.name.clone(), [place.coords.x, place.coords.y]));
    }
    away
}

impl Workflow for HandEyeWorkflow {
    type Command = HandEyeCommand;
    type Work = HandEyeWork;
    type Control = RobotControl;
    type Around = HandEyeAround;
    type View = HandEyeView;

    fn new(folder: &Path) -> Self {
        Self {
            file: folder.join(FILE),
            sights: Sights::default(),
            running: None,
            progress: None,
            proposal: None,
            kept: None,
            asked: None,
            accepted: None,
        }
    }

    fn view(&mut self, around: &HandEyeAround, _moment: &Moment) -> Arc<HandEyeView> {
        self.ask(around.added.as_ref());
        let step = self.step(around);
        let stale = match &step {
            StepState::Stale { why } => Some(why.clone()),
            _ => None,
        };
        Arc::new(HandEyeView {
            step,
            gates: gates(around).into(),
            parts: self.progress.as_ref().map(Progress::parts).unwrap_or_default().into(),
            is_looking: self.running.is_some(),
            is_ending: self.running.as_ref().is_some_and(|running| running.ending),
            proposal: self.proposal.as_ref().map(|proposal| proposal.summary.clone()),
            in_use: self.in_use(around.added.as_ref()).cloned(),
            stale,
        })
    }

    fn restore(&mut self, _around: &HandEyeAround, context: &mut Context<'_>) {
        context.start(HandEyeWork::Restore { file: self.file.clone() });
    }

    fn apply(&mut self, command: HandEyeCommand, around: &HandEyeAround, context: &mut Context<'_>) {
        let done = match command {
            HandEyeCommand::Look => self.begin(around, context),
            HandEyeCommand::End => match &mut self.running {
                Some(running) => {
                    running.reins.end();
                    running.ending = true;
                    Ok(())
                }
                None => Err(Refusal::NothingUnderWay),
            },
            HandEyeCommand::Accept => self.accept(around, context),
            HandEyeCommand::Discard => {
                (self.proposal, self.progress) = (None, None);
                Ok(())
            }
        };
        if let Err(why) = done {
            context.refuse(why);
        }
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: HandEyeResult,
        _around: &HandEyeAround,
        context: &mut Context<'_>,
    ) {
        match result {
            HandEyeResult::Restored(kept) => {
                if let Some(kept) = kept {
                    let summary = Arc::new(kept.summary());
                    self.keep(*kept, summary);
                }
            }
            HandEyeResult::Looked(tied) => {
                if let Some(running) = self.ended(id, context) {
                    let kept = Box::new(Kept::of(&tied, running.at));
                    let summary = Arc::new(kept.summary());
                    self.proposal = Some(Proposal { tied, kept, summary, base: running.base });
                }
            }
            HandEyeResult::Kept => {}
        }
    }

    fn work_ended(
        &mut self,
        id: JobId,
        why: Option<&str>,
        _around: &HandEyeAround,
        context: &mut Context<'_>,
    ) {
        if self.ended(id, context).is_some() && why.is_none() {
            context.notices.add(NoticeLevel::Info, "The look was ended. The arm holds where it is.");
        }
    }
}

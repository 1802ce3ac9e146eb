//! One attempt after the other.

mod around;
mod refusal;
mod stages;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use plumbline_grasp::things::Thing;
use plumbline_grasp::{HandChoice, PLACES_M};

pub use around::{GraspNow, TrialsAround};
pub use refusal::Refusal;
use stages::{SETTLES, Stage, UnderWay};

use super::command::TrialsCommand;
use super::plan::{Experiment, FORMAT, Trial};
use super::view::{EarlierTrials, ShownTrials, TrialStage, TrialsPhase, TrialsView};
use super::work::{Context, TrialsResult, TrialsWork};
use crate::grasp::command::GraspCommand;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::robot::RobotControl;
use crate::twin::command::TwinCommand;

/// More attempts than this are a slip of the hand.
const MOST: usize = 2000;

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct TrialsWorkflow {
    experiments: PathBuf,
    earlier: Vec<EarlierTrials>,
    shown: Option<Arc<ShownTrials>>,
    /// Attempts that are still to be made.
    open: Vec<Trial>,
    under_way: Option<UnderWay>,
    paused: Option<String>,
    pausing: bool,
    opening: Option<JobId>,
    /// It goes on as soon as it is opened.
    goes_on: bool,
    /// What grasping is to do, handed over after each change.
    wishes: Vec<GraspCommand>,
    paces: Vec<Duration>,
}

impl TrialsWorkflow {
    /// What grasping is to do.
    pub fn take_wishes(&mut self) -> Vec<GraspCommand> {
        std::mem::take(&mut self.wishes)
    }

    /// The experiment that is shown, where attempts of it were made and none is under way.
    pub fn resting(&self) -> Option<Arc<ShownTrials>> {
        self.shown.clone().filter(|shown| shown.made > 0 && self.under_way.is_none())
    }

    /// Whether it makes its attempts: one is under way, or prepared.
    pub fn is_under_way(&self) -> bool {
        self.under_way.is_some()
    }

    fn obey(
        &mut self,
        command: TrialsCommand,
        around: &TrialsAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        match command {
            TrialsCommand::Begin { methods, attempts, positions_m, object, seed } => {
                self.stands()?;
                let object = Thing::of_class(&object).ok_or(Refusal::NoThing(object))?.class.to_owned();
                let positions_m = positions_m.unwrap_or_else(|| PLACES_M.to_vec());
                let twin = around.who();
                let (format, hand) = (FORMAT, HandChoice::Auto);
                let experiment = Experiment {
                    format,
                    twin,
                    methods,
                    attempts,
                    positions_m,
                    hand,
                    object,
                    seed,
                    lab: None,
                };
                self.begin(experiment, around, context)?;
            }
            TrialsCommand::Open { folder } => {
                self.stands()?;
                self.goes_on = false;
                self.opening = Some(context.start(TrialsWork::Open { folder, rig: around.rig.clone() }));
            }
            TrialsCommand::GoOn => {
                let shown = self.shown.as_ref().ok_or(Refusal::NoExperiment)?;
                let who = around.who();
                if shown.experiment.twin != who {
                    return Err(Refusal::OtherRobot(shown.experiment.twin.clone()));
                }
                if !around.robot.connection.is_connected() {
                    return Err(Refusal::NotConnected);
                }
                (self.pausing, self.paused) = (false, None);
                if self.under_way.is_none() {
                    self.next(around, context)?;
                }
            }
            TrialsCommand::Pause => match self.under_way.as_ref().map(|attempt| &attempt.stage) {
                Some(Stage::Asks) => self.under_way = None,
                Some(_) => self.pausing = true,
                None => {}
            },
            TrialsCommand::Placed => {
                let attempt = self.under_way.as_mut().filter(|attempt| attempt.stage == Stage::Asks);
                let attempt = attempt.ok_or(Refusal::NotAsked)?;
                attempt.stage = Stage::Laying(context.time.instant + SETTLES);
            }
            TrialsCommand::Close => {
                self.stands()?;
                (self.shown, self.open, self.paused) = (None, vec![], None);
                context.start(TrialsWork::List { experiments: self.experiments.clone() });
            }
            TrialsCommand::Export { file, format } => {
                let shown = self.shown.as_ref().ok_or(Refusal::NoExperiment)?;
                let (folder, rig) = (shown.folder.clone(), around.rig.clone());
                context.start(TrialsWork::Export { folder, file, format, rig });
            }
        }
        Ok(())
    }

    fn stands(&self) -> Result<(), Refusal> {
        match self.under_way.as_ref().map(|attempt| &attempt.stage) {
            None => Ok(()),
            Some(Stage::Keeping(_)) => Err(Refusal::NotOnDisk),
            Some(_) => Err(Refusal::UnderWay),
        }
    }

    fn begin(
        &mut self,
        experiment: Experiment,
        around: &TrialsAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        let count = experiment.trials().take(MOST + 1).count();
        if count == 0 || count > MOST {
            return Err(Refusal::Empty);
        }
        if !around.robot.connection.is_connected() {
            return Err(Refusal::NotConnected);
        }
        let at = context.time.day.strftime("%Y-%m-%dT%H-%M-%SZ");
        let folder = self.experiments.join(format!("{at}_{}", experiment.object.to_lowercase()));
        self.goes_on = true;
        let (experiment, rig) = (Box::new(experiment), around.rig.clone());
        self.opening = Some(context.start(TrialsWork::Begin { folder, experiment, rig }));
        Ok(())
    }

    /// Begins the attempt that is next.
    fn next(&mut self, around: &TrialsAround, context: &mut Context<'_>) -> Result<(), Refusal> {
        let shown = self.shown.as_ref().ok_or(Refusal::NoExperiment)?;
        let trial = *self.open.first().ok_or(Refusal::AllMade)?;
        let (placed_m, _) = shown.experiment.placed(&trial);
        let now = context.time.instant;
        // A person lays it where it belongs as well as a person can: that is its own scatter.
        let (placed_m, stage) = match around.is_twin {
            true => {
                let toy = shown.experiment.object.to_lowercase();
                let [x_m, y_m] = placed_m;
                context.control(TwinCommand::HideBoard.into());
                context.control(TwinCommand::PlaceToy { toy, x_m, y_m }.into());
                (placed_m, Stage::Laying(now + SETTLES))
            }
            false => (shown.experiment.positions_m[trial.position], Stage::Asks),
        };
        self.under_way = Some(UnderWay { trial, placed_m, stage, began: now });
        Ok(())
    }

    fn opened(
        &mut self,
        shown: Arc<ShownTrials>,
        open: Vec<Trial>,
        around: &TrialsAround,
        context: &mut Context<'_>,
    ) {
        (self.shown, self.open, self.paused) = (Some(shown), open, None);
        self.paces.clear();
        if std::mem::take(&mut self.goes_on)
            && let Err(why) = self.next(around, context)
        {
            context.refuse(why);
        }
    }
}

impl Workflow for TrialsWorkflow {
    type Command = TrialsCommand;
    type Work = TrialsWork;
    type Control = RobotControl;
    type Around = TrialsAround;
    type View = TrialsView;

    /// None shown. Experiments are kept in `folder/experiments`.
    fn new(folder: &Path) -> Self {
        Self {
            experiments: folder.join("experiments"),
            earlier: vec![],
            shown: None,
            open: vec![],
            under_way: None,
            paused: None,
            pausing: false,
            opening: None,
            goes_on: false,
            wishes: vec![],
            paces: vec![],
        }
    }

    fn restore(&mut self, _: &TrialsAround, context: &mut Context<'_>) {
        context.start(TrialsWork::List { experiments: self.experiments.clone() });
    }

    fn view(&mut self, around: &TrialsAround, _: &Moment) -> Arc<TrialsView> {
        let mut phase = self.phase();
        if let (TrialsPhase::Running { trial, doing: TrialStage::Judging, .. }, false) =
            (&phase, around.is_twin)
        {
            phase = TrialsPhase::WaitsForWord { trial: *trial };
        }
        Arc::new(TrialsView {
            shown: self.shown.clone(),
            phase,
            earlier: self.earlier.as_slice().into(),
            remaining: self.remaining(),
        })
    }

    fn apply(&mut self, command: TrialsCommand, around: &TrialsAround, context: &mut Context<'_>) {
        if let Err(why) = self.obey(command, around, context) {
            context.refuse(why);
        }
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: TrialsResult,
        around: &TrialsAround,
        context: &mut Context<'_>,
    ) {
        match result {
            TrialsResult::Listed(earlier, problems) => {
                self.earlier = earlier;
                for problem in problems {
                    context.notices.add(NoticeLevel::Warning, crate::ground::text::sentence(&problem));
                }
            }
            TrialsResult::Opened(shown, open) if self.opening.take_if(|opening| *opening == id).is_some() => {
                self.opened(shown, open, around, context);
            }
            TrialsResult::Kept(shown, open) => {
                (self.shown, self.open) = (Some(shown), open);
                self.kept(around, context);
            }
            // One that nobody waits for any more; a file that was asked for.
            TrialsResult::Opened(..) | TrialsResult::Written(_) => {}
        }
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &TrialsAround, _: &mut Context<'_>) {
        self.opening.take_if(|opening| *opening == id);
        let keeping = self.under_way.as_ref().is_some_and(|attempt| attempt.stage == Stage::Keeping(id));
        if keeping {
            let why = why.unwrap_or("It was cancelled.");
            self.hold(&format!("The attempt is not on disk, and is made again when you go on. {why}"));
        }
    }
}

//! One attempt after the other.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_grasp::things::Thing;
use plumbline_grasp::{Failure, HandChoice, Outcome, PLACES_M};
use plumbline_model::robot::Rig;
use plumbline_model::{Point, Robot};

use super::command::TrialsCommand;
use super::plan::{Experiment, FORMAT, Trial};
use super::view::{EarlierTrials, ShownTrials, TrialStage, TrialsPhase, TrialsView};
use super::work::{Context, TrialsResult, TrialsWork};
use crate::grasp::command::{GraspCommand, GraspTarget, HandStep};
use crate::grasp::view::AttemptView;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};
use crate::robot::RobotControl;
use crate::robot::view::RobotView;
use crate::twin::command::TwinCommand;
use crate::twin::view::TwinView;

/// A thing that was laid down comes to rest within this.
const SETTLES: Duration = Duration::from_millis(1500);
/// The eyes have seen it lie there within this, or they are blind, which grasping says.
const SEEN_WITHIN: Duration = Duration::from_secs(10);
/// It lies where it was laid when it is this near, m: what is round rolls a little.
const LAID_M: f64 = 0.05;
/// A thing that is this much higher than before is lifted, m.
const LIFTED_M: f64 = 0.04;
/// The pace is that of so many attempts.
const PACE_OF: usize = 10;

/// Why a command is not done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// There is none.
    #[error("No experiment is shown. Begin one, or open an earlier one.")]
    NoExperiment,
    /// One at a time.
    #[error("An attempt of the experiment is under way. Pause it first.")]
    UnderWay,
    /// It is being written.
    #[error("The last attempt is not on disk yet. Wait a moment.")]
    NotOnDisk,
    /// Nothing moves.
    #[error("No robot is connected. Connect it, or start the twin.")]
    NotConnected,
    /// Nothing is asked.
    #[error("The experiment does not wait for a thing to be laid down.")]
    NotAsked,
    /// Everything is made.
    #[error("All attempts of this experiment are made.")]
    AllMade,
    /// Nothing to do.
    #[error("An experiment needs a method, a position and an attempt, at most 2000 in all.")]
    Empty,
    /// The library of things has no such.
    #[error("Nothing is known of a thing called {0}. Choose one that can be held.")]
    NoThing(String),
    /// It is of another robot.
    #[error("This experiment was made with {0}. Connect that, or begin another.")]
    OtherRobot(String),
}

/// More attempts than this are a slip of the hand.
const MOST: usize = 2000;

/// What grasping does just now.
#[derive(Clone, Debug, Default)]
pub struct GraspNow {
    /// Nothing is under way.
    pub is_idle: bool,
    /// The newest attempt.
    pub newest: Option<AttemptView>,
}

/// What the workflow can see of the rest.
pub struct TrialsAround {
    /// The robot as it is known.
    pub rig: Arc<Rig>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// The twin, as far as the operator sees it.
    pub twin: Arc<TwinView>,
    /// Whether this is the world of the twin.
    pub is_twin: bool,
    /// Grasping.
    pub grasp: GraspNow,
    /// When the newest pair was captured.
    pub newest_pair: Option<Instant>,
}

impl TrialsAround {
    /// What an experiment is made with, for its file.
    fn who(&self) -> String {
        if self.is_twin { self.twin.scenario.clone() } else { format!("robot {}", self.rig.name) }
    }

    /// How high a thing stands on the twin's table, as the scene shows it, m.
    fn height_m(&self, object: &str) -> Option<f64> {
        Some(self.place(object)?.coords.z)
    }

    /// Where a thing is on the twin's table, as the scene shows it.
    fn place(&self, object: &str) -> Option<Point<Robot>> {
        self.twin.toys.iter().find(|toy| toy.name.eq_ignore_ascii_case(object))?.place
    }

    /// Whether a thing that has come to rest by `rests` lies where it was laid and was seen there since.
    fn is_seen_at(&self, object: &str, [x_m, y_m]: [f64; 2], rests: Instant) -> bool {
        let lies = |at: Point<Robot>| (at.coords.x - x_m).hypot(at.coords.y - y_m) < LAID_M;
        let lies = !self.is_twin || self.place(object).is_some_and(lies);
        lies && self.newest_pair.is_some_and(|captured| captured > rests)
    }
}

/// Where the attempt under way is.
#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// A person lays the thing down.
    Asks,
    /// It was laid down, and comes to rest until then.
    Laying(Instant),
    /// Grasping was told to begin; the name of the attempt before, and how high the thing stood.
    Grasping { before: Option<String>, height_m: Option<f64> },
    /// It has ended; how high the thing stood before, and since when it is looked at.
    Judging { height_m: Option<f64>, since: Instant },
    /// The attempt is being written.
    Keeping(JobId),
    /// What the hand still has to do.
    Clearing(Vec<HandStep>),
}

/// The attempt under way.
#[derive(Clone, Debug, PartialEq)]
struct UnderWay {
    trial: Trial,
    placed_m: [f64; 2],
    stage: Stage,
    began: Instant,
}

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
                let experiment =
                    Experiment { format, twin, methods, attempts, positions_m, hand, object, seed };
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

    /// The robot has something new, or time has passed.
    pub fn step(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        let (Some(attempt), Some(shown)) = (&mut self.under_way, self.shown.clone()) else { return };
        let object = &shown.experiment.object;
        let now = context.time.instant;
        match attempt.stage.clone() {
            // The robot and its eyes may be busy: what is not seen yet is waited for.
            Stage::Laying(until)
                if now >= until + SEEN_WITHIN
                    || now >= until && around.is_seen_at(object, attempt.placed_m, until) =>
            {
                let target = GraspTarget { class: Some(object.clone()), near_m: Some(attempt.placed_m) };
                self.wishes = vec![
                    GraspCommand::Method(attempt.trial.method),
                    GraspCommand::Arm(shown.experiment.hand),
                    GraspCommand::Target(target),
                    GraspCommand::Grasp,
                ];
                let before = around.grasp.newest.as_ref().map(|newest| newest.name.clone());
                attempt.stage = Stage::Grasping { before, height_m: around.height_m(object) };
            }
            // What was wished for is handed over at the end of this call.
            Stage::Grasping { before, height_m } if around.grasp.is_idle && self.wishes.is_empty() => {
                match &around.grasp.newest {
                    Some(newest) if Some(&newest.name) != before.as_ref() => {
                        attempt.stage = Stage::Judging { height_m, since: now };
                    }
                    _ => {
                        self.hold("The attempt could not begin; the messages say why. Mend that, then go on.")
                    }
                }
            }
            Stage::Judging { height_m, since } => self.judge(height_m, since, around, &shown, context),
            Stage::Clearing(steps) if around.grasp.is_idle && self.wishes.is_empty() => {
                match steps.split_first() {
                    Some((first, rest)) => {
                        self.wishes = vec![GraspCommand::Hand(*first)];
                        attempt.stage = Stage::Clearing(rest.to_vec());
                    }
                    None => self.cleared(around, context),
                }
            }
            _ => {}
        }
    }

    /// Whether it was lifted: the twin's scene shows it; on the robot a person says it.
    fn judge(
        &mut self,
        height_m: Option<f64>,
        since: Instant,
        around: &TrialsAround,
        shown: &ShownTrials,
        context: &mut Context<'_>,
    ) {
        let (Some(attempt), Some(newest)) = (&mut self.under_way, &around.grasp.newest) else { return };
        if let Some(Outcome::Failed { failure: Failure::Halted, why }) = &newest.outcome {
            let why = format!(
                "It was broken off ({}), and is made again when you go on.",
                why.trim_end_matches('.')
            );
            return self.hold(&why);
        }
        let lifted = match around.is_twin {
            // The hand comes to rest first, or what slips would count.
            true if context.time.instant < since + SETTLES => return,
            true => {
                let now_m = around.height_m(&shown.experiment.object);
                now_m.zip(height_m).is_some_and(|(now_m, before_m)| now_m - before_m > LIFTED_M)
            }
            false => match (newest.told, &newest.outcome) {
                (Some(told), _) => told,
                // Nothing moved at last, so there is nothing to be seen.
                (None, Some(Outcome::Refused { .. })) => false,
                (None, _) => return,
            },
        };
        let job = context.start(TrialsWork::Keep {
            folder: shown.folder.clone(),
            experiment: Box::new(shown.experiment.clone()),
            trial: attempt.trial,
            placed_m: attempt.placed_m,
            grasp: newest.folder.clone(),
            lifted,
            rig: around.rig.clone(),
        });
        attempt.stage = Stage::Keeping(job);
    }

    /// An attempt is on disk: the hand is emptied, and the arm goes home.
    fn kept(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        let object = self.shown.as_ref().map(|shown| shown.experiment.object.to_lowercase());
        let (Some(attempt), Some(toy)) = (&mut self.under_way, object) else { return };
        self.paces.push(context.time.instant.saturating_duration_since(attempt.began));
        let first = match around.is_twin {
            true => {
                context.control(TwinCommand::RemoveToy { toy }.into());
                HandStep::Open
            }
            false => HandStep::Place,
        };
        attempt.stage = Stage::Clearing(vec![first, HandStep::Home]);
    }

    fn cleared(&mut self, around: &TrialsAround, context: &mut Context<'_>) {
        self.under_way = None;
        if std::mem::take(&mut self.pausing) {
            return;
        }
        if self.open.is_empty() {
            context.notices.add(NoticeLevel::Success, "All attempts of the experiment are made.");
        } else if let Err(why) = self.next(around, context) {
            context.refuse(why);
        }
    }

    fn hold(&mut self, why: &str) {
        (self.under_way, self.pausing) = (None, false);
        self.paused = Some(why.to_owned());
    }

    fn phase(&self) -> TrialsPhase {
        let Some(attempt) = &self.under_way else {
            return match &self.paused {
                Some(why) => TrialsPhase::Paused { why: why.clone() },
                None => TrialsPhase::Idle,
            };
        };
        let trial = attempt.trial;
        let running = |doing| TrialsPhase::Running { trial, doing, pausing: self.pausing };
        match &attempt.stage {
            Stage::Asks => TrialsPhase::Asks { trial, at_m: attempt.placed_m },
            Stage::Laying(_) => running(TrialStage::Laying),
            Stage::Grasping { .. } => running(TrialStage::Grasping),
            Stage::Judging { .. } => running(TrialStage::Judging),
            Stage::Keeping(_) | Stage::Clearing(_) => running(TrialStage::Clearing),
        }
    }

    /// At the pace of the last attempts.
    fn remaining(&self) -> Option<Duration> {
        let last = &self.paces[self.paces.len().saturating_sub(PACE_OF)..];
        let left = u32::try_from(self.open.len()).ok()?;
        let count = u32::try_from(last.len()).ok().filter(|count| *count > 0)?;
        Some(last.iter().sum::<Duration>() / count * left)
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

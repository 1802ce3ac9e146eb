//! The 9 by 4 evaluation: the run under way, the figures, and the sessions that there are.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_drift::GridCorrection;
use plumbline_effects::RobotModel;
use plumbline_grasp::things::Thing;

use super::DriftAround;
use super::command::{GridCommand, GridSide};
use super::figures::Figures;
use super::grid::GridRun;
use super::view::GridView;
use super::work::{Context, DriftResult, DriftWork};
use crate::ground::World;
use crate::ground::jobs::JobId;
use crate::ground::sessions::title_of;

/// What an evaluation gave that has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacesResult {
    /// Its session.
    pub session: PathBuf,
    /// Class of the thing.
    pub object: &'static str,
    /// Places at which it was seen.
    pub measured: usize,
    /// Of so many.
    pub of: usize,
    /// Mean error as the robot is described, m.
    pub described_m: f64,
    /// The same by the model in use, m.
    pub model_m: f64,
}

/// Everything of it.
#[derive(Clone, Debug, Default)]
pub(super) struct GridRoom {
    run: Option<GridRun>,
    figures: Figures,
    /// Folders and their names, newest first.
    sessions: Vec<(PathBuf, String)>,
    /// The model that the figures were judged with.
    model: Option<Arc<RobotModel>>,
}

impl GridRoom {
    /// Looks which evaluations there are.
    pub fn list(&self, data_dir: &Path, context: &mut Context<'_>) {
        let sessions = World::ALL.map(|world| sessions_of(world, data_dir)).to_vec();
        context.start(DriftWork::ListGrids { sessions });
    }

    /// What the run gave, once it has ended, is on disk and is judged.
    pub fn result(&self, world: World) -> Option<PlacesResult> {
        let run = self.run.as_ref().filter(|run| run.is_on_disk() && run.world == Some(world))?;
        let session = run.folder.clone()?;
        let [described_m, model_m] = self.figures.both_m(&session)?;
        let (object, [measured, of]) = (run.object(), run.seen());
        Some(PlacesResult { session, object, measured, of, described_m, model_m })
    }

    /// A pair has come.
    pub fn saw(&mut self, data_dir: &Path, around: &DriftAround, context: &mut Context<'_>) {
        if self.model.as_ref().is_some_and(|model| !Arc::ptr_eq(model, &around.model)) {
            let by_model = |figure: &super::view::GridFigure| figure.correction == GridCorrection::Model;
            self.figures.again(by_model, &around.model, context);
            self.model = Some(around.model.clone());
        }
        let (Some(run), Some(world)) = (&mut self.run, around.world) else { return };
        run.saw(around, context);
        run.keep(sessions_of(world, data_dir), around, context);
    }

    pub fn apply(
        &mut self,
        command: GridCommand,
        data_dir: &Path,
        around: &DriftAround,
        context: &mut Context<'_>,
    ) {
        match command {
            GridCommand::Begin { object } => {
                if let Some(why) = self.unable(around) {
                    return context.refuse(format!("The evaluation cannot begin: {why}."));
                }
                match Thing::of_class(&object) {
                    Some(thing) => self.run = Some(GridRun::begin(thing, around, context)),
                    None => context.refuse(format!(
                        "Nobody knows how high a {object} is: choose one of the things of the list."
                    )),
                }
            }
            GridCommand::Placed => {
                let now = context.time.instant;
                if !self.run.as_mut().is_some_and(|run| run.placed(now)) {
                    context.refuse("Nothing is to be laid just now.");
                }
            }
            GridCommand::LeaveOut => match self.run.as_mut().filter(|run| run.is_under_way()) {
                Some(run) => run.leave_out(around, context),
                None => context.refuse("No evaluation is under way."),
            },
            GridCommand::End => match self.run.as_mut().filter(|run| run.is_under_way()) {
                Some(run) => run.end(around, context),
                None => context.refuse("No evaluation is under way."),
            },
            GridCommand::Show { side, session, correction } => {
                if !self.sessions.iter().any(|(known, _)| *known == session) {
                    self.sessions.push(named(session.clone()));
                }
                self.show(side, &session, correction, around, context);
            }
        }
        if let (Some(run), Some(world)) = (&mut self.run, around.world) {
            run.keep(sessions_of(world, data_dir), around, context);
        }
    }

    fn show(
        &mut self,
        side: GridSide,
        session: &Path,
        correction: GridCorrection,
        around: &DriftAround,
        context: &mut Context<'_>,
    ) {
        self.model = Some(around.model.clone());
        self.figures.show(side, session, correction, &around.model, context);
    }

    pub fn work_done(
        &mut self,
        id: JobId,
        result: DriftResult,
        data_dir: &Path,
        around: &DriftAround,
        context: &mut Context<'_>,
    ) {
        match result {
            DriftResult::GridKept(folder) => self.kept(id, &folder, data_dir, around, context),
            DriftResult::Grids(found) => {
                let opened: Vec<PathBuf> =
                    self.figures.sessions().filter(|shown| !found.contains(shown)).cloned().collect();
                self.sessions = found.into_iter().chain(opened).map(named).collect();
            }
            DriftResult::GridJudged(judged) => self.figures.judged(id, &judged),
            DriftResult::Logged(_) | DriftResult::Retold(_) => {}
        }
    }

    /// What was measured so far is on disk: it is shown as the description and as the model in use have it.
    fn kept(
        &mut self,
        id: JobId,
        folder: &Path,
        data_dir: &Path,
        around: &DriftAround,
        context: &mut Context<'_>,
    ) {
        let Some(run) = self.run.as_mut() else { return };
        let is_first = run.folder.is_none();
        if !run.kept(id, folder.to_owned()) {
            return;
        }
        if let Some(world) = around.world {
            run.keep(sessions_of(world, data_dir), around, context);
        }
        if is_first {
            self.sessions.insert(0, named(folder.to_owned()));
            let corrections = [GridCorrection::Described, GridCorrection::Model];
            for (side, correction) in GridSide::BOTH.into_iter().zip(corrections) {
                self.show(side, folder, correction, around, context);
            }
        } else {
            self.figures.again(|figure| figure.session == folder, &around.model, context);
        }
    }

    /// Work has ended without a result.
    pub fn work_ended(&mut self, id: JobId, why: Option<&str>, context: &Context<'_>) {
        if let Some(run) = &mut self.run {
            run.not_kept(id, why, context.time.instant);
        }
        self.figures.not_judged(id, why);
    }

    fn unable(&self, around: &DriftAround) -> Option<&'static str> {
        if self.run.as_ref().is_some_and(GridRun::is_under_way) {
            return Some("one is under way");
        }
        if self.run.as_ref().is_some_and(GridRun::is_unkept) {
            return Some(
                "what the last one measured is not on disk yet; make room there, it is tried again by itself",
            );
        }
        if !around.is_live {
            return Some("no eyes are live");
        }
        if !around.own_eyes || around.world.is_none() || !around.robot.connection.is_connected() {
            return Some("the robot whose eyes are shown is not connected");
        }
        None
    }

    pub fn view(&self, around: &DriftAround) -> GridView {
        GridView {
            unable: self.unable(around),
            run: self.run.as_ref().map(|run| run.view(around)),
            figures: self.figures.view(),
            sessions: self.sessions.as_slice().into(),
        }
    }
}

fn named(folder: PathBuf) -> (PathBuf, String) {
    let name = title_of(&folder);
    (folder, name)
}

fn sessions_of(world: World, data_dir: &Path) -> PathBuf {
    world.folder(data_dir).join("sessions")
}

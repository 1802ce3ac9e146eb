//! Which detectors are judged on what, and what came out.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_vision::detect::shipped_detector;

use super::command::{ConfusionCell, ScoresCommand, SetPart};
use super::evaluation::Evaluation;
use super::view::{OpenedCell, ScoredModelFile};
use super::work::{Context, ScoresResult, ScoresWork};
use crate::detect::command::Provider;
use crate::ground::jobs::JobId;
use crate::ground::{Moment, Nothing, Workflow};
use crate::scores::view::ScoresView;

/// The whole workflow.
#[derive(Clone, Debug, Default)]
pub struct ScoresWorkflow {
    pub(super) models: Vec<ScoredModelFile>,
    pub(super) set: Option<PathBuf>,
    pub(super) part: SetPart,
    pub(super) evaluating: Option<JobId>,
    pub(super) failed: Option<String>,
    pub(super) evaluation: Option<Arc<Evaluation>>,
    /// When it was judged.
    judged_at: Timestamp,
    opening: Option<JobId>,
    pub(super) cell: Option<Arc<OpenedCell>>,
    pub(super) picture: Option<usize>,
}

impl ScoresWorkflow {
    /// What was judged last, and when.
    pub fn judged(&self) -> Option<(Timestamp, Arc<Evaluation>)> {
        Some((self.judged_at, self.evaluation.clone()?))
    }

    fn add(&mut self, file: PathBuf) {
        match self.models.iter_mut().find(|model| model.file == file) {
            Some(model) => model.chosen = true,
            None => self.models.push(ScoredModelFile { file, chosen: true, shipped: false }),
        }
    }

    fn evaluate(&mut self, provider: Provider, context: &mut Context<'_>) {
        if self.evaluating.is_some() {
            return context.refuse("Detectors are being judged already. Wait for it, or cancel that first.");
        }
        let Some(set) = self.set.clone() else { return context.refuse("Choose a labeled data set first.") };
        let chosen = self.models.iter().filter(|model| model.chosen);
        let models: Vec<PathBuf> = chosen.map(|model| model.file.clone()).collect();
        if models.is_empty() {
            return context.refuse("Choose at least one detector first.");
        }
        self.failed = None;
        let part = self.part;
        self.evaluating = Some(context.start(ScoresWork::Evaluate { models, set, part, provider }));
    }

    fn open_cell(&mut self, model: usize, cell: ConfusionCell, context: &mut Context<'_>) {
        let Some(evaluation) = self.evaluation.clone() else { return };
        self.picture = None;
        self.opening = Some(context.start(ScoresWork::OpenCell { evaluation, model, cell }));
    }
}

impl Workflow for ScoresWorkflow {
    type Command = ScoresCommand;
    type Work = ScoresWork;
    type Control = Nothing;
    type Around = Provider;
    type View = ScoresView;

    /// The detector that comes with the program is chosen, where it is there.
    fn new(_: &Path) -> Self {
        let shipped = shipped_detector().map(|shipped| ScoredModelFile {
            file: shipped.file,
            chosen: true,
            shipped: true,
        });
        Self { models: shipped.into_iter().collect(), ..Self::default() }
    }

    fn view(&mut self, _: &Provider, _: &Moment) -> Arc<ScoresView> {
        Arc::new(self.shown())
    }

    fn apply(&mut self, command: ScoresCommand, provider: &Provider, context: &mut Context<'_>) {
        match command {
            ScoresCommand::AddModels { files } => files.into_iter().for_each(|file| self.add(file)),
            ScoresCommand::RemoveModel { file } => self.models.retain(|model| model.file != file),
            ScoresCommand::ChooseModel { file, chosen } => {
                for model in self.models.iter_mut().filter(|model| model.file == file) {
                    model.chosen = chosen;
                }
            }
            ScoresCommand::ChooseSet { path } => (self.set, self.failed) = (Some(path), None),
            ScoresCommand::ChoosePart(part) => (self.part, self.failed) = (part, None),
            ScoresCommand::Evaluate => self.evaluate(*provider, context),
            ScoresCommand::OpenCell { model, cell } => self.open_cell(model, cell, context),
            ScoresCommand::CloseCell => (self.cell, self.picture) = (None, None),
            ScoresCommand::ShowPicture(picture) => {
                let known = self.cell.as_ref().map_or(0, |cell| cell.pictures.len());
                self.picture = picture.filter(|picture| *picture < known);
            }
            ScoresCommand::ExportCsv { file } => match &self.evaluation {
                Some(evaluation) => {
                    context.start(ScoresWork::ExportCsv { evaluation: evaluation.clone(), file });
                }
                None => context.refuse("Judge a detector first, then write the table."),
            },
        }
    }

    fn work_done(&mut self, id: JobId, result: ScoresResult, _: &Provider, context: &mut Context<'_>) {
        self.evaluating.take_if(|evaluating| *evaluating == id);
        match result {
            ScoresResult::Evaluated(evaluation) => {
                (self.evaluation, self.judged_at) = (Some(evaluation), context.time.day);
                (self.cell, self.picture) = (None, None);
            }
            // Of several that were clicked quickly the last one is shown.
            ScoresResult::Opened(cell) if self.opening == Some(id) => {
                self.opening = None;
                self.cell = Some(cell);
            }
            ScoresResult::Opened(_) | ScoresResult::Written(_) => {}
        }
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &Provider, _: &mut Context<'_>) {
        self.opening.take_if(|opening| *opening == id);
        if self.evaluating.take_if(|evaluating| *evaluating == id).is_some() {
            self.failed = why.map(str::to_owned);
        }
    }
}

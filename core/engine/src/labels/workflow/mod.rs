//! Which data set is open, which image is shown, what was changed.

mod arrived;
mod asked;
mod edited;
mod set;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::{ClassNames, StereoFrame};

use super::command::{BoxEdit, LabelsCommand};
use super::history::EditError;
use super::images::Loaded;
use super::seen::Seen;
use super::transfer::ImportPlan;
use super::work::{Context, LabelsResult, LabelsWork};
use crate::detect::command::{DetectorChoice, Provider};
use crate::detect::{LoadedDetector, OpenDetector};
use crate::ground::jobs::JobId;
use crate::ground::{Moment, Nothing, Workflow};
use crate::labels::view::LabelsView;
use set::Saving;
pub use set::Set;

/// What the workflow can see of the rest.
#[derive(Clone, Debug)]
pub struct LabelsAround {
    /// How detectors are opened.
    pub open: OpenDetector,
    /// The present detector.
    pub detector: DetectorChoice,
    /// Where it is computed.
    pub provider: Provider,
    /// Least confidence of what is proposed, 0–1.
    pub confidence: f32,
    /// Newest pair.
    pub newest: Option<StereoFrame>,
    /// Of which source, counted.
    pub opened: u64,
}

/// The whole workflow.
#[derive(Clone, Debug, Default)]
pub struct LabelsWorkflow {
    /// Says which data set was open last.
    memory: PathBuf,
    pub(super) recent: Option<PathBuf>,
    pub(super) set: Option<Set>,
    /// A data set is being opened, made, imported or exported.
    pub(super) working: Option<JobId>,
    pub(super) failed: Option<String>,
    pub(super) loaded: Loaded,
    pub(super) thumbnails: Arc<BTreeMap<String, Arc<RgbImage>>>,
    reading_thumbnails: Option<JobId>,
    saving: Option<Saving>,
    pub(super) unsaved: Option<String>,
    pub(super) proposing: Option<(JobId, String)>,
    proposer: Option<(DetectorChoice, Arc<LoadedDetector>)>,
    pub(super) import: Option<Arc<ImportPlan>>,
    captured_seq: Option<(u64, u64)>,
    capturing: Option<JobId>,
    pub(super) seen: Seen,
}

impl LabelsWorkflow {
    /// Starts something that replaces or reads a whole data set.
    fn begin(&mut self, work: LabelsWork, context: &mut Context<'_>) {
        if self.working.is_some() {
            return context.refuse("A data set is being read or written. Wait for it, or cancel that first.");
        }
        if self.is_on_disk(context) {
            self.failed = None;
            self.working = Some(context.start(work));
        }
    }

    /// Refuses to leave a data set while something of it is in memory only.
    fn is_on_disk(&self, context: &mut Context<'_>) -> bool {
        let dirty = self.set.as_ref().is_some_and(|set| !set.dirty.is_empty() || set.to_check_dirty);
        if dirty || self.saving.is_some() {
            let why = self.unsaved.clone().unwrap_or_else(|| "Boxes are being saved.".to_owned());
            context.refuse(format!("{why} The data set stays open until everything is on disk."));
            return false;
        }
        true
    }

    fn forget_set(&mut self) {
        self.loaded = Loaded::default();
        self.thumbnails = Arc::default();
        (self.unsaved, self.import, self.failed) = (None, None, None);
    }
}

impl Workflow for LabelsWorkflow {
    type Command = LabelsCommand;
    type Work = LabelsWork;
    type Control = Nothing;
    type Around = LabelsAround;
    type View = LabelsView;

    /// Nothing open. What was open last is remembered in `folder`.
    fn new(folder: &Path) -> Self {
        Self { memory: folder.join("label-set.txt"), ..Self::default() }
    }

    fn view(&mut self, around: &LabelsAround, _: &Moment) -> Arc<LabelsView> {
        Arc::new(self.shown(&around.detector))
    }

    fn restore(&mut self, _: &LabelsAround, context: &mut Context<'_>) {
        context.start(LabelsWork::Restore { memory: self.memory.clone() });
    }

    fn apply(&mut self, command: LabelsCommand, around: &LabelsAround, context: &mut Context<'_>) {
        match command {
            LabelsCommand::Open { path } => {
                let memory = self.memory.clone();
                self.begin(LabelsWork::Open { path, memory }, context);
            }
            LabelsCommand::Create { folder, names } => {
                let (names, memory) = (ClassNames::new(names), self.memory.clone());
                self.begin(LabelsWork::Create { folder, names, memory }, context);
            }
            LabelsCommand::Close => {
                if self.is_on_disk(context) {
                    self.recent = self.set.take().map(|set| set.folder).or(self.recent.take());
                    self.forget_set();
                }
            }
            LabelsCommand::Capture => self.capture(around, context),
            LabelsCommand::Choose { image } => self.choose(&image, context),
            LabelsCommand::Step(by) => self.step(by, context),
            LabelsCommand::Edit { image, edit } => self.edit(&image, edit, context),
            LabelsCommand::Undo => self.change(context, |image, _| Ok(image.history.undo())),
            LabelsCommand::Redo => self.change(context, |image, _| Ok(image.history.redo())),
            LabelsCommand::CopyPrevious => {
                let before = self.boxes_before();
                self.change(context, |image, bounds| Ok(image.history.add_all(before, bounds)));
            }
            LabelsCommand::Propose => self.propose(around, context),
            LabelsCommand::AcceptProposals => {
                self.change(context, |image, bounds| {
                    let accepted = std::mem::take(&mut image.proposals);
                    Ok(image.history.add_all(accepted.into_iter().map(|proposed| proposed.label), bounds))
                });
            }
            LabelsCommand::AcceptProposal { index, class, area } => {
                self.change(context, |image, bounds| {
                    let proposed = image.proposals.get(index).ok_or(EditError::NoSuchProposal)?.label;
                    let (class, area) = (class.unwrap_or(proposed.class), area.unwrap_or(proposed.area));
                    let added = image.history.apply(BoxEdit::Add { class, area }, bounds);
                    if added.is_ok() {
                        image.proposals.remove(index);
                    }
                    added
                });
            }
            LabelsCommand::DiscardProposal { index } => {
                if let Some(image) = self.set.as_mut().and_then(Set::shown_mut)
                    && index < image.proposals.len()
                {
                    image.proposals.remove(index);
                }
            }
            LabelsCommand::DiscardProposals => {
                if let Some(image) = self.set.as_mut().and_then(Set::shown_mut) {
                    image.proposals = Vec::new();
                }
            }
            LabelsCommand::NothingHere => {
                self.change(context, |image, _| {
                    image.proposals = Vec::new();
                    Ok(image.history.replace(Vec::new()))
                });
            }
            LabelsCommand::ToCheck(to_check) => self.mark(to_check, context),
            LabelsCommand::SaveAgain => self.save(context),
            LabelsCommand::Export { folder, train_percent, seed } => {
                self.export(folder, train_percent, seed, context);
            }
            LabelsCommand::Import { path } => self.plan_import(path, context),
            LabelsCommand::AcceptImport => self.accept_import(context),
            LabelsCommand::DiscardImport => self.import = None,
        }
        self.look();
    }

    fn work_done(&mut self, id: JobId, result: LabelsResult, _: &LabelsAround, context: &mut Context<'_>) {
        self.working.take_if(|working| *working == id);
        match result {
            // Opening one writes what is looked for here: which of the two came first must not show.
            LabelsResult::Restored(recent) if self.set.is_none() => self.recent = recent,
            LabelsResult::Restored(_) => {}
            LabelsResult::Opened(set) => self.opened(*set, context),
            LabelsResult::Loaded(name, pixels) => {
                self.loaded.read(id, name, pixels);
                self.load(context);
            }
            LabelsResult::Thumbnails(pictures) => {
                self.reading_thumbnails.take_if(|reading| *reading == id);
                self.take_thumbnails(pictures);
                self.read_thumbnails(context);
            }
            LabelsResult::Saved => self.saved(id, context),
            LabelsResult::Captured(entries) => {
                self.capturing.take_if(|capturing| *capturing == id);
                self.captured(entries, context);
            }
            LabelsResult::Proposed { name, boxes, choice, detector, unknown } => {
                self.proposing.take_if(|(proposing, _)| *proposing == id);
                self.proposer = Some((choice, detector));
                self.proposed(&name, boxes, &unknown, context);
            }
            LabelsResult::Exported(_) => {}
            LabelsResult::Planned(plan) => self.import = Some(plan),
        }
        self.look();
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &LabelsAround, context: &mut Context<'_>) {
        if self.working.take_if(|working| *working == id).is_some() {
            self.failed = why.filter(|_| self.set.is_none()).map(str::to_owned);
        }
        self.loaded.gave_nothing(id);
        self.proposing.take_if(|(proposing, _)| *proposing == id);
        self.reading_thumbnails.take_if(|reading| *reading == id);
        if self.capturing.take_if(|capturing| *capturing == id).is_some() {
            self.captured_seq = None;
        }
        if let Some(saving) = self.saving.take_if(|saving| saving.job == id) {
            if let Some(set) = &mut self.set {
                set.dirty.extend(saving.images);
                set.to_check_dirty |= saving.to_check;
                let count = set.dirty.len();
                let why = why.unwrap_or("It was stopped.");
                self.unsaved = Some(format!(
                    "Boxes of {count} image{} are not on disk: {why} They are kept here.",
                    if count == 1 { "" } else { "s" }
                ));
            }
        } else {
            self.save(context);
        }
        self.look();
    }
}

//! Which data set is open, which image is shown, what was changed.

mod arrived;
mod asked;
mod set;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::{ClassNames, StereoFrame};

use super::command::{BoxEdit, LabelsCommand};
use super::history::Bounds;
use super::images::{Image, Loaded};
use super::seen::Seen;
use super::transfer::ImportPlan;
use super::view::LabelBox;
use super::work::{Context, LabelsResult, LabelsWork};
use crate::detect::command::{DetectorChoice, Provider};
use crate::detect::{LoadedDetector, OpenDetector};
use crate::ground::jobs::JobId;
use crate::ground::{Moment, Nothing, Workflow};
use crate::labels::view::LabelsView;
use set::Saving;
pub use set::Set;

const NO_PROPOSAL: &str = "There is no such proposal any more.";

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
#[derive(Clone, Debug)]
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
    /// Nothing open. What was open last is remembered in `folder`.
    pub fn new(folder: &Path) -> Self {
        Self {
            memory: folder.join("label-set.txt"),
            recent: None,
            set: None,
            working: None,
            failed: None,
            loaded: Loaded::default(),
            thumbnails: Arc::default(),
            reading_thumbnails: None,
            saving: None,
            unsaved: None,
            proposing: None,
            proposer: None,
            import: None,
            captured_seq: None,
            capturing: None,
            seen: Seen::default(),
        }
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: LabelsCommand, around: &LabelsAround, context: &mut Context<'_>) {
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
                    let proposed = image.proposals.get(index).ok_or(NO_PROPOSAL)?.label;
                    let (class, area) = (class.unwrap_or(proposed.class), area.unwrap_or(proposed.area));
                    let added = image.history.apply(BoxEdit::Add { class, area }, bounds);
                    if added.is_ok() {
                        image.proposals.remove(index);
                    }
                    added.map_err(|e| e.to_string())
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

    fn choose(&mut self, name: &str, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        if let Some(index) = set.images.iter().position(|image| image.entry.name == name) {
            set.shown = Some(index);
            self.load(context);
        }
    }

    fn step(&mut self, by: i64, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        let (Some(shown), Some(last)) = (set.shown, set.images.len().checked_sub(1)) else { return };
        let to = (shown as i64).saturating_add(by).clamp(0, last as i64);
        set.shown = usize::try_from(to).ok();
        self.load(context);
    }

    /// Reads the shown image, then the one after it.
    fn load(&mut self, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return };
        let Some(shown) = set.shown else { return };
        let wanted = [shown, shown + 1].into_iter().filter_map(|i| set.images.get(i));
        let usable = wanted.filter(|image| image.entry.unusable.is_none());
        let missing = usable.map(|image| &image.entry).find(|entry| !self.loaded.has(&entry.name));
        if let (Some(entry), false) = (missing, self.loaded.is_reading()) {
            let work = LabelsWork::Load { name: entry.name.clone(), file: entry.image.clone() };
            self.loaded.reading(context.start(work));
        }
    }

    fn edit(&mut self, name: &str, edit: BoxEdit, context: &mut Context<'_>) {
        let shown = self.set.as_ref().and_then(Set::shown_image);
        if shown.is_none_or(|image| image.entry.name != name) {
            return context
                .refuse("The image was changed meanwhile. Do that again on the image that is shown.");
        }
        self.change(context, |image, bounds| image.history.apply(edit, bounds).map_err(|e| e.to_string()));
    }

    /// Changes the shown image and saves it.
    fn change(
        &mut self,
        context: &mut Context<'_>,
        change: impl FnOnce(&mut Image, &Bounds) -> Result<bool, String>,
    ) {
        let Some(set) = &mut self.set else { return context.refuse("Open a data set first.") };
        let classes = set.names.len();
        let Some((index, image)) = set.shown.and_then(|i| Some((i, set.images.get_mut(i)?))) else {
            return context.refuse("Choose an image first.");
        };
        if let Some(why) = image.entry.locked.as_ref().or(image.entry.unusable.as_ref()) {
            return context.refuse(why);
        }
        let bounds = Bounds { size_px: image.entry.size_px, classes };
        match change(image, &bounds) {
            Err(why) => context.refuse(why),
            Ok(false) => {}
            Ok(true) => {
                image.revision += 1;
                set.dirty.insert(index);
                set.check(index);
                self.save(context);
            }
        }
    }

    /// Boxes of the image before, of the same eye where there is one.
    pub(super) fn boxes_before(&self) -> Vec<LabelBox> {
        let before = || {
            let set = self.set.as_ref()?;
            let shown = set.shown?;
            let eye = super::images::eye_word(&set.images.get(shown)?.entry.name);
            let mut earlier = set.images[..shown].iter().rev().filter(|i| !i.history.boxes().is_empty());
            let same_eye = earlier.clone().find(|i| super::images::eye_word(&i.entry.name) == eye);
            same_eye.or_else(|| earlier.next()).map(|image| image.history.boxes().to_vec())
        };
        before().unwrap_or_default()
    }

    fn mark(&mut self, to_check: bool, context: &mut Context<'_>) {
        let Some(image) = self.set.as_mut().and_then(Set::shown_mut) else {
            return context.refuse("Choose an image first.");
        };
        image.to_check = to_check;
        if let Some(set) = &mut self.set {
            set.to_check_dirty = true;
        }
        self.save(context);
    }

    /// Writes what is in memory only. One write at a time, so that a later one is never overtaken.
    fn save(&mut self, context: &mut Context<'_>) {
        if self.saving.is_some() {
            return;
        }
        let Some(set) = &mut self.set else { return };
        let files = set.files_to_write();
        if files.is_empty() {
            return;
        }
        let (images, to_check) = (std::mem::take(&mut set.dirty), std::mem::take(&mut set.to_check_dirty));
        let job = context.start(LabelsWork::Save { files });
        self.saving = Some(Saving { job, images, to_check });
    }

    /// What is in memory only, to be written before the program ends.
    pub fn last_write(&self) -> Option<LabelsWork> {
        let mut set = self.set.clone()?;
        if let Some(saving) = &self.saving {
            set.dirty.extend(&saving.images);
            set.to_check_dirty |= saving.to_check;
        }
        let files = set.files_to_write();
        (!files.is_empty()).then_some(LabelsWork::Save { files })
    }
}

impl Workflow for LabelsWorkflow {
    type Command = LabelsCommand;
    type Work = LabelsWork;
    type Control = Nothing;
    type Around = LabelsAround;
    type View = LabelsView;

    fn new(folder: &Path) -> Self {
        Self::new(folder)
    }

    fn view(&mut self, around: &LabelsAround, _moment: &Moment) -> Arc<LabelsView> {
        Arc::new(Self::view(self, &around.detector))
    }

    fn restore(&mut self, _around: &LabelsAround, context: &mut Context<'_>) {
        context.start(LabelsWork::Restore { memory: self.memory.clone() });
    }

    fn apply(&mut self, command: LabelsCommand, around: &LabelsAround, context: &mut Context<'_>) {
        self.apply(command, around, context);
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: LabelsResult,
        _around: &LabelsAround,
        context: &mut Context<'_>,
    ) {
        self.work_done(id, result, context);
    }

    fn work_ended(
        &mut self,
        id: JobId,
        why: Option<&str>,
        _around: &LabelsAround,
        context: &mut Context<'_>,
    ) {
        self.work_ended(id, why, context);
    }
}

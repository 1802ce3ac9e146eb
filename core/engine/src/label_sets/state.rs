//! Which data set is open, which image is shown, what was changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::ClassNames;
use plumbline_vision::yolo_set::SplitOptions;

use super::history::Bounds;
use super::images::{Image, Loaded};
use super::store::{self, OpenedSet};
use super::transfer::ImportPlan;
use super::work::{LabelsResult, LabelsWork};
use crate::command::{BoxEdit, DetectorChoice, JobId, LabelsCommand, Provider};
use crate::context::Context;
use crate::detect::{LoadedDetector, OpenDetector};
use crate::notice::NoticeLevel;
use crate::view::{LabelBox, LabelProblem, ProposedBox};

const NO_PROPOSAL: &str = "There is no such proposal any more.";

/// Small pictures that are read at once.
const THUMBNAILS_AT_ONCE: usize = 24;

/// What the workflow can see of the rest.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// How detectors are opened.
    pub open: OpenDetector,
    /// The present detector.
    pub detector: DetectorChoice,
    /// Where it is computed.
    pub provider: Provider,
    /// Least confidence of what is proposed, 0–1.
    pub confidence: f32,
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
    pub(super) seen: super::view::Seen,
}

/// The open data set.
#[derive(Clone, Debug)]
pub struct Set {
    pub folder: PathBuf,
    pub names: ClassNames,
    pub images: Vec<Image>,
    pub shown: Option<usize>,
    /// What is wrong with the set as a whole.
    pub problems: Vec<String>,
    /// Images whose labels on disk are not those in memory.
    dirty: BTreeSet<usize>,
    to_check_dirty: bool,
}

#[derive(Clone, Debug)]
struct Saving {
    job: JobId,
    images: BTreeSet<usize>,
    to_check: bool,
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
            seen: super::view::Seen::default(),
        }
    }

    /// Looks which data set was open last.
    pub fn restore(&mut self, context: &mut Context<'_>) {
        context.start(LabelsWork::Restore { memory: self.memory.clone() });
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: LabelsCommand, around: &Surroundings, context: &mut Context<'_>) {
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
            LabelsCommand::Capture => self.capture(context),
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

    fn capture(&mut self, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return context.refuse("Open a data set first, or make a new one.") };
        let Some(frame) = context.newest.cloned() else {
            return context.refuse("There is no image yet. Open a source on Live first.");
        };
        let seq = (context.source.opened, frame.stamp.seq);
        if self.captured_seq == Some(seq) {
            return context
                .refuse("This pair is in the data set already. Wait for the next one, or step to it.");
        }
        if self.capturing.is_some() {
            return context.refuse("The pair before is being written. Capture again in a moment.");
        }
        self.captured_seq = Some(seq);
        let folder = set.folder.clone();
        self.capturing = Some(context.start(LabelsWork::Capture { frame, folder }));
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

    fn propose(&mut self, around: &Surroundings, context: &mut Context<'_>) {
        if self.proposing.is_some() {
            return context.refuse("The detector is at work. Wait for it.");
        }
        let Some(image) = self.set.as_ref().and_then(Set::shown_image) else {
            return context.refuse("Choose an image first.");
        };
        if let Some(why) = &image.entry.locked {
            return context.refuse(why);
        }
        if around.detector == DetectorChoice::Off {
            return context.refuse("The detector is switched off. Choose one on Live first.");
        }
        let name = image.entry.name.clone();
        let Some(Ok(pixels)) = self.loaded.get(&name).cloned() else {
            return context.refuse("The image is not read yet. Try again in a moment.");
        };
        let ready = self.proposer.as_ref().filter(|(choice, _)| *choice == around.detector);
        let work = LabelsWork::Propose {
            open: around.open.clone(),
            choice: around.detector.clone(),
            provider: around.provider,
            ready: ready.map(|(_, detector)| detector.clone()),
            name: name.clone(),
            image: pixels,
            names: self.set.as_ref().map(|set| set.names.clone()).unwrap_or_default(),
            confidence: around.confidence,
        };
        self.proposing = Some((context.start(work), name));
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

    fn export(&mut self, folder: PathBuf, train_percent: u8, seed: u64, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return context.refuse("Open a data set first.") };
        let labeled = set.for_training();
        if labeled.images.is_empty() {
            return context
                .refuse("No image is labeled. Draw boxes first, or say that nothing is on an image.");
        }
        let val_fraction = 1.0 - f64::from(train_percent) / 100.0;
        let options = SplitOptions { val_fraction, seed, ..SplitOptions::default() };
        self.begin(LabelsWork::Export { set: Box::new(labeled), folder, options }, context);
    }

    fn plan_import(&mut self, path: PathBuf, context: &mut Context<'_>) {
        let Some(set) = &self.set else {
            return context.refuse("Open a data set to import into first, or make a new one.");
        };
        let there = set.images.iter().map(|image| image.entry.name.clone()).collect();
        let work = LabelsWork::PlanImport { path, names: set.names.clone(), there };
        self.import = None;
        self.begin(work, context);
    }

    fn accept_import(&mut self, context: &mut Context<'_>) {
        let (Some(plan), Some(set)) = (self.import.clone(), &self.set) else {
            return context.refuse("No import is waiting.");
        };
        let work = LabelsWork::Import { plan, folder: set.folder.clone(), memory: self.memory.clone() };
        self.begin(work, context);
        self.import = None;
    }

    /// Work has ended with a result.
    pub fn work_done(&mut self, id: JobId, result: LabelsResult, context: &mut Context<'_>) {
        self.working.take_if(|working| *working == id);
        match result {
            LabelsResult::Restored(recent) => self.recent = recent,
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

    fn opened(&mut self, set: OpenedSet, context: &mut Context<'_>) {
        // A changed set that is read again stays at the image that was shown.
        let shown = self.set.as_ref().and_then(Set::shown_image).map(|image| image.entry.name.clone());
        self.forget_set();
        let mut set = Set::new(set);
        set.shown = shown
            .and_then(|name| set.images.iter().position(|image| image.entry.name == name))
            .or((!set.images.is_empty()).then_some(0));
        self.set = Some(set);
        self.load(context);
        self.read_thumbnails(context);
    }

    fn read_thumbnails(&mut self, context: &mut Context<'_>) {
        let Some(set) = &self.set else { return };
        let readable = set.images.iter().map(|image| &image.entry).filter(|entry| entry.unusable.is_none());
        let missing = readable.filter(|entry| !self.thumbnails.contains_key(&entry.name));
        let files: Vec<(String, PathBuf)> =
            missing.take(THUMBNAILS_AT_ONCE).map(|entry| (entry.name.clone(), entry.image.clone())).collect();
        if !files.is_empty() && self.reading_thumbnails.is_none() {
            self.reading_thumbnails = Some(context.start(LabelsWork::Thumbnails { files }));
        }
    }

    fn take_thumbnails(&mut self, pictures: Vec<(String, Result<Arc<RgbImage>, String>)>) {
        let Some(set) = &mut self.set else { return };
        let small = Arc::make_mut(&mut self.thumbnails);
        for (name, picture) in pictures {
            match picture {
                Ok(picture) => drop(small.insert(name, picture)),
                Err(why) => {
                    if let Some(image) = set.images.iter_mut().find(|image| image.entry.name == name) {
                        image.entry.unusable = Some(why);
                    }
                }
            }
        }
    }

    fn saved(&mut self, id: JobId, context: &mut Context<'_>) {
        if self.saving.take_if(|saving| saving.job == id).is_some() {
            self.unsaved = None;
        }
        self.save(context);
    }

    fn captured(&mut self, entries: Vec<store::Entry>, context: &mut Context<'_>) {
        let Some(set) = &mut self.set else { return };
        let first = entries.first().map(|entry| entry.name.clone());
        // Places of images are kept while labels are being written; they are sorted when it is opened again.
        set.images.extend(entries.into_iter().map(Image::new));
        set.shown = first.and_then(|name| set.images.iter().position(|image| image.entry.name == name));
        self.load(context);
        self.read_thumbnails(context);
    }

    fn proposed(
        &mut self,
        name: &str,
        boxes: Vec<ProposedBox>,
        unknown: &[String],
        context: &mut Context<'_>,
    ) {
        if !unknown.is_empty() {
            context.notices.add(
                NoticeLevel::Warning,
                format!(
                    "The detector knows classes that the data set does not have ({}); what it finds of them is left out.",
                    unknown.join(", ")
                ),
            );
        }
        let Some(set) = &mut self.set else { return };
        let Some(image) = set.images.iter_mut().find(|image| image.entry.name == name) else { return };
        let there = image.history.boxes();
        let is_new = |proposed: &ProposedBox| {
            !there.iter().any(|label| {
                label.class == proposed.label.class && label.area.iou(&proposed.label.area) > 0.5
            })
        };
        image.proposals = boxes.into_iter().filter(is_new).collect();
        if image.proposals.is_empty() {
            context.notices.add(NoticeLevel::Info, format!("The detector proposes nothing new for {name}."));
        }
    }

    /// Work has ended without a result: everything is as it was.
    pub fn work_ended(&mut self, id: JobId, why: Option<&str>, context: &mut Context<'_>) {
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

impl Set {
    fn new(set: OpenedSet) -> Self {
        let mut opened = Self {
            folder: set.folder,
            names: set.names,
            images: set.entries.into_iter().map(Image::new).collect(),
            shown: None,
            problems: set.problems,
            dirty: BTreeSet::new(),
            to_check_dirty: false,
        };
        (0..opened.images.len()).for_each(|index| opened.check(index));
        opened
    }

    fn check(&mut self, index: usize) {
        let image = &mut self.images[index];
        let entry = &image.entry;
        image.problems =
            super::checks::problems(&entry.name, image.history.boxes(), entry.size_px, &self.names).into();
    }

    pub fn shown_image(&self) -> Option<&Image> {
        self.images.get(self.shown?)
    }

    fn shown_mut(&mut self) -> Option<&mut Image> {
        self.images.get_mut(self.shown?)
    }

    /// Everything wrong with boxes.
    pub fn all_problems(&self) -> impl Iterator<Item = &LabelProblem> {
        self.images.iter().flat_map(|image| image.problems.iter())
    }
}

impl Set {
    fn files_to_write(&self) -> Vec<(PathBuf, Option<String>)> {
        let dirty = self.dirty.iter().filter_map(|index| self.images.get(*index));
        let mut files: Vec<(PathBuf, Option<String>)> =
            dirty.map(|image| (image.entry.label_file.clone(), image.label_text())).collect();
        if self.to_check_dirty {
            let marked = self.images.iter().filter(|image| image.to_check);
            let (file, text) = store::to_check_file(&self.folder, marked.map(|image| &*image.entry.name));
            files.push((file, (!text.is_empty()).then_some(text)));
        }
        files
    }
}

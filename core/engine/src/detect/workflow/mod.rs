//! Which detector, and what is shown of what it finds.

mod shown;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::StereoFrame;
use plumbline_vision::detect_places::Rates;

use super::command::{DetectCommand, DetectorChoice, Provider};
use super::detector::{LoadedDetector, OpenDetector, SHOWN_FROM};
use super::store::Store;
use super::view::{DetectionSettings, DetectionsView};
use super::work::{Context, DetectResult, DetectWork};
use crate::detect::view::DetectView;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::statistics::StageClock;
use crate::ground::{Moment, Nothing, Workflow};
use crate::live::{LiveSetup, NoSetup};

/// What detection can see of the rest.
pub struct DetectAround {
    /// Newest pair.
    pub newest: Option<StereoFrame>,
    /// Of which source, counted.
    pub opened: u64,
    /// Whether pairs are photographs that have nothing to do with each other.
    pub photographs: bool,
    /// What places rest on, or why there are none.
    pub setup: Result<Arc<LiveSetup>, NoSetup>,
    /// Whether the arm moves or a run has it, which needs the processor more.
    pub arm_moves: bool,
}

/// Detection, live.
#[derive(Clone, Debug)]
pub struct DetectWorkflow {
    store: Store,
    open: OpenDetector,
    settings: Arc<DetectionSettings>,
    kept: Arc<DetectionSettings>,
    keeping: Option<JobId>,
    restored: bool,
    wanted: bool,
    opening: Option<Opening>,
    /// The chosen detector is to be read although it is in use.
    anew: bool,
    detector: Option<InUse>,
    /// Name and reason of a detector that could not be used, while there is none.
    failed_to_open: Option<(String, String)>,
    /// Why another detector or provider was not taken, while the one before goes on.
    refused: Option<String>,
    found: Option<Accepted>,
    failed: Option<String>,
    /// Why the stage gives nothing any more.
    down: Option<String>,
    /// Of the classes of the detector in use.
    rates: Option<Rates>,
    /// When the first pair that was looked at was taken: looks that give way are counted from it.
    first: Option<Instant>,
    clock: StageClock,
}

#[derive(Clone, Debug)]
struct Opening {
    job: JobId,
    choice: DetectorChoice,
    provider: Provider,
}

#[derive(Clone, Debug)]
struct InUse {
    detector: Arc<LoadedDetector>,
    choice: DetectorChoice,
    provider: Provider,
}

#[derive(Clone, Debug)]
struct Accepted {
    view: Arc<DetectionsView>,
    generation: Option<u64>,
}

impl DetectWorkflow {
    /// Nothing read. Settings are kept in `folder`.
    pub fn new(folder: &Path) -> Self {
        let settings = Arc::new(DetectionSettings::default());
        Self {
            store: Store::new(folder),
            open: OpenDetector::default(),
            kept: settings.clone(),
            settings,
            keeping: None,
            restored: false,
            wanted: false,
            opening: None,
            anew: false,
            detector: None,
            failed_to_open: None,
            refused: None,
            found: None,
            failed: None,
            down: None,
            rates: None,
            first: None,
            clock: StageClock::default(),
        }
    }

    /// Opens detectors in another way (tests).
    pub fn set_opener(&mut self, open: OpenDetector) {
        self.open = open;
    }

    /// Which detector is chosen, and where it is computed.
    pub fn chosen(&self) -> (&DetectorChoice, Provider) {
        (&self.settings.detector, self.settings.provider)
    }

    /// What was found last, while it is true of the newest pair's source.
    pub fn found(&self) -> Option<&Arc<DetectionsView>> {
        self.found.as_ref().map(|found| &found.view)
    }

    /// How detectors are opened.
    pub fn opener(&self) -> &OpenDetector {
        &self.open
    }

    /// The settings in use.
    pub fn settings(&self) -> &Arc<DetectionSettings> {
        &self.settings
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: DetectCommand, context: &mut Context<'_>) {
        let mut settings = (*self.settings).clone();
        match command {
            DetectCommand::Use(DetectorChoice::Off) => {
                settings.detector = DetectorChoice::Off;
                self.cancel_opening(context);
                self.let_go();
                (self.failed_to_open, self.refused) = (None, None);
            }
            DetectCommand::Use(choice) => {
                settings.detector = choice;
                self.reopen(context);
            }
            DetectCommand::Retry => self.reopen(context),
            DetectCommand::Provider(provider) => {
                settings.provider = provider;
                self.reopen(context);
            }
            DetectCommand::Confidence(confidence) => match share(confidence) {
                Ok(confidence) => settings.confidence = confidence,
                Err(why) => return context.refuse(why),
            },
            DetectCommand::ClassConfidence { class, confidence: Some(confidence) } => match share(confidence)
            {
                Ok(confidence) => {
                    settings.class_confidence.insert(class, confidence);
                }
                Err(why) => return context.refuse(why),
            },
            DetectCommand::ClassConfidence { class, confidence: None } => {
                settings.class_confidence.remove(&class);
            }
            DetectCommand::Iou(iou) if (0.0..=1.0).contains(&iou) => settings.iou = iou,
            DetectCommand::Iou(iou) => {
                return context.refuse(format!("The overlap must be between 0 and 1; {iou} is not."));
            }
            DetectCommand::Show { class, shown: true } => {
                settings.hidden.remove(&class);
            }
            DetectCommand::Show { class, shown: false } => {
                settings.hidden.insert(class);
            }
            DetectCommand::ShowAll => settings.hidden.clear(),
            DetectCommand::UsualThresholds => {
                let DetectionSettings { provider, detector, .. } = settings;
                settings = DetectionSettings { provider, detector, ..DetectionSettings::default() };
            }
            DetectCommand::ResetRates => self.rates = None,
        }
        self.change(settings, context);
        self.step(context);
    }

    fn change(&mut self, settings: DetectionSettings, context: &mut Context<'_>) {
        if settings == *self.settings {
            return;
        }
        let before = std::mem::replace(&mut self.settings, Arc::new(settings));
        let thresholds = |of: &DetectionSettings| (of.confidence, of.iou, of.class_confidence.clone());
        if thresholds(&before) != thresholds(&self.settings) {
            // Rates say how well these thresholds do, not those before.
            self.rates = None;
        }
        self.keep(context);
    }

    /// One file at a time is written; a slider that moves gives many settings.
    fn keep(&mut self, context: &mut Context<'_>) {
        if self.keeping.is_none() && self.restored && self.kept != self.settings {
            self.keeping = Some(context.start(DetectWork::Keep(self.store.clone(), self.settings.clone())));
        }
    }

    fn reopen(&mut self, context: &mut Context<'_>) {
        self.cancel_opening(context);
        // Even if it is the same file: it may have been written anew.
        self.anew = true;
        (self.failed_to_open, self.refused) = (None, None);
    }

    fn cancel_opening(&mut self, context: &mut Context<'_>) {
        if let Some(opening) = self.opening.take() {
            context.cancel(opening.job);
        }
    }

    fn let_go(&mut self) {
        (self.detector, self.found, self.failed) = (None, None, None);
        self.rates = None;
    }

    /// Whether somebody looks at objects.
    pub fn want(&mut self, wanted: bool, context: &mut Context<'_>) {
        if self.wanted != wanted {
            self.wanted = wanted;
            (self.found, self.failed) = (None, None);
        }
        self.step(context);
    }

    /// Begins to read the chosen detector if it is needed and is not there.
    fn step(&mut self, context: &mut Context<'_>) {
        let (choice, provider) = (self.settings.detector.clone(), self.settings.provider);
        let there = !self.anew
            && self.detector.as_ref().is_some_and(|it| it.choice == choice && it.provider == provider);
        let needed = self.wanted && self.restored && choice != DetectorChoice::Off;
        if needed && !there && self.failed_to_open.is_none() && self.opening.is_none() {
            self.anew = false;
            let open = self.open.clone();
            let job = context.start(DetectWork::Open { open, choice: choice.clone(), provider });
            self.opening = Some(Opening { job, choice, provider });
        }
    }

    /// Work has ended with this.
    pub fn work_done(&mut self, id: JobId, result: DetectResult, context: &mut Context<'_>) {
        match result {
            DetectResult::Restored(settings, problem) => {
                if let Some(problem) = problem {
                    context.notices.add(NoticeLevel::Warning, problem);
                }
                // What was asked for while it was being read counts more.
                if *self.settings == DetectionSettings::default() {
                    self.settings = Arc::new(settings);
                    self.kept = self.settings.clone();
                }
                self.restored = true;
                self.keep(context);
            }
            DetectResult::Kept(settings) => {
                self.kept = settings;
                self.keeping = None;
                self.keep(context);
            }
            DetectResult::Opened(detector) => {
                let Some(opening) = self.opening.take_if(|opening| opening.job == id) else { return };
                let Opening { choice, provider, .. } = opening;
                self.let_go();
                self.detector = Some(InUse { detector, choice, provider });
            }
        }
        self.step(context);
    }

    /// Work has ended without a result. `None`: it was called off.
    pub fn work_ended(&mut self, id: JobId, why: Option<&str>, context: &mut Context<'_>) {
        self.keeping.take_if(|keeping| *keeping == id);
        let Some(opening) = self.opening.take_if(|opening| opening.job == id) else { return };
        let name = opening.choice.name();
        let why = why.map_or_else(|| format!("Reading {name} was called off."), str::to_owned);
        match &self.detector {
            None => self.failed_to_open = Some((name, why)),
            Some(in_use) => {
                // The one before goes on, now and after the next start.
                let (detector, provider) = (in_use.choice.clone(), in_use.provider);
                let settings = DetectionSettings { detector, provider, ..(*self.settings).clone() };
                self.refused = Some(why);
                self.change(settings, context);
            }
        }
    }

    /// The stage gives nothing any more, or does again.
    pub fn stage_is_down(&mut self, why: Option<String>) {
        (self.found, self.failed) = (None, None);
        self.down = why;
    }

    /// The stage gave nothing of the newest pair: what it found before must not be taken for it.
    pub fn gave_nothing(&mut self, why: &str) {
        (self.found, self.failed) = (None, Some(why.to_owned()));
    }

    /// The source was closed or another one opened.
    pub fn clear(&mut self) {
        (self.found, self.failed) = (None, None);
        self.rates = None;
        self.clock = StageClock::default();
    }
}

impl Workflow for DetectWorkflow {
    type Command = DetectCommand;
    type Work = DetectWork;
    type Control = Nothing;
    type Around = DetectAround;
    type View = DetectView;

    fn new(folder: &Path) -> Self {
        Self::new(folder)
    }

    fn view(&mut self, around: &DetectAround, moment: &Moment) -> Arc<DetectView> {
        Arc::new(self.view(moment.skipped.detect, around, moment.now))
    }

    fn restore(&mut self, _around: &DetectAround, context: &mut Context<'_>) {
        context.start(DetectWork::Restore(self.store.clone()));
    }

    fn apply(&mut self, command: DetectCommand, _around: &DetectAround, context: &mut Context<'_>) {
        self.apply(command, context);
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: DetectResult,
        _around: &DetectAround,
        context: &mut Context<'_>,
    ) {
        self.work_done(id, result, context);
    }

    fn work_ended(
        &mut self,
        id: JobId,
        why: Option<&str>,
        _around: &DetectAround,
        context: &mut Context<'_>,
    ) {
        self.work_ended(id, why, context);
    }
}

/// A threshold that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("The confidence must be between {SHOWN_FROM} and 1; {0} is not.")]
struct NoShare(f32);

fn share(confidence: f32) -> Result<f32, NoShare> {
    if (SHOWN_FROM..=1.0).contains(&confidence) {
        return Ok(confidence);
    }
    Err(NoShare(confidence))
}

//! What is known while the eyes are being calibrated, and what the window shows of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::default_board;
use plumbline_model::robot::default_rig;
use plumbline_model::{
    CalibrationOptions, Chessboard, StereoCalibration, StereoCameras, StereoFrame, Workspace,
};

use super::auto_capture::AutoCapture;
use super::collection::Collection;
use super::command::EyesCommand;
use super::look::Look;
use super::place::{nominal_cameras, place_of, rough_pose};
use super::store::Store;
use super::view::{
    AcceptedCalibration, BoardPlace, BoardSeen, CaptureHint, CollectedPair, Coverage, EarlierCalibration,
    EyesView, GhostBoard, Origin, Proposal,
};
use super::work::{Context, EyesResult, EyesWork, Restore};
use super::{coverage, ghost};
use crate::ground::jobs::JobId;
use crate::ground::step::StepState;
use crate::ground::{Moment, Nothing, Workflow};
use crate::source::view::SourceView;

/// What the workflow can see of the rest.
pub struct EyesAround {
    /// Newest pair.
    pub newest: Option<StereoFrame>,
    /// How the source is doing.
    pub source: Arc<SourceView>,
}

/// The whole workflow.
#[derive(Clone, Debug)]
pub struct EyesWorkflow {
    pub(super) store: Store,
    /// Where captured pairs are kept, one folder per session.
    pub(super) sessions: PathBuf,
    /// The present session and when it began.
    pub(super) session: Option<(PathBuf, jiff::Timestamp)>,
    pub(super) workspace: Workspace,
    pub(super) collection: Collection,
    pub(super) board_chosen: bool,
    pub(super) options: CalibrationOptions,
    pub(super) minutes_since_on: Option<f64>,
    pub(super) auto_capture: bool,
    pub(super) auto: AutoCapture,
    /// The newest look, for when capturing is switched on.
    pub(super) last_look: Option<Look>,
    pub(super) hint: Option<CaptureHint>,
    pub(super) captured_at: Option<Instant>,
    pub(super) board_seen: Option<BoardSeen>,
    pub(super) not_collected: Arc<[(String, String)]>,
    pub(super) proposal: Option<Arc<Proposal>>,
    /// Collection and options that the proposal was solved from.
    pub(super) solved_from: Option<(u64, CalibrationOptions)>,
    pub(super) in_use: Option<Arc<AcceptedCalibration>>,
    pub(super) earlier: Arc<[EarlierCalibration]>,
    pub(super) busy: Busy,
    image_size_px: Option<(u32, u32)>,
    derived: Derived,
}

/// Work that must not be started twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Busy {
    pub capturing: Option<JobId>,
    pub collecting: Option<JobId>,
    pub solving: Option<JobId>,
    pub opening: Option<JobId>,
    pub accepting: Option<JobId>,
}

impl Busy {
    /// The job has ended, one way or another.
    pub fn forget(&mut self, id: JobId) {
        let all = [
            &mut self.capturing,
            &mut self.collecting,
            &mut self.solving,
            &mut self.opening,
            &mut self.accepting,
        ];
        for job in all {
            *job = job.filter(|job| *job != id);
        }
    }

    fn any(&self) -> bool {
        *self != Self::default()
    }
}

/// What everything derived depends on.
#[derive(Clone, Debug, PartialEq)]
struct DerivedFrom {
    revision: u64,
    size_px: Option<(u32, u32)>,
    in_use: Option<String>,
}

/// Computed from the rest; recomputed only when that changes.
#[derive(Clone, Debug)]
struct Derived {
    /// Of what this was computed.
    of: Option<DerivedFrom>,
    coverage: Arc<Coverage>,
    ghost: Option<Arc<GhostBoard>>,
    collected: Arc<[Arc<CollectedPair>]>,
}

impl EyesWorkflow {
    /// Nothing collected, nothing in use. Captured pairs are kept in a folder of `sessions`.
    pub fn new(store: Store, sessions: PathBuf, workspace: Workspace) -> Self {
        let board = default_board();
        Self {
            store,
            sessions,
            session: None,
            workspace,
            collection: Collection::new(board),
            board_chosen: false,
            options: CalibrationOptions::default(),
            minutes_since_on: None,
            auto_capture: false,
            auto: AutoCapture::default(),
            last_look: None,
            hint: None,
            captured_at: None,
            board_seen: None,
            not_collected: Arc::from([]),
            proposal: None,
            solved_from: None,
            in_use: None,
            earlier: Arc::from([]),
            busy: Busy::default(),
            image_size_px: None,
            derived: Derived {
                of: None,
                coverage: Arc::new(coverage::empty(&board)),
                ghost: None,
                collected: Arc::from([]),
            },
        }
    }

    /// Where calibrations are kept.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The board looked for.
    pub fn board(&self) -> &Chessboard {
        self.collection.board()
    }

    /// Whether pairs are captured without asking, for which the board must be looked for.
    pub fn auto_capture(&self) -> bool {
        self.auto_capture
    }

    /// The calibration in use.
    pub fn in_use(&self) -> Option<&Arc<StereoCalibration>> {
        self.in_use.as_ref().map(|in_use| &in_use.calibration)
    }

    /// Where the eyes are over the table, for the maps of the next assessment.
    pub fn set_workspace(&mut self, workspace: Workspace) {
        self.workspace = workspace;
    }

    /// Size of the newest images.
    pub fn set_image_size(&mut self, size_px: (u32, u32)) {
        self.image_size_px = Some(size_px);
    }

    /// Size of the images in the collection, else of the newest ones.
    pub(super) fn size_px(&self) -> Option<(u32, u32)> {
        self.collection.sizes_px().map(|sizes| sizes[0]).or(self.image_size_px)
    }

    /// Coverage by the pairs that are not dropped.
    pub(super) fn coverage(&self) -> &Coverage {
        &self.derived.coverage
    }

    /// The best knowledge of the eyes for images of this size.
    pub(super) fn rough_cameras(&self, size_px: (u32, u32)) -> StereoCameras {
        match self.in_use() {
            Some(in_use) if in_use.cameras.left.size_px() == size_px => in_use.cameras,
            _ => nominal_cameras(size_px, self.options.model),
        }
    }

    /// Where a board is, roughly.
    pub(super) fn place(&self, pair: &CollectedPair, size_px: (u32, u32)) -> Option<BoardPlace> {
        let left = pair.left.as_ref()?;
        place_of(self.board(), &rough_pose(&self.rough_cameras(size_px).left, self.board(), left)?)
    }

    /// Brings everything that is computed from the rest up to date.
    pub(super) fn refresh(&mut self) {
        self.mark_stale();
        let size_px = self.size_px();
        let in_use = self.in_use.as_ref().map(|in_use| in_use.id.clone());
        let of = DerivedFrom { revision: self.collection.revision(), size_px, in_use };
        if self.derived.of.as_ref() == Some(&of) {
            return;
        }
        self.derived.of = Some(of);
        self.derived.collected = self.collection.pairs().into();
        let board = *self.board();
        let Some(size_px) = size_px else {
            self.derived.coverage = Arc::new(coverage::empty(&board));
            self.derived.ghost = None;
            return;
        };
        let dropped = self.collection.dropped();
        let used = self.collection.pairs().iter().filter(|pair| !dropped.contains(&pair.name));
        let covered = coverage::coverage(&board, size_px, used.map(Arc::as_ref));
        self.derived.ghost = ghost::suggest(&self.rough_cameras(size_px), &board, &covered).map(Arc::new);
        self.derived.coverage = Arc::new(covered);
    }

    /// Says of a solved proposal that something changed since.
    fn mark_stale(&mut self) {
        let Some(proposal) = &self.proposal else { return };
        if proposal.origin != Origin::Solved {
            return;
        }
        let stale = match &self.solved_from {
            Some((revision, _)) if *revision != self.collection.revision() => {
                Some("Pairs were added, dropped or restored since it was solved. Solve again.".to_owned())
            }
            Some((_, options)) if *options != self.options => {
                Some("The options were changed since it was solved. Solve again.".to_owned())
            }
            _ => None,
        };
        if proposal.stale != stale {
            self.proposal = Some(Arc::new(Proposal { stale, ..(**proposal).clone() }));
        }
    }

    /// What the window shows.
    pub fn view(&self) -> EyesView {
        EyesView {
            step: self.step(),
            board: *self.board(),
            board_chosen: self.board_chosen,
            options: self.options.clone(),
            minutes_since_on: self.minutes_since_on,
            board_seen: self.board_seen.clone(),
            auto_capture: self.auto_capture,
            hint: self.hint.clone(),
            collected: self.derived.collected.clone(),
            dropped: Arc::new(self.collection.dropped().clone()),
            not_collected: self.not_collected.clone(),
            can_undo: self.collection.can_undo(),
            coverage: self.derived.coverage.clone(),
            ghost: self.derived.ghost.clone(),
            solving: self.busy.solving,
            proposal: self.proposal.clone(),
            in_use: self.in_use.clone(),
            earlier: self.earlier.clone(),
        }
    }

    fn step(&self) -> StepState {
        if self.busy.any() {
            return StepState::Running;
        }
        let Some(in_use) = self.in_use() else { return StepState::NotDone };
        let (calibrated, now) = (in_use.cameras.left.size_px(), self.image_size_px);
        match now {
            Some(now) if now != calibrated => StepState::Stale {
                why: format!(
                    "The images are {}×{} px now, the calibration in use is for {}×{} px. Calibrate again with these images.",
                    now.0, now.1, calibrated.0, calibrated.1
                ),
            },
            _ => StepState::Done,
        }
    }
}

impl Workflow for EyesWorkflow {
    type Command = EyesCommand;
    type Work = EyesWork;
    type Control = Nothing;
    type Around = EyesAround;
    type View = EyesView;

    fn new(folder: &Path) -> Self {
        let (store, rig) = (Store::of_world(folder), default_rig());
        Self::new(store, folder.join("sessions"), rig.workspace(&rig.home()))
    }

    fn view(&mut self, _around: &EyesAround, _moment: &Moment) -> Arc<EyesView> {
        Arc::new(Self::view(self))
    }

    fn restore(&mut self, _around: &EyesAround, context: &mut Context<'_>) {
        let (store, workspace) = (self.store.clone(), self.workspace);
        context.start(EyesWork::Restore(Restore { store, workspace }));
    }

    fn apply(&mut self, command: EyesCommand, around: &EyesAround, context: &mut Context<'_>) {
        self.apply(command, around, context);
    }

    fn work_done(&mut self, id: JobId, result: EyesResult, _around: &EyesAround, context: &mut Context<'_>) {
        self.work_done(id, result, context);
    }

    fn work_ended(
        &mut self,
        id: JobId,
        _why: Option<&str>,
        _around: &EyesAround,
        _context: &mut Context<'_>,
    ) {
        self.work_ended(id);
    }
}

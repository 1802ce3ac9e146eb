//! What is known while the eyes are being calibrated.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::default_board;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::{
    CalibrationOptions, Chessboard, Corners, Pixel, Raw, StereoCalibration, StereoCameras, StereoFrame,
    Workspace,
};

use super::auto_capture::AutoCapture;
use super::clock::CamerasClock;
use super::collection::Collection;
use super::command::EyesCommand;
use super::health::HealthRoom;
use super::look::Look;
use super::place::{nominal_cameras, place_of, rough_pose};
use super::store::Store;
use super::view::{
    AcceptedCalibration, BoardPlace, BoardSeen, CaptureEnded, CaptureHint, CollectedPair, Coverage, Drifted,
    EarlierCalibration, EyesView, GhostBoard, Origin, Proposal, Taken,
};
use super::work::{Context, EyesResult, EyesWork, OpenWhat, Restore};
use super::{coverage, ghost};
use crate::ground::jobs::JobId;
use crate::ground::{Moment, Nothing, Workflow};
use crate::source::view::SourceView;

/// What the workflow can see of the rest.
pub struct EyesAround {
    /// Newest pair.
    pub newest: Option<StereoFrame>,
    /// How the source is doing.
    pub source: Arc<SourceView>,
    /// For how long the eyes of the twin have been on, s, where it is what the source shows.
    pub twin_on_s: Option<f64>,
    /// The robot, for where it works.
    pub rig: Arc<Rig>,
    /// Whether the arm before these eyes moves, or a run has it.
    pub arm_moves: bool,
    /// Whether drift is being watched.
    pub is_watched: bool,
    /// What watching says by now, or said last; `None`: nothing yet.
    pub drifted: Option<Drifted>,
    /// Whether a law of time takes off what the eyes have turned since they were calibrated.
    pub is_corrected: bool,
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
    /// For how long the cameras have been on.
    pub(super) clock: CamerasClock,
    /// How long they had been on when the collected pairs were taken, min, as far as those were not taken live.
    pub(super) minutes_of_pairs: Option<f64>,
    /// The clock as it was before the cameras were away or became others, with when that was seen.
    pub(super) clocks_before: Vec<(Instant, CamerasClock)>,
    /// When the pair was taken that is being searched.
    pub(super) capturing_taken: Option<Taken>,
    pub(super) auto_capture: bool,
    /// Why that was switched off although nobody asked for it.
    pub(super) capture_ended: Option<CaptureEnded>,
    pub(super) auto: AutoCapture,
    /// The newest look, for when capturing is switched on.
    pub(super) last_look: Option<Look>,
    pub(super) hint: Option<CaptureHint>,
    /// Of which source, counted; `None`: nobody has looked yet.
    pub(super) hint_of: Option<u64>,
    pub(super) is_done_with_board: bool,
    pub(super) captured_at: Option<Instant>,
    pub(super) board_seen: Option<BoardSeen>,
    pub(super) not_collected: Arc<[(String, String)]>,
    pub(super) proposal: Option<Arc<Proposal>>,
    /// Collection and options that the proposal was solved from.
    pub(super) solved_from: Option<(u64, CalibrationOptions)>,
    pub(super) in_use: Option<Arc<AcceptedCalibration>>,
    /// Collection and options that a calibration with this id was solved from, of the one accepted last.
    pub(super) accepted_from: Option<(u64, CalibrationOptions, String)>,
    /// Whether what was accepted before has been read.
    pub(super) is_known: bool,
    pub(super) earlier: Arc<[EarlierCalibration]>,
    pub(super) busy: Busy,
    pub(super) health: HealthRoom,
    pub(super) image_size_px: Option<(u32, u32)>,
    pub(super) derived: Derived,
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

    /// Whether something is under way.
    pub fn any(&self) -> bool {
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
pub(super) struct Derived {
    /// Of what this was computed.
    of: Option<DerivedFrom>,
    pub coverage: Arc<Coverage>,
    pub ghost: Option<Arc<GhostBoard>>,
    pub collected: Arc<[Arc<CollectedPair>]>,
}

impl EyesWorkflow {
    /// The board looked for.
    pub fn board(&self) -> &Chessboard {
        self.collection.board()
    }

    /// Whether pairs are captured without asking, for which the board must be looked for.
    pub fn auto_capture(&self) -> bool {
        self.auto_capture
    }

    /// Pairs are captured only when asked for from now on.
    pub fn end_auto_capture(&mut self, why: CaptureEnded) {
        if std::mem::take(&mut self.auto_capture) {
            self.capture_ended = Some(why);
        }
    }

    /// The calibration in use.
    pub fn in_use(&self) -> Option<&Arc<StereoCalibration>> {
        self.in_use.as_ref().map(|in_use| &in_use.calibration)
    }

    /// The calibration in use as it was accepted; `None`: not read yet. Inside `None`: none is in use.
    pub fn accepted(&self) -> Option<Option<&Arc<AcceptedCalibration>>> {
        self.is_known.then_some(self.in_use.as_ref())
    }

    /// When both eyes saw the board last, in the newest pair in which it was looked for, and its outermost corners in
    /// order around it: left, right.
    pub fn board_at(&self) -> Option<(Instant, [[Pixel<Raw>; 4]; 2])> {
        let look = self.last_look.as_ref()?;
        let (columns, rows) = (look.board.inner_columns as usize, look.board.inner_rows as usize);
        let around = |corners: &Option<Corners>| -> Option<[Pixel<Raw>; 4]> {
            let corners = corners.as_ref()?;
            let last = (columns * rows).checked_sub(1)?;
            let at = |index: usize| corners.get(index).copied().flatten();
            Some([at(0)?, at(columns - 1)?, at(last)?, at(last + 1 - columns)?])
        };
        Some((look.frame.stamp.captured_at, [around(&look.left)?, around(&look.right)?]))
    }

    /// Pairs that are collected.
    pub fn pair_count(&self) -> usize {
        self.collection.pairs().len()
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

    /// Whether the calibration in use was solved from the pairs that are collected, as they are.
    pub(super) fn is_solved_in_use(&self) -> bool {
        let (Some((revision, options, id)), Some(in_use)) = (&self.accepted_from, &self.in_use) else {
            return false;
        };
        *revision == self.collection.revision() && *options == self.options && *id == in_use.id
    }

    /// Whether the shown proposal was solved from other pairs than those that are collected now.
    pub(super) fn pairs_changed(&self) -> bool {
        let is_solved = self.proposal.as_ref().is_some_and(|proposal| proposal.origin == Origin::Solved);
        let revision = self.solved_from.as_ref().map(|(revision, _)| *revision);
        is_solved && revision.is_some_and(|revision| revision != self.collection.revision())
    }

    /// Says of a solved proposal that something changed since.
    fn mark_stale(&mut self) {
        let Some(proposal) = &self.proposal else { return };
        if proposal.origin != Origin::Solved {
            return;
        }
        let stale = match &self.solved_from {
            Some(_) if self.pairs_changed() => {
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
}

impl Workflow for EyesWorkflow {
    type Command = EyesCommand;
    type Work = EyesWork;
    type Control = Nothing;
    type Around = EyesAround;
    type View = EyesView;

    /// Nothing collected, nothing in use. Calibrations are kept in `folder/calibrations`, captured pairs
    /// in `folder/sessions`.
    fn new(folder: &Path) -> Self {
        let rig = default_rig();
        let board = default_board();
        Self {
            store: Store::of_world(folder),
            sessions: folder.join("sessions"),
            session: None,
            workspace: rig.workspace(&rig.home()),
            collection: Collection::new(board),
            board_chosen: false,
            options: CalibrationOptions::default(),
            clock: CamerasClock::default(),
            minutes_of_pairs: None,
            clocks_before: Vec::new(),
            capturing_taken: None,
            auto_capture: false,
            capture_ended: None,
            auto: AutoCapture::default(),
            last_look: None,
            hint: None,
            hint_of: None,
            is_done_with_board: false,
            captured_at: None,
            board_seen: None,
            not_collected: Arc::from([]),
            proposal: None,
            solved_from: None,
            in_use: None,
            accepted_from: None,
            is_known: false,
            earlier: Arc::from([]),
            busy: Busy::default(),
            health: HealthRoom::default(),
            image_size_px: None,
            derived: Derived {
                of: None,
                coverage: Arc::new(coverage::empty(&board)),
                ghost: None,
                collected: Arc::from([]),
            },
        }
    }

    fn view(&mut self, around: &EyesAround, moment: &Moment) -> Arc<EyesView> {
        Arc::new(self.shown(around, moment.now))
    }

    fn restore(&mut self, _: &EyesAround, context: &mut Context<'_>) {
        let (store, workspace) = (self.store.clone(), self.workspace);
        context.start(EyesWork::Restore(Restore { store, workspace }));
    }

    fn apply(&mut self, command: EyesCommand, around: &EyesAround, context: &mut Context<'_>) {
        match command {
            EyesCommand::ChooseBoard { columns, rows, square_m } => {
                self.choose_board(columns, rows, square_m, context);
            }
            EyesCommand::RecognizeBoard => self.recognize_board(around, context),
            EyesCommand::ChooseOptions(options) => self.options = options,
            EyesCommand::MinutesSinceOn(minutes) => self.set_minutes(minutes, around, context),
            EyesCommand::Capture => self.capture(around, context),
            EyesCommand::AutoCapture(on) => self.set_auto_capture(on, around, context),
            EyesCommand::CollectRecording => self.collect_recording(around, context),
            EyesCommand::DeleteLast => self.edit(context, |pairs| pairs.delete_last().map(drop)),
            EyesCommand::Delete { pair } => self.edit(context, |pairs| pairs.delete(&pair)),
            EyesCommand::DeleteAll => self.edit(context, |pairs| pairs.delete_all().map(drop)),
            EyesCommand::Undo => self.edit(context, |pairs| pairs.undo()),
            EyesCommand::DropPair { pair } => self.edit(context, |pairs| pairs.drop_pair(&pair)),
            EyesCommand::RestorePair { pair } => self.edit(context, |pairs| pairs.restore_pair(&pair)),
            EyesCommand::Solve => self.solve(around, context),
            EyesCommand::JudgeHealth => self.judge_health(around, context),
            EyesCommand::Accept => match self.not_offered(around, context.time) {
                Some(why) => context.refuse(why),
                None => self.accept(context),
            },
            EyesCommand::Discard => (self.proposal, self.solved_from) = (None, None),
            EyesCommand::Import { files, length } => self.open(OpenWhat::Files { files, length }, context),
            EyesCommand::ProposeEarlier { id } => self.open(OpenWhat::Earlier { id }, context),
            EyesCommand::UseEarlier { id } => self.use_earlier(id, context),
            EyesCommand::CollectEvidence => self.collect_evidence(context),
            EyesCommand::Export { what, format, file } => self.export(what, format, file, context),
        }
        self.refresh();
    }

    fn work_done(&mut self, id: JobId, result: EyesResult, around: &EyesAround, context: &mut Context<'_>) {
        self.busy.forget(id);
        match result {
            EyesResult::Captured(captured) => self.captured(captured, context),
            EyesResult::Recognized(seen) => self.board_seen = Some(seen),
            EyesResult::Kept(_) => {}
            EyesResult::Collected(collected) => self.collected(collected, context),
            EyesResult::Solved(solved) => self.solved(solved),
            EyesResult::Opened(opened) => self.opened(opened),
            EyesResult::Accepted(accepted) => self.accepted_now(accepted),
            EyesResult::Health(ended) => self.judged_health(id, ended, around, context),
            EyesResult::Exported(_) => {}
            EyesResult::Restored(restored) => self.restored(restored, context),
            EyesResult::UsedEarlier(restored) => {
                self.in_use = None;
                self.restored(restored, context);
            }
        }
        self.refresh();
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &EyesAround, context: &mut Context<'_>) {
        self.busy.forget(id);
        self.not_judged(id, why, context.time.instant);
    }
}

//! What happens while calibrating the eyes: the overlay sees a board, work ends.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::{StereoFrame, counted};

use super::assess::{Assessment, STATED_AT_M};
use super::clock::is_live;
use super::collection::Collection;
use super::coverage::Novelty;
use super::look::Look;
use super::times::taken;
use super::view::{CaptureEnded, CaptureHint, CollectedPair, Origin, Proposal};
use super::work::{Accepted, Captured, Collected, Context, EyesWork, Keep, Opened, Restored, Solved};
use super::workflow::{EyesAround, EyesWorkflow};
use super::{auto_capture, coverage};
use crate::ground::notice::NoticeLevel;

/// That a pair was captured is shown for this long.
const SHOW_CAPTURED: Duration = Duration::from_millis(1200);
/// What a look said of eyes that deliver is shown for this long; a busy machine looks seldom.
const HINT_LASTS: Duration = Duration::from_secs(10);

impl EyesWorkflow {
    /// Takes a look at what the overlay saw: says what capturing waits for, and captures if
    /// that is switched on.
    pub fn look(&mut self, look: Look, around: &EyesAround, context: &mut Context<'_>) {
        // What was said of the look before says nothing of this one.
        self.is_done_with_board = false;
        if look.board != *self.board() {
            return self.hint = None;
        }
        self.hint_of = Some(around.source.opened);
        let size_px = look.frame.left.dimensions();
        self.set_image_size(size_px);
        self.refresh();
        if look.left.is_some() || look.right.is_some() {
            self.board_seen = None;
        } else if look.other_board.is_some() {
            self.board_seen.clone_from(&look.other_board);
        }
        self.last_look = Some(look.clone());
        let hint = self.judge(&look, size_px, around);
        self.is_done_with_board = matches!(hint, CaptureHint::Ready | CaptureHint::NothingNew);
        if hint == CaptureHint::Ready && self.auto_capture && self.busy.capturing.is_none() {
            self.is_done_with_board = self.capture_look(look, around, context);
            return;
        }
        let captured_lately = self
            .captured_at
            .is_some_and(|at| look.frame.stamp.captured_at.saturating_duration_since(at) < SHOW_CAPTURED);
        let still_shown = matches!(self.hint, Some(CaptureHint::Captured { .. })) && captured_lately;
        if !(still_shown && hint == CaptureHint::NothingNew) {
            self.hint = Some(hint);
        }
    }

    /// Whether by the newest look nothing more is to be had of the board where it is: it was captured, could be, or has
    /// been there before.
    pub fn is_done_with_board(&self) -> bool {
        self.is_done_with_board
    }

    /// What capturing waits for, as far as that is of what the eyes see now: of another source, or where nobody has
    /// looked for a while, it says nothing.
    pub(super) fn shown_hint(&self, around: &EyesAround, now: Instant) -> Option<CaptureHint> {
        let looked_at = self.last_look.as_ref().map(|look| look.frame.stamp.captured_at);
        let is_old = looked_at.is_some_and(|at| now.saturating_duration_since(at) > HINT_LASTS);
        let is_of_another = self.hint_of.is_some_and(|opened| opened != around.source.opened);
        let is_stale = is_of_another || is_live(&around.source) && is_old;
        self.hint.clone().filter(|_| !is_stale)
    }

    fn judge(&mut self, look: &Look, size_px: (u32, u32), around: &EyesAround) -> CaptureHint {
        let known = look.frame.name.as_ref().is_some_and(|name| self.collection.contains(name));
        let both = look.left.as_ref().zip(look.right.as_ref());
        let novelty = both.filter(|_| !known).map(|(left, right)| {
            let place = self.place(&pair_of(look, String::new()), size_px);
            let pairs = self.collection.pairs().iter().map(Arc::as_ref);
            let elsewhere = coverage::is_elsewhere(size_px, left, place.as_ref(), pairs);
            let covered = self.coverage();
            let novelty = coverage::novelty(covered, self.board(), size_px, [left, right], place.as_ref());
            Novelty { elsewhere, ..novelty }
        });
        self.auto.look(auto_capture::Look {
            at: look.frame.stamp.captured_at,
            width_px: size_px.0,
            left: look.left.as_ref(),
            right: look.right.as_ref(),
            edge_width_px: look.edge_width_px,
            novelty,
            photograph: around.source.photographs,
        })
    }

    /// Whether it is collected now.
    fn capture_look(&mut self, look: Look, around: &EyesAround, context: &mut Context<'_>) -> bool {
        let name = look.frame.name.clone().unwrap_or_else(|| self.collection.next_name());
        let sizes_px = [look.frame.left.dimensions(), look.frame.right.dimensions()];
        self.captured_at = Some(look.frame.stamp.captured_at);
        let pair = CollectedPair { taken: taken(&look.frame, around), ..pair_of(&look, name) };
        let is_collected = self.add(pair, &look.frame, sizes_px, context);
        if !is_collected {
            // Saying it once per look would flood the operator.
            self.auto_capture = false;
            self.hint = None;
        }
        is_collected
    }

    /// Adds a pair; whether it is collected now.
    fn add(
        &mut self,
        pair: CollectedPair,
        frame: &StereoFrame,
        sizes_px: [(u32, u32); 2],
        context: &mut Context<'_>,
    ) -> bool {
        let name = pair.name.clone();
        let place = self.place(&pair, sizes_px[0]);
        match self.collection.add(CollectedPair { place, ..pair }, sizes_px) {
            Ok(()) => {
                self.board_chosen = true;
                self.board_seen = None;
                self.hint = Some(CaptureHint::Captured { pair: name.clone() });
                self.keep(&name, frame, context);
                // What is captured by itself is seen where it is counted.
                if !self.auto_capture {
                    let count = counted(self.collection.pairs().len(), "pair");
                    context.notices.add(NoticeLevel::Success, format!("Captured: {count} so far."));
                }
            }
            Err(error) => context.refuse(error),
        }
        self.refresh();
        self.collection.contains(&name)
    }

    /// Pairs of cameras exist nowhere else, so they are written down; recordings are on disk already.
    fn keep(&mut self, name: &str, frame: &StereoFrame, context: &mut Context<'_>) {
        if frame.name.is_some() {
            return;
        }
        let (folder, started) = self.session.get_or_insert_with(|| {
            let started = context.time.day;
            (self.sessions.join(format!("{}_eyes", started.strftime("%Y-%m-%dT%H-%M-%S"))), started)
        });
        let (folder, started) = (folder.clone(), *started);
        let work = Keep { frame: frame.clone(), name: name.to_owned(), folder, started };
        context.start(EyesWork::Keep(work));
    }

    pub(super) fn captured(&mut self, captured: Captured, context: &mut Context<'_>) {
        if captured.board == *self.board() {
            self.captured_at = Some(captured.frame.stamp.captured_at);
            let pair = CollectedPair { taken: self.capturing_taken.take(), ..captured.pair };
            self.add(pair, &captured.frame, captured.sizes_px, context);
        } else {
            context.refuse("The board was changed while the pair was searched. Capture it again.");
        }
    }

    pub(super) fn collected(&mut self, collected: Collected, context: &mut Context<'_>) {
        self.not_collected = collected.not_collected.into();
        if collected.board != *self.board() {
            return context
                .refuse("The board was changed while the recording was searched. Collect it again.");
        }
        let Some(sizes_px) = collected.sizes_px else { return };
        let placed = |pair: CollectedPair| CollectedPair { place: self.place(&pair, sizes_px[0]), ..pair };
        let pairs = collected.pairs.into_iter().map(placed).collect();
        match self.collection.add_all(pairs, sizes_px) {
            Ok(_) => self.board_chosen = true,
            Err(error) => context.refuse(error),
        }
    }

    pub(super) fn solved(&mut self, solved: Solved) {
        self.solved_from = Some((solved.revision, solved.options));
        self.proposal = Some(Arc::new(proposal(solved.calibration, Origin::Solved, solved.assessment)));
    }

    pub(super) fn accepted_now(&mut self, accepted: Accepted) {
        let same =
            |proposal: &Arc<Proposal>| Arc::ptr_eq(&proposal.calibration, &accepted.in_use.calibration);
        // A newer proposal that came meanwhile still waits for a decision.
        if self.proposal.as_ref().is_some_and(same) {
            let from = self.solved_from.take();
            self.accepted_from =
                from.map(|(revision, options)| (revision, options, accepted.in_use.id.clone()));
            self.proposal = None;
        }
        // The board lies there for the mount next: what the eyes see of it then is none of their pairs.
        self.end_auto_capture(CaptureEnded::Accepted);
        self.in_use = Some(Arc::new(accepted.in_use));
        self.is_known = true;
        self.earlier = accepted.earlier.into();
    }

    pub(super) fn opened(&mut self, opened: Opened) {
        self.solved_from = None;
        self.proposal = Some(Arc::new(proposal(opened.calibration, opened.origin, opened.assessment)));
    }

    pub(super) fn restored(&mut self, restored: Restored, context: &mut Context<'_>) {
        for problem in restored.problems {
            context.notices.add(NoticeLevel::Warning, problem);
        }
        self.is_known = true;
        if self.in_use.is_none() {
            self.in_use = restored.in_use.map(Arc::new);
            if let Some(evidence) = self.in_use().and_then(|in_use| in_use.evidence.as_ref())
                && !self.board_chosen
                && self.collection.pairs().is_empty()
            {
                // The laboratory has this board; asking again would be a nuisance.
                self.collection = Collection::new(evidence.board);
            }
        }
        self.earlier = restored.earlier.into();
    }
}

fn pair_of(look: &Look, name: String) -> CollectedPair {
    let [left_image, right_image] = look.gray.clone().map(Some);
    CollectedPair {
        name,
        left: look.left.clone(),
        right: look.right.clone(),
        left_image,
        right_image,
        place: None,
        taken: None,
    }
}

fn proposal(
    calibration: Arc<plumbline_model::StereoCalibration>,
    origin: Origin,
    assessment: Assessment,
) -> Proposal {
    Proposal {
        calibration,
        origin,
        difference: assessment.difference,
        uncertainty: assessment.uncertainty,
        stated_at_m: STATED_AT_M,
        depth_per_px_m: assessment.depth_per_px_m,
        doubts: assessment.doubts,
        stale: None,
    }
}

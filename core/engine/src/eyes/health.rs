//! Whether the calibration in use still holds, and whether a proposed one is better: ordinary pairs are gathered for some
//! seconds and judge both, as `plumbline health` does.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::{StereoCalibration, StereoFrame};

use super::view::{EyesHealth, HealthState, HealthView, ProposalHealth};
use super::work::{Context, EyesWork, Health, Pictures};
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::jobs::JobId;
use crate::source::view::{SourceStatus, SourceView};

/// So many pairs are looked at …
const PAIRS: usize = 4;
/// … one in so long: what passes before the eyes is not in all of them.
const EVERY: Duration = Duration::from_secs(1);

/// Which calibrations are judged.
#[derive(Clone, Debug)]
struct Of {
    in_use: Arc<StereoCalibration>,
    proposed: Option<Arc<StereoCalibration>>,
}

impl Of {
    fn is(&self, other: &Self) -> bool {
        let same = |a: &Arc<StereoCalibration>, b: &Arc<StereoCalibration>| Arc::ptr_eq(a, b);
        let proposed = match (&self.proposed, &other.proposed) {
            (Some(a), Some(b)) => same(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        same(&self.in_use, &other.in_use) && proposed
    }
}

/// Pairs that are being gathered.
#[derive(Clone, Debug)]
struct Gathering {
    /// Of which source, counted.
    opened: u64,
    pairs: Vec<Pictures>,
    due: Instant,
}

/// How far it is, and what was judged last.
#[derive(Clone, Debug, Default)]
pub(super) struct HealthRoom {
    gathering: Option<Gathering>,
    judging: Option<(JobId, Of)>,
    /// How judging ended last.
    ended: Option<(Of, HealthState)>,
    /// What was judged last: it stands while it is looked at again, and when nothing comes of that.
    judged: Option<(Of, Arc<EyesHealth>)>,
}

impl EyesWorkflow {
    /// Begins to look; what was being looked at is forgotten.
    pub(super) fn judge_health(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        self.stop_judging(context);
        if self.in_use().is_none() {
            return context.refuse("No calibration is in use. Accept one first; then it can be judged.");
        }
        let Some(newest) = &around.newest else {
            return context.refuse("There is no image yet. Open the eyes, or pairs that they took.");
        };
        let pairs = vec![pictures(newest)];
        if goes_on(&around.source) {
            let due = context.time.instant + EVERY;
            self.health.gathering = Some(Gathering { opened: around.source.opened, pairs, due });
        } else {
            self.judge_pairs(pairs, around, context);
        }
    }

    /// Whether pairs are being gathered.
    pub fn wants_pairs(&self) -> bool {
        self.health.gathering.is_some()
    }

    /// A pair has come while pairs are being gathered.
    pub fn saw(&mut self, frame: &StereoFrame, around: &EyesAround, context: &mut Context<'_>) {
        self.source_changed(around, context);
        let now = context.time.instant;
        let Some(gathering) = &mut self.health.gathering else { return };
        if now < gathering.due {
            return;
        }
        gathering.pairs.push(pictures(frame));
        gathering.due = now + EVERY;
        if gathering.pairs.len() >= PAIRS
            && let Some(gathering) = self.health.gathering.take()
        {
            self.judge_pairs(gathering.pairs, around, context);
        }
    }

    /// The source has something new: where no more pairs come of it, none are waited for.
    pub fn source_changed(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        let Some(gathering) = &self.health.gathering else { return };
        let why = if gathering.opened != around.source.opened {
            "Other eyes were opened: ask again whether the calibration is still good."
        } else if !goes_on(&around.source) {
            "No more pairs come: ask again whether the calibration is still good when they do."
        } else {
            return;
        };
        self.health.gathering = None;
        context.refuse(why);
    }

    fn judge_pairs(&mut self, pairs: Vec<Pictures>, around: &EyesAround, context: &mut Context<'_>) {
        let Some(of) = self.to_be_judged() else { return };
        let work = Health {
            pairs,
            in_use: of.in_use.clone(),
            proposed: of.proposed.clone(),
            rig: around.rig.clone(),
        };
        self.health.judging = Some((context.start(EyesWork::Health(work)), of));
    }

    /// The calibration in use and the one proposed; `None`: none is in use.
    fn to_be_judged(&self) -> Option<Of> {
        let proposed = self.proposal.as_ref().map(|proposal| proposal.calibration.clone());
        let in_use = self.in_use()?.clone();
        Some(Of { proposed: proposed.filter(|proposed| !Arc::ptr_eq(proposed, &in_use)), in_use })
    }

    fn stop_judging(&mut self, context: &mut Context<'_>) {
        self.health.gathering = None;
        if let Some((job, _)) = self.health.judging.take() {
            context.cancel(job);
        }
    }

    /// Judged, or why not.
    pub(super) fn judged_health(&mut self, id: JobId, state: HealthState) {
        let Some((_, of)) = self.health.judging.take_if(|(job, _)| *job == id) else { return };
        if let HealthState::Judged(health) = &state {
            self.health.judged = Some((of.clone(), health.clone()));
        }
        self.health.ended = Some((of, state));
    }

    /// Nothing came of the work.
    pub(super) fn not_judged(&mut self, id: JobId, why: Option<&str>) {
        if let Some((_, of)) = self.health.judging.take_if(|(job, _)| *job == id)
            && let Some(why) = why
        {
            self.health.ended = Some((of, HealthState::Failed(why.to_owned())));
        }
    }

    /// What the window shows of it: of the calibration in use and of the proposal as they are now, and of nothing else.
    pub(super) fn shown_health(&self) -> HealthView {
        let now = self.to_be_judged();
        let is_of_now = |of: &Of| now.as_ref().is_some_and(|now| of.is(now));
        let gathered = self.health.gathering.as_ref().map(|gathering| gathering.pairs.len());
        let ended = self.health.ended.as_ref().filter(|(of, _)| is_of_now(of));
        let judged = self.health.judged.as_ref().filter(|(of, _)| is_of_now(of));
        let state = match (gathered, &self.health.judging) {
            (Some(pairs), _) => HealthState::Gathering { pairs, of: PAIRS },
            (None, Some(_)) => HealthState::Judging,
            (None, None) => ended.map_or(HealthState::NotAsked, |(_, state)| state.clone()),
        };
        HealthView { state, judged: judged.map(|(_, health)| health.clone()) }
    }

    /// Why the proposal is not offered; `None`: it is, or nobody has judged it.
    pub(super) fn not_offered(&self) -> Option<&'static str> {
        match self.shown_health().judged?.proposed?.1 {
            ProposalHealth::Better | ProposalHealth::Untold => None,
            ProposalHealth::Worse => Some(
                "The proposed calibration fits what the eyes see worse than the one in use: it is not put in use. \
                 Discard it.",
            ),
            ProposalHealth::Undecided => Some(
                "The proposed calibration cannot be told apart from the one in use by what the eyes see: it is not \
                 put in use. Discard it, or judge again with more before the eyes.",
            ),
        }
    }
}

/// Whether more pairs come by themselves.
fn goes_on(source: &SourceView) -> bool {
    let plays = source.replay.as_ref().is_none_or(|replay| replay.playing);
    source.status == SourceStatus::Running && !source.photographs && plays
}

fn pictures(frame: &StereoFrame) -> Pictures {
    [frame.left.clone(), frame.right.clone()]
}

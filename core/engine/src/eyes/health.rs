//! Whether the calibration in use still holds, and whether a proposed one is better: ordinary pairs are gathered for some
//! seconds and judge both, as `plumbline health` does. Whoever asks has an answer within ten seconds.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::StereoFrame;

use super::clock::is_live;
use super::health_by_itself::ByItself;
use super::health_judged::{Ask, Gathering, Judged, Judging, Of, Then, ToldHealth};
use super::view::HealthState;
use super::work::{Context, EyesWork, Health, HealthEnded, Pictures};
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::jobs::JobId;
use crate::source::view::{SourceStatus, SourceView};

/// So many pairs are looked at …
pub(super) const PAIRS: usize = 4;
/// … one in so long: what passes before the eyes is not in all of them.
const EVERY: Duration = Duration::from_secs(1);
/// Where pairs come slowly, those that came within this time are judged …
const GATHERED_WITHIN: Duration = Duration::from_secs(5);
/// … by the places that were matched within this time …
const MATCHED_WITHIN: Duration = Duration::from_secs(9);
/// … and whatever the machine does, whoever asked is told something within this time.
const ANSWERED_WITHIN: Duration = Duration::from_secs(10);
/// Told where nothing came of it in time.
const NO_TIME: &str = "Not enough was seen in ten seconds, because this computer has too much to do: close other \
     programs, or wait until the work in the bottom line has ended, and ask again.";

/// How far it is, and what was judged last.
#[derive(Clone, Debug, Default)]
pub(super) struct HealthRoom {
    pub gathering: Option<Gathering>,
    pub judging: Option<Judging>,
    pub by_itself: ByItself,
    /// How judging ended last.
    pub ended: Option<(Of, HealthState)>,
    /// What was judged last: it stands while it is looked at again, and when nothing comes of that.
    pub judged: Option<Judged>,
    /// What was judged and told last: what nobody asked for and is as it was is not told.
    told: Option<ToldHealth>,
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
        let ask = Ask { at: context.time.instant, by_itself: false };
        if goes_on(&around.source) {
            self.gather(ask, newest, around);
        } else {
            self.judge_pairs(vec![pictures(newest)], ask, around, context);
        }
    }

    /// Begins to gather pairs when nobody has asked.
    pub(super) fn gather_by_itself(&mut self, frame: &StereoFrame, around: &EyesAround, now: Instant) {
        self.gather(Ask { at: now, by_itself: true }, frame, around);
    }

    fn gather(&mut self, ask: Ask, frame: &StereoFrame, around: &EyesAround) {
        let pairs = vec![pictures(frame)];
        let (opened, due) = (around.source.opened, ask.at + EVERY);
        self.health.gathering = Some(Gathering { ask, opened, pairs, due });
    }

    /// Whether pairs are being gathered.
    pub fn wants_pairs(&self) -> bool {
        self.health.gathering.is_some()
    }

    /// A pair has come while pairs are being gathered.
    pub fn saw(&mut self, frame: &StereoFrame, around: &EyesAround, context: &mut Context<'_>) {
        self.source_changed(around, context);
        self.time_passes(around, context);
        if let Some(judged) = &mut self.health.judged {
            judged.keep_moved(around);
        }
        if self.may_give_way() && around.arm_moves {
            return self.give_way(context);
        }
        let now = context.time.instant;
        let Some(gathering) = &mut self.health.gathering else {
            return self.look_by_itself(frame, around, context);
        };
        if gathering.ask.by_itself && around.arm_moves {
            return self.put_off(now);
        }
        if now < gathering.due {
            return;
        }
        gathering.pairs.push(pictures(frame));
        gathering.due = now + EVERY;
        if gathering.pairs.len() >= PAIRS
            && let Some(Gathering { pairs, ask, .. }) = self.health.gathering.take()
        {
            self.judge_pairs(pairs, ask, around, context);
        }
    }

    /// Whether it is judged and nobody has asked: that ends when the arm begins to move.
    pub fn may_give_way(&self) -> bool {
        self.health.judging.as_ref().is_some_and(|judging| judging.ask.by_itself)
    }

    fn give_way(&mut self, context: &mut Context<'_>) {
        let Some(Judging { job, since, .. }) = self.health.judging.take() else { return };
        context.cancel(job);
        self.rest_since(since, context.time.instant);
        // Whoever has a proposal waits for what is said of it.
        self.look_at_proposal_again(context.time.instant);
    }

    /// Whether somebody has waited for as long as anybody is to wait.
    pub fn is_overdue(&self, now: Instant) -> bool {
        let waits = |ask: &Ask, at_most: Duration| now.saturating_duration_since(ask.at) >= at_most;
        let HealthRoom { gathering, judging, .. } = &self.health;
        gathering.as_ref().is_some_and(|gathering| waits(&gathering.ask, GATHERED_WITHIN))
            || judging.as_ref().is_some_and(|judging| waits(&judging.ask, ANSWERED_WITHIN))
    }

    /// What was seen by now is judged where no more is waited for; and where nothing comes of that, it is said.
    pub fn time_passes(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        if !self.is_overdue(context.time.instant) {
            return;
        }
        if let Some(Gathering { pairs, ask, .. }) = self.health.gathering.take() {
            self.judge_pairs(pairs, ask, around, context);
        } else if let Some(Judging { job, of, ask, since, .. }) = self.health.judging.take() {
            context.cancel(job);
            self.rest_since(since, context.time.instant);
            self.put_off(context.time.instant);
            if !ask.by_itself {
                self.health.ended = Some((of, HealthState::Failed(NO_TIME.to_owned())));
            }
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
        if gathering.ask.by_itself {
            return self.put_off(context.time.instant);
        }
        self.health.gathering = None;
        context.refuse(why);
    }

    fn judge_pairs(
        &mut self,
        pairs: Vec<Pictures>,
        ask: Ask,
        around: &EyesAround,
        context: &mut Context<'_>,
    ) {
        let Some(of) = self.to_be_judged(around) else { return };
        let work = Health {
            pairs,
            in_use: of.in_use.clone(),
            proposed: of.proposed.clone(),
            rig: around.rig.clone(),
            until: ask.at + MATCHED_WITHIN,
        };
        let work = EyesWork::Health(work);
        let job = if ask.by_itself { context.start_by_itself(work) } else { context.start(work) };
        let since = context.time.instant;
        let then = Then { eyes_on_min: self.eyes_on_min(around, since), drifted: around.drifted.clone() };
        self.health.judging = Some(Judging { job, of, ask, since, then });
    }

    /// The calibration in use and the one proposed, by what is before the eyes; `None`: none is in use.
    pub(super) fn to_be_judged(&self, around: &EyesAround) -> Option<Of> {
        let proposed = self.proposal.as_ref().map(|proposal| proposal.calibration.clone());
        let in_use = self.in_use()?.clone();
        let proposed = proposed.filter(|proposed| !Arc::ptr_eq(proposed, &in_use));
        Some(Of { proposed, in_use, source: around.source.spec.clone() })
    }

    fn stop_judging(&mut self, context: &mut Context<'_>) {
        self.health.gathering = None;
        if let Some(judging) = self.health.judging.take() {
            context.cancel(judging.job);
        }
    }

    /// Judged, or why not.
    pub(super) fn judged_health(
        &mut self,
        id: JobId,
        ended: HealthEnded,
        around: &EyesAround,
        context: &mut Context<'_>,
    ) {
        let HealthEnded { state, busy } = ended;
        let Some(Judging { of, ask, then, .. }) = self.health.judging.take_if(|judging| judging.job == id)
        else {
            return;
        };
        self.rest(busy, context.time.instant);
        if let HealthState::Judged(health) = &state {
            let at = context.time.day;
            self.health.judged =
                Some(Judged { of: of.clone(), health: health.clone(), at, then, moved: None });
            let is_told = self.tell_of_health((&of, health), ask, around, context);
            // What cold eyes see says nothing of a calibration that was made warm.
            let says_something =
                health.in_use.is_good || self.to_be_warm_min(around, context.time.instant).is_none();
            if (is_told || !ask.by_itself) && says_something {
                let (at, is_live) = (context.time.day, is_live(&around.source));
                self.health.told = Some(ToldHealth { at, health: health.clone(), is_live });
            }
        }
        // That nothing is seen at night is no news where nobody has asked.
        if !ask.by_itself || matches!(state, HealthState::Judged(_)) || !self.has_ended(&of) {
            self.health.ended = Some((of, state));
        }
    }

    /// What was judged and told last.
    pub fn told_health(&self) -> Option<ToldHealth> {
        self.health.told.clone()
    }

    /// What was judged of these.
    pub(super) fn judged_of(&self, of: &Of) -> Option<&Judged> {
        self.health.judged.as_ref().filter(|judged| judged.of.is(of))
    }

    pub(super) fn has_ended(&self, of: &Of) -> bool {
        self.health.ended.as_ref().is_some_and(|(ended, _)| ended.is(of))
    }

    /// Nothing came of the work.
    pub(super) fn not_judged(&mut self, id: JobId, why: Option<&str>, now: Instant) {
        let Some(Judging { of, ask, since, .. }) = self.health.judging.take_if(|judging| judging.job == id)
        else {
            return;
        };
        self.rest_since(since, now);
        if let Some(why) = why.filter(|_| !ask.by_itself) {
            self.health.ended = Some((of, HealthState::Failed(why.to_owned())));
        }
    }
}

/// Whether more pairs come by themselves.
pub(super) fn goes_on(source: &SourceView) -> bool {
    let plays = source.replay.as_ref().is_none_or(|replay| replay.playing);
    source.status == SourceStatus::Running && !source.photographs && plays
}

fn pictures(frame: &StereoFrame) -> Pictures {
    [frame.left.clone(), frame.right.clone()]
}

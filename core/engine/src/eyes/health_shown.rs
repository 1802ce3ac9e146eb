//! What the window shows of judging, and what follows for a proposal.

use std::time::Instant;

use super::clock::is_live;
use super::health::PAIRS;
use super::health_judged::{Ask, Of};
use super::view::{HealthState, HealthView, ProposalHealth};
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::Time;
use crate::ground::warming::{Warmth, cold_for_min, still_gets_as_warm};

impl EyesWorkflow {
    /// What the window shows of it: of the calibration in use and of the proposal as they are now, and of nothing else.
    pub(super) fn shown_health(&self, around: &EyesAround, instant: Instant) -> HealthView {
        let now = self.to_be_judged(around);
        let is_of_now = |of: &Of| now.as_ref().is_some_and(|now| of.is(now));
        // Looking again by itself leaves what stands there.
        let has_ended = now.as_ref().is_some_and(|now| self.has_ended(now));
        let is_shown = |ask: &Ask| !ask.by_itself || !has_ended;
        let gathering = self.health.gathering.as_ref().filter(|gathering| is_shown(&gathering.ask));
        let gathered = gathering.map(|gathering| gathering.pairs.len());
        let judging = self.health.judging.as_ref().filter(|judging| is_shown(&judging.ask));
        let ended = self.health.ended.as_ref().filter(|(of, _)| is_of_now(of));
        let judged = now.as_ref().and_then(|now| self.judged_of(now));
        let state = match (gathered, judging) {
            (Some(pairs), _) => HealthState::Gathering { pairs, of: PAIRS },
            (None, Some(_)) => HealthState::Judging,
            (None, None) => ended.map_or(HealthState::NotAsked, |(_, state)| state.clone()),
        };
        let colder_wait_min = self.to_be_warm_min(around, instant);
        let on_min = self.eyes_on_min(around, instant);
        let cold_for_min = on_min.and_then(cold_for_min);
        let when = judged.map(|judged| judged.when(around, on_min));
        let does_not_hold = self.does_not_hold().map(str::to_owned);
        let judged = judged.map(|judged| judged.health.clone());
        HealthView { state, judged, when, colder_wait_min, cold_for_min, does_not_hold }
    }

    /// In how many minutes the eyes are as warm as when the calibration in use was made; `None`: they are, or nobody knows.
    pub(super) fn to_be_warm_min(&self, around: &EyesAround, now: Instant) -> Option<f64> {
        let calibrated_min = self.in_use()?.evidence.as_ref()?.minutes_since_on?;
        match Warmth::of(self.eyes_on_min(around, now)?, calibrated_min) {
            Warmth::Colder { wait_min } => Some(wait_min),
            Warmth::Alike | Warmth::Warmer => None,
        }
    }

    /// Whether what these eyes see otherwise than they were calibrated may pass by itself.
    pub(super) fn still_gets_as_warm(&self, around: &EyesAround, now: Instant) -> bool {
        let calibrated_min = || self.in_use()?.evidence.as_ref()?.minutes_since_on;
        let both_min = self.eyes_on_min(around, now).zip(calibrated_min());
        both_min.is_some_and(|(on_min, calibrated_min)| still_gets_as_warm(on_min, calibrated_min))
    }

    /// For how long the eyes have been on, min: a twin's clock runs by itself. `None`: nobody knows.
    pub(super) fn eyes_on_min(&self, around: &EyesAround, now: Instant) -> Option<f64> {
        let of_twin_min = around.twin_on_s.filter(|_| is_live(&around.source)).map(|on_s| on_s / 60.0);
        of_twin_min.or_else(|| self.minutes_since_on(around, now))
    }

    /// Why the proposal is not offered; `None`: it is, or nobody has judged it.
    pub(super) fn not_offered(&self, around: &EyesAround, time: Time) -> Option<&'static str> {
        let judged = self.judged_of(&self.to_be_judged(around)?)?;
        let verdict = judged.health.proposed?.1;
        let is_outdated = judged.when(around, self.eyes_on_min(around, time.instant)).is_outdated(time.day);
        match verdict {
            ProposalHealth::Better | ProposalHealth::Untold | ProposalHealth::KnowsWhen => None,
            _ if is_outdated => Some(
                "When the proposed calibration was judged it was not better than the one in use, but that does not \
                 stand any more: judge it again, then accept or discard it.",
            ),
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

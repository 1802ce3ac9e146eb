//! Judging the calibration when nobody has asked: a proposal as soon as it is there, and the one in use now and then, so
//! that it is said when it does not hold any more.

use std::sync::Arc;
use std::time::{Duration, Instant};

use jiff::Timestamp;
use plumbline_model::{StereoCalibration, StereoFrame};

use super::clock::is_live;
use super::health::goes_on;
use super::health_judged::{Ask, Of};
use super::view::EyesHealth;
use super::work::{Context, at_most_busy};
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::Time;
use crate::ground::notice::NoticeLevel;

/// Eyes that were just opened are left to settle for so long.
const SETTLED: Duration = Duration::from_secs(10);
/// The calibration in use is judged no more often than this …
const PERIOD: Duration = Duration::from_secs(120);
/// … and takes no more than this share of one processor.
const MOST_SHARE: f64 = 0.03;
/// Where it cannot look, it tries again after this time.
const AGAIN: Duration = Duration::from_secs(5);
/// So often in a row it must look bad before that is said: a hand before an eye is no turned eye.
const BAD_IN_A_ROW: u32 = 2;
/// What looked bad is looked at again after this time, whatever that takes: nobody should work long with turned eyes, and
/// by then a hand that passed is gone.
const SOON: Duration = Duration::from_secs(20);

/// When it looks next, and what it has told.
#[derive(Clone, Debug, Default)]
pub(super) struct ByItself {
    /// Of which source, counted.
    opened: u64,
    /// `None`: no pair has come yet.
    due: Option<Instant>,
    /// It could not look: it tries again from then on.
    put_off: Option<Instant>,
    /// The proposal that was looked at, and when it had been judged before, if it had.
    looked_at: Option<(Of, Option<Timestamp>)>,
    /// Which calibration looked bad, and how often in a row.
    bad: Option<(Arc<StereoCalibration>, u32)>,
    /// Which one was said to be bad.
    told: Option<Arc<StereoCalibration>>,
    /// Which one has looked bad more than once, and how bad last.
    off: Option<Off>,
}

/// A calibration that does not hold any more.
#[derive(Clone, Debug)]
struct Off {
    of: Arc<StereoCalibration>,
    /// How bad it is, in words.
    said: String,
    /// How far the right eye has turned against the left one, rad.
    turn_rad: f64,
}

impl EyesWorkflow {
    /// Whether it may be time to look, without being asked: whoever has a proposal may wait for it.
    pub fn may_look(&self, now: Instant) -> bool {
        let health = &self.health;
        self.in_use().is_some()
            && health.gathering.is_none()
            && health.judging.is_none()
            && health.by_itself.put_off.is_none_or(|until| now >= until)
            && (self.is_due(now) || self.proposal.is_some())
    }

    fn is_due(&self, now: Instant) -> bool {
        self.health.by_itself.due.is_none_or(|due| now >= due)
    }

    /// A pair has come, and nothing is being judged.
    pub(super) fn look_by_itself(
        &mut self,
        frame: &StereoFrame,
        around: &EyesAround,
        context: &mut Context<'_>,
    ) {
        let now = context.time.instant;
        let by_itself = &mut self.health.by_itself;
        if by_itself.due.is_none() || by_itself.opened != around.source.opened {
            (by_itself.opened, by_itself.due) = (around.source.opened, Some(now + SETTLED));
            by_itself.bad = None;
        }
        if around.is_watched || around.is_corrected || !is_live(&around.source) {
            // What was seen before says nothing of what is corrected since, and watching says it itself.
            self.health.by_itself.off = None;
        }
        if !self.may_look(now) {
            return;
        }
        let Some(of) = self.to_be_judged(around) else { return };
        let is_proposed = self.is_unseen(&of, around, context.time);
        if !is_proposed && !self.is_due(now) {
            return;
        }
        let sees_now = is_live(&around.source) && goes_on(&around.source);
        // Watching drift says itself when the eyes turn, with the same share; and what a law of time takes off, the
        // calibration alone does not know.
        // Cold eyes do not see as they did when they were calibrated warm, and will again.
        let is_cold = self.still_gets_as_warm(around, now);
        let is_needed = is_proposed || !(around.is_watched || around.is_corrected || is_cold);
        if !sees_now || around.arm_moves || !is_needed {
            return self.put_off(now);
        }
        let judged_at = self.judged_of(&of).map(|judged| judged.at);
        self.health.by_itself.looked_at = of.proposed.is_some().then_some((of, judged_at));
        self.gather_by_itself(frame, around, now);
    }

    /// Whether a proposal waits that nobody has looked at beside the calibration in use, or not since what was judged of
    /// it does not stand any more.
    fn is_unseen(&self, of: &Of, around: &EyesAround, time: Time) -> bool {
        let judged = self.judged_of(of);
        let stands = judged.is_some_and(|judged| {
            !judged.when(around, self.eyes_on_min(around, time.instant)).is_outdated(time.day)
        });
        let looked_at = self.health.by_itself.looked_at.as_ref();
        let is_seen =
            looked_at.is_some_and(|(seen, before)| seen.is(of) && *before == judged.map(|judged| judged.at));
        of.proposed.is_some() && !stands && !is_seen
    }

    /// It cannot look now; what was gathered is let go.
    pub(super) fn put_off(&mut self, now: Instant) {
        if self.health.gathering.take().is_some() {
            self.health.by_itself.looked_at = None;
        }
        self.health.by_itself.put_off = Some(now + AGAIN);
    }

    /// As [`Self::put_off`], and a proposal is not taken for one that was looked at.
    pub(super) fn look_at_proposal_again(&mut self, now: Instant) {
        self.health.by_itself.looked_at = None;
        self.put_off(now);
    }

    /// Nothing came of the work since then: it rests as if that had kept all processors busy until now.
    pub(super) fn rest_since(&mut self, began: Instant, now: Instant) {
        self.rest(at_most_busy(now.saturating_duration_since(began)), now);
    }

    /// Processors were busy with it for so long: it rests until that is a small share of the time.
    pub(super) fn rest(&mut self, busy: Duration, now: Instant) {
        let by_itself = &mut self.health.by_itself;
        by_itself.due = Some(now + PERIOD.max(busy.div_f64(MOST_SHARE)));
    }

    /// Why the calibration in use does not hold any more; `None`: nobody has seen that, or it is told otherwise now.
    pub fn does_not_hold(&self) -> Option<&str> {
        self.off().map(|off| off.said.as_str())
    }

    /// How far the right eye was seen to have turned against the left one since the calibration in use was made, rad; 0:
    /// nobody has seen that, or it is told otherwise now.
    pub fn turned_apart_rad(&self) -> f64 {
        self.off().map_or(0.0, |off| off.turn_rad)
    }

    fn off(&self) -> Option<&Off> {
        let off = self.health.by_itself.off.as_ref()?;
        self.in_use().is_some_and(|in_use| Arc::ptr_eq(&off.of, in_use)).then_some(off)
    }

    /// Says once that the calibration in use does not hold any more, and that it does again; whether it did.
    pub(super) fn tell_of_health(
        &mut self,
        (of, health): (&Of, &EyesHealth),
        ask: Ask,
        around: &EyesAround,
        context: &mut Context<'_>,
    ) -> bool {
        // What a recording shows is told where it was asked for: it is not how these eyes are now.
        if !is_live(&around.source) {
            return false;
        }
        let is_cold = self.still_gets_as_warm(around, context.time.instant);
        let by_itself = &mut self.health.by_itself;
        let is_told = by_itself.told.as_ref().is_some_and(|told| Arc::ptr_eq(told, &of.in_use));
        if health.in_use.is_good {
            (by_itself.bad, by_itself.off) = (None, None);
            if is_told {
                by_itself.told = None;
                context.notices.add(NoticeLevel::Info, "The calibration of the eyes holds again.");
            }
            return is_told;
        }
        if is_cold {
            by_itself.bad = None;
            return false;
        }
        // How another one looked is none of its doing.
        let before = by_itself.bad.take().filter(|(bad, _)| Arc::ptr_eq(bad, &of.in_use));
        let times = before.map_or(0, |(_, times)| times) + 1;
        by_itself.bad = Some((of.in_use.clone(), times));
        if times >= BAD_IN_A_ROW {
            let turn_rad = health.in_use.turn_rad;
            by_itself.off = Some(Off { of: of.in_use.clone(), said: does_not_hold(health), turn_rad });
        } else {
            let soon = context.time.instant + SOON;
            by_itself.due = by_itself.due.map(|due| due.min(soon));
        }
        if !ask.by_itself {
            // Who asked reads it where he has asked.
            by_itself.told = Some(of.in_use.clone());
        } else if times >= BAD_IN_A_ROW && !is_told {
            by_itself.told = Some(of.in_use.clone());
            context.notices.add(NoticeLevel::Warning, does_not_hold(health));
            return true;
        }
        false
    }
}

fn does_not_hold(health: &EyesHealth) -> String {
    let [near_mm, middle_mm, far_mm] = health.in_use.off_m.map(|off_m| 1e3 * off_m);
    format!(
        "The calibration of the eyes does not hold any more: places are off by {near_mm:.0} mm near, {middle_mm:.0} mm in \
         the middle and {far_mm:.0} mm far. Calibrate the eyes again; the screen Drift says what has turned."
    )
}

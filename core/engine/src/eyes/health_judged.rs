//! What is being judged, and what was: of which calibrations, by which eyes, and how things stood then.

use std::sync::Arc;
use std::time::Instant;

use jiff::Timestamp;
use plumbline_hardware::SourceSpec;
use plumbline_model::StereoCalibration;

use super::clock::is_live;
use super::view::{Drifted, EyesHealth, JudgedWhen};
use super::work::Pictures;
use super::workflow::EyesAround;
use crate::ground::jobs::JobId;
use crate::ground::warming::Warmth;

/// When it was asked, and whether nobody did.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ask {
    pub at: Instant,
    pub by_itself: bool,
}

/// Which calibrations are judged, and by what.
#[derive(Clone, Debug)]
pub(super) struct Of {
    pub in_use: Arc<StereoCalibration>,
    pub proposed: Option<Arc<StereoCalibration>>,
    /// What was before the eyes; `None`: nothing is open.
    pub source: Option<SourceSpec>,
}

impl Of {
    /// Whether both are of the same calibrations by the same eyes: what a recording shows of a calibration is not told of
    /// the eyes that are open now. That eyes were closed makes them no other ones.
    pub fn is(&self, other: &Self) -> bool {
        let same = |a: &Arc<StereoCalibration>, b: &Arc<StereoCalibration>| Arc::ptr_eq(a, b);
        let proposed = match (&self.proposed, &other.proposed) {
            (Some(a), Some(b)) => same(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let is_of_other_eyes =
            self.source.as_ref().zip(other.source.as_ref()).is_some_and(|(own, others)| own != others);
        same(&self.in_use, &other.in_use) && proposed && !is_of_other_eyes
    }
}

/// Pairs that are being gathered.
#[derive(Clone, Debug)]
pub(super) struct Gathering {
    pub ask: Ask,
    /// Of which source, counted.
    pub opened: u64,
    pub pairs: Vec<Pictures>,
    pub due: Instant,
}

/// Work that judges.
#[derive(Clone, Debug)]
pub(super) struct Judging {
    pub job: JobId,
    pub of: Of,
    pub ask: Ask,
    pub since: Instant,
    pub then: Then,
}

/// How things stood when the pairs were taken that are judged.
#[derive(Clone, Debug)]
pub(super) struct Then {
    /// For how long the eyes had been on, min; `None`: nobody knows.
    pub eyes_on_min: Option<f64>,
    /// What watching drift said; `None`: nothing of these eyes.
    pub drifted: Option<Drifted>,
}

/// What was judged, of what, and how things stood then.
#[derive(Clone, Debug)]
pub(super) struct Judged {
    pub of: Of,
    pub health: Arc<EyesHealth>,
    pub at: Timestamp,
    pub then: Then,
    /// What came of it; `None`: no pair has come since.
    pub moved: Option<Moved>,
}

/// How far places have moved near, in the middle and far, m, since something was judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    /// Which opening of the eyes the newest pair is of, counted.
    opened: u64,
    /// While they were open before that, at its end.
    before_m: Option<[f64; 3]>,
    /// Since, by that pair.
    told_m: Option<[f64; 3]>,
}

/// What was judged and is told to who keeps it.
#[derive(Clone, Debug)]
pub struct ToldHealth {
    /// When.
    pub at: Timestamp,
    /// What came out.
    pub health: Arc<EyesHealth>,
    /// Whether by what was seen then; else by what was recorded or photographed before.
    pub is_live: bool,
}

impl Judged {
    /// When that was, and what has come since; the eyes have been on for `on_min`, where anybody knows.
    pub fn when(&self, around: &EyesAround, on_min: Option<f64>) -> JudgedWhen {
        let colder = self.was_colder(self.then.eyes_on_min);
        JudgedWhen {
            at: self.at,
            eyes_on_min: self.then.eyes_on_min,
            moved_m: self.moved_m(around),
            colder,
            warmed_since: colder == Some(true) && self.was_colder(on_min) == Some(false)
                || on_min.zip(self.then.eyes_on_min).is_some_and(got_warmer),
        }
    }

    /// Whether eyes that have been on for so many minutes are colder than when the calibration in use was made; `None`:
    /// nobody knows.
    fn was_colder(&self, on_min: Option<f64>) -> Option<bool> {
        let evidence = self.of.in_use.evidence.as_ref();
        let calibrated_min = evidence.and_then(|evidence| evidence.minutes_since_on);
        let warmth = on_min.zip(calibrated_min).map(|(on_min, then_min)| Warmth::of(on_min, then_min));
        warmth.map(|warmth| matches!(warmth, Warmth::Colder { .. }))
    }

    /// A pair has come.
    pub fn keep_moved(&mut self, around: &EyesAround) {
        let opened = around.source.opened;
        if self.of.source == around.source.spec && is_live(&around.source) {
            let (before_m, told_m) = (self.before_m(opened), self.told_m(around));
            self.moved = Some(Moved { opened, before_m, told_m });
        }
    }

    /// How far places have moved since. What watching drift tells begins anew with each opening, but eyes that are closed
    /// and opened again sit as they sat.
    fn moved_m(&self, around: &EyesAround) -> Option<[f64; 3]> {
        let source = &around.source;
        let is_of_these = source.spec.is_none() || is_live(source);
        let before_m = is_of_these.then(|| self.before_m(source.opened)).flatten();
        farther(self.told_m(around), before_m)
    }

    /// How far they had moved when the eyes were opened as they are now; `None`: nothing told.
    fn before_m(&self, opened: u64) -> Option<[f64; 3]> {
        let moved = self.moved?;
        if moved.opened == opened { moved.before_m } else { farther(moved.told_m, moved.before_m) }
    }

    /// The same, as watching drift tells it of the source that is open.
    fn told_m(&self, around: &EyesAround) -> Option<[f64; 3]> {
        let drifted = around.drifted.as_ref().filter(|_| self.of.source == around.source.spec);
        let then = self.then.drifted.as_ref();
        // A recording that is watched again begins before what was judged of it.
        let goes_on =
            |now: &&Drifted| is_live(&around.source) || then.is_some_and(|then| then.watch == now.watch);
        drifted.filter(goes_on).and_then(|now| now.since(then))
    }
}

/// Whether eyes that have been on for the first time are warmer by much than after the second, min.
fn got_warmer((on_min, then_min): (f64, f64)) -> bool {
    Warmth::of(on_min, then_min) == Warmth::Warmer
}

/// The farther of both.
fn farther(a: Option<[f64; 3]>, b: Option<[f64; 3]>) -> Option<[f64; 3]> {
    match (a, b) {
        (Some(a), Some(b)) => Some([0, 1, 2].map(|row| a[row].max(b[row]))),
        (a, b) => a.or(b),
    }
}

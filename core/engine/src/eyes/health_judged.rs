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
    /// When that was, and what has come since.
    pub fn when(&self, around: &EyesAround) -> JudgedWhen {
        let drifted = around.drifted.as_ref().filter(|_| self.of.source == around.source.spec);
        let then = self.then.drifted.as_ref();
        // A recording that is watched again begins before what was judged of it.
        let goes_on =
            |now: &&Drifted| is_live(&around.source) || then.is_some_and(|then| then.watch == now.watch);
        let moved_m = drifted.filter(goes_on).and_then(|now| now.since(then));
        JudgedWhen { at: self.at, eyes_on_min: self.then.eyes_on_min, moved_m }
    }
}

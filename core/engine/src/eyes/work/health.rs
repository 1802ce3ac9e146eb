//! Judges the calibration in use, and a proposed one, by ordinary pairs.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{GrayImage, RgbImage};
use plumbline_model::robot::Rig;
use plumbline_model::{Cancelled, JobContext, StereoCalibration};
use plumbline_vision::health::{
    Better, HealthError, Judged, Match, TableRows, better, find_matches_until, judge,
};

use crate::eyes::view::{EyesHealth, HealthFigures, HealthState, ProposalHealth};
use crate::ground::text::sentence;

/// The images of a pair, left and right.
pub type Pictures = [Arc<RgbImage>; 2];

/// Eyes whose distance differs by more than this share put places elsewhere by as much, which ordinary pairs do not show.
const SAME_DISTANCE: f64 = 0.01;
const NOT_SEEN: &str = "The eyes do not see the table with this calibration: is it one of these eyes?";

/// Judge the calibration in use, and a proposed one.
#[derive(Clone, Debug)]
pub struct Health {
    /// Ordinary pairs, left and right.
    pub pairs: Vec<Pictures>,
    /// The calibration in use.
    pub in_use: Arc<StereoCalibration>,
    /// One that might take its place.
    pub proposed: Option<Arc<StereoCalibration>>,
    /// The robot, for where it works.
    pub rig: Arc<Rig>,
    /// What was seen until then is judged; nobody waits for longer.
    pub until: Instant,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct HealthEnded {
    /// What the pairs say.
    pub state: HealthState,
    /// Time that processors were busy with it, at most.
    pub busy: Duration,
}

/// Time that processors were busy with work that took so long, at most: places are looked for by all of them, and
/// what one of them waits is counted, too.
pub fn at_most_busy(took: Duration) -> Duration {
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    took.saturating_mul(u32::try_from(processors).unwrap_or(u32::MAX))
}

impl Health {
    /// What came out; that the pairs say nothing is an outcome, too.
    pub fn run(self, context: &dyn JobContext) -> Result<HealthEnded, Cancelled> {
        let began = Instant::now();
        let state = self.looked(context)?;
        Ok(HealthEnded { state, busy: at_most_busy(began.elapsed()) })
    }

    fn looked(&self, context: &dyn JobContext) -> Result<HealthState, Cancelled> {
        context.checkpoint()?;
        context.report(0.1, "matching the eyes");
        let gray = |[left, right]: &Pictures| -> (GrayImage, GrayImage) {
            (image::imageops::grayscale(&**left), image::imageops::grayscale(&**right))
        };
        let pairs: Vec<(GrayImage, GrayImage)> = self.pairs.iter().map(gray).collect();
        let is_over = || context.checkpoint().is_err() || Instant::now() >= self.until;
        let matches = match find_matches_until(&self.in_use.cameras, &pairs, &is_over) {
            Ok((matches, _)) => matches,
            Err(error) => return Ok(said(&error)),
        };
        context.checkpoint()?;
        context.report(0.9, "judging");
        Ok(self.judged(&matches).unwrap_or_else(|error| said(&error)))
    }

    fn judged(&self, matches: &[Match]) -> Result<HealthState, HealthError> {
        let cameras = &self.in_use.cameras;
        let table = TableRows::of(&self.rig, cameras);
        let Some(in_use) = judge(cameras, matches, &table)? else {
            return Ok(HealthState::Failed(NOT_SEEN.to_owned()));
        };
        let proposed = match &self.proposed {
            None => None,
            Some(calibration) => {
                let other = &calibration.cameras;
                let Some(judged) = judge(other, matches, &table)? else {
                    return Ok(HealthState::Failed(NOT_SEEN.to_owned()));
                };
                let better = better((cameras, &in_use.turn), (other, &judged.turn), matches)?;
                Some((figures(&judged), proposal_health(&self.in_use, calibration, better)))
            }
        };
        let (pairs, places) = (self.pairs.len(), matches.len());
        let health = EyesHealth { in_use: figures(&in_use), proposed, pairs, places };
        Ok(HealthState::Judged(Arc::new(health)))
    }
}

fn proposal_health(
    in_use: &StereoCalibration,
    proposed: &StereoCalibration,
    better: Better,
) -> ProposalHealth {
    let distance = proposed.cameras.baseline_m() / in_use.cameras.baseline_m();
    let knows_when = |calibration: &StereoCalibration| {
        calibration.evidence.as_ref().is_some_and(|evidence| evidence.minutes_since_on.is_some())
    };
    match better {
        Better::Proposed => ProposalHealth::Better,
        Better::InUse => ProposalHealth::Worse,
        Better::Undecided if (distance - 1.0).abs() > SAME_DISTANCE => ProposalHealth::Untold,
        Better::Undecided if knows_when(proposed) && !knows_when(in_use) => ProposalHealth::KnowsWhen,
        Better::Undecided => ProposalHealth::Undecided,
    }
}

fn figures(judged: &Judged) -> HealthFigures {
    HealthFigures {
        is_good: judged.is_good(),
        off_m: judged.costs.map(|cost| cost.error_m),
        sigma_m: judged.costs.map(|cost| cost.sigma_m),
        turn_rad: judged.turn.angle_rad(),
        epipolar_px: judged.epipolar_px,
    }
}

fn said(error: &HealthError) -> HealthState {
    HealthState::Failed(sentence(&error.to_string()))
}

//! Measures the point under the mouse.

use std::sync::Arc;

use plumbline_model::{Eye, Pixel, Stamp, StereoCalibration, StereoFrame};
use plumbline_vision::locate::{Locator, NoBaseline};

use super::command::ProbePoint;
use super::no_reading::NoReading;
use super::setup::{LiveSetup, fitting};
use super::view::ProbeReading;
use crate::eyes::work::gray;
use crate::ground::stage::Stage;
use crate::ground::watched::WatchedThread;

/// A pair and the point asked for.
#[derive(Clone, Debug)]
pub struct ProbeInput {
    /// The pair.
    pub frame: StereoFrame,
    /// The point.
    pub point: ProbePoint,
    /// What measuring rests on.
    pub setup: Arc<LiveSetup>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct ProbeOutput {
    /// The point asked for.
    pub point: ProbePoint,
    /// Of which setup.
    pub generation: u64,
    /// Where it is, or why that is not known.
    pub reading: Result<ProbeReading, NoReading>,
}

/// Keeps the locator of the calibration in use.
#[derive(Default)]
pub struct ProbeStage {
    locator: Option<(Arc<StereoCalibration>, Locator)>,
}

impl Stage for ProbeStage {
    type Input = ProbeInput;
    type Output = ProbeOutput;
    type Key = (u64, u64, ProbePoint);
    const THREAD: WatchedThread = WatchedThread::Probe;

    fn stamp(input: &ProbeInput) -> Stamp {
        input.frame.stamp
    }

    fn key(input: &ProbeInput) -> Self::Key {
        (input.frame.stamp.seq, input.setup.generation, input.point)
    }

    fn process(&mut self, input: ProbeInput) -> ProbeOutput {
        ProbeOutput { point: input.point, generation: input.setup.generation, reading: self.measure(&input) }
    }
}

impl ProbeStage {
    fn measure(&mut self, input: &ProbeInput) -> Result<ProbeReading, NoReading> {
        let setup = &input.setup;
        let left_raw = match input.point {
            ProbePoint::Raw { eye: Eye::Left, u_px, v_px } => Pixel::new(u_px, v_px),
            ProbePoint::Raw { eye: Eye::Right, .. } => {
                return Err(NoReading::RightEye);
            }
            ProbePoint::Rectified { u_px, v_px } => setup
                .pair
                .raw_from_rectified(Eye::Left, Pixel::new(u_px, v_px))
                .map_err(|_| NoReading::Unseen)?,
        };
        fitting(&input.frame, &setup.pair.cameras)?;
        let locator = self.locator(&setup.calibration)?;
        let mut located = locator.locate(&gray(&input.frame.left), &gray(&input.frame.right), &[left_raw]);
        let located = match located.pop() {
            Some(located) => located?,
            None => return Err(NoReading::Nothing),
        };
        let place = setup.place(&located.point, &located.covariance_m2)?;
        let (_, range_sigma_m) = place.range_m(&setup.robot_from_left().translation_m());
        let in_views = setup.pair.project(located.point).ok();
        let left_rectified =
            in_views.map(|(left, _)| left).filter(|pixel| pixel.is_inside(setup.pair.size_px()));
        Ok(ProbeReading {
            left_raw,
            right_raw: located.match_in_right,
            left_rectified,
            disparity_px: in_views.map(|(left, right)| left.u_px - right.u_px),
            point_in_left: located.point,
            point_in_robot: place.point,
            range_sigma_m,
            sigma_m: place.sigma_m(),
            wide_because: setup.wide_because(),
            model: setup.title.clone(),
        })
    }

    fn locator(&mut self, calibration: &Arc<StereoCalibration>) -> Result<&Locator, NoBaseline> {
        let known = self.locator.take().filter(|(of, _)| Arc::ptr_eq(of, calibration));
        let kept = match known {
            Some(kept) => kept,
            None => (calibration.clone(), Locator::new(calibration)?),
        };
        Ok(&self.locator.insert(kept).1)
    }
}

//! What an attempt rests on: the robot with what was calibrated, and what finds things.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_grasp::attempt::{HandFinder, RenderedHand};
use plumbline_grasp::see::Looker;
use plumbline_grasp::{Corrections, Grasper, Hand, Knowledge, Method};
use plumbline_model::StereoCalibration;
use plumbline_model::robot::Rig;
use plumbline_vision::detect::{DetectSettings, DetectorOptions, EyesDetector, Provider, shipped_detector};

use crate::detect::command::DetectorChoice;
use crate::detect::detector_threads;
use crate::ground::jobs::JobError;

/// What an attempt rests on, as data.
#[derive(Clone, Debug)]
pub struct RestsOn {
    /// The robot as it is known in this world: lenses, mount, place of the screen, effects.
    pub model: Arc<RobotModel>,
    /// The robot as described.
    pub described: Arc<Rig>,
    /// The calibration of the eyes; `None`: the lenses as described.
    pub calibration: Option<Arc<StereoCalibration>>,
    /// Models learned from touches.
    pub corrections: Corrections,
    /// Which detector, computed where.
    pub detector: (DetectorChoice, Provider),
}

impl RestsOn {
    /// All of it, for both hands.
    pub fn grasper(&self, method: Method) -> Result<Grasper, JobError> {
        let knowledge = self.knowledge();
        let looker = Looker::new(self.detector()?, &knowledge, DetectSettings::default());
        let mut finder = |hand: Hand| (method == Method::M5).then(|| self.finder(hand)).flatten();
        Grasper::new(knowledge, looker, &mut finder).map_err(JobError::told)
    }

    /// What is known of the robot.
    pub fn knowledge(&self) -> Knowledge {
        let bare = || Arc::new(StereoCalibration::bare(self.described.eyes.cameras));
        Knowledge {
            model: (*self.model).clone(),
            described: self.described.clone(),
            calibration: self.calibration.clone().unwrap_or_else(bare),
            corrections: self.corrections.clone(),
        }
    }

    fn detector(&self) -> Result<EyesDetector, JobError> {
        let (choice, provider) = &self.detector;
        let options = DetectorOptions {
            provider: *provider,
            threads: Some(detector_threads()),
            shares_processor: true,
            ..DetectorOptions::default()
        };
        let none = || JobError::failed("No detector comes with this version: choose an ONNX file in Detect.");
        let file = match choice {
            DetectorChoice::File(file) => file.clone(),
            // Switched off is the live view; a grasp cannot do without.
            DetectorChoice::Shipped | DetectorChoice::Off => shipped_detector().ok_or_else(none)?.file,
        };
        EyesDetector::open(&file, &options).map_err(JobError::told)
    }

    /// What finds the hand; without it the hand goes by the model alone.
    fn finder(&self, hand: Hand) -> Option<Box<dyn HandFinder>> {
        match RenderedHand::of_rig(self.model.rig(), hand.palm()) {
            Ok(hand) => Some(Box::new(hand)),
            Err(why) => {
                log::warn!("the hand goes by the model alone: {why}");
                None
            }
        }
    }
}

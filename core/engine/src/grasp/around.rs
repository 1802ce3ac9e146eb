//! What grasping can see of the rest.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_grasp::Corrections;
use plumbline_model::StereoCalibration;
use plumbline_model::robot::Rig;
use plumbline_vision::detect::Provider;

use super::rests_on::RestsOn;
use crate::detect::command::DetectorChoice;
use crate::detect::view::DetectionsView;
use crate::robot::view::RobotView;
use crate::source::view::SourceView;

/// What the workflow can see of the rest.
pub struct GraspAround {
    /// The robot as its description has it.
    pub described: Arc<Rig>,
    /// The robot as it is known in this world.
    pub model: Arc<RobotModel>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// The calibration of the eyes; `None`: none was accepted.
    pub calibration: Option<Arc<StereoCalibration>>,
    /// For how long the eyes have been on, min; `None`: nobody knows.
    pub eyes_on_min: Option<f64>,
    /// Why places are in doubt although what they rest on was calibrated: eyes that do not hold any more, a mount of
    /// other eyes, a screen that few touches placed; `None`: nobody has seen that.
    pub in_doubt: Option<String>,
    /// Whether the mount of the eyes was calibrated.
    pub has_mount: bool,
    /// Whether it was measured where the screen lies.
    pub has_screen: bool,
    /// Models learned from touches.
    pub corrections: Corrections,
    /// Which detector, computed where.
    pub detector: (DetectorChoice, Provider),
    /// Where the images come from.
    pub source: Arc<SourceView>,
    /// How old the newest pair of images is, s; `None`: none came yet.
    pub pair_age_s: Option<f64>,
    /// Whether these are the eyes of the robot whose arm is connected.
    pub own_eyes: bool,
    /// What was detected last.
    pub found: Option<Arc<DetectionsView>>,
    /// Whether an experiment makes its attempts.
    pub in_experiment: bool,
    /// Why a run of touches, or a look at the hands, comes first, and what to do; a sentence.
    pub goes_first: Option<&'static str>,
    /// Whether a run of touches is paused: it goes on after what is done here.
    pub touches_paused: bool,
}

impl GraspAround {
    /// What an attempt rests on.
    pub(super) fn rests_on(&self) -> RestsOn {
        RestsOn {
            model: self.model.clone(),
            described: self.described.clone(),
            calibration: self.calibration.clone(),
            corrections: self.corrections.clone(),
            detector: self.detector.clone(),
        }
    }
}

#[cfg(test)]
impl GraspAround {
    /// A robot that is not connected, of which nothing was calibrated.
    pub(crate) fn bare(rig: &Arc<Rig>) -> Self {
        Self {
            described: rig.clone(),
            model: Arc::new(RobotModel::nominal(rig.clone())),
            robot: Arc::default(),
            calibration: None,
            eyes_on_min: None,
            in_doubt: None,
            has_mount: false,
            has_screen: false,
            corrections: Corrections::default(),
            detector: (DetectorChoice::Shipped, Provider::default()),
            source: Arc::default(),
            pair_age_s: None,
            own_eyes: true,
            found: None,
            in_experiment: false,
            goes_first: None,
            touches_paused: false,
        }
    }
}

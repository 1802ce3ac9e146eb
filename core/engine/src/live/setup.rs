//! What rectification and measuring rest on: a calibration, aimed at the workspace.

use std::sync::Arc;

use nalgebra::Matrix3;
use plumbline_effects::robot_model::Turned;
use plumbline_effects::{PlaceInRobot, RobotModel, SeenUnder};
use plumbline_model::aim::DEFAULT_SIZE_PX;
use plumbline_model::camera::ModelKind;
use plumbline_model::robot::Posture;
use plumbline_model::{
    AimError, AimedPair, Eye, LeftCamera, Point, Pose, Robot, StereoCalibration, StereoCameras, StereoFrame,
    Workspace,
};

use super::command::AimChoice;
use super::wide::{SEEN_TURNED, wide_because};
use crate::ground::text::sentence;

/// What rectification and measuring rest on. Results of an older one are not shown any more.
#[derive(Clone, Debug)]
pub struct LiveSetup {
    /// Counts up with every change.
    pub generation: u64,
    /// The calibration in use.
    pub calibration: Arc<StereoCalibration>,
    /// How the virtual pair looks at the workspace.
    pub pair: AimedPair,
    /// Largest disparity that is searched, pixels.
    pub max_disparity_px: u32,
    /// The robot as it is known.
    pub model: Arc<RobotModel>,
    /// What it is called for people.
    pub title: Arc<str>,
    /// How the head stands, the rest of the robot as usual.
    pub posture: Posture,
    /// For how long the eyes have been on, s, where somebody knows it: lenses move as they warm up.
    pub eyes_on_s: Option<f64>,
    /// How far the right eye was seen to have turned against the left one since they were calibrated, rad; 0: nobody has
    /// seen that.
    pub apart_rad: f64,
}

impl LiveSetup {
    /// Where in the robot's frame something is that stereo puts at a point of the left camera
    /// (covariance in its axes, m²).
    ///
    /// # Errors
    /// When the effects leave no such place.
    pub fn place(
        &self,
        in_left: &Point<LeftCamera>,
        covariance_m2: &Matrix3<f64>,
    ) -> Result<PlaceInRobot, NoPlace> {
        let place = self.model.place(in_left, covariance_m2, &self.posture, &self.seen_under());
        place.ok_or(NoPlace)
    }

    /// What the effects of the eyes depend on besides the posture.
    pub fn seen_under(&self) -> SeenUnder {
        SeenUnder { t_secs: self.eyes_on_s, apart_rad: self.apart_rad, ..SeenUnder::default() }
    }

    /// Why the uncertainty of places is wide, or what it leaves out, and what to do; `None`: all that they rest on was
    /// measured with eyes about as warm as now, and says how well it is known.
    pub fn wide_because(&self) -> Option<&'static str> {
        let turned = self.model.turned_since(&self.seen_under());
        let unmeasured = self.model.unmeasured();
        let seen = Turned { apart_rad: self.apart_rad, together_rad: 0.0 };
        // What nobody measured is wider than what was seen to turn.
        if seen.counts() && !unmeasured.mount && !unmeasured.lenses {
            return Some(SEEN_TURNED);
        }
        wide_because(unmeasured, self.calibration.covariance.is_some(), turned)
    }

    /// Where the left eye is.
    pub fn robot_from_left(&self) -> Pose<Robot, LeftCamera> {
        self.model.robot_from_left(&self.posture)
    }
}

/// Why nothing can be rectified or measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSetup {
    /// Nobody calibrated these eyes.
    #[error("The eyes are not calibrated yet. Go to step 1, Eyes, or read a calibration file there.")]
    NotCalibrated,
    /// The virtual pair cannot look so.
    #[error("{}", sentence(&.0.to_string()))]
    Aim(#[from] AimError),
}

/// The effects of the model leave no place for what is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "with the effects of the model in use there is no place that the eyes would see so: measure another point, or \
     look at the model in step 5, Gap"
)]
pub struct NoPlace;

/// Images and calibration do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "The images are {}×{} px, the calibration in use is for {}×{} px. Set the cameras to that size, or calibrate with these images.",
    .images.0,
    .images.1,
    .calibrated.0,
    .calibrated.1
)]
pub struct OtherSize {
    /// Size of the images.
    pub images: (u32, u32),
    /// Size that was calibrated.
    pub calibrated: (u32, u32),
}

/// Whether a pair fits the calibration.
///
/// # Errors
/// When an image has another size than was calibrated.
pub fn fitting(frame: &StereoFrame, cameras: &StereoCameras) -> Result<(), OtherSize> {
    for (eye, image) in [(Eye::Left, &frame.left), (Eye::Right, &frame.right)] {
        let (images, calibrated) = (image.dimensions(), cameras.camera(eye).size_px());
        if images != calibrated {
            return Err(OtherSize { images, calibrated });
        }
    }
    Ok(())
}

/// The virtual pair for a choice.
pub fn aimed(aim: AimChoice, cameras: &StereoCameras, workspace: &Workspace) -> Result<AimedPair, AimError> {
    match aim {
        AimChoice::Table => match AimedPair::suited(cameras, workspace) {
            // A finer lens than NICO's gets a larger view.
            Err(AimError::Coarse { needed_width_px, needed_height_px, .. }) => {
                AimedPair::at_workspace(cameras, workspace, (needed_width_px, needed_height_px))
            }
            aimed => aimed,
        },
        AimChoice::Manual { pitch_rad, horizontal_field_of_view_rad } => {
            let size_px = match cameras.left.model.kind() {
                ModelKind::Fisheye => DEFAULT_SIZE_PX,
                ModelKind::Pinhole => cameras.left.size_px(),
            };
            AimedPair::turned_down(cameras, pitch_rad, horizontal_field_of_view_rad, size_px)
        }
    }
}

/// The disparity of the nearest thing that can be on the table.
pub fn max_disparity_px(pair: &AimedPair, workspace: &Workspace) -> u32 {
    let nearest = workspace
        .corners_in_left(workspace.headroom_m)
        .into_iter()
        .filter_map(|corner| pair.project(corner).ok())
        .map(|(left, right)| left.u_px - right.u_px)
        .reduce(f64::max);
    let (least, most) = SEARCH_LIMITS_PX;
    match (pair.cameras.left.model.kind(), nearest) {
        (ModelKind::Fisheye, Some(nearest_px)) => ((nearest_px * SEARCH_MARGIN) as u32).clamp(least, most),
        _ => SEARCH_USUAL_PX,
    }
}

/// Disparities beyond the nearest corner of the workspace that are searched too.
const SEARCH_MARGIN: f64 = 1.15;

/// Least and most that is searched, pixels.
const SEARCH_LIMITS_PX: (u32, u32) = (32, 256);

/// Searched where the workspace does not say how near things come.
const SEARCH_USUAL_PX: u32 = 128;

//! What the robot and its eyes are, in numbers: frames, pixels, camera models, the stereo
//! rig, the workspace, calibration files and measurement sessions.
//!
//! Pure computation: no device, no window, no OpenCV. Lengths are meters, angles radians,
//! pixels have their origin at the center of the top-left pixel.

pub mod aim;
pub mod calibration;
pub mod camera;
pub mod chessboard;
mod counted;
pub mod decompose;
pub mod detection;
pub mod duration;
pub mod files;
pub mod formats;
pub mod frame;
pub mod image_pair;
pub mod job;
pub mod measured_data;
pub mod number;
pub mod parameter_units;
pub mod parameter_words;
pub mod pixel;
pub mod plausible;
pub mod predict;
pub mod priority;
pub mod robot;
pub mod session;
pub mod session_names;
pub mod spread;
pub mod stereo;
pub mod touch_plan;
pub mod touchscreen;
pub mod workspace;

pub use aim::{AimError, AimedPair};
pub use calibration::{
    CalibrationOptions, CornerResidual, Corners, Evidence, FitSummary, PairFit, PairObservation,
    ParameterCovariance, RejectedPair, StereoCalibration,
};
pub use camera::{Camera, CameraModel, Fisheye, ModelKind, Pinhole, ProjectError};
pub use chessboard::{BoardError, Chessboard, InnerCorners, default_board};
pub use counted::{counted, listed};
pub use detection::{ClassIndex, ClassNames, Detection, PixelBox};
pub use formats::FormatError;
pub use frame::{
    Board, Direction, Frame, LeftCamera, LeftRectified, Point, Pose, RightCamera, RightRectified, Robot,
};
pub use image_pair::{Beside, EyesThen, Stamp, StereoFrame};
pub use job::{Cancelled, CancelledFrom, JobContext, Unattended};
pub use pixel::{Eye, Pixel, PixelSpace, Raw, Rectified};
pub use session::{Session, SessionError};
pub use stereo::StereoCameras;
pub use touch_plan::{
    Pattern, PlanError, PlanOptions, PlannedTouch, Purpose, Side, Sides, TouchArea, TouchPlan,
};
pub use touchscreen::{PlacementError, ScreenPlacement, place_screen};
pub use workspace::Workspace;

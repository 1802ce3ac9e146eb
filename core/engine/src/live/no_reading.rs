//! Why nothing was measured or rectified; stands inside a sentence.

use plumbline_vision::disparity::DisparityError;
use plumbline_vision::locate::{NoBaseline, NotLocated};
use plumbline_vision::rectify::RectifyError;

use super::setup::{NoPlace, OtherSize};

/// Why a point was not measured.
#[derive(Debug, thiserror::Error)]
pub enum NoReading {
    /// Only one image is measured in.
    #[error("points are chosen in the left image; the right one shows where they are found")]
    RightEye,
    /// Outside of the lens.
    #[error("the left eye does not see this place of the view")]
    Unseen,
    /// Images of other eyes.
    #[error(transparent)]
    OtherSize(#[from] OtherSize),
    /// The calibration cannot locate anything.
    #[error(transparent)]
    NoBaseline(#[from] NoBaseline),
    /// This point cannot be located.
    #[error(transparent)]
    Locate(#[from] NotLocated),
    /// No place of the robot's frame looks so.
    #[error(transparent)]
    NoPlace(#[from] NoPlace),
    /// Nothing came back.
    #[error("nothing was measured")]
    Nothing,
}

/// Why a pair was not rectified or matched.
#[derive(Debug, thiserror::Error)]
pub enum NoView {
    /// Rectification.
    #[error(transparent)]
    Rectify(#[from] RectifyError),
    /// Matching.
    #[error(transparent)]
    Disparity(#[from] DisparityError),
}

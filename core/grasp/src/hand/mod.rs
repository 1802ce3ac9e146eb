//! Where the hand is: known from the arm, seen by both eyes.
//!
//! The arm's model says where the hand must be, up to a few millimeters or centimeters. The hand is
//! rendered there from the shapes of the rig's description, into the raw images of both eyes, and
//! the shift is found that makes its outline agree with what they see: the idea of Vicente, Jamone
//! and Bernardino (2016, "Robotic hand pose estimation based on stereo vision and GPU-enabled
//! internal graphical simulation") and of Fantacci et al. (2017, "Visual end-effector tracking using
//! a 3D model-aided particle filter"), solved here by region evidence along lines across the outline
//! (Stoiber et al. 2020, "A sparse Gaussian approach to region-based 6DoF object tracking") and
//! then by fitting colors across it, as model-based edge trackers do (Drummond and Cipolla 2002).
//!
//! Nothing is matched between the eyes, so what lies behind the hand, near or far, cannot take its
//! place. Depth along the rays is weak with short focal lengths and a short baseline (one pixel of
//! disparity is about 20 mm at 0.5 m): there the arm's word counts, and the covariance says how much.
//!
//! Assumes a hand whose shape is about that of the description and whose joints are about as told;
//! its turn and thickness may be off by some degrees and a millimeter or two. Broken by a hand that
//! cannot be told from what is behind it, or that holds something larger than itself: then the
//! answer is a reason, or the covariance stays that of the prior.

mod evidence;
mod find;
mod lines;
mod search;
mod shape;
mod sight;
mod solid;
mod solve;
#[cfg(test)]
mod tests;
mod view;

use image::RgbImage;
use nalgebra::{Matrix3, Vector2, Vector3};
use plumbline_model::Pose;
use plumbline_model::frame::{Robot, Tip};
use plumbline_model::robot::Posture;

pub use find::look_for_hand;
pub use shape::{EyesAt, HandShape, HandShapeError, Part};
pub use view::{HandView, Mask};

use crate::body::Sight;

/// Raw images of both eyes, of one moment.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Left eye.
    pub left: &'a RgbImage,
    /// Right eye.
    pub right: &'a RgbImage,
}

impl<'a> From<&'a Sight> for Pair<'a> {
    fn from(sight: &'a Sight) -> Self {
        Self { left: &sight.left, right: &sight.right }
    }
}

/// Where the hand is by the arm's model.
#[derive(Clone, Debug)]
pub struct Predicted<'a> {
    /// All joints; the hand's own joints give its fingers, the arm's the forearm behind it.
    pub posture: &'a Posture,
    /// Place of the tip that the shape was made for.
    pub robot_from_tip: Pose<Robot, Tip>,
    /// Covariance of that place, robot axes, m².
    pub covariance_m2: Matrix3<f64>,
}

/// How a hand is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandOptions {
    /// Standard deviation of the hand's turn about each axis, rad.
    pub sigma_turn_rad: f64,
    /// Standard deviation of the palm's half extents about those of the description, m.
    pub sigma_palm_m: f64,
    /// Standard deviation of the radius of fingers and thumb about that of the description, m.
    pub sigma_radius_m: f64,
    /// Standard deviation of the place of a straight finger on the hand, m.
    pub sigma_digit_m: f64,
    /// How much more a bent finger may be off, m per rad: real ones bend in two places.
    pub sigma_bent_m: f64,
    /// At least this share of the hand must lie on the image of an eye, 0–1.
    pub least_in_view: f64,
    /// The tip may lie this far off the optical axis of an eye, rad: beyond, the face covers the rim.
    pub most_off_axis_rad: f64,
    /// At most this share of the hand may look like something else, 0–1.
    pub most_hidden: f64,
    /// At least this share of the hand must differ from the pair before, 0–1.
    pub least_changed: f64,
    /// A place that lies farther from the prediction than this, in standard deviations, does not fit.
    pub most_sigmas: f64,
}

impl Default for HandOptions {
    fn default() -> Self {
        Self {
            sigma_turn_rad: 0.06,
            sigma_palm_m: 0.004,
            sigma_radius_m: 0.001,
            sigma_digit_m: 0.002,
            sigma_bent_m: 0.01,
            least_in_view: 0.6,
            most_off_axis_rad: 1.35,
            most_hidden: 0.5,
            least_changed: 0.15,
            most_sigmas: 4.0,
        }
    }
}

/// A hand that was seen.
#[derive(Clone, Debug)]
pub struct HandSeen {
    /// Add this to the predicted place of the tip, robot axes, m.
    pub offset_m: Vector3<f64>,
    /// Covariance of that place: what was known before and what was seen together, robot axes, m².
    pub covariance_m2: Matrix3<f64>,
    /// Turn of the hand against the prediction, rotation vector about the tip, robot axes, rad.
    pub turn_rad: Vector3<f64>,
    /// The predicted place with offset and turn.
    pub robot_from_tip: Pose<Robot, Tip>,
    /// How well it agrees, left eye first; `None`: that eye did not see it.
    pub fit: [Option<EyeFit>; 2],
}

impl HandSeen {
    /// Standard deviation in the worst direction, m.
    pub fn sigma_m(&self) -> f64 {
        // A covariance that cannot be taken apart says that nothing is known.
        plumbline_model::decompose::symmetric_eigenvalues(self.covariance_m2)
            .map_or(f64::INFINITY, |variances| variances.max().max(0.0).sqrt())
    }
}

/// How a hand agrees with the image of one eye.
#[derive(Clone, Debug, PartialEq)]
pub struct EyeFit {
    /// Its outline where it was found.
    pub outline: Vec<OutlinePoint>,
    /// Robust standard deviation of what was measured from that outline, px.
    pub spread_px: f64,
    /// Share of the hand that looks like something else, 0–1.
    pub hidden: f64,
    /// Share of the hand that differs from the pair before, 0–1; `None` without one.
    pub changed: Option<f64>,
}

/// A point of the hand's outline in a raw image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePoint {
    /// Where it is with the place that was found.
    pub pixel_px: Vector2<f64>,
    /// Unit normal, out of the hand.
    pub normal: Vector2<f64>,
    /// Measured minus found, along the normal, px; `None`: nothing could be measured there.
    pub residual_px: Option<f64>,
    /// What it counted, 0–1: 0 for what contradicts the rest.
    pub weight: f64,
}

/// Why a hand was not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HandNotSeen {
    /// It is not on the images.
    #[error(
        "the hand is outside of what the eyes see: turn the head toward it, or bring the hand back over the table"
    )]
    OutsideView,
    /// The images are not of the size of the lenses.
    #[error("the images are not of the size that the calibration is for: calibrate at this size")]
    OtherSize,
    /// The prior covariance cannot be inverted, or a number is not finite.
    #[error("the prediction of the hand's place has no usable uncertainty: give one of some millimeters")]
    NoPrior,
    /// Something is in front of it, or it is not there.
    #[error("{:.0} % of the hand look like something else: take away what is in front of it", 100.0 * share)]
    Hidden {
        /// Share of the hand, 0–1.
        share: f64,
    },
    /// Images before and now are the same where it should be.
    #[error(
        "nothing changed where the hand should be ({:.0} % of it): take the pair before without the hand, or check whether the arm moved",
        100.0 * share
    )]
    NothingChanged {
        /// Share of the hand that differs, 0–1.
        share: f64,
    },
    /// What is seen contradicts the prediction, or the outline is not the hand's.
    #[error(
        "what the eyes see does not fit the hand: {sigmas:.1} standard deviations from where the arm should have it, outline off by {spread_px:.1} px; calibrate the arm or look again"
    )]
    DoesNotFit {
        /// Distance from the prediction in standard deviations of the prior.
        sigmas: f64,
        /// Robust standard deviation of the outline, px.
        spread_px: f64,
    },
}

//! What is said about the objects of a pair of images.

use nalgebra::Matrix3;
use plumbline_model::decompose;
use plumbline_model::{ClassIndex, Eye, LeftCamera, Point};

use super::votes::Votes;

/// One object: a box in one eye or in both, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectPlace {
    /// What it is; where the eyes disagree, what the more confident one says.
    pub class: ClassIndex,
    /// Confidence of the more confident box, 0–1.
    pub confidence: f32,
    /// Which boxes belong to it.
    pub seen: Seen,
    /// Where it is, or why that is not known.
    pub place: Result<Place, NoPlace>,
}

/// Which boxes belong to an object. Indices are those of the lists that were given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// Both eyes have a box of it.
    Both {
        /// Index of the left box.
        left: usize,
        /// Index of the right box.
        right: usize,
        /// How far the middle of the right box lies below (+) or above (−) the epipolar line of
        /// the middle of the left box, raw pixels at the image's center.
        epipolar_px: f64,
        /// What the left and the right eye call it, where they disagree.
        eyes_disagree: Option<[ClassIndex; 2]>,
    },
    /// Only one eye has a box of it.
    One {
        /// Which eye.
        eye: Eye,
        /// Index of the box in that eye's list.
        index: usize,
        /// Why there is no partner.
        why: Unpaired,
    },
}

impl Seen {
    /// Index of its box in an eye's list.
    pub fn index(&self, of: Eye) -> Option<usize> {
        match *self {
            Self::Both { left, right, .. } => Some(if of == Eye::Left { left } else { right }),
            Self::One { eye, index, .. } => (eye == of).then_some(index),
        }
    }
}

/// Why a box has no partner in the other eye.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unpaired {
    /// The other eye has no box of that class, nor of one that looks alike.
    #[error("the other eye has found nothing of this kind")]
    NoneOfThatClass,
    /// The boxes of that class are elsewhere.
    #[error("the other eye's nearest box of this kind is {by_px:.1} px off the epipolar line")]
    OffEpipolarLine {
        /// Distance of the best candidate from the line, px (no sign).
        by_px: f64,
    },
    /// The other eye cannot see that direction at any range of the workspace.
    #[error("the other eye does not see this direction")]
    OutsideOtherView,
    /// Together with the only candidates the object would lie behind the eyes or beyond infinity.
    #[error("with the other eye's box it would lie beyond infinity: not the same object")]
    BeyondInfinity,
    /// It would be nearer than anything can be.
    #[error("with the other eye's box it would be {range_m:.2} m away, nearer than anything can be")]
    TooNear {
        /// Range that the two middles give, m.
        range_m: f64,
    },
    /// It would be farther than the workspace.
    #[error("with the other eye's box it would be {range_m:.1} m away, farther than is looked for")]
    TooFar {
        /// Range that the two middles give, m.
        range_m: f64,
    },
    /// The candidates are much larger or smaller.
    #[error("the other eye's box on the epipolar line has {ratio:.1} times its size")]
    SizesDiffer {
        /// Size of the candidate relative to this box (height or width, whichever differs more).
        ratio: f64,
    },
    /// The candidates fit other boxes better.
    #[error("the other eye's box fits another box better")]
    FitsAnotherBetter,
    /// The middle of the box is outside what the lens sees.
    #[error("the middle of the box lies outside what the lens sees")]
    OutsideLens,
    /// The box has no extent or an edge that is no number.
    #[error("the box has no extent")]
    NotABox,
    /// Only the most confident boxes of an eye are paired.
    #[error("more than {most} boxes in this eye: only the most confident are paired")]
    TooMany {
        /// How many are paired.
        most: usize,
    },
    /// Nothing to pair with.
    #[error("no usable stereo calibration: open one or calibrate, then boxes are paired")]
    NoCalibration,
}

/// Why an object has no place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoPlace {
    /// There is no (usable) calibration.
    #[error("no usable stereo calibration: open one or calibrate, then places are shown")]
    NoCalibration,
    /// The calibration has both eyes in one place.
    #[error("the calibration has no distance between the eyes: calibrate again")]
    NoBaseline,
    /// The images are not of the size that the calibration is for.
    #[error("the images are not of the size that the calibration is for: calibrate at this size")]
    OtherSize,
    /// One eye alone tells no range.
    #[error("only the {0} eye sees it: one eye alone tells no range")]
    OneEye(Eye),
    /// The rays do not meet in front of the eyes, or their uncertainty has no end.
    #[error("the two boxes do not meet in front of the eyes")]
    DoNotMeet,
}

/// A point and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Where.
    pub point: Point<LeftCamera>,
    /// Covariance of the point, m², everything included that is known to be uncertain.
    pub covariance_m2: Matrix3<f64>,
}

impl Estimate {
    /// Standard deviation in the worst direction (nearly along the ray), m.
    pub fn sigma_m(&self) -> f64 {
        // A covariance that cannot be taken apart says that nothing is known.
        decompose::symmetric_eigenvalues(self.covariance_m2)
            .map_or(f64::INFINITY, |variances| variances.max().max(0.0).sqrt())
    }
}

/// Where an object is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Middle of the object's body: what a gripper closes around.
    pub middle: Estimate,
    /// Middle of the surface that it turns to the eyes. It lies in front of `middle` by
    /// `half_depth_m` along the ray.
    pub surface: Estimate,
    /// From the visible surface to the middle, along the ray, m; estimated from the size of the
    /// boxes, because nothing is seen of the far side.
    pub half_depth_m: f64,
    /// Its standard deviation, m.
    pub half_depth_sigma_m: f64,
    /// Width and height of the box at that range, m.
    pub size_m: [f64; 2],
    /// What the range comes from.
    pub from: RangeFrom,
    /// The object's own pixels that were matched.
    pub votes: Votes,
    /// By how much the matched pixels and the middles of the boxes disagree, where it is more
    /// than both admit.
    pub disagreement: Option<Disagreement>,
    /// What lies behind the object would have spoiled a place taken from all pixels of the box.
    pub leak: Option<LeakWarning>,
}

/// What a range comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeFrom {
    /// The object's own pixels, matched, together with the middles of both boxes.
    OwnPixelsAndBoxes,
    /// The middles of both boxes alone: too few of its pixels could be matched.
    BoxesAlone,
}

/// Matched pixels and box middles contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Range by the matched pixels minus range by the boxes (both of the middle), m.
    pub by_m: f64,
    /// The same in standard deviations.
    pub sigmas: f64,
}

/// Pixels of the box that do not belong to the object are at another range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeakWarning {
    /// How far behind the object's surface they are (median), m; negative: in front of it.
    pub behind_m: f64,
    /// Their share of the box's pixels that could be matched, 0–1.
    pub share: f64,
    /// By how much the median range of all matched pixels of the box would have been wrong, m.
    pub median_off_m: f64,
    /// By how much the range matched at the middle of the box would have been wrong, m; `None` if
    /// that pixel could not be matched.
    pub middle_off_m: Option<f64>,
}

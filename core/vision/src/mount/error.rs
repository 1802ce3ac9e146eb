//! Why no mount came out.

use plumbline_model::Cancelled;

/// Why no mount came out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MountError {
    /// Stopped on request.
    #[error("cancelled")]
    Cancelled(#[from] Cancelled),
    /// Not enough to work with.
    #[error(
        "the target is seen in {found} usable view(s), at least {needed} are needed (10 to 20 make a good calibration): turn the head and take more{}", left_out(.rejected)
    )]
    TooFewViews {
        /// Views with enough points.
        found: usize,
        /// Fewest views.
        needed: usize,
        /// Why others could not be used, a sentence each.
        rejected: Vec<String>,
    },
    /// No view shows the target.
    #[error(
        "neither eye sees the target in any of the {views} view(s): put the board where both eyes see all of it, and light it evenly"
    )]
    NotSeen {
        /// Views offered.
        views: usize,
    },
    /// The head did not move.
    #[error(
        "the head stood in only {distinct} different pose(s), at least {needed} are needed: turn it by 10° or more to the sides, up and down between views"
    )]
    SamePose {
        /// Poses that differ from each other.
        distinct: usize,
        /// Fewest.
        needed: usize,
    },
    /// All rotations share an axis.
    #[error(
        "the head turned about one axis only ({turned}): with a board at an unknown place this leaves open how far the eyes are moved along that axis and turned about it. Take views with {missing} changed by 10° or more too"
    )]
    OneAxis {
        /// The joint that moved.
        turned: String,
        /// The joint that did not.
        missing: String,
    },
    /// No majority of views agrees.
    #[error(
        "the views do not agree on where the board lies (only {agreeing} of {views} do): keep the board still and the robot's base fixed while the head turns, and wait until the head stands before each view{}", left_out(.rejected)
    )]
    NoAgreement {
        /// Views that agree.
        agreeing: usize,
        /// Views offered.
        views: usize,
        /// What is wrong with the others, a sentence each.
        rejected: Vec<String>,
    },
    /// The data leave a combination of parameters open.
    #[error(
        "the views do not determine the mount: take more views, with the head turned to the sides, up and down"
    )]
    Undetermined,
    /// A pixel list of the wrong length.
    #[error(
        "view \"{view}\" has {found} points in the {eye} image, the target has {expected}: use the board that the corners were found with"
    )]
    WrongCount {
        /// View.
        view: String,
        /// Eye.
        eye: plumbline_model::Eye,
        /// Points in the list.
        found: usize,
        /// Points of the target.
        expected: usize,
    },
    /// NaN or infinity.
    #[error("{what} is not a number: {remedy}")]
    NotFinite {
        /// Which value.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// An option out of its range.
    #[error("the option {option} is {value}, it must be {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What is right.
        expected: &'static str,
    },
    /// The rig does not fit.
    #[error("the rig {rig} cannot be used for this: {what}")]
    Rig {
        /// Its name.
        rig: String,
        /// What is wrong, and what to do.
        what: String,
    },
    /// No head pose shows the target.
    #[error(
        "{usable} head pose(s) within the limits show the whole target to both eyes, at least {needed} are needed: move the board nearer to the middle in front of the robot, about 0.3 to 0.5 m away"
    )]
    OutOfView {
        /// Head poses that do.
        usable: usize,
        /// Fewest.
        needed: usize,
    },
}

fn left_out(reasons: &[String]) -> String {
    match reasons {
        [] => String::new(),
        reasons => format!(". Left out: {}", reasons.join("; ")),
    }
}

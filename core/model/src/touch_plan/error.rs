//! Why a plan cannot be made.

/// What is wrong with the options of a plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The area has no extent, or is not a number.
    #[error("the area to be touched is empty: drag it over the part of the screen that the arm reaches")]
    AreaEmpty,
    /// The area leaves the screen.
    #[error(
        "the area to be touched goes beyond the screen of {width_px}×{height_px} pixels: make it smaller or move it"
    )]
    AreaOffScreen {
        /// Pixels across.
        width_px: u32,
        /// Pixels down.
        height_px: u32,
    },
    /// Nothing to be touched.
    #[error("no pattern is chosen: choose at least one, such as a grid")]
    NoPattern,
    /// A pattern without a target.
    #[error("the {pattern} has no target: give it at least {least}")]
    EmptyPattern {
        /// Name of the pattern.
        pattern: &'static str,
        /// What it needs.
        least: &'static str,
    },
    /// What tells most is chosen among all touches, by itself.
    #[error(
        "places that tell most are chosen alone, of the screen as it lies and the bare hand: take the other patterns, heights and weights away"
    )]
    TellingAlone,
    /// Nobody but the arm knows where.
    #[error(
        "places that tell most are chosen with the arm: connect to the robot or the twin, and plan there"
    )]
    TellingNeedsArm,
    /// Only repeats of what no pattern has.
    #[error("there is nothing to be repeated: add a grid, lines or random targets")]
    NothingToRepeat,
    /// Each target zero times.
    #[error("every target would be touched zero times: set the repeats to 1 or more")]
    NoRepeats,
    /// No height or weight, a negative one, one twice.
    #[error("the list of {what} {problem}: {advice}")]
    Conditions {
        /// "screen heights" or "weights".
        what: &'static str,
        /// What is wrong.
        problem: String,
        /// What to do.
        advice: &'static str,
    },
    /// Too many touches.
    #[error(
        "the plan has {count} touches, more than {most}: take fewer targets, repeats, sides, heights or weights"
    )]
    TooMany {
        /// How many it would have.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// Placing the screen needs a plane.
    #[error("these targets lie on a line and cannot tell how the screen lies: choose its corners")]
    OnALine,
}

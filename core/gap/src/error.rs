//! Why no search was made.

use plumbline_effects::MeasurementsError;
use plumbline_model::Cancelled;

/// Why no search was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GapError {
    /// Too little to look at.
    #[error("{rows} rows are too few to find anything: measure at least {needed}")]
    TooFew {
        /// There are.
        rows: usize,
        /// Needed.
        needed: usize,
    },
    /// The arm did not move.
    #[error(
        "all {rows} rows are of one pose: they tell how far repeats scatter, but nothing of the arm. Measure at least a \
         dozen poses that differ in every joint"
    )]
    OnePose {
        /// There are.
        rows: usize,
    },
    /// A column is in another unit than its name says.
    #[error(
        "{session}: {column} seems to be {} (against the model off by a factor of {}): correct the column and \
         look again, everything else would be nonsense",
        unit_words(.seems), factor_words(*.factor)
    )]
    WrongUnit {
        /// Which session.
        session: String,
        /// Its column or columns.
        column: String,
        /// The unit that it seems to be in ("millimeters").
        seems: String,
        /// Measured over predicted.
        factor: f64,
    },
    /// Nothing fits, in no unit.
    #[error(
        "{session}: with its frames placed as well as can be, half of the rows still lie more than {:.1} m from where \
         the model of the robot has them: check that the session names the right robot, tip and joints, and the units \
         of its columns", .off_m
    )]
    AnotherRobot {
        /// Which session.
        session: String,
        /// Median distance, m.
        off_m: f64,
    },
    /// A joint turns otherwise than in the model.
    #[error(
        "{session}: joint {joint} {turns} than in the model: with that changed, what is left falls from {:.1} to {:.1} mm. Correct its \
         column (cmd_{joint}_rad, enc_{joint}_rad), or the axis in the robot's description, and look again",
        .off_m * 1e3, .with_m * 1e3
    )]
    OtherTurn {
        /// Which session.
        session: String,
        /// Its joint.
        joint: String,
        /// How.
        turns: Turns,
        /// Typical distance of rows from the model, m.
        off_m: f64,
        /// The same with the joint changed.
        with_m: f64,
    },
    /// Places of an external device are the mirror image of what the arm did.
    #[error(
        "{session}: the measured places are mirrored: with one axis the other way round, what is left falls from {:.1} to \
         {:.1} mm. The frame of the device is left-handed: change the sign of one of meas_x_m, meas_y_m, meas_z_m, leave \
         out orientations (meas_q…) or convert them as well, and look again",
        .off_m * 1e3, .with_m * 1e3
    )]
    Mirrored {
        /// Which session.
        session: String,
        /// Typical distance of rows from the model, m.
        off_m: f64,
        /// The same with the places mirrored back.
        with_m: f64,
    },
    /// A column that should change has one value.
    #[error(
        "{session}: {column} has the same value in every row although the arm moved: it was not logged. Leave the \
         column out or measure again"
    )]
    DeadColumn {
        /// Which session.
        session: String,
        /// Its column.
        column: String,
    },
    /// The model cannot say what most rows should have measured.
    #[error(
        "the model sees only {predictable} of {rows} places: check the rig's eyes and the known places, which lie \
         outside of the eyes' view"
    )]
    OutOfView {
        /// Rows that can be predicted.
        predictable: usize,
        /// All rows.
        rows: usize,
    },
    /// The sessions cannot be looked at.
    #[error(transparent)]
    Measurements(#[from] MeasurementsError),
    /// Cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How a joint turns otherwise than in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turns {
    /// Its axis or its sign is reversed.
    TheOtherWay,
    /// Its column holds twice what the joint turned, as on the motor's side of a gear.
    HalfAsFar,
    /// Its column holds half of what the joint turned.
    TwiceAsFar,
}

impl std::fmt::Display for Turns {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::TheOtherWay => "turns the other way",
            Self::HalfAsFar => "turns half as far",
            Self::TwiceAsFar => "turns twice as far",
        })
    }
}

fn unit_words(seems: &str) -> String {
    if seems.contains(' ') { seems.to_owned() } else { format!("in {seems}") }
}

fn factor_words(factor: f64) -> String {
    if factor >= 1.0 {
        format!("{}", (factor * 10.0).round() / 10.0)
    } else {
        format!("1/{}", (10.0 / factor).round() / 10.0)
    }
}

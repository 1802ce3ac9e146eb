//! What was measured, row by row, as predictions need it: one list for touches, poses and
//! localizations of any number of sessions.

mod derive;
mod read;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Point3};
use plumbline_model::predict::Angles;
use plumbline_model::robot::{DescriptionError, RigError};

use crate::arm::Arm;
use crate::eyes::Eyes;
use crate::library::Surface;

/// All rows of one or several sessions of the same robot.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// Name of the robot.
    pub rig: String,
    /// One per session, in the order given.
    pub apparatuses: Vec<Apparatus>,
    /// Rows that can be used.
    pub rows: Vec<Observation>,
    /// Rows that cannot.
    pub left_out: Vec<LeftOut>,
    /// Effects that the model already has, by [`crate::RigModel`]: every prediction holds them, so
    /// that a search finds what comes in addition. Empty: the nominal robot.
    pub present: Vec<crate::Present>,
}

/// What a session was measured with, nominal.
#[derive(Clone, Debug)]
pub struct Apparatus {
    /// Name of the session.
    pub title: String,
    /// The tip that touched or was measured from outside.
    pub tip: Option<String>,
    /// The arm that ends in it.
    pub arm: Option<Arm>,
    /// The touchscreen.
    pub surface: Option<Surface>,
    /// The eyes.
    pub eyes: Option<Eyes>,
}

/// What a row measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum What {
    /// A fingertip met the touchscreen.
    Touch,
    /// A point of the robot was measured from outside.
    Pose,
    /// The eyes estimated a known place.
    Place,
    /// A known place was seen at a pixel of each eye.
    EyePoints,
}

/// Unit of a natural coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// m.
    Meter,
    /// rad.
    Radian,
    /// Raw pixels.
    Pixel,
}

impl What {
    /// Names and units of what a row of this kind measures.
    ///
    /// - Touch: along u and v of the screen from the middle of the image, and the height of the
    ///   fingertip over the glass (measured: zero).
    /// - Pose: x, y, z in the external frame.
    /// - Place: bearing to the right and down in the left eye (tangents), and the disparity angle
    ///   (baseline over depth), all nearly of the same noise.
    /// - Eye points: u and v in the left image, u and v in the right one.
    pub fn coordinates(self) -> &'static [(&'static str, Unit)] {
        match self {
            Self::Touch => {
                &[("along u", Unit::Meter), ("along v", Unit::Meter), ("height over the glass", Unit::Meter)]
            }
            Self::Pose => &[("x", Unit::Meter), ("y", Unit::Meter), ("z", Unit::Meter)],
            Self::Place => &[
                ("bearing right", Unit::Radian),
                ("bearing down", Unit::Radian),
                ("disparity", Unit::Radian),
            ],
            Self::EyePoints => &[
                ("left u", Unit::Pixel),
                ("left v", Unit::Pixel),
                ("right u", Unit::Pixel),
                ("right v", Unit::Pixel),
            ],
        }
    }

    /// Number of natural coordinates.
    #[allow(clippy::len_without_is_empty)] // Every kind measures something.
    pub fn len(self) -> usize {
        self.coordinates().len()
    }

    /// Whether the frame of the measurement is free against the robot: where the screen or the
    /// external device stands is not known better than by the rows themselves.
    pub fn is_placed(self) -> bool {
        matches!(self, Self::Touch | Self::Pose)
    }

    /// The table that it comes from.
    pub fn table(self) -> &'static str {
        match self {
            Self::Touch => "touches.csv",
            Self::Pose => "poses.csv",
            Self::Place | Self::EyePoints => "localizations.csv",
        }
    }
}

/// One row.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Which session, by place in [`Measurements::apparatuses`].
    pub session: usize,
    /// Row of its table, from 0.
    pub row: usize,
    /// What it measured.
    pub what: What,
    /// Natural coordinates, as [`What::coordinates`].
    pub measured: Vec<f64>,
    /// Commanded angles, one per joint of the arm, where all are known, rad.
    pub commanded_rad: Option<Vec<f64>>,
    /// Encoder readings, the same way.
    pub encoder_rad: Option<Vec<f64>>,
    /// Last motion of each joint: −1, 0 (not known) or 1.
    pub direction: Vec<f64>,
    /// Known mass at the palm, kg.
    pub payload_kg: f64,
    /// Height of the block under the screen, m.
    pub screen_height_m: f64,
    /// Time since power-on of robot or eyes, s.
    pub t_secs: Option<f64>,
    /// Duration of the move, s.
    pub move_secs: Option<f64>,
    /// How long the same pose had been held without a move, s; where the times of its rows say.
    pub hold_secs: Option<f64>,
    /// Mean speed of each joint in the move that led here, rad/s, where the last command and the
    /// duration of the move are known.
    pub speed_rad_s: Option<Vec<f64>>,
    /// Measured torque of each joint, N m, where all are known; positive where it drives the joint
    /// to larger angles, as gravity's does.
    pub torque_nm: Option<Vec<f64>>,
    /// Servo temperature of each joint, °C, where all are known.
    pub temperature_c: Option<Vec<f64>>,
    /// Angles of the joints that carry the eyes, rad.
    pub neck_rad: Vec<f64>,
    /// The known place (robot frame, m) that the eyes looked at.
    pub truth_m: Option<Point3<f64>>,
    /// Distance of what lies behind it, m.
    pub background_m: Option<f64>,
    /// What was seen.
    pub object: Option<String>,
    /// Rows of one cell repeat the same measurement: same command, side, height, weight, session.
    /// Counted from 0 over all sessions.
    pub cell: usize,
    /// Label that blocks cross-validation; rows without one are a block each by [`Self::cell`].
    pub set: Option<String>,
    /// Label of the side of approach.
    pub approach: Option<String>,
}

impl Observation {
    /// The angles that predictions start from: encoder readings where all are there, else the
    /// commanded ones. Empty for what the eyes saw.
    pub fn angles_rad(&self) -> &[f64] {
        self.encoder_rad.as_deref().or(self.commanded_rad.as_deref()).unwrap_or_default()
    }

    /// From which angles predictions start.
    pub fn angles(&self) -> Angles {
        if self.encoder_rad.is_some() { Angles::Encoder } else { Angles::Commanded }
    }

    /// Commanded angle less encoder reading, where both are known, rad.
    pub fn lag_rad(&self) -> Option<Vec<f64>> {
        let (commanded, encoder) = (self.commanded_rad.as_ref()?, self.encoder_rad.as_ref()?);
        Some(commanded.iter().zip(encoder).map(|(c, e)| c - e).collect())
    }
}

/// A row that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LeftOut {
    /// Which session.
    pub session: usize,
    /// Its table.
    pub table: String,
    /// Row of the table, from 0.
    pub row: usize,
    /// Why, in words.
    pub why: String,
}

/// Why sessions cannot be looked at together, or at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasurementsError {
    /// Nothing given.
    #[error("no session was given: choose at least one")]
    NoSession,
    /// Different robots.
    #[error("the sessions are of different robots ({first} and {other}): look at each robot by itself")]
    DifferentRigs {
        /// Of the first session.
        first: String,
        /// Another one.
        other: String,
    },
    /// Different chains.
    #[error(
        "the sessions moved different tips ({first} and {other}): look at the sessions of one tip at a time"
    )]
    DifferentTips {
        /// Of the first session.
        first: String,
        /// Another one.
        other: String,
    },
    /// A part of the manifest is missing.
    #[error("{session} does not say which {section} was used: add [{section}] to its session.toml")]
    Missing {
        /// The session.
        session: String,
        /// The section.
        section: &'static str,
    },
    /// The rig has no such tip or joint.
    #[error("{session} and the robot do not fit together: {error}. Give the rig that it was recorded with")]
    Rig {
        /// The session.
        session: String,
        /// Why.
        error: DescriptionError,
    },
    /// A joint that moves the tip was not logged.
    #[error(
        "{session}: joint {joint} moves {tip} but is not among the joints of its chain: give the rig that it was recorded with"
    )]
    NotLogged {
        /// The session.
        session: String,
        /// The joint.
        joint: String,
        /// The tip.
        tip: String,
    },
    /// The rig was only measured and has no such part.
    #[error("{session}: {error}")]
    Lacks {
        /// The session.
        session: String,
        /// What is lacking.
        error: Box<RigError>,
    },
    /// Nothing left.
    #[error("none of the {rows} rows can be used. The first: {why}")]
    NothingUsable {
        /// Number of rows.
        rows: usize,
        /// Why the first one was left out.
        why: String,
    },
}

impl Measurements {
    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.rows.iter().map(|row| row.cell + 1).max().unwrap_or(0)
    }

    /// Whether any row is of this kind.
    pub fn has(&self, what: What) -> bool {
        self.rows.iter().any(|row| row.what == what)
    }

    /// What is measured with, of a row.
    pub fn apparatus(&self, row: &Observation) -> &Apparatus {
        &self.apparatuses[row.session]
    }

    /// The same with only some rows, by place in [`Self::rows`]; cells keep their numbers.
    pub fn only(&self, rows: impl IntoIterator<Item = usize>) -> Self {
        let rows = rows.into_iter().filter_map(|i| self.rows.get(i).cloned()).collect();
        Self { rows, ..self.clone() }
    }

    /// What is not as it should be although the rows can be used, in words.
    pub fn remarks(&self) -> Vec<String> {
        let arms = self.apparatuses.iter().filter_map(|apparatus| apparatus.arm.as_ref());
        let torques = self.rows.iter().filter(|row| row.what.is_placed());
        let mut remarks = vec![];
        if arms.clone().any(|arm| arm.masses_made_up) {
            let measured = torques.clone().all(|row| row.torque_nm.is_some());
            remarks.push(if measured {
                "The robot's description gives no masses: what gives way under load follows the measured \
                 torques, what gives way sideways or with a weight counts every link as one kilogram."
                    .to_owned()
            } else {
                "The robot's description gives no masses: every link counts as one kilogram, so what gives \
                 way under load has the right shape but not the right size."
                    .to_owned()
            });
        }
        remarks
    }

    /// Frames of all sessions where they are nominally.
    pub fn nominal_placements(&self) -> Vec<Isometry3<f64>> {
        vec![Isometry3::identity(); self.apparatuses.len()]
    }
}

//! What was measured, row by row, as predictions need it: one list for touches, poses and
//! localizations of any number of sessions.

mod copies;
mod derive;
mod lags;
mod read;
#[cfg(test)]
mod tests;

use nalgebra::Isometry3;
use plumbline_model::robot::{DescriptionError, RigError};

use crate::arm::Arm;
use crate::eyes::Eyes;
use crate::library::{Present, Surface};

pub use copies::copies_of_commands;

pub use crate::observation::{Observation, Unit, What};

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
    pub present: Vec<Present>,
}

/// What a session was measured with, nominal.
#[derive(Clone, Debug, Default)]
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
    /// Other frames of the robot that were measured from outside; their joints are the first ones of
    /// the arm's.
    pub markers: Vec<Marker>,
    /// Label of the external frame; sessions of one label share it.
    pub external_frame: Option<String>,
    /// Where the measured point sits at the tip's frame is not known.
    pub tip_is_unknown: bool,
}

/// A frame of the robot beside the chain's tip.
#[derive(Clone, Debug)]
pub struct Marker {
    /// Its name.
    pub name: String,
    /// The arm up to it.
    pub arm: Arm,
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
    /// A column in the unit of another kind of motion.
    #[error(
        "{session}: joint {joint} {moves} in the robot's description: log where it stood in {column}, or give the rig \
         that it was recorded with"
    )]
    OtherMotion {
        /// The session.
        session: String,
        /// The joint.
        joint: String,
        /// "turns" or "slides".
        moves: &'static str,
        /// The column that such a joint has.
        column: String,
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

    /// The arm that ends in what a row measured.
    pub fn arm_of(&self, row: &Observation) -> Option<&Arm> {
        let apparatus = self.apparatus(row);
        match row.marker.checked_sub(1) {
            None => apparatus.arm.as_ref(),
            Some(marker) => apparatus.markers.get(marker).map(|marker| &marker.arm),
        }
    }

    /// The same with only some rows, by place in [`Self::rows`]; cells keep their numbers.
    pub fn only(&self, rows: impl IntoIterator<Item = usize>) -> Self {
        let rows = rows.into_iter().filter_map(|i| self.rows.get(i).cloned()).collect();
        Self { rows, ..self.clone() }
    }

    /// Works out anew what follows from repeats ([`Observation::usual_lag_rad`]), after angles were
    /// changed.
    pub fn complete_lags(&mut self) {
        lags::complete(&mut self.rows, &self.apparatuses);
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

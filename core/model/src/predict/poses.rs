//! Poses: where the frames that the rows name should have been, and what became of rows whose frame nobody declared.

use std::collections::BTreeMap;

use super::{Angles, Arm, PredictError};
use crate::frame::{Point, Robot, Tip};
use crate::robot::Rig;
use crate::session::{Chain as SessionChain, PoseRow, PoseSetup, PoseTable};
use nalgebra::UnitQuaternion;

/// Where the tip should have been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePrediction {
    /// The frame that the row names, else the chain's tip, in the frame of the robot. The external frame of the
    /// measurement need not be the same one.
    pub tip: Point<Robot>,
    /// How it should have been turned, same frame.
    pub turn: UnitQuaternion<f64>,
    /// From which angles.
    pub angles: Angles,
}

/// What became of the rows of `poses.csv` that measured one tip or marker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TipOutcome {
    /// As the rows name it, else the chain's tip.
    pub tip: String,
    /// Number of rows.
    pub rows: usize,
    /// Whose place was predicted.
    pub place: TipPlace,
    /// In words, for people.
    pub words: String,
}

/// Whose place was predicted for what a row measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TipPlace {
    /// That of the frame of this name: it is what was measured.
    Description,
    /// That of the marker, which sits at the frame where a model found it in this session.
    Model {
        /// The session that it was found in.
        session: String,
    },
    /// That of the frame, although what was measured sits elsewhere, and nothing tells where.
    Frame,
    /// None: the rows are not predicted.
    Nowhere,
}

impl TipPlace {
    /// Whether what was measured can be held against what was predicted.
    pub fn is_comparable(&self) -> bool {
        matches!(self, Self::Description | Self::Model { .. })
    }

    /// In a word, as in JSON.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Description => "description",
            Self::Model { .. } => "model",
            Self::Frame => "frame",
            Self::Nowhere => "none",
        }
    }
}

/// Each row is of the frame that it names, else of the chain's tip. `None`: the robot has no such frame, or it does not
/// move with the joints that were logged.
pub(super) fn poses(
    table: &PoseTable,
    rig: &Rig,
    logged: &SessionChain,
    setup: &PoseSetup,
) -> Result<(Vec<Option<PosePrediction>>, Vec<TipOutcome>), PredictError> {
    let mut arms = BTreeMap::from([(logged.tip.clone(), Ok(Arm::of(rig, logged)?))]);
    let mut outcomes: Vec<TipOutcome> = vec![];
    let mut predict = |(i, row): (usize, PoseRow)| -> Result<Option<PosePrediction>, PredictError> {
        let name = row.tip.clone().unwrap_or_else(|| logged.tip.clone());
        let marker = || SessionChain { tip: name.clone(), joints: logged.joints.clone() };
        let arm = arms.entry(name.clone()).or_insert_with(|| Arm::of(rig, &marker()));
        let (place, words) = match arm {
            Err(reason) => (TipPlace::Nowhere, not_predicted(&reason.to_string())),
            Ok(_) if setup.tip_is_unknown && name == logged.tip => (TipPlace::Frame, mounted_anew(&name)),
            Ok(_) => (TipPlace::Description, format!("the frame {name} of the robot's description")),
        };
        TipOutcome { tip: name, rows: 1, place, words }.add_to(&mut outcomes);
        let Ok(arm) = arm else { return Ok(None) };
        let (robot_from_tip, angles) = arm.tip("poses.csv", i + 1, &row.encoder_rad, &row.commanded_rad)?;
        let tip = robot_from_tip * Point::<Tip>::new(0.0, 0.0, 0.0);
        Ok(Some(PosePrediction { tip, turn: robot_from_tip.isometry.rotation, angles }))
    };
    let predicted = table.rows().enumerate().map(&mut predict).collect::<Result<_, _>>()?;
    Ok((predicted, outcomes))
}

impl TipOutcome {
    /// Counts its rows with others to which the same happened.
    pub fn add_to(self, outcomes: &mut Vec<Self>) {
        let same = |other: &&mut Self| {
            (&other.tip, &other.place, &other.words) == (&self.tip, &self.place, &self.words)
        };
        match outcomes.iter_mut().find(same) {
            Some(known) => known.rows += self.rows,
            None => outcomes.push(self),
        }
    }
}

/// Said of rows that are not predicted.
pub fn not_predicted(reason: &str) -> String {
    format!(
        "not predicted: {reason}. Write the name of a frame of the robot into the column tip, or add the frame to its \
         description"
    )
}

fn mounted_anew(tip: &str) -> String {
    format!(
        "the frame {tip} itself: the session says that what was measured was mounted anew there (tip_place), and nothing \
         tells where. Give a model that was found with this session (gap --add, then --rig-model)"
    )
}

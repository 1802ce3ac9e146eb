//! What the model of the robot says that a session should have measured, without any effect:
//! where each touch should have landed, what stereo should have estimated, where the tip should
//! have been seen. The difference to what was measured is the gap.

mod poses;
#[cfg(test)]
mod tests;

pub use poses::{PosePrediction, TipOutcome, TipPlace, not_predicted};

use crate::frame::{Point, Robot, Tip};
use crate::pixel::{Pixel, Raw};
use crate::robot::{Chain, DescriptionError, JointIndex, Posture, Rig};
use crate::session::{
    Chain as SessionChain, LocalizationRow, LocalizationTable, Screen, Session, TouchTable, Touchscreen,
};
use crate::{Pose, ProjectError};

/// One prediction per row, in the order of each table; empty for a table that is not there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SessionPrediction {
    /// `touches.csv`.
    pub touches: Vec<TouchPrediction>,
    /// `localizations.csv`.
    pub localizations: Vec<LocalizationPrediction>,
    /// `poses.csv`; `None` where the robot has no frame for what was measured, as [`Self::tips`] says.
    pub poses: Vec<Option<PosePrediction>>,
    /// What became of the rows of each tip and marker of `poses.csv`.
    pub tips: Vec<TipOutcome>,
}

/// Which joint angles a prediction starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angles {
    /// Encoder readings of all joints of the chain.
    Encoder,
    /// Commanded angles, where a reading is missing.
    Commanded,
}

/// Where a touch should have landed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchPrediction {
    /// The foot of the perpendicular from the fingertip to the glass; it may lie beside the image.
    pub touch: Pixel<Screen>,
    /// Height of the fingertip above the glass, m; negative below it. Zero was measured.
    pub above_glass_m: f64,
    /// From which angles.
    pub angles: Angles,
}

/// What stereo should have estimated, and what its measurement means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalizationPrediction {
    /// The estimate for the known place: without effects, that place.
    pub estimate: Option<Point<Robot>>,
    /// The known place in both images, where image points belong to the table.
    pub pixels: Option<(Pixel<Raw>, Pixel<Raw>)>,
    /// The place that the model infers from what was measured: by triangulation where image points
    /// were logged, else the estimate that was logged. `None` where nothing was measured, or the
    /// rays do not meet in front of the eyes.
    pub corrected: Option<Point<Robot>>,
}

/// Why a session cannot be predicted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictError {
    /// A part of the manifest is missing.
    #[error("the session does not say which {0} was used: add [{0}] to its session.toml")]
    Missing(&'static str),
    /// The touchscreen has no area.
    #[error(
        "the touchscreen of the session has no usable size or axes: correct [touchscreen] in its session.toml"
    )]
    Screen,
    /// The rig has no such tip or joint.
    #[error(
        "the session and the robot do not fit together: {0}. Give the rig that the session was recorded with"
    )]
    Rig(#[from] DescriptionError),
    /// The rig was only measured and has no such part.
    #[error(transparent)]
    Lacks(#[from] crate::robot::RigError),
    /// A row with a number that cannot be.
    #[error("{table}, {what}. Correct the cell, or delete the row: every row is predicted in its place")]
    Implausible {
        /// The table.
        table: &'static str,
        /// Line, column, number, range and likely cause.
        what: String,
    },
    /// A joint that moves the tip was not logged.
    #[error(
        "joint {joint} moves {tip} but is not among the joints of the session's chain: give the rig that the session was recorded with"
    )]
    NotLogged {
        /// The joint.
        joint: String,
        /// The tip.
        tip: String,
    },
    /// Neither angle of a joint in a row.
    #[error(
        "{table}, row {row}: neither the encoder nor the commanded angle of {joint} is there: fill one of them or delete the row"
    )]
    NoAngle {
        /// The table.
        table: &'static str,
        /// Counted from 1 without the header.
        row: usize,
        /// The joint.
        joint: String,
    },
    /// A known place that the eyes cannot see.
    #[error(
        "localizations.csv, row {row}: the known place cannot be projected into the eyes of the model ({reason}): check the place and the head's angles"
    )]
    Unseen {
        /// Counted from 1 without the header.
        row: usize,
        /// Why.
        reason: ProjectError,
    },
}

/// Predicts every row of every table. Fingertips are placed by forward kinematics, from encoder
/// readings where a row has all of them; touches are projected onto the session's touchscreen, or
/// onto `screen` where it was measured to lie, lifted by the block that a row names.
///
/// # Errors
/// When the rig is not the session's, or a row lacks what its prediction needs.
pub fn predict_session(
    session: &Session,
    rig: &Rig,
    screen: Option<&Touchscreen>,
) -> Result<SessionPrediction, PredictError> {
    if let Some((table, _, what)) = session.implausible().next() {
        return Err(PredictError::Implausible { table, what: what.to_owned() });
    }
    let chain = || session.manifest.chain.as_ref().ok_or(PredictError::Missing("chain"));
    let mut prediction = SessionPrediction::default();
    if let Some(table) = &session.touches {
        let screen = screen.or(session.manifest.touchscreen.as_ref());
        let screen = screen.ok_or(PredictError::Missing("touchscreen"))?;
        prediction.touches = touches(table, &Arm::of(rig, chain()?)?, screen)?;
    }
    if let Some(table) = &session.localizations {
        rig.need(crate::robot::RigPart::Eyes)?;
        prediction.localizations = localizations(table, rig)?;
    }
    if let Some(table) = &session.poses {
        let setup = session.manifest.pose_setup();
        (prediction.poses, prediction.tips) = poses::poses(table, rig, chain()?, &setup)?;
    }
    Ok(prediction)
}

fn touches(
    table: &TouchTable,
    arm: &Arm,
    screen: &Touchscreen,
) -> Result<Vec<TouchPrediction>, PredictError> {
    if !screen.is_usable() {
        return Err(PredictError::Screen);
    }
    let predict = |(i, row): (usize, crate::session::TouchRow)| {
        let (robot_from_tip, angles) = arm.tip("touches.csv", i + 1, &row.encoder_rad, &row.commanded_rad)?;
        let tip = robot_from_tip * Point::<Tip>::new(0.0, 0.0, 0.0);
        let screen = screen.raised(row.screen_height_m.unwrap_or(0.0));
        Ok(TouchPrediction { touch: screen.pixel_at(tip), above_glass_m: screen.height_above_m(tip), angles })
    };
    table.rows().enumerate().map(predict).collect()
}

fn localizations(table: &LocalizationTable, rig: &Rig) -> Result<Vec<LocalizationPrediction>, PredictError> {
    let find = |name: &String| rig.description.find_joint(name);
    let head: Vec<JointIndex> = table.head_joints().iter().map(find).collect::<Result<_, _>>()?;
    let has_pixels = table.table().has("left_u_px");
    let home = rig.home();
    let predict = |(i, row): (usize, LocalizationRow)| {
        let robot_from_left = rig.robot_from_left(&posture(&home, &head, &row.head_rad));
        let project = |truth: Point<Robot>| -> Result<_, ProjectError> {
            let in_left = robot_from_left.inverse() * truth;
            let in_right = rig.eyes.cameras.right_from_left * in_left;
            let left = rig.eyes.cameras.left.project(&in_left.coords.coords)?;
            Ok((left, rig.eyes.cameras.right.project(&in_right.coords.coords)?))
        };
        let pixels = row.truth.filter(|_| has_pixels).map(project).transpose();
        let triangulated = row.left.zip(row.right).map(|(left, right)| {
            let in_left = rig.eyes.cameras.triangulate(left, right)?;
            Some(robot_from_left * in_left)
        });
        Ok(LocalizationPrediction {
            estimate: row.truth,
            pixels: pixels.map_err(|reason| PredictError::Unseen { row: i + 1, reason })?,
            corrected: triangulated.unwrap_or(row.estimate),
        })
    };
    table.rows().enumerate().map(predict).collect()
}

/// The head as logged, the rest of the robot in its usual pose.
fn posture(home: &Posture, head: &[JointIndex], angles_rad: &[Option<f64>]) -> Posture {
    let mut posture = home.clone();
    for (joint, angle_rad) in head.iter().zip(angles_rad) {
        posture[*joint] = angle_rad.unwrap_or(home[*joint]);
    }
    posture
}

/// The chain of a session in a rig.
struct Arm {
    chain: Chain,
    /// For each joint of the chain its place among the session's joints.
    order: Vec<usize>,
}

impl Arm {
    fn of(rig: &Rig, logged: &SessionChain) -> Result<Self, PredictError> {
        let chain = Chain::logged(&rig.description, &logged.tip, &rig.home(), &logged.joints)?;
        for joint in &logged.joints {
            if let Some(kind) = rig.description.unmoved_kind(joint) {
                let (joint, kind) = (joint.clone(), kind.to_owned());
                return Err(DescriptionError::Kind { joint, kind }.into());
            }
        }
        let place = |name: &String| {
            let found = logged.joints.iter().position(|joint| joint == name);
            found.ok_or_else(|| PredictError::NotLogged { joint: name.clone(), tip: logged.tip.clone() })
        };
        let order = chain.names().iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { chain, order })
    }

    fn tip(
        &self,
        table: &'static str,
        row: usize,
        encoder_rad: &[Option<f64>],
        commanded_rad: &[Option<f64>],
    ) -> Result<(Pose<Robot, Tip>, Angles), PredictError> {
        let of = |logged: &[Option<f64>]| -> Vec<Option<f64>> {
            self.order.iter().map(|place| logged.get(*place).copied().flatten()).collect()
        };
        let place = |angles_rad: Vec<f64>| self.chain.robot_from_tip(&angles_rad);
        if let Some(angles_rad) = of(encoder_rad).into_iter().collect() {
            return Ok((place(angles_rad), Angles::Encoder));
        }
        let commanded = of(commanded_rad);
        match commanded.iter().position(Option::is_none) {
            None => Ok((place(commanded.into_iter().flatten().collect()), Angles::Commanded)),
            Some(missing) => {
                let joint = self.chain.names()[missing].clone();
                Err(PredictError::NoAngle { table, row, joint })
            }
        }
    }
}

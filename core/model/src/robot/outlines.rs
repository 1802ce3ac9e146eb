//! Straight edges of known place that the eyes can measure by: the frame around the touchscreen's
//! image, and the robot's own body, which tells how the head stands on it.

use nalgebra::Vector3;
use serde::Deserialize;

use super::error::RigError;
use super::rig_file::Reader;
use crate::plausible;

/// What the eyes can measure by. What a rig file does not give is not measured by.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlines {
    /// The monitor's frame.
    pub screen_frame: Option<ScreenFrame>,
    /// The body.
    pub body: Option<BodyEdges>,
}

/// The dark frame around the image of the touchscreen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenFrame {
    /// Width at the left and the right side, m.
    pub side_m: f64,
    /// Width at the side near the robot, m.
    pub near_m: f64,
    /// Its outer edge lies so far below the glass, m.
    pub below_m: f64,
}

/// Edges of the robot's body, which does not move in the robot's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyEdges {
    /// From one end to the other, robot frame, m.
    pub edges_m: Vec<[Vector3<f64>; 2]>,
    /// The body as a whole is where the description has it to within this, standard deviation per axis, m.
    pub shift_sd_m: f64,
    /// The same for its turn, standard deviation per axis, rad.
    pub turn_sd_rad: f64,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct OutlinesPart {
    screen_frame: Option<FramePart>,
    body: Option<BodyPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FramePart {
    side_m: f64,
    near_m: f64,
    below_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyPart {
    edges_m: Vec<[[f64; 3]; 2]>,
    shift_sd_m: f64,
    turn_sd_rad: f64,
}

/// Shorter edges have no direction that could be measured, m.
const SHORTEST_M: f64 = 0.02;

impl Reader<'_> {
    pub(super) fn outlines(&self, part: &OutlinesPart) -> Result<Outlines, RigError> {
        let screen_frame = part.screen_frame.as_ref().map(|frame| self.frame(frame)).transpose()?;
        let body = part.body.as_ref().map(|body| self.body(body)).transpose()?;
        Ok(Outlines { screen_frame, body })
    }

    fn frame(&self, part: &FramePart) -> Result<ScreenFrame, RigError> {
        let FramePart { side_m, near_m, below_m } = *part;
        self.plausible("outlines.screen_frame", plausible::PLACE_M, &[side_m, near_m, below_m])?;
        if side_m < 0.0 || near_m < 0.0 {
            return Err(self.value("outlines.screen_frame", "a width is not negative".to_owned()));
        }
        Ok(ScreenFrame { side_m, near_m, below_m })
    }

    fn body(&self, part: &BodyPart) -> Result<BodyEdges, RigError> {
        let place = "outlines.body";
        self.plausible(place, plausible::PLACE_M, &part.edges_m.concat().concat())?;
        self.plausible(place, plausible::PLACE_M, &[part.shift_sd_m])?;
        self.plausible(place, plausible::ANGLE_RAD, &[part.turn_sd_rad])?;
        if part.shift_sd_m <= 0.0 || part.turn_sd_rad <= 0.0 {
            let what = "shift_sd_m and turn_sd_rad say how well its place is known: they are positive";
            return Err(self.value(place, what.to_owned()));
        }
        let edges_m: Vec<[Vector3<f64>; 2]> =
            part.edges_m.iter().map(|ends| ends.map(Vector3::from)).collect();
        if edges_m.is_empty() || edges_m.iter().any(|[from, to]| (to - from).norm() < SHORTEST_M) {
            let what = format!("it needs at least one edge, and each is at least {SHORTEST_M} m long");
            return Err(self.value(place, what));
        }
        Ok(BodyEdges { edges_m, shift_sd_m: part.shift_sd_m, turn_sd_rad: part.turn_sd_rad })
    }
}

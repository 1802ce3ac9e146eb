//! What a touch is asked for and what it consists of.

use std::time::Duration;

use nalgebra::Vector3;
use plumbline_model::robot::Posture;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::Side;
use plumbline_model::{Direction, Pixel, Point, Robot};
use serde::{Deserialize, Serialize};

/// The tip waits this high above the glass, or above the point that is sent where that is higher, m;
/// it always gets at least as high.
pub(super) const ABOVE_MEASURED_M: f64 = 0.04;
/// So high while the screen was not measured: the real finger may meet it up to 40 mm above its
/// nominal place, m.
const ABOVE_NOMINAL_M: f64 = 0.06;

/// Where the screen is taken to lie, which decides how far the finger stays away from the glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScreenPlace {
    /// Where the rig's description has it: real touches may come much earlier.
    Nominal,
    /// Where touches have shown that it lies.
    Measured,
}

impl ScreenPlace {
    /// The tip waits this high above the glass where the arm gets so high, m.
    pub fn above_m(self) -> f64 {
        match self {
            Self::Nominal => ABOVE_NOMINAL_M,
            Self::Measured => ABOVE_MEASURED_M,
        }
    }
}

/// How a touch is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchPace {
    /// Peak joint speed on the way, rad/s.
    pub speed_rad_s: f64,
    /// Speed of the tip while lowering, m/s.
    pub lower_speed_m_s: f64,
    /// Time after the contact until the encoders are read once more.
    pub dwell: Duration,
    /// A contact farther from the target is somebody else's, m.
    pub plausible_m: f64,
}

impl Default for TouchPace {
    fn default() -> Self {
        Self {
            speed_rad_s: 0.6,
            lower_speed_m_s: 0.02,
            dwell: Duration::from_secs(1),
            // The published robot missed by up to 29 mm before any correction was learned.
            plausible_m: 0.06,
        }
    }
}

impl TouchPace {
    /// At a share of the usual speeds.
    pub fn at(self, share: f64) -> Self {
        Self { speed_rad_s: self.speed_rad_s * share, lower_speed_m_s: self.lower_speed_m_s * share, ..self }
    }
}

/// How the hand is held at a touch, other than as its place has it: what other postures at the same place
/// show of the arm's errors the usual one does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// Turned about the vertical by this much, rad.
    pub turn_rad: f64,
    /// The top of the finger leaned toward the robot's x and y by about this much, rad.
    pub lean_rad: [f64; 2],
}

impl Hold {
    /// Whether it is held as the place has it.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Where the tip's z axis should point.
    pub(super) fn tool_z(self) -> Option<Direction<Robot>> {
        Direction::new(Vector3::new(self.lean_rad[0], self.lean_rad[1], 1.0))
    }
}

/// A touch that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Pixel to be touched.
    pub target: Pixel<Screen>,
    /// Where the tip is to end.
    pub place: Point<Robot>,
    /// The point that is sent for it: beside the place by as much as the arm is known to miss by.
    pub sent: Point<Robot>,
    /// From where the tip comes.
    pub side: Side,
    /// How the hand is held.
    pub hold: Hold,
    /// How much deeper than usual it goes on down where it meets nothing, m: the arm may stand higher than anybody knows.
    pub deeper_m: f64,
}

impl Wanted {
    /// Sent to the place itself, the hand held as it has it.
    pub fn straight(target: Pixel<Screen>, place: Point<Robot>, side: Side) -> Self {
        Self { target, place, sent: place, side, hold: Hold::default(), deeper_m: 0.0 }
    }

    /// Going on deeper by this much where it meets nothing, m.
    pub fn deeper(self, by_m: f64) -> Self {
        Self { deeper_m: by_m, ..self }
    }

    /// The point that is sent, less the place, m.
    pub fn beside_m(&self) -> Vector3<f64> {
        self.sent.coords - self.place.coords
    }
}

/// Postures of one touch.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchPath {
    /// Pixel to be touched.
    pub target: Pixel<Screen>,
    /// The point that is sent.
    pub sent: Point<Robot>,
    /// That point, less the place where the tip is to end; robot axes, m.
    pub beside_m: Vector3<f64>,
    /// How much deeper than usual it goes on down, m.
    pub deeper_m: f64,
    /// On the way to the posture above the target, that one last.
    pub approach: Vec<Posture>,
    /// While lowering, [`STEP_M`] apart, from above to the lowest.
    pub lower: Vec<Posture>,
    /// Place of the tip, by the model, in each posture of `lower`.
    pub lower_tip: Vec<Point<Robot>>,
    /// With the tip at the point that is sent.
    pub contact: Posture,
    /// Sign of each chain joint's motion as the tip comes to the point: −1, 0 or 1.
    pub direction: Vec<i8>,
    /// Azimuth of the tip's x axis, rad.
    pub heading_rad: f64,
    /// Cosine of the finger's inclination at the point, 1 straight down.
    pub upright: f64,
    /// Way of the tip from above to the point, m.
    pub drop_m: f64,
    /// Largest turn of a joint in each leg of the approach, rad.
    pub(super) turns_rad: Vec<f64>,
}

impl TouchPath {
    /// The posture above the target.
    pub fn above(&self) -> &Posture {
        &self.lower[0]
    }

    /// How long it takes, estimated; the contact at the point that is sent.
    pub fn duration(&self, pace: &TouchPace) -> Duration {
        // Each leg comes to rest, and the encoders have to stand still above the target.
        let legs_s: f64 = self.turns_rad.iter().map(|turn| 1.875 * turn / pace.speed_rad_s + 0.15).sum();
        let settle_s = 0.3;
        let lower_s = self.drop_m / pace.lower_speed_m_s + 0.2;
        let up_s = self.contact.distance_rad(self.above()) * 1.875 / pace.speed_rad_s + 0.2;
        Duration::try_from_secs_f64(legs_s + settle_s + lower_s + pace.dwell.as_secs_f64() + up_s)
            .unwrap_or_default()
    }
}

//! What the robot's thread is told about one touch, and what it tells.

use std::time::{Duration, Instant};

use nalgebra::Vector3;
use plumbline_model::robot::{Chain, Posture};
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::{Pixel, Point, Robot};

use crate::motion::{TouchPace, TouchPath};

/// One touch: go above, wait until the arm stands, lower until something is felt, log, go up.
/// Only the joints of one arm move.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchOrder {
    /// Number of the planned touch, from 1.
    pub number: usize,
    /// Counts orders, so that a report is never taken for another's.
    pub order: u64,
    /// Name of the tip that touches.
    pub tip: String,
    /// Postures on the way to the one above the target, the last one above it. Each was checked
    /// against the one before.
    pub approach: Vec<Posture>,
    /// Postures while lowering, a few millimeters apart, the last one the lowest.
    pub lower: Vec<Posture>,
    /// Place of the tip (by the model) in each posture of `lower`.
    pub lower_tip: Vec<Point<Robot>>,
    /// The point that is sent, less the place where the tip is known to end then; robot axes, m.
    pub beside_m: Vector3<f64>,
    /// How much deeper than usual the finger goes on down where it meets nothing, m.
    pub deeper_m: f64,
    /// Speed of the tip while lowering, m/s.
    pub lower_speed_m_s: f64,
    /// Peak joint speed on the way, rad/s.
    pub speed_rad_s: f64,
    /// Time after the contact until the encoders are read once more.
    pub dwell: Duration,
    /// Pixel to be touched.
    pub target: Pixel<Screen>,
    /// A contact farther than this from the target is somebody else's, px.
    pub plausible_px: f64,
}

impl TouchOrder {
    /// The touch along a planned path.
    pub fn along(
        path: TouchPath,
        chain: &Chain,
        screen: &Touchscreen,
        pace: &TouchPace,
        number: usize,
        order: u64,
    ) -> Self {
        let [u_m, v_m] = screen.pitch_m();
        Self {
            number,
            order,
            tip: chain.tip().to_owned(),
            approach: path.approach,
            lower: path.lower,
            lower_tip: path.lower_tip,
            beside_m: path.beside_m,
            deeper_m: path.deeper_m,
            lower_speed_m_s: pace.lower_speed_m_s,
            speed_rad_s: pace.speed_rad_s,
            dwell: pace.dwell,
            target: path.target,
            plausible_px: pace.plausible_m / u_m.min(v_m),
        }
    }
}

/// Away from the screen, so that somebody can reach it: along a way, and the arm stays at its end. The
/// finger is lowered nowhere.
#[derive(Clone, Debug, PartialEq)]
pub struct WithdrawOrder {
    /// Number of the planned touch that waits for it, from 1; `None`: all are done.
    pub number: Option<usize>,
    /// Counts orders, those of touches among them.
    pub order: u64,
    /// Name of the tip that touches.
    pub tip: String,
    /// Postures one after the other, each checked against the one before.
    pub way: Vec<Posture>,
    /// What the touch before was sent beside the place where the tip ended; robot axes, m.
    pub beside_m: Vector3<f64>,
    /// Peak joint speed, rad/s.
    pub speed_rad_s: f64,
}

impl TouchStage {
    /// For people, after the number of the touch.
    pub fn name(self) -> &'static str {
        match self {
            Self::Approaching => "on the way",
            Self::Settling => "settling",
            Self::Lowering => "lowering",
            Self::Dwelling => "on the glass",
            Self::Retreating => "going up",
            Self::Withdrawing => "away from the screen",
        }
    }
}

/// What the arm does in a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchStage {
    /// On the way to above the target.
    Approaching,
    /// Above the target; waits until the encoders stand still.
    Settling,
    /// Lowers.
    Lowering,
    /// Has touched, and stays for a moment.
    Dwelling,
    /// Goes up again.
    Retreating,
    /// Goes away from the screen, so that somebody can reach it.
    Withdrawing,
}

/// How an order is doing.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchNews {
    /// Which order.
    pub order: u64,
    /// Number of the planned touch; `None` on a way that no touch waits for.
    pub number: Option<usize>,
    /// Under way, or ended.
    pub state: TouchRun,
}

/// Under way, or ended.
#[derive(Clone, Debug, PartialEq)]
pub enum TouchRun {
    /// Under way.
    Doing(TouchStage),
    /// There was a contact; the arm is up again.
    Touched(Box<TouchMeasurement>),
    /// There was none; the arm is up again. A sentence: the load was too large, something else touched.
    Missed(String),
    /// There was none: the lowest place was reached, and nothing was met there. The arm is up again.
    MetNothing,
    /// The arm is away from the screen, as it was ordered; nothing was touched.
    Away,
    /// Joints were not heard in time: nothing was refused, and the arm holds where it is. The touch may be
    /// made again once they are heard. A sentence.
    Unheard(String),
    /// The run cannot go on without the operator: STOP, a lost connection, a refused move. The
    /// arm stands where it is. A sentence.
    Interrupted(String),
}

/// What was measured at a contact. Lists are in the order of the tip's chain.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchMeasurement {
    /// First contact.
    pub pixel: Pixel<Screen>,
    /// When.
    pub at: Instant,
    /// Angles commanded at that moment, rad.
    pub commanded_rad: Vec<Option<f64>>,
    /// Place of the tip, by the model, at these angles: where it really was sent. It lies above the
    /// planned point where the arm sags; from a side it lies beside it, too. `None`: not known.
    pub commanded_tip: Option<Point<Robot>>,
    /// Encoders at that moment, rad.
    pub encoder_rad: Vec<Option<f64>>,
    /// Encoders after the dwell, rad.
    pub later_encoder_rad: Vec<Option<f64>>,
    /// Sign of the last motion of each joint: −1, 0 or 1.
    pub direction: Vec<i8>,
    /// Temperatures, °C.
    pub temperature_c: Vec<Option<f64>>,
    /// Loads as signed shares of the stall torque, at the contact.
    pub load: Vec<Option<f64>>,
    /// Duration of the lowering up to the contact, s.
    pub move_secs: f64,
    /// Seconds since the connection was made.
    pub connected_secs: f64,
}

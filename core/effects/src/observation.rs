//! One row of a session as predictions need it, and what it measured.

use nalgebra::{Point3, UnitQuaternion};
use plumbline_model::predict::Angles;

/// What a row measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum What {
    /// A fingertip met the touchscreen.
    Touch,
    /// A point of the robot was measured from outside.
    Pose,
    /// The same with its orientation.
    OrientedPose,
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

/// Pixels that count as one unit of a bearing where pixels were measured.
const PX_PER_RAD: f64 = 500.0;

impl What {
    /// What one unit of a stand's offset is in the natural coordinates of such rows.
    pub(crate) fn offset_unit(self) -> f64 {
        if self == Self::EyePoints { PX_PER_RAD } else { 1.0 }
    }

    /// All of them.
    pub const ALL: [Self; 5] = [Self::Touch, Self::Pose, Self::OrientedPose, Self::Place, Self::EyePoints];

    /// Names and units of what a row of this kind measures.
    ///
    /// - Touch: along u and v of the screen from the middle of the image, and the height of the
    ///   fingertip over the glass (measured: zero).
    /// - Pose: x, y, z in the external frame.
    /// - Oriented pose: the same, and the turn that leads from the measured orientation to the
    ///   predicted one, a rotation vector in the external frame (measured: zero).
    /// - Place: bearing to the right and down in the left eye, and the angle between the rays of both eyes
    ///   (disparity), all nearly of the same noise wherever the place is.
    /// - Eye points: u and v in the left image, u and v in the right one.
    pub fn coordinates(self) -> &'static [(&'static str, Unit)] {
        match self {
            Self::Touch => {
                &[("along u", Unit::Meter), ("along v", Unit::Meter), ("height over the glass", Unit::Meter)]
            }
            Self::Pose => &[("x", Unit::Meter), ("y", Unit::Meter), ("z", Unit::Meter)],
            Self::OrientedPose => &[
                ("x", Unit::Meter),
                ("y", Unit::Meter),
                ("z", Unit::Meter),
                ("turn about x", Unit::Radian),
                ("turn about y", Unit::Radian),
                ("turn about z", Unit::Radian),
            ],
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
        matches!(self, Self::Touch | Self::Pose | Self::OrientedPose)
    }

    /// Whether an external device measured it.
    pub fn is_pose(self) -> bool {
        matches!(self, Self::Pose | Self::OrientedPose)
    }

    /// The table that it comes from.
    pub fn table(self) -> &'static str {
        match self {
            Self::Touch => "touches.csv",
            Self::Pose | Self::OrientedPose => "poses.csv",
            Self::Place | Self::EyePoints => "localizations.csv",
        }
    }
}

/// One row.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Which session, by place in [`crate::Measurements::apparatuses`].
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
    /// How far each servo lags in this pose, rad, where repeats tell it from what encoders happen to read: an
    /// expectation of commanded less encoder angle in which this row's own reading has no part, unless repeats spread
    /// further than readings do.
    pub usual_lag_rad: Option<Vec<f64>>,
    /// Whether the row's own reading has a part in that.
    pub has_own_lag: bool,
    /// What of that goes with the load on the joint, rad: the servo gave way by it.
    pub given_way_rad: Option<Vec<f64>>,
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
    /// Rows of one pose of the arm, whatever was measured of it, counted like [`Self::cell`]; `None`:
    /// those of the cell.
    pub pose: Option<usize>,
    /// Measured orientation of an oriented pose: `external_from_tip`.
    pub orientation: Option<UnitQuaternion<f64>>,
    /// Standard deviation of the instrument along each axis, m, where it is known.
    pub sigma_m: Option<f64>,
    /// Which frame was measured: 0 the chain's tip, else one more than its place in
    /// [`crate::measurements::Apparatus::markers`].
    pub marker: usize,
    /// Encoders are read behind the gears, and see their play.
    pub encoder_behind_gear: bool,
    /// Joints whose encoder column only repeats the command, row after row of the session: nothing was read
    /// there. Empty: none of them.
    pub encoder_copies: Vec<bool>,
    /// Room temperature, °C.
    pub ambient_c: Option<f64>,
    /// Which stand, counted from 0 over all sessions: rows of one thing that stood still while the eyes
    /// that looked at it stood still too, seen again and again. What is constant there is found along with
    /// the effects. `None`: nothing is known of such a thing.
    pub stand: Option<usize>,
}

impl Observation {
    /// A row that nobody measured, of which nothing is known.
    pub fn imagined(what: What) -> Self {
        Self {
            session: 0,
            row: 0,
            what,
            measured: vec![0.0; what.len()],
            commanded_rad: None,
            encoder_rad: None,
            usual_lag_rad: None,
            has_own_lag: false,
            given_way_rad: None,
            direction: vec![],
            payload_kg: 0.0,
            screen_height_m: 0.0,
            t_secs: None,
            move_secs: None,
            hold_secs: None,
            speed_rad_s: None,
            torque_nm: None,
            temperature_c: None,
            neck_rad: vec![],
            truth_m: None,
            background_m: None,
            object: None,
            cell: 0,
            set: None,
            approach: None,
            pose: None,
            orientation: None,
            sigma_m: None,
            marker: 0,
            encoder_behind_gear: false,
            encoder_copies: vec![],
            ambient_c: None,
            stand: None,
        }
    }

    /// The angles that predictions start from: encoder readings where all are there, else the
    /// commanded ones. Empty for what the eyes saw.
    pub fn angles_rad(&self) -> &[f64] {
        self.encoder_rad.as_deref().or(self.commanded_rad.as_deref()).unwrap_or_default()
    }

    /// Whether an encoder told where this joint stood.
    pub fn reads_encoder(&self, joint: usize) -> bool {
        self.encoder_rad.is_some() && !self.encoder_copies.get(joint).copied().unwrap_or(false)
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

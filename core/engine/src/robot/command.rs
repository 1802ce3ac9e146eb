//! Commands about the robot.

use std::path::PathBuf;

use plumbline_model::robot::{JointIndex, Posture};
use serde::{Deserialize, Serialize};

/// The robot: connecting it, and moving it. STOP is not here: it does not queue, see
/// [`crate::Engine::stop`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobotCommand {
    /// Starts the twin and connects to its servos.
    ConnectTwin {
        /// Name of a scenario, see [`crate::view::TwinView::scenarios`].
        scenario: String,
    },
    /// Connects to the servos at a serial port. Nothing moves and no torque is switched.
    ConnectPort {
        /// Path of the port.
        path: PathBuf,
    },
    /// Lets the connection go. The arm holds.
    Disconnect,
    /// Looks which serial ports there are.
    ListPorts,
    /// Asks the bus anew who is there.
    Scan,
    /// Lets servos that wait longer than they need to before each answer wait less. They keep that in
    /// their permanent memory, and take it only while they are limp.
    ShortenAnswers,
    /// Switches the torque of some joints on (they hold where they are) or off (they sink).
    Torque {
        /// Which; empty means all.
        joints: Vec<JointIndex>,
        /// On or off.
        on: bool,
    },
    /// Shows a move without running it.
    Preview(Destination),
    /// Forgets the preview.
    ClearPreview,
    /// Runs the move that is shown.
    RunPreview,
    /// Moves a tip steadily; to be sent again at least every [`JOG_DEADLINE_MS`] while the key is
    /// held, and stops by itself without.
    Jog(JogRates),
    /// Stops jogging at once.
    EndJog,
    /// Which tip jogging and Cartesian targets speak of.
    ChooseTip {
        /// A link of the description.
        link: String,
    },
    /// Share of the usual speed for moves and jogging, 0–2.
    Speed(f64),
    /// Releases a latched STOP. Nothing moves by that.
    ReleaseStop,
    /// Saves the present posture of some joints under a name.
    SavePose {
        /// Name for people.
        title: String,
        /// Which; empty means all.
        joints: Vec<JointIndex>,
    },
    /// Deletes one of the operator's own poses.
    DeletePose {
        /// Its short name.
        name: String,
    },
    /// Forgets the refusal that is shown.
    DismissRefusal,
}

/// A jog command is valid for this long.
pub const JOG_DEADLINE_MS: u64 = 200;

/// Where a move goes. Joints that are not spoken of stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Destination {
    /// One joint to an angle (rad).
    Joint {
        /// Which.
        joint: JointIndex,
        /// Where to.
        angle_rad: f64,
    },
    /// A pose of the library.
    Pose {
        /// Its short name.
        name: String,
    },
    /// All joints.
    Posture(Posture),
    /// The chosen tip to a place, its direction free.
    TipPosition {
        /// Robot frame, m.
        point_m: [f64; 3],
    },
    /// The chosen tip to a place, pointing down, turned about the vertical.
    TipPositionYaw {
        /// Robot frame, m.
        point_m: [f64; 3],
        /// Turn about the vertical, rad.
        yaw_rad: f64,
    },
    /// The head looks at a point.
    LookAt {
        /// Robot frame, m.
        point_m: [f64; 3],
    },
}

/// How fast a tip is jogged, robot frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JogRates {
    /// m/s.
    pub velocity_m_s: [f64; 3],
    /// About the vertical, rad/s.
    pub yaw_rad_s: f64,
}

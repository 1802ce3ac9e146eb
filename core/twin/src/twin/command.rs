//! What can be asked of the twin, and what it shows.

use nalgebra::Vector3;
use plumbline_model::{Board, Pose, Robot};

use crate::servos::Fault;
use crate::toys::Toy;

/// What can be done to the twin's world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TwinCommand {
    /// Puts a toy on the table.
    PlaceObject {
        /// Which.
        toy: Toy,
        /// Robot frame, m.
        x_m: f64,
        /// Robot frame, m.
        y_m: f64,
    },
    /// Puts a toy away.
    RemoveObject {
        /// Which.
        toy: Toy,
    },
    /// Holds the chessboard somewhere.
    PlaceBoard {
        /// Where.
        robot_from_board: Pose<Robot, Board>,
    },
    /// Puts the chessboard away.
    HideBoard,
    /// Puts the touchscreen on a block and a weight into the right palm.
    PrepareTouch {
        /// Height of the block, m.
        screen_height_m: f64,
        /// The weight, kg.
        payload_kg: f64,
    },
    /// Lets the clock of the eyes' warming up run ahead.
    AdvanceWarmUp {
        /// Minutes.
        minutes: f64,
    },
    /// Lets the clock of the eyes' warming up run faster than everything else.
    WarmUpPace {
        /// Times, 1–60.
        times: f64,
    },
    /// Switches the eyes off until they are cold, and on again: their clock starts anew.
    CoolEyes,
    /// Switches a fault of the servo bus on or off.
    Fault {
        /// Which.
        fault: Fault,
        /// On or off.
        on: bool,
    },
    /// Switches all faults off.
    ClearFaults,
    /// Simulated seconds per second.
    Pace(f64),
    /// Everything as at the start; faults end, the servos' registers stay.
    Reset,
}

/// What the operator may see of the twin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TwinState {
    /// Simulated time, s.
    pub time_s: f64,
    /// Since when the eyes are on, s.
    pub eyes_on_s: f64,
    /// How many times faster than everything else the eyes' clock runs.
    pub warm_up_pace: f64,
    /// Simulated seconds per second, over the last second.
    pub real_time_factor: f64,
    /// Toys and the place of their middle; `None`: put away.
    pub toys: Vec<(Toy, Option<Vector3<f64>>)>,
    /// Where the chessboard is held.
    pub board: Option<Pose<Robot, Board>>,
    /// Height of the block under the touchscreen, m.
    pub screen_height_m: f64,
    /// Weight in the right palm, kg.
    pub payload_kg: f64,
    /// Faults that are on.
    pub faults: Vec<Fault>,
    /// Why the last command that was refused was.
    pub refusal: Option<String>,
}

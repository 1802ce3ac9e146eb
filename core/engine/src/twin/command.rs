//! Commands of the twin.

use serde::{Deserialize, Serialize};

/// The twin: what stands on its table, its clock, its faults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TwinCommand {
    /// Puts a toy on the table.
    PlaceToy {
        /// Its name.
        toy: String,
        /// Robot frame, m.
        x_m: f64,
        /// Robot frame, m.
        y_m: f64,
    },
    /// Puts a toy away.
    RemoveToy {
        /// Its name.
        toy: String,
    },
    /// Holds the chessboard at one of the places made for calibrating the eyes.
    HoldBoard {
        /// 0 to [`crate::view::TwinView::board_places`] − 1.
        place: usize,
    },
    /// Lays the chessboard flat on the table.
    LayBoard {
        /// Center, robot frame, m.
        x_m: f64,
        /// Center, robot frame, m.
        y_m: f64,
        /// Turn about the vertical, rad.
        yaw_rad: f64,
    },
    /// Shows the board at all places one after the other, each for a moment, so that pairs can be
    /// captured by themselves.
    TourBoard(bool),
    /// The same at the few places that suffice where the board is then looked at as it lies on the table.
    TourFew,
    /// Goes on with showing it where that was broken off.
    TourRest,
    /// Goes on to the next place, whether or not it was captured where it is.
    SkipPlace,
    /// Puts the chessboard away.
    HideBoard,
    /// Makes room on the touchscreen, puts it on a block and a weight into the right palm.
    PrepareTouch {
        /// Height of the block, m.
        screen_height_m: f64,
        /// The weight, kg.
        payload_kg: f64,
    },
    /// Nobody touches the screen any more: toys that made room on it stand where they stood.
    EndTouch,
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
    /// Switches the eyes off and on: they are cold again.
    CoolEyes,
    /// Switches a fault on or off.
    Fault {
        /// Its short name, see [`crate::view::TwinView::faults`].
        name: String,
        /// On or off.
        on: bool,
    },
    /// Puts everything back as it was at the start; the scenario stays.
    Reset,
}

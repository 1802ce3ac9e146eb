//! How the twin is looked at.

/// How the twin is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct TwinPanels {
    /// The toy that a click on the table puts down, by its place in the list.
    pub chosen_toy: Option<usize>,
    /// Place at which the board is held next, counted from 1 as on screen.
    pub board_place: usize,
}

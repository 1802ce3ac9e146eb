//! What the chessboard search saw.

use std::sync::Arc;

use image::GrayImage;
use plumbline_model::{Chessboard, Corners, StereoFrame};

use super::view::BoardSeen;

/// What the overlay saw in one pair.
#[derive(Clone, Debug)]
pub struct Look {
    /// The pair.
    pub frame: StereoFrame,
    /// The board that was looked for.
    pub board: Chessboard,
    /// Corners in the left eye.
    pub left: Option<Corners>,
    /// Corners in the right eye.
    pub right: Option<Corners>,
    /// Gray levels of both images.
    pub gray: [Arc<GrayImage>; 2],
    /// Median width of the board's edges, the wider of both eyes, pixels.
    pub edge_width_px: Option<f64>,
    /// Which board is seen instead, looked for now and then.
    pub other_board: Option<BoardSeen>,
}

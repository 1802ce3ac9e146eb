//! Finds the chessboard in one image.
//!
//! Two ways, one result. [`glimpse`] grows a grid from saddle points in a few milliseconds, with
//! or without a board in view, and is what the live path uses. [`find`] tries that first and
//! then OpenCV's exhaustive search (without `CALIB_CB_FAST_CHECK`, which loses most fisheye
//! views), which may take half a second when there is no board.

mod grid;
mod order;
mod refine;
mod saddle;
#[cfg(test)]
mod tests;

use image::GrayImage;
use image::imageops::{self, FilterType};
use nalgebra::Vector2;
use opencv::core::{Mat, Point2f, Size, Vector as CvVector};
use plumbline_model::{Chessboard, Corners, InnerCorners, PairObservation, Pixel, Raw};

/// Why no board was found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotSeen {
    /// Nothing that looks like a chessboard.
    #[error("no chessboard is visible: show the whole board, flat, sharp and evenly lit")]
    Nothing,
    /// A board, but not the one asked for.
    #[error(
        "a board of {seen_columns}x{seen_rows} inner corners is visible, not {columns}x{rows}: \
         either part of it is hidden or the board size is set wrong"
    )]
    OtherBoard {
        /// Inner corners asked for, along a row.
        columns: u32,
        /// Inner corners asked for, along a column.
        rows: u32,
        /// Inner corners seen, the longer side.
        seen_columns: u32,
        /// Inner corners seen, the shorter side.
        seen_rows: u32,
    },
    /// Too small an image, or OpenCV refused it.
    #[error("the image cannot be searched for a chessboard: {0}")]
    BadImage(String),
}

/// What both eyes saw of the board, and why an eye did not.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSighting {
    /// Corners of both eyes, counted from the same end of the board.
    pub observation: PairObservation,
    /// For left and right: why no board was found.
    pub not_seen: [Option<NotSeen>; 2],
}

/// [`find`] in both eyes.
pub fn find_in_pair(name: &str, left: &GrayImage, right: &GrayImage, board: &Chessboard) -> PairSighting {
    let (left, right) = rayon::join(|| find(left, board), || find(right, board));
    pair_up(name, board, left, right)
}

/// Joins what was found in the two images of a pair.
pub fn pair_up(
    name: &str,
    board: &Chessboard,
    left: Result<Vec<Pixel<Raw>>, NotSeen>,
    right: Result<Vec<Pixel<Raw>>, NotSeen>,
) -> PairSighting {
    let right = match &left {
        Ok(left) => right.map(|right| order::align(board, left, right)),
        Err(_) => right,
    };
    let corners = |found: &Result<Vec<Pixel<Raw>>, NotSeen>| -> Option<Corners> {
        found.as_ref().ok().map(|corners| corners.iter().copied().map(Some).collect())
    };
    PairSighting {
        observation: PairObservation { name: name.to_owned(), left: corners(&left), right: corners(&right) },
        not_seen: [left.err(), right.err()],
    }
}

/// Finds all inner corners of `board`, to a fraction of a pixel, in the board's order.
pub fn find(gray: &GrayImage, board: &Chessboard) -> Result<Vec<Pixel<Raw>>, NotSeen> {
    if let Some(corners) = glimpse(gray, board) {
        return Ok(corners);
    }
    if gray.width() < 32 || gray.height() < 32 {
        return Err(NotSeen::BadImage(format!("it is only {}x{} pixels", gray.width(), gray.height())));
    }
    if let Some(corners) = search_with_opencv(gray, board)? {
        let (columns, rows) = (board.inner_columns as usize, board.inner_rows as usize);
        let ordered = order::to_board_order(gray, board, columns, rows, &corners);
        return ordered.and_then(|corners| refine::refine(gray, board, &corners)).ok_or(NotSeen::Nothing);
    }
    Err(match recognize(gray) {
        Some(seen) if !same_board(seen, board) => NotSeen::OtherBoard {
            columns: board.inner_columns,
            rows: board.inner_rows,
            seen_columns: seen.columns,
            seen_rows: seen.rows,
        },
        _ => NotSeen::Nothing,
    })
}

/// Finds the board if it is easily seen; a few milliseconds at 640×480 either way.
pub fn glimpse(gray: &GrayImage, board: &Chessboard) -> Option<Vec<Pixel<Raw>>> {
    let (columns, rows) = (board.inner_columns as usize, board.inner_rows as usize);
    let filled =
        LOOKS.iter().find_map(|look| look.grid(gray, |saddles, grid| grid.board(saddles, columns, rows)))?;
    let corners = order::to_board_order(gray, board, filled.columns, filled.rows, &filled.corners)?;
    refine::refine(gray, board, &corners)
}

/// Size of whatever chessboard is visible, longer side first; for telling an operator that the
/// board size is set wrong.
pub fn recognize(gray: &GrayImage) -> Option<InnerCorners> {
    const SMALLEST_BOARD: usize = 12;
    let full = |filled: &grid::FilledGrid| {
        filled.corners.len() >= SMALLEST_BOARD && filled.columns.min(filled.rows) >= 3
    };
    let filled =
        LOOKS.iter().find_map(|look| look.grid(gray, |saddles, grid| grid.filled(saddles).filter(full)))?;
    Some(inner_corners(&filled))
}

/// One way to look for saddles.
struct Look {
    half_size: bool,
    detail: saddle::Detail,
}

/// In the order of how often they succeed.
const LOOKS: [Look; 3] = [
    Look { half_size: false, detail: saddle::Detail::Normal },
    Look { half_size: false, detail: saddle::Detail::Fine },
    // Blurred or grainy boards show at half size.
    Look { half_size: true, detail: saddle::Detail::Normal },
];

impl Look {
    /// Hands grids to `choose` until it likes one; corners in pixels of `gray`.
    fn grid(
        &self,
        gray: &GrayImage,
        choose: impl Fn(&[saddle::Saddle], &grid::Grid) -> Option<grid::FilledGrid>,
    ) -> Option<grid::FilledGrid> {
        let half;
        let image = if self.half_size {
            half = imageops::resize(gray, gray.width() / 2, gray.height() / 2, FilterType::Triangle);
            &half
        } else {
            gray
        };
        let saddles = saddle::find(image, self.detail);
        let mut filled = grid::first_grid(&saddles, |grid| choose(&saddles, grid))?;
        if self.half_size {
            for corner in &mut filled.corners {
                // Pixel centers: half-size pixel i covers full-size pixels 2i and 2i + 1.
                *corner = *corner * 2.0 + Vector2::new(0.5, 0.5);
            }
        }
        Some(filled)
    }
}

fn inner_corners(grid: &grid::FilledGrid) -> InnerCorners {
    let (a, b) = (grid.columns as u32, grid.rows as u32);
    InnerCorners { columns: a.max(b), rows: a.min(b) }
}

fn same_board(seen: InnerCorners, board: &Chessboard) -> bool {
    let (a, b) = (board.inner_columns, board.inner_rows);
    seen == InnerCorners { columns: a.max(b), rows: a.min(b) }
}

/// OpenCV's search in the image.
fn search_with_opencv(gray: &GrayImage, board: &Chessboard) -> Result<Option<Vec<Vector2<f64>>>, NotSeen> {
    let refused = |e: opencv::Error| NotSeen::BadImage(crate::cv_words::words(&e).to_owned());
    let mat = Mat::new_rows_cols_with_data(gray.height() as i32, gray.width() as i32, gray.as_raw())
        .map_err(refused)?;
    let size = Size::new(board.inner_columns as i32, board.inner_rows as i32);
    let flags = opencv::calib3d::CALIB_CB_ADAPTIVE_THRESH | opencv::calib3d::CALIB_CB_NORMALIZE_IMAGE;
    let mut points = CvVector::<Point2f>::new();
    let found = opencv::calib3d::find_chessboard_corners(&mat, size, &mut points, flags).map_err(refused)?;
    Ok((found && points.len() == board.corner_count())
        .then(|| points.iter().map(|p| Vector2::new(f64::from(p.x), f64::from(p.y))).collect()))
}

//! Finds the board in one pair, thoroughly.

use std::sync::Arc;

use image::{GrayImage, RgbImage};
use plumbline_model::{Chessboard, Corners, Eye, InnerCorners, StereoFrame};
use plumbline_vision::chessboard::{self, NotSeen};

use crate::eyes::view::{BoardSeen, CollectedPair};
use crate::ground::jobs::JobError;

/// Find the board in one pair.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The pair.
    pub frame: StereoFrame,
    /// Its name in the collection.
    pub name: String,
    /// The board looked for.
    pub board: Chessboard,
}

/// A pair in which both eyes see the board.
#[derive(Clone, Debug)]
pub struct Captured {
    /// The pair, its place not yet known.
    pub pair: CollectedPair,
    /// Size (width, height) of both images.
    pub sizes_px: [(u32, u32); 2],
    /// The board looked for.
    pub board: Chessboard,
    /// The images as they came.
    pub frame: StereoFrame,
}

impl Capture {
    /// Finds the board or says which eye does not see it.
    pub fn run(self) -> Result<Captured, JobError> {
        let images = [gray(&self.frame.left), gray(&self.frame.right)];
        let pair = find_in_both(self.name, images, &self.board).map_err(JobError::failed)?;
        Ok(Captured {
            pair,
            sizes_px: [size(&self.frame.left), size(&self.frame.right)],
            board: self.board,
            frame: self.frame,
        })
    }
}

/// Why a pair is of no use.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("In the {eye} image {reason}.")]
pub struct NotInBoth {
    /// The first eye that does not see the board.
    pub eye: Eye,
    /// What that eye sees instead.
    pub reason: NotSeen,
}

/// Finds the board in both images of a pair.
pub fn find_in_both(
    name: String,
    [left_image, right_image]: [GrayImage; 2],
    board: &Chessboard,
) -> Result<CollectedPair, NotInBoth> {
    let sighting = chessboard::find_in_pair(&name, &left_image, &right_image, board);
    let not_seen = sighting.not_seen.into_iter().zip(Eye::BOTH);
    if let Some((reason, eye)) = not_seen.filter_map(|(reason, eye)| Some((reason?, eye))).next() {
        return Err(NotInBoth { eye, reason });
    }
    Ok(CollectedPair {
        name,
        left: sighting.observation.left,
        right: sighting.observation.right,
        left_image: Some(Arc::new(left_image)),
        right_image: Some(Arc::new(right_image)),
        place: None,
        taken: None,
    })
}

/// Looks for the board in both images of a pair, fast.
pub fn glimpse_in_both(images: [&GrayImage; 2], board: &Chessboard) -> [Option<Corners>; 2] {
    let glimpse = |image| chessboard::glimpse(image, board).ok_or(NotSeen::Nothing);
    let (left, right) = rayon::join(|| glimpse(images[0]), || glimpse(images[1]));
    let seen = chessboard::pair_up("", board, left, right).observation;
    [seen.left, seen.right]
}

/// Gray levels of a color image.
pub fn gray(image: &RgbImage) -> GrayImage {
    image::imageops::grayscale(image)
}

/// Width and height.
pub fn size(image: &RgbImage) -> (u32, u32) {
    image.dimensions()
}

/// Say which board a pair shows.
#[derive(Clone, Debug)]
pub struct Recognize {
    /// The pair.
    pub frame: StereoFrame,
    /// The board in use, for comparison.
    pub board: Chessboard,
}

impl Recognize {
    /// Looks in the left eye and, if it sees none, in the right one.
    pub fn run(self) -> BoardSeen {
        let seen = [&self.frame.left, &self.frame.right]
            .into_iter()
            .find_map(|image| chessboard::recognize(&gray(image)));
        board_seen(seen, &self.board)
    }
}

/// Says which board is seen, counted in squares as the operator counts them.
pub fn board_seen(inner_corners: Option<InnerCorners>, board: &Chessboard) -> BoardSeen {
    let (columns, rows) = board.squares();
    let text = match inner_corners {
        None => "No chessboard is seen. Hold the whole board, flat and evenly lit, in front of both eyes."
            .to_owned(),
        Some(seen) => {
            let (seen_columns, seen_rows) = (seen.columns + 1, seen.rows + 1);
            if (columns.max(rows), columns.min(rows)) == (seen_columns, seen_rows) {
                format!("The board in view has {seen_columns}×{seen_rows} squares, as chosen.")
            } else {
                format!(
                    "The board in view has {seen_columns}×{seen_rows} squares ({}×{} inner corners), not {columns}×{rows}. Choose {seen_columns}×{seen_rows}, or uncover the rest of the board.",
                    seen.columns, seen.rows
                )
            }
        }
    };
    BoardSeen { inner_corners, text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_board_is_named_in_squares() {
        let board = plumbline_model::default_board();
        let seen = board_seen(Some(InnerCorners { columns: 9, rows: 6 }), &board);
        assert!(seen.text.contains("10×7 squares (9×6 inner corners), not 9×6"), "{}", seen.text);
        let same = board_seen(Some(InnerCorners { columns: 8, rows: 5 }), &board);
        assert!(same.text.contains("as chosen"), "{}", same.text);
    }

    #[test]
    fn the_eye_that_does_not_see_the_board_is_named() {
        let blank = || GrayImage::from_pixel(160, 120, image::Luma([128]));
        let error = find_in_both("pair".into(), [blank(), blank()], &plumbline_model::default_board())
            .expect_err("blank");
        assert_eq!(error.eye, Eye::Left);
        assert!(error.to_string().starts_with("In the left image no chessboard is visible"), "{error}");
    }
}

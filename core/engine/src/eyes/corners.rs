//! The chessboard in both eyes of a live pair, fast.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::GrayImage;
use plumbline_model::{Chessboard, InnerCorners, Stamp, StereoFrame};
use plumbline_vision::chessboard;

use super::look::Look;
use super::sharpness::of_both;
use super::work::{board_seen, glimpse_in_both, gray};
use crate::ground::stage::Stage;
use crate::ground::watched::WatchedThread;

/// When the board is not seen, another one is looked for this often.
const LOOK_FOR_ANOTHER: Duration = Duration::from_millis(1500);

/// A pair and the board looked for.
#[derive(Clone, Debug)]
pub struct CornersInput {
    /// The pair.
    pub frame: StereoFrame,
    /// The board.
    pub board: Chessboard,
}

/// Finds the board in pair after pair.
#[derive(Debug, Default)]
pub struct CornersStage {
    looked_for_another: Option<Instant>,
}

impl Stage for CornersStage {
    type Input = CornersInput;
    type Output = Look;
    type Key = (u64, Chessboard);
    const THREAD: WatchedThread = WatchedThread::Corners;

    fn stamp(input: &CornersInput) -> Stamp {
        input.frame.stamp
    }

    fn key(input: &CornersInput) -> Self::Key {
        (input.frame.stamp.seq, input.board)
    }

    fn process(&mut self, input: CornersInput) -> Look {
        let CornersInput { frame, board } = input;
        let (left_gray, right_gray) = rayon::join(|| gray(&frame.left), || gray(&frame.right));
        let [left, right] = glimpse_in_both([&left_gray, &right_gray], &board);
        let other_board =
            (left.is_none() && right.is_none() && self.is_time_for_another(frame.stamp.captured_at))
                .then(|| board_seen(recognized_by_both([&left_gray, &right_gray]), &board));
        let edge_width_px = of_both(&board, [&left_gray, &right_gray], [left.as_ref(), right.as_ref()]);
        let gray = [Arc::new(left_gray), Arc::new(right_gray)];
        Look { frame, board, left, right, gray, edge_width_px, other_board }
    }
}

/// What is a board to both eyes: on a speckled table one of them sees a few squares where there are none.
fn recognized_by_both([left, right]: [&GrayImage; 2]) -> Option<InnerCorners> {
    let seen = chessboard::recognize(left)?;
    (chessboard::recognize(right) == Some(seen)).then_some(seen)
}

impl CornersStage {
    fn is_time_for_another(&mut self, now: Instant) -> bool {
        let due = self
            .looked_for_another
            .is_none_or(|last| now.saturating_duration_since(last) >= LOOK_FOR_ANOTHER);
        if due {
            self.looked_for_another = Some(now);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat board of so many squares, seen from the front.
    fn board(columns: u32, rows: u32) -> GrayImage {
        GrayImage::from_fn(320, 240, |x, y| {
            let (column, row) = ((x as i32 - 40).div_euclid(24), (y as i32 - 40).div_euclid(24));
            let on_board = (0..columns as i32).contains(&column) && (0..rows as i32).contains(&row);
            image::Luma([if on_board && (column + row) % 2 == 0 { 20 } else { 230 }])
        })
    }

    #[test]
    fn another_board_is_one_to_both_eyes() {
        let (small, large, blank) = (board(6, 5), board(8, 6), board(0, 0));
        let seen = recognized_by_both([&small, &small]).expect("a board that both eyes see");
        assert_eq!((seen.columns, seen.rows), (5, 4));
        for (left, right) in [(&small, &blank), (&blank, &small), (&small, &large)] {
            assert_eq!(recognized_by_both([left, right]), None, "squares to one eye alone");
        }
    }
}

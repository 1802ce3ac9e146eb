//! The chessboard in both eyes of a live pair, fast.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::{Chessboard, Stamp, StereoFrame};
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
                .then(|| board_seen(chessboard::recognize(&left_gray), &board));
        let edge_width_px = of_both(&board, [&left_gray, &right_gray], [left.as_ref(), right.as_ref()]);
        let gray = [Arc::new(left_gray), Arc::new(right_gray)];
        Look { frame, board, left, right, gray, edge_width_px, other_board }
    }
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

//! How the two eyes sit to each other, from the board poses that each saw by itself; and the
//! mistakes that show there: eyes swapped, one image mirrored, pairs of different moments.

use nalgebra::{Isometry3, Vector2};
use plumbline_model::{Chessboard, Eye, ModelKind};

use super::initial::calibrate_one_eye;
use super::problem::Corner;

/// One pair seen by both eyes.
pub(super) struct SeenByBoth {
    pub left_from_board: Isometry3<f64>,
    pub right_from_board: Isometry3<f64>,
    /// `right_from_board` if the right eye's corners are counted from the other end.
    pub right_from_board_turned: Isometry3<f64>,
}

/// The relative pose most pairs agree on.
pub(super) struct Agreement {
    pub right_from_left: Isometry3<f64>,
    /// For each pair: does it agree, and does it need its right corners turned?
    pub pairs: Vec<Option<Turned>>,
}

/// Whether the right eye's corners must be read from the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turned {
    No,
    Yes,
}

/// Two relative poses agree within this angle …
const SAME_ANGLE_RAD: f64 = 0.12;
/// … and this distance, in units of the board's distance from the eye.
const SAME_DISTANCE: f64 = 0.15;

/// Finds the relative pose with the most supporters.
pub(super) fn agree(pairs: &[SeenByBoth]) -> Option<Agreement> {
    let candidates = |p: &SeenByBoth| {
        [(Turned::No, p.right_from_board), (Turned::Yes, p.right_from_board_turned)]
            .map(|(turned, right_from_board)| (turned, right_from_board * p.left_from_board.inverse()))
    };
    let support = |hypothesis: &Isometry3<f64>| -> (usize, f64) {
        let distances: Vec<f64> = pairs
            .iter()
            .filter_map(|p| {
                candidates(p).iter().map(|(_, c)| disagreement(hypothesis, c, p)).min_by(f64::total_cmp)
            })
            .filter(|&d| d < 1.0)
            .collect();
        (distances.len(), distances.iter().sum())
    };
    // Every pair proposes its straight reading; the one that others agree with best wins.
    let best = pairs
        .iter()
        .map(|p| candidates(p)[0].1)
        .map(|hypothesis| (support(&hypothesis), hypothesis))
        .max_by(|((count_a, sum_a), _), ((count_b, sum_b), _)| {
            count_a.cmp(count_b).then(sum_b.total_cmp(sum_a))
        })?;
    let right_from_left = best.1;
    let pairs = pairs
        .iter()
        .map(|p| {
            candidates(p)
                .iter()
                .map(|(turned, c)| (*turned, disagreement(&right_from_left, c, p)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, d)| *d < 1.0)
                .map(|(turned, _)| turned)
        })
        .collect();
    Some(Agreement { right_from_left, pairs })
}

/// Below 1: the same relative pose.
fn disagreement(a: &Isometry3<f64>, b: &Isometry3<f64>, pair: &SeenByBoth) -> f64 {
    let angle = a.rotation.angle_to(&b.rotation) / SAME_ANGLE_RAD;
    let range = pair.left_from_board.translation.vector.norm();
    let distance = (a.translation.vector - b.translation.vector).norm() / (SAME_DISTANCE * range);
    angle.max(distance)
}

/// Looks for the eye whose image is mirrored: mirroring it back must make the pairs agree.
///
/// Called only when the pairs do not agree as they are. Corners are per pair, one list per eye.
pub(super) fn find_mirrored_eye(
    kind: ModelKind,
    board: &Chessboard,
    sizes_px: [(u32, u32); 2],
    corners: &[[Vec<Corner>; 2]],
) -> Option<Eye> {
    // Mirroring either eye makes a pair consistent; with the wrong one the whole world is
    // mirrored and the right eye comes out on the left.
    Eye::BOTH.into_iter().find(|&eye| {
        let views: [Vec<Vec<Corner>>; 2] = Eye::BOTH.map(|e| {
            corners
                .iter()
                .map(|pair| {
                    let corners = &pair[e.index()];
                    if e == eye { mirrored(corners, board, sizes_px[e.index()].0) } else { corners.clone() }
                })
                .collect()
        });
        let Some(agreement) = agree_from_corners(kind, board, sizes_px, &views) else { return false };
        let agreeing = agreement.pairs.iter().flatten().count();
        agreeing * 10 >= corners.len() * 8 && agreement.right_from_left.translation.vector.x < 0.0
    })
}

/// Mirrors an eye's corners about the vertical and renumbers them so that the board again shows
/// its front.
fn mirrored(corners: &[Corner], board: &Chessboard, width_px: u32) -> Vec<Corner> {
    let columns = board.inner_columns as usize;
    corners
        .iter()
        .map(|c| {
            let index = (c.index / columns) * columns + (columns - 1 - c.index % columns);
            Corner {
                index,
                point_in_board: board.corner(index).coords.coords,
                measured_px: Vector2::new(f64::from(width_px) - 1.0 - c.measured_px.x, c.measured_px.y),
                ..*c
            }
        })
        .collect()
}

/// Both eyes calibrated by themselves, then their agreement.
pub(super) fn agree_from_corners(
    kind: ModelKind,
    board: &Chessboard,
    sizes_px: [(u32, u32); 2],
    views: &[Vec<Vec<Corner>>; 2],
) -> Option<Agreement> {
    let [left, right] = [0, 1].map(|i| calibrate_one_eye(kind, sizes_px[i], &views[i]));
    let (left, right) = (left?, right?);
    let pairs: Vec<SeenByBoth> = left
        .poses
        .iter()
        .zip(&right.poses)
        .filter_map(|(l, r)| Some(seen_by_both(board, (*l)?, (*r)?)))
        .collect();
    agree(&pairs)
}

/// A pair with both readings of the right eye.
pub(super) fn seen_by_both(
    board: &Chessboard,
    left_from_board: Isometry3<f64>,
    right_from_board: Isometry3<f64>,
) -> SeenByBoth {
    let far = board.corner(board.corner_count() - 1).coords.coords;
    // The same print, counted from the opposite corner.
    let half_turn = Isometry3::new(far, nalgebra::Vector3::z() * std::f64::consts::PI);
    SeenByBoth { left_from_board, right_from_board, right_from_board_turned: right_from_board * half_turn }
}

//! Where to hold the board next: of many places in front of both eyes, the one that adds most.

use nalgebra::Point3;
use plumbline_model::frame::{Board, LeftCamera};
use plumbline_model::{Chessboard, Corners, Eye, Pixel, Point, Pose, Raw, StereoCameras};

use super::coverage::{self, Novelty};
use super::place::{diagonal_m, place_of, pose_at};
use super::view::{BoardPlace, Coverage, GhostBoard};

/// Directions tried across and down the left image.
const DIRECTIONS: (usize, usize) = (9, 7);
/// Distances tried, in diagonals of the board.
const DISTANCES_DIAGONALS: [f64; 4] = [0.85, 1.3, 2.2, 3.5];
/// Tilts tried, radians (35°).
const TILT_RAD: f64 = 0.61;
const TILTS: [(f64, f64); 5] =
    [(0.0, 0.0), (TILT_RAD, 0.0), (-TILT_RAD, 0.0), (0.0, TILT_RAD), (0.0, -TILT_RAD)];
/// What a new distance or tilt is worth, in new cells.
const WORTH_OF_DISTANCE: usize = 6;
const WORTH_OF_TILT: usize = 8;
/// Free border of the image, as a share of its width: a board that touches it is often lost.
const BORDER: f64 = 0.03;
/// Nothing is asked for further off the optical axis, radians (83°): the image of a fisheye ends
/// in a circle whose radius nobody has measured yet, and near its rim a board is all slant.
const MOST_OFF_AXIS_RAD: f64 = 1.45;
/// Points along each side of the drawn outline.
const PER_SIDE: usize = 12;

/// The most useful place; `None` when no place would add anything.
pub fn suggest(cameras: &StereoCameras, board: &Chessboard, coverage: &Coverage) -> Option<GhostBoard> {
    // The first place is an easy one; what is hard comes when the operator knows the game.
    let begun = coverage.by_tilt.iter().any(|&pairs| pairs > 0);
    let mut best: Option<(usize, Candidate)> = None;
    for candidate in candidates(cameras, board).filter(|candidate| begun || candidate.is_easy(cameras, board))
    {
        let novelty = candidate.novelty(cameras, board, coverage);
        let worth = novelty.cells
            + usize::from(novelty.distance) * WORTH_OF_DISTANCE
            + usize::from(novelty.tilt) * WORTH_OF_TILT;
        if novelty.is_new() && best.as_ref().is_none_or(|(most, _)| worth > *most) {
            best = Some((worth, candidate));
        }
    }
    let (_, candidate) = best?;
    let [left, right] = outline(cameras, board, &candidate.left_from_board, PER_SIDE)?;
    let reason = candidate.describe(board, cameras);
    Some(GhostBoard { left, right, reason, place: candidate.place })
}

struct Candidate {
    left_from_board: Pose<LeftCamera, Board>,
    place: BoardPlace,
    middle: Pixel<Raw>,
}

fn candidates<'a>(cameras: &'a StereoCameras, board: &'a Chessboard) -> impl Iterator<Item = Candidate> + 'a {
    let (width, height) = cameras.left.size_px();
    let along = |i: usize, n: usize, length: u32| (i as f64 + 0.5) / n as f64 * f64::from(length) - 0.5;
    let directions = (0..DIRECTIONS.1).flat_map(move |row| {
        (0..DIRECTIONS.0).map(move |column| {
            Pixel::<Raw>::new(along(column, DIRECTIONS.0, width), along(row, DIRECTIONS.1, height))
        })
    });
    directions.filter_map(|middle| Some((middle, cameras.left.unproject(middle).ok()?))).flat_map(
        move |(middle, direction)| {
            DISTANCES_DIAGONALS.iter().flat_map(move |diagonals| {
                let middle_in_left = Point3::from(direction * (diagonals * diagonal_m(board)));
                TILTS.iter().filter_map(move |&(up_down, left_right)| {
                    let left_from_board = pose_at(board, &middle_in_left, up_down, left_right)?;
                    // Four points per side are enough to know that it fits.
                    outline(cameras, board, &left_from_board, 4)?;
                    let place = place_of(board, &left_from_board)?;
                    Some(Candidate { left_from_board, place, middle })
                })
            })
        },
    )
}

impl Candidate {
    /// Facing the eyes in the middle of the image, not too near: where anybody would begin.
    fn is_easy(&self, cameras: &StereoCameras, board: &Chessboard) -> bool {
        let (width, height) = cameras.left.size_px();
        let middle = Pixel::new(0.5 * (f64::from(width) - 1.0), 0.5 * (f64::from(height) - 1.0));
        coverage::tilt_bin(&self.place) == 0
            && coverage::distance_bin(board, &self.place) == 1
            && self.middle.distance_px(&middle) < 0.1 * f64::from(width)
    }

    fn novelty(&self, cameras: &StereoCameras, board: &Chessboard, coverage: &Coverage) -> Novelty {
        let corners = |eye| -> Corners {
            board
                .corners()
                .into_iter()
                .map(|corner| project(cameras, eye, self.left_from_board * corner))
                .collect()
        };
        let eyes = [&corners(Eye::Left), &corners(Eye::Right)];
        coverage::novelty(coverage, board, cameras.left.size_px(), eyes, Some(&self.place))
    }

    fn describe(&self, board: &Chessboard, cameras: &StereoCameras) -> String {
        let third = |at: f64, length: u32, names: [&'static str; 3]| {
            let share = at / f64::from(length);
            if share < 1.0 / 3.0 {
                names[0]
            } else if share < 2.0 / 3.0 {
                names[1]
            } else {
                names[2]
            }
        };
        let (width, height) = cameras.left.size_px();
        let across = third(self.middle.u_px, width, ["left", "middle", "right"]);
        let down = third(self.middle.v_px, height, ["upper", "middle", "lower"]);
        let where_to = if across == down { "middle".to_owned() } else { format!("{down} {across}") };
        let distance =
            ["very near", "near", "further away", "far away"][coverage::distance_bin(board, &self.place)];
        let tilt = Coverage::TILT_NAMES[coverage::tilt_bin(&self.place)];
        format!("{where_to}, {distance} ({:.0} mm), {tilt}", self.place.distance_m * 1e3)
    }
}

/// Outline of the board's squares in both eyes; `None` when an eye does not see all of it.
fn outline(
    cameras: &StereoCameras,
    board: &Chessboard,
    left_from_board: &Pose<LeftCamera, Board>,
    per_side: usize,
) -> Option<[Vec<Pixel<Raw>>; 2]> {
    let s = board.square_m;
    let (columns, rows) = (f64::from(board.inner_columns) * s, f64::from(board.inner_rows) * s);
    let around = [(-s, -s), (columns, -s), (columns, rows), (-s, rows)];
    let border_px = BORDER * f64::from(cameras.left.width_px);
    let seen_by = |eye: Eye| -> Option<Vec<Pixel<Raw>>> {
        let (width, height) = cameras.camera(eye).size_px();
        (0..4 * per_side)
            .map(|i| {
                let (from, to) = (around[i / per_side], around[(i / per_side + 1) % 4]);
                let share = (i % per_side) as f64 / per_side as f64;
                let at = |a: f64, b: f64| a + share * (b - a);
                let on_board = Point::<Board>::new(at(from.0, to.0), at(from.1, to.1), 0.0);
                project(cameras, eye, *left_from_board * on_board).filter(|pixel| {
                    pixel.u_px >= border_px
                        && pixel.v_px >= border_px
                        && pixel.u_px <= f64::from(width) - 1.0 - border_px
                        && pixel.v_px <= f64::from(height) - 1.0 - border_px
                })
            })
            .collect()
    };
    Some([seen_by(Eye::Left)?, seen_by(Eye::Right)?])
}

fn project(cameras: &StereoCameras, eye: Eye, point_in_left: Point<LeftCamera>) -> Option<Pixel<Raw>> {
    let in_eye = match eye {
        Eye::Left => point_in_left.coords.coords,
        Eye::Right => (cameras.right_from_left * point_in_left).coords.coords,
    };
    let off_axis_rad = in_eye.x.hypot(in_eye.y).atan2(in_eye.z);
    if off_axis_rad > MOST_OFF_AXIS_RAD { None } else { cameras.camera(eye).project(&in_eye).ok() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eyes::place::nominal_cameras;
    use crate::eyes::view::CollectedPair;
    use plumbline_model::ModelKind;

    fn board() -> Chessboard {
        Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
    }

    #[test]
    fn following_the_ghost_covers_both_eyes_and_then_it_is_gone() {
        let (board, cameras) = (board(), nominal_cameras((640, 480), ModelKind::Fisheye));
        let mut pairs: Vec<CollectedPair> = Vec::new();
        let mut covered = coverage::empty(&board);
        while let Some(ghost) = suggest(&cameras, &board, &covered) {
            for (eye, outline) in [(Eye::Left, &ghost.left), (Eye::Right, &ghost.right)] {
                assert!(outline.iter().all(|pixel| pixel.is_inside(cameras.camera(eye).size_px())));
            }
            // Hold the board exactly there.
            let candidate = candidates(&cameras, &board)
                .find(|candidate| {
                    candidate.place == ghost.place
                        && outline(&cameras, &board, &candidate.left_from_board, PER_SIDE)
                            .is_some_and(|[left, _]| left == ghost.left)
                })
                .expect("the ghost is one of the candidates");
            let corners = |eye| {
                let seen = |corner| project(&cameras, eye, candidate.left_from_board * corner);
                Some(board.corners().into_iter().map(seen).collect())
            };
            pairs.push(CollectedPair {
                name: pairs.len().to_string(),
                left: corners(Eye::Left),
                right: corners(Eye::Right),
                left_image: None,
                right_image: None,
                place: Some(candidate.place),
                taken: None,
            });
            assert!(pairs.len() < 60, "the ghost never lets go");
            covered = coverage::coverage(&board, (640, 480), &pairs);
        }
        assert!(pairs.len() >= 8, "only {} pairs", pairs.len());
        for grid in [&covered.left, &covered.right] {
            assert!(grid.filled_fraction() > 0.6, "{:?}", grid);
        }
        assert!(covered.by_tilt.iter().all(|&n| n > 0), "{:?}", covered.by_tilt);
        assert!(covered.by_distance.iter().all(|&n| n > 0), "{:?}", covered.by_distance);
    }
}

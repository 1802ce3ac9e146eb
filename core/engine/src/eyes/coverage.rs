//! Where the board has been: over both images, in distance and in tilt.

use plumbline_model::{Chessboard, Corners};

use super::place::diagonal_m;
use super::view::{BoardPlace, CollectedPair, Coverage, CoverageGrid};

/// Cells across and down an image.
const CELLS: (usize, usize) = (8, 6);
/// Ends of the distance bins, in diagonals of the board.
const DISTANCE_EDGES_DIAGONALS: [f64; 3] = [1.0, 1.75, 3.0];
/// Below this angle a board counts as facing the eye, radians (15°).
const FACING_RAD: f64 = 0.26;
/// A pair is new when it reaches this many cells, over both eyes, that no pair has reached.
const NEW_CELLS: usize = 3;
/// A board that has moved by more than this share of the image's width is elsewhere.
const ELSEWHERE: f64 = 0.1;
/// So is one whose distance differs by more than this factor.
const OTHER_DISTANCE: f64 = 1.3;

/// Coverage by these pairs of images of this size.
pub fn coverage<'a>(
    board: &Chessboard,
    size_px: (u32, u32),
    pairs: impl IntoIterator<Item = &'a CollectedPair>,
) -> Coverage {
    let mut coverage = empty(board);
    for pair in pairs {
        for (grid, corners) in [(&mut coverage.left, &pair.left), (&mut coverage.right, &pair.right)] {
            for cell in corners.iter().flat_map(|corners| cells(corners, size_px)) {
                grid.corners[cell] += 1;
            }
        }
        if let Some(place) = &pair.place {
            coverage.by_distance[distance_bin(board, place)] += 1;
            coverage.by_tilt[tilt_bin(place)] += 1;
        }
    }
    coverage
}

/// What a further pair would add.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Novelty {
    /// Cells, over both eyes, that no pair has reached.
    pub cells: usize,
    /// Whether no pair was at this distance.
    pub distance: bool,
    /// Whether no pair was tilted like this.
    pub tilt: bool,
    /// Whether every pair was clearly somewhere else; see [`is_elsewhere`].
    pub elsewhere: bool,
}

impl Novelty {
    /// Whether the pair is worth taking.
    pub fn is_new(&self) -> bool {
        self.cells >= NEW_CELLS || self.distance || self.tilt || self.elsewhere
    }
}

/// What a pair would add to the coverage.
pub fn novelty(
    coverage: &Coverage,
    board: &Chessboard,
    size_px: (u32, u32),
    eyes: [&Corners; 2],
    place: Option<&BoardPlace>,
) -> Novelty {
    let new_cells = |grid: &CoverageGrid, corners: &Corners| {
        let mut reached: Vec<usize> =
            cells(corners, size_px).filter(|&cell| grid.corners[cell] == 0).collect();
        reached.sort_unstable();
        reached.dedup();
        reached.len()
    };
    Novelty {
        cells: new_cells(&coverage.left, eyes[0]) + new_cells(&coverage.right, eyes[1]),
        distance: place.is_some_and(|place| coverage.by_distance[distance_bin(board, place)] == 0),
        tilt: place.is_some_and(|place| coverage.by_tilt[tilt_bin(place)] == 0),
        elsewhere: false,
    }
}

/// Whether a board is clearly in another place than in every one of these pairs: elsewhere in
/// the left image, nearer or further, or tilted otherwise.
pub fn is_elsewhere<'a>(
    size_px: (u32, u32),
    left: &Corners,
    place: Option<&BoardPlace>,
    pairs: impl IntoIterator<Item = &'a CollectedPair>,
) -> bool {
    let allowed_px = ELSEWHERE * f64::from(size_px.0);
    pairs.into_iter().all(|pair| {
        let moved_px = pair.left.as_ref().and_then(|other| Some((middle(left)? - middle(other)?).norm()));
        let moved = moved_px.is_none_or(|moved_px| moved_px > allowed_px);
        let turned = place.zip(pair.place.as_ref()).is_some_and(|(a, b)| {
            let ratio = (a.distance_m / b.distance_m).ln().abs();
            let up_down = (a.tilt_up_down_rad - b.tilt_up_down_rad).abs();
            let left_right = (a.tilt_left_right_rad - b.tilt_left_right_rad).abs();
            ratio > OTHER_DISTANCE.ln() || up_down.max(left_right) > FACING_RAD
        });
        moved || turned
    })
}

/// Mean of the measured corners, pixels.
fn middle(corners: &Corners) -> Option<nalgebra::Vector2<f64>> {
    let seen = corners.iter().flatten().count();
    let sum: nalgebra::Vector2<f64> = corners.iter().flatten().map(|corner| corner.vector()).sum();
    (seen > 0).then(|| sum / seen as f64)
}

/// No pairs yet.
pub fn empty(board: &Chessboard) -> Coverage {
    let grid = CoverageGrid { columns: CELLS.0, rows: CELLS.1, corners: vec![0; CELLS.0 * CELLS.1] };
    Coverage {
        left: grid.clone(),
        right: grid,
        by_distance: vec![0; DISTANCE_EDGES_DIAGONALS.len() + 1],
        distance_edges_m: DISTANCE_EDGES_DIAGONALS.map(|edge| edge * diagonal_m(board)).to_vec(),
        by_tilt: [0; 5],
    }
}

/// Index into [`Coverage::by_distance`].
pub fn distance_bin(board: &Chessboard, place: &BoardPlace) -> usize {
    let diagonals = place.distance_m / diagonal_m(board);
    DISTANCE_EDGES_DIAGONALS.iter().filter(|&&edge| diagonals >= edge).count()
}

/// Index into [`Coverage::by_tilt`].
pub fn tilt_bin(place: &BoardPlace) -> usize {
    let (up_down, left_right) = (place.tilt_up_down_rad, place.tilt_left_right_rad);
    if up_down.abs().max(left_right.abs()) < FACING_RAD {
        return 0;
    }
    match (up_down.abs() >= left_right.abs(), up_down > 0.0, left_right > 0.0) {
        (true, true, _) => 1,
        (true, false, _) => 2,
        (false, _, true) => 3,
        (false, _, false) => 4,
    }
}

/// The cell of every measured corner that lies on the image.
fn cells(corners: &Corners, size_px: (u32, u32)) -> impl Iterator<Item = usize> {
    let (width, height) = (f64::from(size_px.0), f64::from(size_px.1));
    corners.iter().flatten().filter(move |corner| corner.is_inside(size_px)).map(move |corner| {
        // Pixel centers are whole numbers, so the image begins half a pixel before 0.
        let column = ((corner.u_px + 0.5) / width * CELLS.0 as f64) as usize;
        let row = ((corner.v_px + 0.5) / height * CELLS.1 as f64) as usize;
        row.min(CELLS.1 - 1) * CELLS.0 + column.min(CELLS.0 - 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Pixel;

    const SIZE_PX: (u32, u32) = (640, 480);

    fn board() -> Chessboard {
        Chessboard { inner_columns: 3, inner_rows: 2, square_m: 0.05 }
    }

    fn pair(corners: &[(f64, f64)], place: BoardPlace) -> CollectedPair {
        let corners: Corners = corners.iter().map(|&(u, v)| Some(Pixel::new(u, v))).collect();
        CollectedPair {
            name: "pair".into(),
            left: Some(corners.clone()),
            right: Some(corners),
            left_image: None,
            right_image: None,
            place: Some(place),
            taken: None,
        }
    }

    fn place(distance_m: f64, tilt_up_down_rad: f64, tilt_left_right_rad: f64) -> BoardPlace {
        BoardPlace { distance_m, tilt_up_down_rad, tilt_left_right_rad }
    }

    #[test]
    fn corners_are_counted_in_their_cells() {
        let pairs = [pair(&[(-0.5, -0.5), (79.0, 79.0), (80.0, 0.0), (639.0, 479.0)], place(0.2, 0.0, 0.0))];
        let coverage = coverage(&board(), SIZE_PX, &pairs);
        // The first corner lies half a pixel outside of the outermost centers.
        assert_eq!(coverage.left.corners[0], 1);
        assert_eq!(coverage.left.corners[1], 1);
        assert_eq!(coverage.left.corners[47], 1);
        assert_eq!(coverage.left.corners.iter().sum::<u32>(), 3);
        assert!((coverage.right.filled_fraction() - 3.0 / 48.0).abs() < 1e-12);
    }

    #[test]
    fn what_was_collected_is_not_new_again() {
        let one = pair(&[(10.0, 10.0), (100.0, 10.0), (10.0, 100.0)], place(0.2, 0.4, 0.0));
        let eyes = [one.left.as_ref().expect("left"), one.right.as_ref().expect("right")];
        let before = novelty(&empty(&board()), &board(), SIZE_PX, eyes, one.place.as_ref());
        assert_eq!(before, Novelty { cells: 6, distance: true, tilt: true, elsewhere: false });
        let coverage = coverage(&board(), SIZE_PX, [&one]);
        let after = novelty(&coverage, &board(), SIZE_PX, eyes, one.place.as_ref());
        assert_eq!(after, Novelty::default());
        assert!(!after.is_new());
        let further = novelty(&coverage, &board(), SIZE_PX, eyes, Some(&place(2.0, 0.4, 0.0)));
        assert!(further.is_new() && further.distance && !further.tilt);
    }

    #[test]
    fn a_board_is_elsewhere_when_it_moved_turned_or_came_nearer() {
        let corners = [(100.0, 100.0), (140.0, 100.0), (120.0, 140.0)];
        let one = pair(&corners, place(0.4, 0.0, 0.0));
        let shifted = |by: f64| pair(&corners.map(|(u, v)| (u + by, v)), place(0.4, 0.0, 0.0));
        let elsewhere = |other: &CollectedPair| {
            is_elsewhere(SIZE_PX, other.left.as_ref().expect("left"), other.place.as_ref(), [&one])
        };
        assert!(!elsewhere(&shifted(50.0)) && elsewhere(&shifted(80.0)));
        for (other, expected) in
            [((0.45, 0.0, 0.0), false), ((0.6, 0.0, 0.0), true), ((0.4, 0.1, -0.4), true)]
        {
            assert_eq!(elsewhere(&pair(&corners, place(other.0, other.1, other.2))), expected, "{other:?}");
        }
        assert!(is_elsewhere(SIZE_PX, one.left.as_ref().expect("left"), None, []), "nothing is collected");
    }

    #[test]
    fn tilts_are_told_apart() {
        let tilts = [(0.1, -0.1), (0.5, 0.1), (-0.5, 0.1), (0.1, 0.5), (0.1, -0.5)];
        let bins: Vec<usize> = tilts.iter().map(|&(a, b)| tilt_bin(&place(0.3, a, b))).collect();
        assert_eq!(bins, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn distances_are_sorted_by_the_size_of_the_board() {
        let diagonal = diagonal_m(&board());
        let bins: Vec<usize> = [0.5, 1.2, 2.0, 30.0]
            .iter()
            .map(|d| distance_bin(&board(), &place(d * diagonal, 0.0, 0.0)))
            .collect();
        assert_eq!(bins, [0, 1, 2, 3]);
        let edges = empty(&board()).distance_edges_m;
        assert!((edges[1] - 1.75 * diagonal).abs() < 1e-12);
    }
}

//! Roughly where a board is, from one eye's corners: good enough to tell whether it has been
//! there before, long before anything is calibrated.
//!
//! The corners are turned into directions with the best lens known (the calibration in use, or
//! a nominal one). Board plane and directions are related by a homography; its two rotation
//! columns and the translation are read off (Zhang 2000, section 3.1).

use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::decompose;
use plumbline_model::frame::{Board, LeftCamera, RightCamera};
use plumbline_model::{
    Camera, CameraModel, Chessboard, Corners, Fisheye, ModelKind, Pinhole, Point, Pose, StereoCameras,
};

use super::view::BoardPlace;

/// Fewer corners than this say too little.
const LEAST_CORNERS: usize = 6;

/// Eyes as drawn: NICO's lenses scaled to the image, 70 mm apart, parallel.
pub fn nominal_cameras(size_px: (u32, u32), kind: ModelKind) -> StereoCameras {
    let (width_px, height_px) = size_px;
    let (cx_px, cy_px) = (0.5 * (f64::from(width_px) - 1.0), 0.5 * (f64::from(height_px) - 1.0));
    let model = match kind {
        ModelKind::Fisheye => {
            let f_px = 150.0 / 640.0 * f64::from(width_px);
            CameraModel::Fisheye(Fisheye {
                fx_px: f_px,
                fy_px: f_px,
                cx_px,
                cy_px,
                skew_px: 0.0,
                k: [0.0; 4],
            })
        }
        ModelKind::Pinhole => {
            let f_px = 0.8 * f64::from(width_px);
            CameraModel::Pinhole(Pinhole {
                fx_px: f_px,
                fy_px: f_px,
                cx_px,
                cy_px,
                k1: 0.0,
                k2: 0.0,
                p1: 0.0,
                p2: 0.0,
                k3: 0.0,
            })
        }
    };
    let camera = Camera { model, width_px, height_px };
    let right_from_left = Pose::<RightCamera, LeftCamera>::from_rotation_vector(
        Vector3::zeros(),
        Vector3::new(-0.07, 0.0, 0.0),
    );
    StereoCameras { left: camera, right: camera, right_from_left }
}

/// Pose of the board in front of the left eye, good to some percent; `None` when the corners
/// do not determine one.
pub fn rough_pose(camera: &Camera, board: &Chessboard, corners: &Corners) -> Option<Pose<LeftCamera, Board>> {
    let seen: Vec<(Point<Board>, Vector3<f64>)> = corners
        .iter()
        .enumerate()
        .filter_map(|(index, corner)| Some((board.corner(index), camera.unproject((*corner)?).ok()?)))
        .collect();
    if seen.len() < LEAST_CORNERS {
        return None;
    }
    // Turned so that the board is ahead: then every direction has a positive z, however far
    // aside a fisheye sees it.
    let mean: Vector3<f64> = seen.iter().map(|(_, direction)| direction).sum();
    let ahead_from_camera = UnitQuaternion::rotation_between(&mean, &Vector3::z())?;
    let homography = homography(board, &seen, &ahead_from_camera)?;
    let ahead_from_board = pose_of(&homography)?;
    Some(Pose::new(ahead_from_camera.inverse() * ahead_from_board))
}

/// Distance and tilt of a board.
pub fn place_of(board: &Chessboard, left_from_board: &Pose<LeftCamera, Board>) -> Option<BoardPlace> {
    let middle = (*left_from_board * middle_of(board)).coords.coords;
    let distance_m = middle.norm();
    let sight = middle.try_normalize(1e-9)?;
    let right = (Vector3::x() - sight * sight.x).try_normalize(1e-6)?;
    let down = sight.cross(&right);
    let normal = left_from_board.rotation().column(2).into_owned();
    let toward = normal.dot(&sight);
    Some(BoardPlace {
        distance_m,
        tilt_up_down_rad: normal.dot(&down).atan2(toward),
        tilt_left_right_rad: normal.dot(&right).atan2(toward),
    })
}

/// Middle of the inner corners.
pub fn middle_of(board: &Chessboard) -> Point<Board> {
    let (first, last) = (board.corner(0), board.corner(board.corner_count() - 1));
    Point::from(nalgebra::center(&first.coords, &last.coords))
}

/// Diagonal of the inner corners, meters.
pub fn diagonal_m(board: &Chessboard) -> f64 {
    board.corner(0).distance_m(&board.corner(board.corner_count() - 1))
}

/// Board plane to directions: the eigenvector of the smallest eigenvalue of the normal equations.
fn homography(
    board: &Chessboard,
    seen: &[(Point<Board>, Vector3<f64>)],
    ahead_from_camera: &UnitQuaternion<f64>,
) -> Option<Matrix3<f64>> {
    // Board coordinates around 0 and of size 1 keep the equations well scaled.
    let (middle, scale_m) = (middle_of(board).coords, 0.5 * diagonal_m(board));
    let mut rows = DMatrix::<f64>::zeros(2 * seen.len(), 9);
    for (i, (corner, direction)) in seen.iter().enumerate() {
        let ahead = ahead_from_camera * direction;
        if ahead.z < 0.05 {
            return None;
        }
        let (x, y) = (ahead.x / ahead.z, ahead.y / ahead.z);
        let on_board = [(corner.coords.x - middle.x) / scale_m, (corner.coords.y - middle.y) / scale_m, 1.0];
        for (j, value) in on_board.into_iter().enumerate() {
            rows[(2 * i, j)] = value;
            rows[(2 * i, 6 + j)] = -x * value;
            rows[(2 * i + 1, 3 + j)] = value;
            rows[(2 * i + 1, 6 + j)] = -y * value;
        }
    }
    let eigen = decompose::symmetric_eigen(rows.transpose() * &rows)?;
    let smallest = eigen.eigenvalues.imin();
    let h = eigen.eigenvectors.column(smallest);
    let normalized = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    // Back to meters from the first inner corner.
    let to_unit = Matrix3::new(
        1.0 / scale_m,
        0.0,
        -middle.x / scale_m,
        0.0,
        1.0 / scale_m,
        -middle.y / scale_m,
        0.0,
        0.0,
        1.0,
    );
    Some(normalized * to_unit)
}

/// Rotation and translation of a homography of unit focal length.
fn pose_of(homography: &Matrix3<f64>) -> Option<Isometry3<f64>> {
    let [h1, h2, h3] = [0, 1, 2].map(|i| homography.column(i).into_owned());
    let length = 0.5 * (h1.norm() + h2.norm());
    if !(length > 1e-12 && length.is_finite()) {
        return None;
    }
    // A board is in front of the lens.
    let scale = if h3.z < 0.0 { -1.0 / length } else { 1.0 / length };
    let (r1, r2) = (h1 * scale, h2 * scale);
    let svd = decompose::svd(Matrix3::from_columns(&[r1, r2, r1.cross(&r2)]), true, true)?;
    let rotation = svd.u? * svd.v_t?;
    if rotation.determinant() < 0.0 {
        return None;
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    let translation = Translation3::from(h3 * scale);
    translation.vector.iter().all(|c| c.is_finite()).then(|| Isometry3::from_parts(translation, rotation))
}

/// Pose of a board whose middle is at `middle_in_left` and that is tilted against the line of
/// sight; the inverse of [`place_of`], upright in the image.
pub fn pose_at(
    board: &Chessboard,
    middle_in_left: &Point3<f64>,
    tilt_up_down_rad: f64,
    tilt_left_right_rad: f64,
) -> Option<Pose<LeftCamera, Board>> {
    let sight = middle_in_left.coords.try_normalize(1e-9)?;
    let right = (Vector3::x() - sight * sight.x).try_normalize(1e-6)?;
    let down = sight.cross(&right);
    let view = Matrix3::from_columns(&[right, down, sight]);
    let normal = Vector3::new(tilt_left_right_rad.tan(), tilt_up_down_rad.tan(), 1.0).normalize();
    let x = (Vector3::x() - normal * normal.x).try_normalize(1e-6)?;
    let tilt = Matrix3::from_columns(&[x, normal.cross(&x), normal]);
    let rotation = Rotation3::from_matrix_unchecked(view * tilt);
    let translation = middle_in_left.coords - rotation * middle_of(board).coords.coords;
    Some(Pose::new(Isometry3::from_parts(
        Translation3::from(translation),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn board() -> Chessboard {
        Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
    }

    /// A lens that differs from the nominal one: the truth.
    fn true_lens() -> Camera {
        let mut camera = nominal_cameras((640, 480), ModelKind::Fisheye).left;
        camera.model = CameraModel::from_parameters(
            ModelKind::Fisheye,
            &[156.0, 155.0, 330.0, 236.0, 0.02, -0.01, 0.0, 0.0],
        );
        camera
    }

    fn seen(camera: &Camera, left_from_board: &Pose<LeftCamera, Board>) -> Corners {
        board()
            .corners()
            .into_iter()
            .map(|corner| camera.project(&(*left_from_board * corner).coords.coords).ok())
            .collect()
    }

    #[test]
    fn a_known_place_is_recovered_exactly_with_the_true_lens() {
        for (x, y, up_down, left_right) in
            [(0.0, 0.0, 0.0, 0.0), (0.2, -0.1, 0.5, 0.0), (-0.5, 0.1, 0.0, -0.6), (0.1, 0.3, -0.4, 0.3)]
        {
            let truth = pose_at(&board(), &Point3::new(x, y, 0.35), up_down, left_right).expect("a pose");
            let corners = seen(&true_lens(), &truth);
            let found = rough_pose(&true_lens(), &board(), &corners).expect("found");
            assert!((found.translation_m() - truth.translation_m()).norm() < 1e-6);
            let place = place_of(&board(), &found).expect("a place");
            assert!((place.tilt_up_down_rad - up_down).abs() < 1e-5, "{place:?}");
            assert!((place.tilt_left_right_rad - left_right).abs() < 1e-5, "{place:?}");
            assert!((place.distance_m - Vector3::<f64>::new(x, y, 0.35).norm()).abs() < 1e-6);
        }
    }

    #[test]
    fn the_nominal_lens_is_good_enough_to_sort_places() {
        let nominal = nominal_cameras((640, 480), ModelKind::Fisheye).left;
        let truth = pose_at(&board(), &Point3::new(0.15, 0.1, 0.4), 0.45, 0.0).expect("a pose");
        let found = rough_pose(&nominal, &board(), &seen(&true_lens(), &truth)).expect("found");
        let place = place_of(&board(), &found).expect("a place");
        assert!(
            (place.distance_m / Vector3::<f64>::new(0.15, 0.1, 0.4).norm() - 1.0).abs() < 0.1,
            "{place:?}"
        );
        assert!((place.tilt_up_down_rad - 0.45).abs() < 0.2, "{place:?}");
    }

    #[test]
    fn the_top_is_away_for_a_positive_up_down_tilt() {
        let pose = pose_at(&board(), &Point3::new(0.0, 0.0, 0.4), 0.5, 0.0).expect("a pose");
        let (top, bottom) = (pose * board().corner(0), pose * board().corner(39));
        assert!(top.coords.y < bottom.coords.y, "upright in the image");
        assert!(top.coords.z > bottom.coords.z, "top away");
        let pose = pose_at(&board(), &Point3::new(0.0, 0.0, 0.4), 0.0, 0.5).expect("a pose");
        let (left, right) = (pose * board().corner(0), pose * board().corner(7));
        assert!(left.coords.x < right.coords.x);
        assert!(left.coords.z > right.coords.z, "left away");
    }

    #[test]
    fn few_corners_have_no_place() {
        let truth = pose_at(&board(), &Point3::new(0.0, 0.0, 0.4), 0.0, 0.0).expect("a pose");
        let mut corners = seen(&true_lens(), &truth);
        for corner in corners.iter_mut().skip(LEAST_CORNERS - 1) {
            *corner = None;
        }
        assert!(rough_pose(&true_lens(), &board(), &corners).is_none());
    }
}

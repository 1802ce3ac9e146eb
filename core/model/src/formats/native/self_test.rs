//! What the cameras of a file answered when it was written. A file that answers otherwise when it is
//! read has been changed or damaged since, however plausible its numbers are.

use crate::calibration::{Evidence, StereoCalibration};
use crate::formats::error::FormatError;
use crate::formats::node::Field;
use crate::frame::{LeftCamera, Point};
use crate::pixel::{Eye, Pixel, Raw};
use crate::stereo::StereoCameras;

/// Key of the answers.
pub(super) const KEY: &str = "self_test";
/// Key of the sums over what no answer depends on.
pub(super) const SUMS: &str = "self_test_sums";
/// x, y, z of a point in the left camera (m), and its pixels in the left and the right image.
type Answer = [f64; 7];
/// Answers that are kept.
const MOST: usize = 24;
/// Corners that are taken of a pair.
const OF_A_PAIR: usize = 3;
/// Sums may differ by this part of themselves: they are of numbers that come back digit for digit.
const SUM_TOLERANCE: f64 = 1e-12;
/// Another processor may round otherwise, by far less than this, px.
const TOLERANCE_PX: f64 = 1e-3;
/// Points that are asked about whatever was measured, in the left camera, m: near the optical axis
/// and far aside of it, where the last coefficients of a lens show.
const ALWAYS: [[f64; 3]; 5] =
    [[0.02, 0.03, 0.5], [-0.2, 0.15, 0.5], [0.25, -0.2, 0.4], [0.6, 0.1, 0.35], [-0.5, -0.3, 0.3]];

/// Answers about points of the calibration's own corners, and about some others.
pub(super) fn answers(calibration: &StereoCalibration) -> Vec<Answer> {
    let cameras = &calibration.cameras;
    let own = calibration.evidence.iter().flat_map(|evidence| own_points(cameras, evidence));
    let points = ALWAYS.into_iter().map(|[x, y, z]| Point::new(x, y, z)).chain(own);
    points.filter_map(|point| answer(cameras, point)).take(MOST).collect()
}

/// Where both eyes put some corners of each pair.
fn own_points<'a>(
    cameras: &'a StereoCameras,
    evidence: &'a Evidence,
) -> impl Iterator<Item = Point<LeftCamera>> + 'a {
    let pairs =
        evidence.observations.iter().filter_map(|pair| Some((pair.left.as_ref()?, pair.right.as_ref()?)));
    pairs.flat_map(move |(left, right)| {
        let both =
            left.iter().zip(right).filter_map(|(left, right)| cameras.triangulate((*left)?, (*right)?));
        let found: Vec<Point<LeftCamera>> = both.filter(|point| point.range_m() < 10.0).collect();
        let step = found.len().div_ceil(OF_A_PAIR).max(1);
        found.into_iter().step_by(step)
    })
}

/// `None` where an eye does not see the point.
fn answer(cameras: &StereoCameras, point: Point<LeftCamera>) -> Option<Answer> {
    let seen = |eye: Eye| -> Option<Pixel<Raw>> {
        let in_eye = match eye {
            Eye::Left => point.coords.coords,
            Eye::Right => (cameras.right_from_left * point).coords.coords,
        };
        cameras.camera(eye).project(&in_eye).ok()
    };
    let (left, right) = (seen(Eye::Left)?, seen(Eye::Right)?);
    let [x, y, z] = point.coords.coords.into();
    let answer = [x, y, z, left.u_px, left.v_px, right.u_px, right.v_px];
    answer.iter().all(|number| number.is_finite()).then_some(answer)
}

/// Refuses cameras that do not answer as the file says that they did.
pub(super) fn check(cameras: &StereoCameras, kept: &Field<'_>) -> Result<(), FormatError> {
    for one in kept.items()? {
        let expected: Answer = one.exactly()?;
        let now = answer(cameras, Point::new(expected[0], expected[1], expected[2]));
        let off_px = now.map_or(f64::INFINITY, |now| {
            now.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        });
        if off_px.is_nan() || off_px > TOLERANCE_PX {
            return Err(FormatError::OtherAnswers { place: one.place(), off_px });
        }
    }
    Ok(())
}

/// Sums over the covariance, the corners, the residuals, the places of the board, and the summary.
/// Every number counts for as much as its digits say, however small it is.
pub(super) fn sums(calibration: &StereoCalibration) -> [f64; 5] {
    let evidence = calibration.evidence.iter().flat_map(|evidence| &evidence.observations);
    let corners = evidence.flat_map(|pair| pair.left.iter().chain(&pair.right)).flatten().flatten();
    let residuals = calibration.per_pair.iter().flat_map(|pair| &pair.residuals);
    let places = calibration.per_pair.iter().map(|pair| &pair.left_from_board.isometry);
    let summary = calibration.summary.iter().flat_map(|fit| {
        let own = [fit.rms_left_px, fit.rms_right_px, fit.rms_stereo_px, fit.epipolar_px, fit.square_mean_m];
        own.into_iter().chain([fit.square_sd_m]).chain(fit.cross_validated_px)
    });
    [
        sum(calibration.covariance.iter().flat_map(|covariance| covariance.matrix.iter().copied())),
        sum(corners.flat_map(|corner| [corner.u_px, corner.v_px])),
        sum(residuals.flat_map(|r| [r.measured.u_px, r.measured.v_px, r.error_px[0], r.error_px[1]])),
        sum(places
            .flat_map(|place| place.translation.vector.iter().chain(place.rotation.coords.iter()).copied())),
        sum(summary),
    ]
}

/// Of sign and magnitude, in which small numbers show beside large ones.
fn sum(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers
        .filter(|number| *number != 0.0)
        .map(|number| number.signum() * (100.0 + number.abs().log10()))
        .sum()
}

/// Refuses a calibration whose evidence is not what it was.
pub(super) fn check_sums(calibration: &StereoCalibration, kept: &Field<'_>) -> Result<(), FormatError> {
    const OF: [&str; 5] = ["covariance", "corners", "residuals", "places of the board", "summary"];
    let expected: [f64; 5] = kept.exactly()?;
    for ((what, now), then) in OF.into_iter().zip(sums(calibration)).zip(expected) {
        // Not so for NaN either.
        if !((now - then).abs() <= SUM_TOLERANCE * then.abs().max(1.0)) {
            return Err(FormatError::ChangedSince { place: kept.place(), what });
        }
    }
    Ok(())
}

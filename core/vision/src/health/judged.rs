//! Calibrations judged on the same places: how far off each puts what lies on the table, whether that is bearable, and
//! which of two is better.

use nalgebra::Point3;
use plumbline_model::robot::{Rig, RigPart};
use plumbline_model::{LeftCamera, Point, StereoCameras};

use super::cost::{Cost, cost};
use super::matches::{HealthError, Match};
use super::turn::{Turn, epipolar_px, fit_turn, fits_better_by};

/// A calibration that puts places farther off than this is not good any more, m: what a hand that grasps
/// bears.
pub const BEARABLE_M: f64 = 0.008;
/// A turn is believed when it is so many standard deviations away from none.
const SURE: f64 = 3.0;
/// One calibration beats another by so many standard deviations: those by which its right eye stands where the
/// images say, or those by which it fits the same places.
const BETTER: f64 = 3.0;
/// Places across the table, shares of its half width.
const ACROSS: [f64; 3] = [-0.6, 0.0, 0.6];

/// Places on the table, in the left eye: near, in the middle, far.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRows(pub [Vec<Point<LeftCamera>>; 3]);

impl TableRows {
    /// The patch on which the robot works, its head as in the home pose; straight ahead where the rig has no eyes.
    pub fn of(rig: &Rig, cameras: &StereoCameras) -> Self {
        if rig.need(RigPart::Eyes).is_err() {
            let ahead = |z_m: f64| ACROSS.map(|share| Point::new(0.3 * share, 0.15, z_m)).to_vec();
            let reach_m = cameras.baseline_m() * 10.0;
            return Self([0.5, 0.75, 1.0].map(|share| ahead(share * reach_m)));
        }
        let left_from_robot = rig.robot_from_left(&rig.home()).isometry.inverse();
        let [near_m, far_m] = rig.work_patch.x_range_m;
        let [right_m, left_m] = rig.work_patch.y_range_m;
        let row = |x_m: f64| {
            let at = |share: &f64| {
                let y_m = 0.5 * (right_m + left_m) + share * 0.5 * (left_m - right_m);
                Point::from(left_from_robot * Point3::new(x_m, y_m, rig.table.height_m))
            };
            ACROSS.iter().map(at).collect()
        };
        Self([near_m, 0.5 * (near_m + far_m), far_m].map(row))
    }
}

/// How one calibration does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// How far off it puts places near, in the middle and far.
    pub costs: [Cost; 3],
    /// How the right eye has turned against the left one since.
    pub turn: Turn,
    /// How far places leave its epipolar planes, rms, px.
    pub epipolar_px: f64,
}

impl Judged {
    /// Whether it is still good: nowhere on the table off by more than a grasp bears, as far as can be told.
    pub fn is_good(&self) -> bool {
        let is_off = |cost: &Cost| cost.error_m > BEARABLE_M && cost.error_m > SURE * cost.sigma_m;
        !self.costs.iter().any(is_off)
    }
}

/// Judges a calibration; `None`: an eye does not see the table.
///
/// # Errors
/// When the matches do not tell how the eye has turned.
pub fn judge(
    cameras: &StereoCameras,
    matches: &[Match],
    table: &TableRows,
) -> Result<Option<Judged>, HealthError> {
    let turn = fit_turn(cameras, matches)?;
    let [near, middle, far] = &table.0;
    let costs = [near, middle, far].map(|row| cost(cameras, &turn, row));
    let [Some(near), Some(middle), Some(far)] = costs else { return Ok(None) };
    let epipolar_px = epipolar_px(cameras, matches)?;
    Ok(Some(Judged { costs: [near, middle, far], turn, epipolar_px }))
}

/// Which of two calibrations fits the images better, beyond doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The one in use.
    InUse,
    /// The proposed one.
    Proposed,
    /// They cannot be told apart.
    Undecided,
}

/// Compares the calibration in use with a proposed one on the same matches.
///
/// # Errors
/// When the eyes of one of them are in one place.
pub fn better(
    in_use: (&StereoCameras, &Turn),
    proposed: (&StereoCameras, &Turn),
    matches: &[Match],
) -> Result<Better, HealthError> {
    let fits_by = fits_better_by(in_use.0, proposed.0, matches)?;
    Ok(beats(fits_by, in_use.1.sigmas().zip(proposed.1.sigmas())))
}

/// From how much better the second fits and how far both are from where the images say that the eye stands.
fn beats(second_fits_by: f64, turns_sigmas: Option<(f64, f64)>) -> Better {
    let stands_by = turns_sigmas.map_or(0.0, |(first, second)| first - second);
    let most = if second_fits_by.abs() > stands_by.abs() { second_fits_by } else { stands_by };
    // Both have to point the same way.
    let agree = second_fits_by * stands_by >= 0.0;
    match most {
        by if agree && by > BETTER => Better::Proposed,
        by if agree && by < -BETTER => Better::InUse,
        _ => Better::Undecided,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    #[test]
    fn one_beats_the_other_only_where_fit_and_stand_point_the_same_way() {
        assert_eq!(beats(5.0, Some((6.0, 1.0))), Better::Proposed);
        assert_eq!(beats(-5.0, Some((1.0, 6.0))), Better::InUse);
        assert_eq!(beats(5.0, Some((1.0, 6.0))), Better::Undecided, "they disagree");
        assert_eq!(beats(1.0, Some((2.0, 1.0))), Better::Undecided, "too little");
        assert_eq!(beats(4.0, None), Better::Proposed);
    }

    #[test]
    fn what_a_grasp_bears_and_what_is_not_sure_is_good() {
        let turn = Turn { rotation_rad: Vector3::zeros(), covariance_rad2: Matrix3::identity() };
        let off = |error_m, sigma_m| {
            Judged { costs: [Cost { error_m, sigma_m }; 3], turn, epipolar_px: 0.1 }.is_good()
        };
        assert!(off(0.007, 0.0001) && off(0.02, 0.01));
        assert!(!off(0.02, 0.001));
    }
}

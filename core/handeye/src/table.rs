//! How much lower than the glass the table around the screen lies, by what both eyes match on it.
//!
//! Glass is nothing that eyes can match, and a table without any pattern neither: then nobody knows it.

use nalgebra::{Isometry3, Point3};
use plumbline_grasp::Body;
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;
use plumbline_model::{Pixel, StereoCalibration};
use plumbline_vision::locate::Locator;
use serde::{Deserialize, Serialize};

use crate::HandEyeError;
use crate::picture::{grays, still};
use crate::screen::SeenScreen;

/// Places that are looked at lie so far apart, m.
const STEP_M: f64 = 0.012;
/// They are so far beside the frame, m: nearer its edge would be matched.
const BESIDE_M: f64 = 0.02;
/// …and no farther: what a plane of that tilt is off by grows with the distance.
const FAR_M: f64 = 0.16;
/// Places in robot frame that are on the table for sure stay so far from its rim, m.
const RIM_M: f64 = 0.03;
/// What lies farther from where the table should be is something on it, m.
const PLAUSIBLE_M: f64 = 0.02;
/// Of the places those count that are nearer to the middle of all than so many robust deviations.
const ODD: f64 = 3.0;
/// Fewer places tell nothing.
const FEWEST: usize = 30;
/// Neighboring places share what surrounds them: so many of them count as one.
const ALIKE: f64 = 4.0;
/// Lenses and mount leave at least this much, m.
const LEAST_SD_M: f64 = 0.0005;

/// The table around the screen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableBeside {
    /// So much higher the glass lies, m.
    pub glass_over_m: f64,
    /// One standard deviation, m.
    pub sd_m: f64,
    /// Places that were matched and count.
    pub places: usize,
}

/// Looks at the table from where the head stands, which is home. `rig` has its eyes where they sit, `placed` has
/// the screen's size. `None` when too few places are matched. Nothing moves.
///
/// # Errors
/// When there is no pair, or the calibration cannot be used.
pub fn see(
    body: &mut dyn Body,
    rig: &Rig,
    calibration: &StereoCalibration,
    screen: &SeenScreen,
    placed: &Touchscreen,
) -> Result<Option<TableBeside>, HandEyeError> {
    let sight = still(body)?;
    let [(left, _), (right, _)] = grays(&sight);
    let posture = sight.posture;
    let locator = Locator::new(calibration)?;
    let robot_from_left = rig.robot_from_left(&posture).isometry;
    let pixels: Vec<Pixel<plumbline_model::Raw>> = places(rig, &screen.robot_from_screen, placed)
        .into_iter()
        .filter_map(|place| {
            let in_left = robot_from_left.inverse() * place;
            calibration.cameras.left.project(&in_left.coords).ok()
        })
        .collect();
    let located = locator.locate(&left, &right, &pixels);
    let screen_from_left = screen.robot_from_screen.inverse() * robot_from_left;
    let under_m = located.into_iter().flatten().map(|found| (screen_from_left * found.point.coords).z);
    Ok(middle(under_m.filter(|under_m| under_m.abs() < PLAUSIBLE_M).collect()))
}

/// Places on the table around the screen, robot frame.
fn places(rig: &Rig, robot_from_screen: &Isometry3<f64>, screen: &Touchscreen) -> Vec<Point3<f64>> {
    let frame_m = rig.outlines.screen_frame.as_ref().map_or(0.0, |frame| frame.side_m.max(frame.near_m));
    let inner = [0.5 * screen.width_m + frame_m + BESIDE_M, 0.5 * screen.height_m + frame_m + BESIDE_M];
    let (x_m, y_m) = (rig.table.x_range_m, rig.table.y_range_m);
    let steps = |half_m: f64| {
        let count = (half_m / STEP_M).ceil() as i32;
        (-count..=count).map(|k| f64::from(k) * STEP_M)
    };
    let mut found = vec![];
    for u_m in steps(inner[0] + FAR_M) {
        for v_m in steps(inner[1] + FAR_M) {
            if u_m.abs() < inner[0] && v_m.abs() < inner[1] {
                continue;
            }
            let place = robot_from_screen * Point3::new(u_m, v_m, 0.0);
            let within = |value: f64, [low, high]: [f64; 2]| value > low + RIM_M && value < high - RIM_M;
            if within(place.x, x_m) && within(place.y, y_m) {
                found.push(place);
            }
        }
    }
    found
}

/// What most of them say; `None` when they are too few.
fn middle(mut under_m: Vec<f64>) -> Option<TableBeside> {
    under_m.sort_by(f64::total_cmp);
    let median = |sorted: &[f64]| sorted.get(sorted.len() / 2).copied();
    let center_m = median(&under_m)?;
    let mut off_m: Vec<f64> = under_m.iter().map(|m| (m - center_m).abs()).collect();
    off_m.sort_by(f64::total_cmp);
    // 1.48 median deviations are a standard deviation, where errors are normal.
    let spread_m = 1.48 * median(&off_m)?;
    let kept: Vec<f64> =
        under_m.into_iter().filter(|m| (m - center_m).abs() <= ODD * spread_m.max(LEAST_SD_M)).collect();
    if kept.len() < FEWEST {
        return None;
    }
    let mean_m = kept.iter().sum::<f64>() / kept.len() as f64;
    let sd_m = (spread_m / (kept.len() as f64 / ALIKE).sqrt()).hypot(LEAST_SD_M);
    Some(TableBeside { glass_over_m: mean_m, sd_m, places: kept.len() })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn the_middle_of_many_is_what_most_say_and_of_few_nothing() {
        let many: Vec<f64> = (0..90).map(|k| 0.003 + 1e-4 * f64::from(k % 9 - 4)).collect();
        let clean = middle(many.clone()).expect("enough");
        assert!((clean.glass_over_m - 0.003).abs() < 1e-9 && clean.places == 90, "{clean:?}");
        // A hand that lies there.
        let with_hand =
            middle(many.iter().copied().chain((0..25).map(|_| -0.015)).collect()).expect("enough");
        assert!((with_hand.glass_over_m - 0.003).abs() < 1e-4 && with_hand.places == 90, "{with_hand:?}");
        assert_eq!(middle(many[..FEWEST - 1].to_vec()), None);
        assert_eq!(middle(vec![]), None);
    }

    #[test]
    fn places_lie_on_the_table_and_beside_the_frame() {
        let rig = Rig::built_in("nico").expect("valid");
        let screen = &rig.touchscreen;
        let at = plumbline_fit::pose(screen);
        let found = places(&rig, &at, screen);
        assert!(found.len() > 200, "{}", found.len());
        for place in found {
            let in_screen: Vector3<f64> = (at.inverse() * place).coords;
            let beside_u = in_screen.x.abs() - 0.5 * screen.width_m;
            let beside_v = in_screen.y.abs() - 0.5 * screen.height_m;
            assert!(beside_u.max(beside_v) > 0.03, "{in_screen:?}");
            assert!(place.x > rig.table.x_range_m[0] && place.x < rig.table.x_range_m[1]);
        }
    }
}

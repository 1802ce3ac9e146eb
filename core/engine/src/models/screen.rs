//! Whether what was learned on one touchscreen holds on another, or on the same one elsewhere.

use nalgebra::Vector3;
use plumbline_correction::ScreenSize;
use plumbline_model::session::Touchscreen;
use plumbline_model::{Direction, Point};

use super::error::ModelError;

/// Sizes that differ by less are the same, m.
const SAME_SIZE_M: f64 = 1e-3;
/// A screen whose corners moved less than this lies where it lay, m.
const MOVED_M: f64 = 1e-4;

/// Corners of a screen, as they are kept with a model.
pub type Corners = [[f64; 3]; 4];

/// Where a screen lies.
pub fn corners(screen: &Touchscreen) -> Corners {
    screen.corners().map(|corner| corner.coords.into())
}

/// The screen with its corners there; `None` where they span none.
pub fn lying(screen: &Touchscreen, corners: &Corners) -> Option<Touchscreen> {
    let [origin, right, _, bottom] = corners.map(Vector3::from);
    let along = |to: Vector3<f64>| Some(((to - origin).norm(), Direction::new(to - origin)?));
    let ((width_m, u_axis), (height_m, v_axis)) = (along(right)?, along(bottom)?);
    let origin = Point::new(origin.x, origin.y, origin.z);
    Some(Touchscreen { width_m, height_m, origin, u_axis, v_axis, ..screen.clone() })
}

/// Refuses a screen of another size; `whose` begins the sentence.
pub fn same_size(learned: &ScreenSize, present: &ScreenSize, whose: &'static str) -> Result<(), ModelError> {
    let pixels = (learned.width_px, learned.height_px) == (present.width_px, present.height_px);
    let meters = (learned.width_m - present.width_m).abs() <= SAME_SIZE_M
        && (learned.height_m - present.height_m).abs() <= SAME_SIZE_M;
    if pixels && meters {
        return Ok(());
    }
    Err(ModelError::OtherScreen { whose, learned: *learned, present: *present })
}

/// How far the farthest corner moved, m; `None` when the screen lies where it lay.
pub fn moved_m(then: &Corners, now: &Corners) -> Option<f64> {
    let moves =
        then.iter().zip(now).map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
    Some(moves.fold(0.0, f64::max)).filter(|moved_m| *moved_m > MOVED_M)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Vector3};
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn a_screen_lies_where_its_corners_are() {
        let nominal = Rig::built_in("nico").expect("comes along").touchscreen;
        let turned = Isometry3::new(Vector3::new(0.01, -0.02, 0.005), Vector3::new(0.01, -0.02, 0.03));
        let moved = nominal.moved(&turned);
        let again = lying(&nominal, &corners(&moved)).expect("a screen");
        let farthest_m = moved_m(&corners(&moved), &corners(&again));
        assert_eq!(farthest_m, None, "{again:?}");
        assert!((again.width_m - nominal.width_m).abs() < 1e-12);
        assert_eq!(lying(&nominal, &[[0.1, 0.2, 0.3]; 4]), None, "one point is no screen");
    }
}

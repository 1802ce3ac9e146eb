//! Whether what was learned on one touchscreen holds on another, or on the same one elsewhere.

use plumbline_correction::ScreenSize;
use plumbline_model::session::Touchscreen;

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

//! What is known before anything is measured, wherever it is used.

use plumbline_effects::What;

/// Masses of a description are off by this share (printed parts, cables, screws that nobody weighed).
pub(crate) const MASS_SD: f64 = 0.2;
/// A fingertip's pad gives way and the angles are logged a moment before or after: the height at
/// contact is off by this whatever repeats say, m.
const CONTACT_M: f64 = 0.45e-3;

/// Standard deviation that a coordinate is weighed by.
pub(crate) fn standard(what: What, coordinate: usize, floor: f64) -> f64 {
    if what == What::Touch && coordinate == 2 { floor.hypot(CONTACT_M) } else { floor }
}

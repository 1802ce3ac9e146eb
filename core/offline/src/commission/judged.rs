//! What the judge of a commissioned twin tells.

use serde::{Deserialize, Serialize};

/// Median and 95 % of errors, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaceError {
    /// Median of the distance in space.
    pub median: Option<f64>,
    /// 95 % of them lie below.
    pub p95: Option<f64>,
    /// Median and 95 % of where both eyes see it by themselves, without its shape and the height of the table.
    #[serde(default)]
    pub by_eyes: [Option<f64>; 2],
    /// Median of the distance along the table.
    pub plane_median: Option<f64>,
    /// 95 % of those lie below.
    pub plane_p95: Option<f64>,
    /// Mean error (found − true) along x, y, z.
    pub mean: Option<[f64; 3]>,
    /// Mean of the stated standard deviations along x, y, z.
    #[serde(default)]
    pub sigma: Option<[f64; 3]>,
    /// Share of the errors along x, y, z within the stated standard deviation, 0 to 1: honest at 0.68.
    #[serde(default)]
    pub within_sigma: Option<f64>,
    /// The same within two of them: honest at 0.95.
    #[serde(default)]
    pub within_two_sigma: Option<f64>,
    /// Mean of eᵀ C⁻¹ e over the places: honest at 3.
    #[serde(default)]
    pub chi2: Option<f64>,
    /// Places where the object was found.
    pub found: usize,
    /// Places where it stood.
    pub places: usize,
    /// Each place where it was found.
    #[serde(default)]
    pub rows: Vec<PlaceRow>,
}

/// An object that was found at a place; robot frame, along x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaceRow {
    /// Where it was put, x and y, m.
    pub at_m: [f64; 2],
    /// Found − true, mm.
    pub error_mm: [f64; 3],
    /// Stated standard deviation, mm.
    pub sigma_mm: [f64; 3],
}

/// Errors of the palm, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PalmError {
    /// Median of its distance in space from where it was sent, robot frame.
    pub median: Option<f64>,
    /// 95 % of them lie below.
    pub p95: Option<f64>,
    /// Median of its distance along the table from an object that it was sent to where the eyes found it:
    /// errors that arm and eyes share do not count.
    pub to_object_median: Option<f64>,
    /// 95 % of those lie below.
    pub to_object_p95: Option<f64>,
    /// Standard deviation of its place as the effects state it, over all axes, rms.
    #[serde(default)]
    pub stated: Option<f64>,
    /// Share of the errors, along each axis by itself, inside of the stated 95 %.
    #[serde(default)]
    pub within_95: Option<f64>,
    /// Places that it was sent to.
    pub places: usize,
}

/// Errors of new touches, touched − aimed along the glass, rms, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchError {
    /// Inside of the touched area.
    pub inside: Option<f64>,
    /// Outside of it.
    pub outside: Option<f64>,
    /// Mean of the same lengths inside …
    #[serde(default)]
    pub inside_mean: Option<f64>,
    /// … and outside.
    #[serde(default)]
    pub outside_mean: Option<f64>,
    /// Touches inside.
    pub inside_touches: usize,
    /// Touches outside.
    pub outside_touches: usize,
    /// Inside, with M3 from the same touches.
    #[serde(default)]
    pub m3_inside: Option<f64>,
    /// Outside, with M3 from the same touches.
    #[serde(default)]
    pub m3_outside: Option<f64>,
    /// The same touches without any effect and with the nominal screen would have missed by, rms.
    pub uncorrected: Option<f64>,
}

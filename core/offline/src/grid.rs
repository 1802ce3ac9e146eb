//! `plumbline grid`: places on a grid of known targets, how far off they came out, and what the published
//! correction makes of them.

use std::path::PathBuf;

use plumbline_drift::{GridErrors, GridPlace, PivotCorrection, grid_places};
use plumbline_model::JobContext;
use serde::Serialize;

use super::OfflineError;
use super::session;

/// Which places.
#[derive(Clone, Debug)]
pub struct GridArgs {
    /// Session with `localizations.csv`: true places and estimates.
    pub session: PathBuf,
}

/// How far off places came out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridReport {
    /// Without a correction, then each that could be made.
    pub corrections: Vec<GridCorrection>,
    /// Coefficients of the pivot correction as published: shift a·d² + b·d + c (m) and factor far away.
    pub published: [f64; 4],
    /// The same fitted to these places; null where they do not tell it.
    pub fitted: Option<[f64; 4]>,
}

/// Places with one correction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridCorrection {
    /// `none`, `pivot-published`, `pivot-fitted` (on the same places) or `pivot-held-out` (each place by a fit
    /// to the others).
    pub correction: &'static str,
    /// Mean error in the plane of the table.
    pub mean_mm: f64,
    /// Its median.
    pub median_mm: f64,
    /// Its largest.
    pub worst_mm: f64,
    /// Every place.
    pub places: Vec<GridRow>,
}

/// A place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GridRow {
    /// Where it is, robot frame.
    pub target_m: [f64; 3],
    /// Where it came out, robot frame.
    pub estimate_m: [f64; 3],
    /// How far that is off in the plane of the table.
    pub error_mm: f64,
}

/// Judges the places of a session.
pub fn grid(args: &GridArgs, _: &dyn JobContext) -> Result<GridReport, OfflineError> {
    let (session, rig) = session::open(&args.session)?;
    let places = session.localizations.as_ref().map(|table| grid_places(table, &rig)).unwrap_or_default();
    if places.is_empty() {
        return Err(OfflineError::NoGrid(args.session.clone()));
    }
    let published: Vec<GridPlace> =
        places.iter().map(|place| PivotCorrection::PUBLISHED.applied(place)).collect();
    let fitted = PivotCorrection::fitted(&places);
    let mut corrections = vec![corrected("none", &places), corrected("pivot-published", &published)];
    if let Some(fitted) = &fitted {
        let on_the_same: Vec<GridPlace> = places.iter().map(|place| fitted.applied(place)).collect();
        corrections.push(corrected("pivot-fitted", &on_the_same));
    }
    if let Some(held_out) = PivotCorrection::leave_one_out(&places) {
        corrections.push(corrected("pivot-held-out", &held_out));
    }
    let numbers = |pivot: &PivotCorrection| {
        let [a, b, c] = pivot.shift;
        [a, b, c, pivot.far_factor]
    };
    Ok(GridReport {
        corrections: corrections.into_iter().flatten().collect(),
        published: numbers(&PivotCorrection::PUBLISHED),
        fitted: fitted.as_ref().map(numbers),
    })
}

fn corrected(correction: &'static str, places: &[GridPlace]) -> Option<GridCorrection> {
    let errors = GridErrors::of(places)?;
    let row = |place: &GridPlace| GridRow {
        target_m: place.target.coords.coords.into(),
        estimate_m: place.estimate.coords.coords.into(),
        error_mm: 1e3 * place.error_m().norm(),
    };
    Some(GridCorrection {
        correction,
        mean_mm: 1e3 * errors.mean_m,
        median_mm: 1e3 * errors.median_m,
        worst_mm: 1e3 * errors.worst_m,
        places: places.iter().map(row).collect(),
    })
}

//! The 9 by 4 evaluation: where things are laid, and how far off they come out with one correction or another.

use nalgebra::Matrix3;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::session::{LocalizationRow, LocalizationTable};
use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};

use crate::grid::{GridErrors, GridPlace, PivotCorrection, places_by};

/// Distances of the rows from the torso, and places across each, robot frame, m: as published.
const ROWS_M: [f64; 4] = [0.2, 0.3, 0.4, 0.5];
const ACROSS: usize = 9;
const STEP_M: f64 = 0.1;

/// The published places (x, y; robot frame, m), row by row from the robot on, and each row begun where the one
/// before has ended: whoever lays them walks the least.
pub fn evaluation_places_m() -> Vec<[f64; 2]> {
    let row = |(number, x_m): (usize, &f64)| {
        let x_m = *x_m;
        (0..ACROSS).map(move |k| {
            let k = if number % 2 == 0 { k } else { ACROSS - 1 - k };
            [x_m, STEP_M * (k as f64 - 4.0)]
        })
    };
    ROWS_M.iter().enumerate().flat_map(row).collect()
}

/// What is made of places before they are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GridCorrection {
    /// As the robot's description has them, with what was calibrated.
    #[default]
    Described,
    /// With the effects of the model in use, in the ray and the disparity.
    Model,
    /// The pivot, with the published numbers.
    PivotPublished,
    /// The pivot, each place by a fit to all others.
    PivotHeldOut,
}

impl GridCorrection {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Described, Self::Model, Self::PivotPublished, Self::PivotHeldOut];

    /// For people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Described => "As described",
            Self::Model => "Model in use",
            Self::PivotPublished => "Published pivot",
            Self::PivotHeldOut => "Pivot, fitted to the others",
        }
    }
}

/// Places with one correction.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Every place that was seen.
    pub places: Vec<GridPlace>,
    /// How far off they are in the plane of the table.
    pub errors: GridErrors,
    /// Places at which nothing was seen.
    pub not_seen: usize,
}

/// Why nothing can be judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotJudged {
    /// No row counts.
    #[error("it has no place with a target and an estimate: measure the grid again")]
    NoPlaces,
    /// A fit wants more.
    #[error("it has too few places to fit the pivot to: choose another correction, or measure more places")]
    TooFew,
}

/// Judges the places of a session by `model`'s rig, corrected.
///
/// # Errors
/// When nothing of it can be judged so.
pub fn judge(
    table: &LocalizationTable,
    model: &RobotModel,
    correction: GridCorrection,
) -> Result<Judged, NotJudged> {
    let described = || places_by(table, model.rig(), |row, _| row.estimate);
    let places = match correction {
        GridCorrection::Described => described(),
        GridCorrection::Model => by_model(table, model),
        GridCorrection::PivotPublished => {
            described().iter().map(|place| PivotCorrection::PUBLISHED.applied(place)).collect()
        }
        GridCorrection::PivotHeldOut => {
            PivotCorrection::leave_one_out(&described()).ok_or(NotJudged::TooFew)?
        }
    };
    let errors = GridErrors::of(&places).ok_or(NotJudged::NoPlaces)?;
    Ok(Judged { not_seen: not_seen(table, &places), places, errors })
}

/// Estimates as the effects of the model put them, at the time and with the head of each row.
fn by_model(table: &LocalizationTable, model: &RobotModel) -> Vec<GridPlace> {
    let rig = model.rig();
    places_by(table, rig, |row: &LocalizationRow, posture| {
        let in_left = rig.robot_from_left(posture).inverse() * row.estimate?;
        let seen = SeenUnder { t_secs: row.t_secs, background_m: row.background_m, ..SeenUnder::default() };
        Some(model.place(&in_left, &Matrix3::zeros(), posture, &seen)?.point)
    })
}

/// Targets of which no row counts.
fn not_seen(table: &LocalizationTable, places: &[GridPlace]) -> usize {
    let mut missing: Vec<Point<Robot>> = Vec::new();
    for target in table.rows().filter_map(|row| row.truth) {
        if !places.iter().any(|place| place.target == target) && !missing.contains(&target) {
            missing.push(target);
        }
    }
    missing.len()
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    fn rows() -> Vec<LocalizationRow> {
        let mut rows = Vec::new();
        for (k, [x_m, y_m]) in evaluation_places_m().into_iter().enumerate() {
            let truth = Some(Point::new(x_m, y_m, 0.05));
            // Two looks that scatter by 2 mm about 10 mm too far; the last place was never seen.
            for off_m in [0.009, 0.011] {
                let estimate = (k < 35).then(|| Point::new(x_m + off_m, y_m, 0.05));
                let group = Some(format!("{}", k + 1));
                rows.push(LocalizationRow {
                    truth,
                    estimate,
                    group,
                    valid: k < 35,
                    ..LocalizationRow::default()
                });
            }
        }
        rows
    }

    #[test]
    fn the_published_grid_has_nine_by_four_places() {
        let places = evaluation_places_m();
        assert_eq!(places.len(), 36);
        assert_eq!((places[0], places[8], places[9]), ([0.2, -0.4], [0.2, 0.4], [0.3, 0.4]));
        let farthest = places.windows(2).map(|two| (two[0][0] - two[1][0]).hypot(two[0][1] - two[1][1]));
        assert!(farthest.fold(0.0, f64::max) < 0.11, "each place is beside the one before");
    }

    #[test]
    fn looks_at_one_place_count_once_and_what_was_not_seen_is_counted() {
        let table = LocalizationTable::from_rows(vec![], &rows());
        let model = RobotModel::nominal(default_rig());
        for correction in [GridCorrection::Described, GridCorrection::Model] {
            let judged = judge(&table, &model, correction).expect("places");
            assert_eq!((judged.places.len(), judged.not_seen), (35, 1), "{correction:?}");
            let GridErrors { mean_m, median_m, worst_m } = judged.errors;
            for error_m in [mean_m, median_m, worst_m] {
                assert!((error_m - 0.010).abs() < 1e-9, "{correction:?}: {error_m}");
            }
        }
        let held_out = judge(&table, &model, GridCorrection::PivotHeldOut).expect("fits");
        assert!(held_out.errors.mean_m < 0.010, "{:?}", held_out.errors);
    }

    #[test]
    fn nothing_is_judged_of_nothing() {
        let model = RobotModel::nominal(default_rig());
        let table = LocalizationTable::from_rows(vec![], &[]);
        let judged = judge(&table, &model, GridCorrection::Described);
        assert_eq!(judged, Err(NotJudged::NoPlaces));
        assert_eq!(judge(&table, &model, GridCorrection::PivotHeldOut), Err(NotJudged::NoPlaces));
    }
}

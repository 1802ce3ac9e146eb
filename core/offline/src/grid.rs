//! `plumbline grid`: places on a grid of known targets, how far off they came out, and what the published
//! correction makes of them.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_drift::{
    GridCorrection as Correction, GridErrors, GridPlace, PivotCorrection, grid_places, judge,
};
use plumbline_effects::{RigModel, RobotModel};
use plumbline_model::JobContext;
use serde::Serialize;

use super::OfflineError;
use super::session;

/// Which places.
#[derive(Clone, Debug)]
pub struct GridArgs {
    /// Session with `localizations.csv`: true places and estimates.
    pub session: PathBuf,
    /// Effects of the eyes that are undone, as they are kept by the window or written by `gap`.
    pub rig_model: Option<PathBuf>,
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
    /// `none`, `pivot-published`, `pivot-fitted` (on the same places), `pivot-held-out` (each place by a fit
    /// to the others) or `rig-model` (with the effects of that model, at the time and with the head of each row).
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
    if let (Some(file), Some(table)) = (&args.rig_model, &session.localizations) {
        let added = RigModel::read(file, &rig)?;
        let model = RobotModel::new(Arc::new(rig), Arc::new(added))?;
        let judged = judge(table, &model, Correction::Model);
        corrections.push(judged.ok().and_then(|judged| corrected("rig-model", &judged.places)));
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

#[cfg(test)]
mod tests {
    use plumbline_effects::rig_model::ModelEffect;
    use plumbline_effects::{Effect, Kind};
    use plumbline_model::robot::default_rig;
    use plumbline_model::session::{LocalizationRow, LocalizationTable, Manifest, StereoImages};
    use plumbline_model::{Point, Session, Unattended};

    use super::*;

    /// Places that come out where they are, twenty minutes after the cameras were switched on.
    fn session(folder: &std::path::Path) {
        let place = |k: usize| Point::new(0.2 + 0.1 * (k / 3) as f64, 0.1 * (k % 3) as f64 - 0.1, 0.05);
        let row = |k: usize| LocalizationRow {
            truth: Some(place(k)),
            estimate: Some(place(k)),
            t_secs: Some(1200.0),
            valid: true,
            ..LocalizationRow::default()
        };
        let rows: Vec<LocalizationRow> = (0..9).map(row).collect();
        let session = Session {
            manifest: Manifest::of_rig("nico", jiff::Timestamp::UNIX_EPOCH),
            touches: None,
            localizations: Some(LocalizationTable::from_rows(vec![], &rows)),
            poses: None,
            stereo: StereoImages::default(),
            log: None,
        };
        session.write(folder).expect("written");
    }

    fn worst_mm(folder: &std::path::Path, model: &RigModel) -> f64 {
        let file = folder.join("rig-model.toml");
        model.write(&file, &default_rig()).expect("written");
        let args = GridArgs { session: folder.to_owned(), rig_model: Some(file) };
        let report = grid(&args, &Unattended).expect("judged");
        report.corrections.iter().find(|one| one.correction == "rig-model").expect("made").worst_mm
    }

    #[test]
    fn places_are_judged_with_the_effects_of_a_rig_model() {
        let folder = tempfile::tempdir().expect("a folder");
        session(folder.path());
        let mut model = RigModel::nominal(&default_rig());
        assert!(worst_mm(folder.path(), &model) < 1e-6, "without effects nothing is changed");
        model.contents.effects.push(ModelEffect {
            id: Kind::EyeYaw.id().to_owned(),
            site: "right".to_owned(),
            title: String::new(),
            tip: None,
            shape: Some(Effect::yaw_growth(240.0, 0.0)),
            reference_s: 0.0,
            values: vec![0.01],
            covariance: vec![],
            probability: None,
            parameters: vec![],
        });
        assert!(
            worst_mm(folder.path(), &model) > 10.0,
            "an eye that turned is undone at the time of each row"
        );
        let args = GridArgs { session: folder.path().to_owned(), rig_model: Some("none.toml".into()) };
        assert!(matches!(grid(&args, &Unattended), Err(OfflineError::Effects(_))));
    }
}

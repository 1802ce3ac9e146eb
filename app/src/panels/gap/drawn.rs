//! What is drawn of a finding over the table.

use std::sync::Arc;

use plumbline_engine::view::ShownFinding;
use plumbline_widgets::format;
use plumbline_widgets::table_map::{BeforeAfter, Outline, Place, TableMark, TableScene};
use plumbline_widgets::theme::Role;

use crate::operator::snapshot::gap::{Residual, ShownUnit};
use crate::panels::arrows::{Errors, arrow_scale};

/// Around everything that is shown, m.
pub const MARGIN_M: f64 = 0.04;

/// What is drawn of a finding, made once.
#[derive(Debug)]
pub struct Drawn {
    pub(crate) of: Arc<ShownFinding>,
    pub(crate) screen_m: Vec<[f64; 2]>,
    pub(crate) x_m: [f64; 2],
    pub(crate) y_m: [f64; 2],
    pub(crate) outliers: usize,
    pub(crate) mean_m: [f64; 2],
}

impl Drawn {
    pub fn of(shown: &Arc<ShownFinding>, screen_m: Vec<[f64; 2]>) -> Self {
        let rows = &shown.finding.comparison.residuals;
        let places = || rows.iter().map(|row| [row.at_m[0], row.at_m[1]]).chain(screen_m.iter().copied());
        let range = |axis: usize| {
            let (low, high) = places()
                .map(|at| at[axis])
                .filter(|value| value.is_finite())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            if low < high { [low - MARGIN_M, high + MARGIN_M] } else { [-0.5, 0.7] }
        };
        let kept: Vec<&Residual> = rows.iter().filter(|row| !row.outlier).collect();
        let mean = |of: &dyn Fn(&Residual) -> [f64; 3]| {
            kept.iter().map(|row| plane(of(row))).sum::<f64>() / kept.len().max(1) as f64
        };
        // Along the glass, where the finding tells it: on the map it is seen from above, which is a little less.
        let told = &shown.finding.shown;
        let mean_m = match told.unit {
            ShownUnit::Meter => [told.before, told.after],
            ShownUnit::Pixel => [mean(&|row| row.before_m), mean(&|row| row.after_m)],
        };
        Self {
            x_m: range(0),
            y_m: range(1),
            outliers: rows.len() - kept.len(),
            mean_m,
            screen_m,
            of: shown.clone(),
        }
    }

    pub fn residuals(&self) -> &[Residual] {
        &self.of.finding.comparison.residuals
    }

    pub fn scale(&self, errors: Errors) -> f64 {
        let kept = self.residuals().iter().filter(|row| !row.outlier);
        match errors {
            Errors::After => arrow_scale(kept.map(|row| plane(row.after_m))),
            Errors::Before | Errors::Both => arrow_scale(kept.map(|row| plane(row.before_m))),
        }
    }

    pub fn scene(&self, errors: Errors) -> TableScene {
        let xy = |error: [f64; 3]| [error[0], error[1]];
        let (kept, outliers): (Vec<&Residual>, Vec<&Residual>) =
            self.residuals().iter().partition(|row| !row.outlier);
        let outlines = if self.screen_m.is_empty() {
            vec![]
        } else {
            vec![Outline {
                place: Place::Touchscreen,
                name: "touchscreen".to_owned(),
                corners_m: self.screen_m.clone(),
            }]
        };
        TableScene {
            x_m: self.x_m,
            y_m: self.y_m,
            outlines,
            marks: outliers
                .into_iter()
                .map(|row| TableMark {
                    at_m: xy(row.at_m),
                    vector_m: None,
                    ink: Role::NoiseFloor.into(),
                    text: String::new(),
                })
                .collect(),
            before_after: kept
                .into_iter()
                .map(|row| BeforeAfter {
                    at_m: xy(row.at_m),
                    before_m: (errors != Errors::After).then_some(xy(row.before_m)),
                    after_m: (errors != Errors::Before).then_some(xy(row.after_m)),
                })
                .collect(),
            vector_scale: self.scale(errors),
            ..TableScene::new()
        }
    }

    /// "before 6.71 mm, after 3.20 mm" of the nearest row.
    pub fn words(&self, at_m: [f64; 2]) -> String {
        let far = |row: &&Residual| (row.at_m[0] - at_m[0]).hypot(row.at_m[1] - at_m[1]);
        let nearest = self.residuals().iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        match nearest.filter(|row| far(row) < 0.02) {
            Some(row) => format!(
                "{}row {} of set {}: before {}, after {}",
                if row.outlier { "outlier, " } else { "" },
                row.row + 1,
                row.set,
                format::mm(plane(row.before_m)),
                format::mm(plane(row.after_m))
            ),
            None => "nothing was measured here".to_owned(),
        }
    }
}

/// Length in the plane of the table.
pub fn plane(error_m: [f64; 3]) -> f64 {
    error_m[0].hypot(error_m[1])
}

//! The points of the chart of residuals.

use plumbline_widgets::scatter::ScatterSeries;
use plumbline_widgets::theme::Role;

use crate::operator::snapshot::gap::{Finding, Residual};

/// Which part of the residual is drawn against a covariate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Along {
    /// Forward, away from the robot.
    #[default]
    X,
    /// To the left.
    Y,
    /// Up.
    Z,
}

/// Points of the chart, made once.
#[derive(Debug)]
pub struct Points {
    pub(crate) series: [ScatterSeries; 2],
    pub(crate) name: String,
}

/// Angles are drawn in degrees, everything else as it is.
pub fn points(finding: &Finding, covariate: usize, axis: usize) -> Points {
    let (name, unit) = &finding.shown.covariates[covariate];
    let (factor, unit) = match unit.as_str() {
        "rad" => (1f64.to_degrees(), "°"),
        "m" => (1e3, "mm"),
        "kg" => (1e3, "g"),
        other => (1.0, other),
    };
    let kept = || finding.comparison.residuals.iter().filter(|row| !row.outlier);
    let series = |name, role, of: &dyn Fn(&Residual) -> [f64; 3]| {
        let point = |row| {
            let row: &Residual = row;
            let across = row.covariates.get(covariate).copied().flatten()?;
            Some([across * factor, of(row)[axis]])
        };
        ScatterSeries { name, points: kept().filter_map(point).collect(), role }
    };
    Points {
        series: [
            series("before", Role::Difference, &|row| row.before_m),
            series("after", Role::HeldOut, &|row| row.after_m),
        ],
        name: if unit.is_empty() { name.clone() } else { format!("{name}, {unit}") },
    }
}

//! The residual against what it depends on, before and after.

use plumbline_gap::Finding;
use plumbline_gap::finding::Residual;

use super::{Area, HEADING, heading};
use crate::drawing::{Anchor, Color, Drawing, Stroke, Style, ink};
use crate::font;
use crate::values::{self, Printed, fixed, ticks};

/// At most this many points of a panel.
const MOST_POINTS: usize = 400;
/// Bins of the mean.
const BINS: usize = 8;
/// Up to this many different values each is a bin.
const FEW_VALUES: usize = 4;
/// Names of the axes of the robot frame.
const AXES: [&str; 3] = ["error forward", "error to the left", "error up"];

/// Rows that can be drawn against a covariate: its printed value, and millimeters before and after
/// along the axis of the robot frame that depends on it most.
struct Series {
    title: String,
    unit: &'static str,
    axis: usize,
    points: Vec<(f64, f64, f64)>,
}

/// Whether any covariate can be drawn.
pub fn is_possible(finding: &Finding) -> bool {
    !series(finding).is_empty()
}

fn series(finding: &Finding) -> Vec<Series> {
    finding.shown.telling.iter().filter_map(|&place| Series::of(finding, place)).take(2).collect()
}

impl Series {
    fn of(finding: &Finding, place: usize) -> Option<Self> {
        let (name, unit) = finding.shown.covariates.get(place)?;
        let Printed { unit, per_si } = values::covariate(unit);
        let is_finite = |vector: &[f64; 3]| vector.iter().all(|v| v.is_finite());
        let rows: Vec<(f64, &Residual)> = finding
            .comparison
            .residuals
            .iter()
            .filter(|row| !row.outlier && is_finite(&row.before_m) && is_finite(&row.after_m))
            .filter_map(|row| {
                let value = row.covariates.get(place).copied().flatten()?;
                value.is_finite().then_some((value * per_si, row))
            })
            .collect();
        let (low, high) = range(rows.iter().map(|row| row.0))?;
        if rows.len() < 4 || !(high > low) {
            return None;
        }
        let axis = (0..3).max_by(|a, b| {
            let explained = |axis: usize| {
                let points: Vec<(f64, f64)> = rows.iter().map(|(x, row)| (*x, row.before_m[axis])).collect();
                between_bins(&points)
            };
            explained(*a).total_cmp(&explained(*b))
        })?;
        let points =
            rows.iter().map(|(x, row)| (*x, 1e3 * row.before_m[axis], 1e3 * row.after_m[axis])).collect();
        Some(Self { title: name.clone(), unit, axis, points })
    }
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}

/// Middle and mean of each bin. Bins hold equally many rows; few different values are a bin each.
fn bins(points: &[(f64, f64)]) -> Vec<(f64, f64, usize)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let different = 1 + sorted.windows(2).filter(|pair| pair[0].0 < pair[1].0).count();
    let mean = |bin: &[(f64, f64)]| {
        let n = bin.len() as f64;
        (bin.iter().map(|p| p.0).sum::<f64>() / n, bin.iter().map(|p| p.1).sum::<f64>() / n, bin.len())
    };
    if different <= FEW_VALUES {
        return sorted.chunk_by(|a, b| a.0 == b.0).map(mean).collect();
    }
    let size = sorted.len().div_ceil(BINS).max(1);
    sorted.chunks(size).map(mean).collect()
}

/// Sum of squares between bins.
fn between_bins(points: &[(f64, f64)]) -> f64 {
    let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len().max(1) as f64;
    bins(points).iter().map(|(_, y, n)| *n as f64 * (y - mean).powi(2)).sum()
}

/// Draws before and after for one or two covariates.
pub fn draw(drawing: &mut Drawing, area: Area, finding: &Finding) {
    let series = series(finding);
    let columns = area.columns([1.0, 1.0]);
    match series.as_slice() {
        [one] => {
            heading(drawing, area, &caption(one, area.width));
            let [left, right] = area.below(HEADING).columns([1.0, 1.0]);
            pair(drawing, left, right, one);
        }
        several => {
            for (series, column) in several.iter().zip(columns) {
                heading(drawing, column, &caption(series, column.width));
                let below = column.below(HEADING);
                let left = Area { width: 0.53 * below.width, ..below };
                let right =
                    Area { x: left.right() + 8.0, width: below.right() - left.right() - 8.0, ..below };
                pair(drawing, left, right, series);
            }
        }
    }
}

fn caption(series: &Series, width: f64) -> String {
    let unit = if series.unit.is_empty() { String::new() } else { format!(" in {}", series.unit) };
    let style = Style::HEADING;
    font::fit(&format!("What gave it away: {}{unit}", series.title), width, style.size, style.weight)
}

fn pair(drawing: &mut Drawing, left: Area, right: Area, series: &Series) {
    let Some(x) = range(series.points.iter().map(|p| p.0)) else { return };
    let Some((low, high)) = range(series.points.iter().flat_map(|p| [p.1, p.2])) else { return };
    let margin = 0.06 * (high - low).max(0.1);
    let axes = Axes { x, y: (low - margin, high + margin) };
    let before: Vec<(f64, f64)> = series.points.iter().map(|p| (p.0, p.1)).collect();
    let after: Vec<(f64, f64)> = series.points.iter().map(|p| (p.0, p.2)).collect();
    let what = format!("{}, mm", AXES[series.axis]);
    panel(drawing, left, &axes, &before, ink::BEFORE, &format!("before · {what}"), true);
    panel(drawing, right, &axes, &after, ink::AFTER, "after", false);
}

struct Axes {
    x: (f64, f64),
    y: (f64, f64),
}

fn panel(
    drawing: &mut Drawing,
    area: Area,
    axes: &Axes,
    points: &[(f64, f64)],
    color: Color,
    title: &str,
    labeled: bool,
) {
    let style = Style::SMALL;
    let left = if labeled { 22.0 } else { 0.0 };
    let plot =
        Area { x: area.x + left, y: area.y + 9.0, width: area.width - left, height: area.height - 20.0 };
    let inner = 5.0;
    let at = |x: f64, y: f64| {
        let across = (x - axes.x.0) / (axes.x.1 - axes.x.0);
        let up = (y - axes.y.0) / (axes.y.1 - axes.y.0);
        [plot.x + inner + across * (plot.width - 2.0 * inner), plot.bottom() - up * plot.height]
    };
    drawing.rect(plot.x, plot.y, plot.width, plot.height, ink::TRACK);
    let title = font::fit(title, plot.width, style.size, style.weight);
    drawing.text([plot.x, area.y + 5.0], title, style.bold().color(color));
    let rows = ticks(axes.y.0, axes.y.1, 3);
    let step = rows.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
    for tick in rows {
        let [_, y] = at(axes.x.0, tick);
        let stroke =
            if tick.abs() < 1e-9 { Stroke::new(ink::FLOOR, 0.7) } else { Stroke::new(ink::LINE, 0.5) };
        drawing.line(vec![[plot.x, y], [plot.right(), y]], stroke);
        if labeled && y > plot.y + 1.0 {
            let label = fixed(tick, decimals(step));
            drawing.anchored([plot.x - 3.0, y + 2.4], label, style, Anchor::End);
        }
    }
    columns(drawing, plot, axes, &at);
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    for (x, y) in points.iter().step_by(every) {
        drawing.circle(at(*x, *y), 1.0, color, 0.45);
    }
    means(drawing, points, &at);
}

/// That a step of a scale can be read with.
fn decimals(step: f64) -> usize {
    (-step.log10() - 1e-9).ceil().clamp(0.0, 6.0) as usize
}

/// Labels below, as many as have room.
fn columns(drawing: &mut Drawing, plot: Area, axes: &Axes, at: &impl Fn(f64, f64) -> [f64; 2]) {
    let style = Style::SMALL;
    let about = ((plot.width / 40.0) as usize).clamp(2, 6);
    let marks = ticks(axes.x.0, axes.x.1, about);
    let step = marks.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
    let mut free_from = plot.x - 8.0;
    for tick in marks {
        let [x, _] = at(tick, axes.y.0);
        let label = fixed(tick, decimals(step));
        let half = 0.5 * font::width(&label, style.size, style.weight);
        if x - half < free_from || x + half > plot.right() + 4.0 {
            continue;
        }
        free_from = x + half + 4.0;
        drawing.line(vec![[x, plot.bottom()], [x, plot.bottom() + 2.0]], Stroke::new(ink::LINE, 0.5));
        drawing.anchored([x, plot.bottom() + 9.0], label, style, Anchor::Middle);
    }
}

/// The mean of each bin: a line, or a dash for each of few values.
fn means(drawing: &mut Drawing, points: &[(f64, f64)], at: &impl Fn(f64, f64) -> [f64; 2]) {
    let bins = bins(points);
    let line = |points: Vec<[f64; 2]>, drawing: &mut Drawing| {
        drawing.line(points.clone(), Stroke::new(ink::PAPER, 3.0));
        drawing.line(points, Stroke::new(ink::STRONG, 1.3));
    };
    if bins.len() <= FEW_VALUES {
        for (x, y, _) in bins {
            let [x, y] = at(x, y);
            line(vec![[x - 5.0, y], [x + 5.0, y]], drawing);
        }
        return;
    }
    line(bins.iter().map(|(x, y, _)| at(*x, *y)).collect(), drawing);
}

//! The figures' captions and arrangement: bars, history, maps.

use plumbline_effects::measurements::Unit;
use plumbline_gap::finding::{CoordinateComparison, Knowledge, ShownUnit};
use plumbline_gap::{Finding, Verdict};

use super::bars::{self, Bar};
use super::{Area, HEADING, count, heading, map};
use crate::drawing::{Anchor, Drawing, Stroke, Style, ink};
use crate::values::{p_value, percent, share, significant};
use crate::{HistoryEntry, ReportContext, font};

/// At most this many models of the history are drawn.
const MOST_MODELS: usize = 7;
/// At most this many coordinates.
const MOST_COORDINATES: usize = 5;

/// How large the gap is, and what it was before or where it lies.
pub fn summary(drawing: &mut Drawing, area: Area, finding: &Finding, context: &ReportContext) {
    let [left, right] = area.columns([1.0, 1.0]);
    gap(drawing, left, finding);
    if context.history.is_empty() {
        coordinates(drawing, right, finding);
    } else {
        history(drawing, right, finding, &context.history);
    }
}

/// Unit that held-out errors are printed in, and what one of the finding's is in it.
pub(super) fn unit(finding: &Finding) -> (&'static str, f64) {
    match finding.shown.unit {
        ShownUnit::Meter => ("mm", 1e3),
        ShownUnit::Pixel => ("px", 1.0),
    }
}

fn gap(drawing: &mut Drawing, area: Area, finding: &Finding) {
    let (shown, (unit, scale)) = (&finding.shown, unit(finding));
    heading(drawing, area, "Mean error on rows that were not used");
    let label = |value: f64| format!("{} {unit}", significant(value * scale, 3));
    let bar =
        |name: &str, value: f64, color| Bar { name: name.to_owned(), value, label: label(value), color };
    let mut all = vec![bar("before", shown.before, ink::BEFORE)];
    if finding.verdict != Verdict::NoGap {
        all.push(bar("after", shown.after, ink::AFTER));
    }
    let is_known = finding.comparison.is_noise_known();
    let floor = if is_known { "noise floor" } else { "the best model" };
    all.push(bar(floor, shown.floor, ink::FLOOR));
    let y = bars::draw(drawing, area.below(HEADING), &all, 54.0, 17.0, Some(shown.floor));
    let mut lines = vec![];
    match (finding.verdict, shown.closure) {
        (Verdict::NoGap, _) if !finding.is_all_clear() => {
            lines.push(
                "What noise alone leaves is not known: what stands there is what the best model leaves."
                    .to_owned(),
            );
        }
        (Verdict::NoGap, _) => lines
            .push(format!("Noise alone leaves as much or more ({}).", p_value(finding.comparison.p_value))),
        (_, Some(_)) if !is_known => {
            lines
                .push("Nothing tells the noise: how much of the rest can be closed is not known.".to_owned());
        }
        (_, Some(closure)) => {
            let range = shown
                .closure_range
                .map_or(String::new(), |[low, high]| format!(" (95 %: {} to {})", share(low), share(high)));
            lines.push(format!("{} of what can be closed is closed{range}.", share(closure)));
        }
        (_, None) => lines.push("There is nothing above the noise floor to close.".to_owned()),
    }
    if let Some(unseen) = &shown.unseen {
        lines.push(format!(
            "Held out as a whole, {}: {} to {} {unit}, floor {}.",
            unseen.what,
            significant(unseen.before * scale, 3),
            significant(unseen.after * scale, 3),
            significant(unseen.floor * scale, 3)
        ));
    }
    let mut y = y + 8.0;
    for line in lines {
        y = drawing.paragraph([area.x, y], area.width, &line, Style::BODY, 2);
    }
}

/// Which coordinates hold the gap.
fn coordinates(drawing: &mut Drawing, area: Area, finding: &Finding) {
    heading(drawing, area, "Share of the squared residual");
    let mut all: Vec<&CoordinateComparison> =
        finding.comparison.kinds.iter().flat_map(|kind| &kind.coordinates).collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    if all.is_empty() {
        drawing.text([area.x, area.y + HEADING + 8.0], "Nothing was compared.", Style::BODY);
        return;
    }
    let all = &all[..all.len().min(MOST_COORDINATES)];
    let bars: Vec<Bar> = all
        .iter()
        .map(|coordinate| Bar {
            name: coordinate.name.clone(),
            value: coordinate.share,
            label: share(coordinate.share),
            color: ink::BEFORE,
        })
        .collect();
    let (right, pitch) = (108.0, 15.0);
    let below = area.below(HEADING);
    bars::draw(drawing, Area { width: below.width - right, ..below }, &bars, 88.0, pitch, None);
    for (i, coordinate) in all.iter().enumerate() {
        let (rms, floor) = (printed(coordinate.rms, coordinate), printed(coordinate.floor, coordinate));
        let style = Style::SMALL;
        let text = font::fit(&format!("rms {rms}, floor {floor}"), right - 8.0, style.size, style.weight);
        let base = below.y + pitch * i as f64 + 0.5 * (pitch - 5.0) + 2.8;
        drawing.anchored([area.right(), base], text, style, Anchor::End);
    }
}

fn printed(value: f64, coordinate: &CoordinateComparison) -> String {
    match coordinate.unit {
        Unit::Meter => format!("{} mm", significant(1e3 * value, 2)),
        Unit::Radian => format!("{}°", significant(value.to_degrees(), 2)),
        Unit::Pixel => format!("{} px", significant(value, 2)),
    }
}

/// Models with their gaps, the last one after what was found now.
fn history(drawing: &mut Drawing, area: Area, finding: &Finding, entries: &[HistoryEntry]) {
    let (unit, scale) = unit(finding);
    heading(drawing, area, &format!("Models so far, mean error in {unit} (dashed: noise floor)"));
    let shown = &entries[entries.len().saturating_sub(MOST_MODELS)..];
    let plot = Area { height: 50.0, y: area.y + HEADING + 4.0, ..area };
    let largest = shown
        .iter()
        .map(|e| e.gap)
        .chain([finding.shown.floor])
        .filter(|v| v.is_finite())
        .fold(0.0, f64::max);
    let at =
        |value: f64| plot.bottom() - if largest > 0.0 { 0.86 * plot.height * value / largest } else { 0.0 };
    let slot = plot.width / shown.len() as f64;
    drawing.line(vec![[plot.x, plot.bottom()], [plot.right(), plot.bottom()]], Stroke::new(ink::LINE, 0.6));
    if finding.shown.floor.is_finite() {
        let y = at(finding.shown.floor);
        drawing.line(vec![[plot.x, y], [plot.right(), y]], Stroke::new(ink::STRONG, 0.7).dashed(2.0, 1.6));
    }
    let style = Style::SMALL;
    for (i, entry) in shown.iter().enumerate() {
        let middle = plot.x + (i as f64 + 0.5) * slot;
        let width = (0.5 * slot).min(26.0);
        if entry.gap.is_finite() {
            let y = at(entry.gap);
            let is_last = i + 1 == shown.len();
            let color = if is_last { ink::AFTER } else { ink::BEFORE };
            drawing.rect(middle - 0.5 * width, y, width, plot.bottom() - y, color);
            let value = significant(entry.gap * scale, 3);
            drawing.anchored([middle, y - 2.5], value, style.bold().color(ink::STRONG), Anchor::Middle);
        }
        let mut y = plot.bottom() + 9.0;
        for line in font::wrap(&entry.name, slot - 4.0, style.size, style.weight, 2) {
            drawing.anchored([middle, y], line, style, Anchor::Middle);
            y += style.leading();
        }
    }
}

/// Least height of what stands beside the map where there is no gap.
const BESIDE: f64 = 130.0;

/// The table from above, before and after. Returns the lower end.
pub fn maps(drawing: &mut Drawing, area: Area, finding: &Finding, context: &ReportContext) -> f64 {
    let [left, right] = area.columns([1.0, 1.0]);
    let Some(view) = map::View::of(finding, context, left.below(HEADING)) else {
        heading(drawing, area, "Over the table");
        let text = "No row has a place on the table, so no map can be drawn.";
        drawing.text([area.x, area.y + HEADING + 8.0], text, Style::BODY);
        return area.y + HEADING + 12.0;
    };
    let cut = |area: Area| Area { height: view.height, ..area.below(HEADING) };
    if finding.verdict == Verdict::NoGap {
        heading(drawing, left, "Measured less predicted, from above");
        view.draw(drawing, cut(left), finding, map::Which::Before);
        could_have_shown(drawing, right, finding);
        return cut(left).bottom().max(area.y + BESIDE).min(area.bottom());
    }
    heading(drawing, left, "Before: measured less predicted");
    view.draw(drawing, cut(left), finding, map::Which::Before);
    heading(drawing, right, "After, same scale");
    view.draw(drawing, cut(right), finding, map::Which::After);
    cut(left).bottom()
}

/// What the rows of a session without a gap can say.
fn could_have_shown(drawing: &mut Drawing, area: Area, finding: &Finding) {
    heading(drawing, area, "What this verdict rests on");
    let comparison = &finding.comparison;
    let of = |is: fn(&Knowledge) -> bool| finding.candidates.iter().filter(|c| is(&c.knowledge)).count();
    let unseen = of(|k| matches!(k, Knowledge::Dead | Knowledge::Flat));
    let traded = of(|k| matches!(k, Knowledge::TradeOff(_)));
    let mut lines = vec![if finding.is_all_clear() {
        format!(
            "Beyond the noise the residual is {} times the floor; a gap starts at 0.3.",
            significant(comparison.size_sigmas, 2)
        )
    } else {
        "There is no noise floor that the residual could be compared with.".to_owned()
    }];
    if !finding.candidates.is_empty() {
        lines.push(format!(
            "{} at their places were looked for.",
            count(finding.candidates.len(), "possible effect", "possible effects")
        ));
    }
    if unseen > 0 {
        lines.push(format!("{unseen} of them would not show in these rows even if they were there."));
    }
    if traded > 0 {
        lines.push(format!("{traded} would show, but could not be told from others."));
    }
    if let Some(first) = finding.candidates.first() {
        let title = font::fit(&first.title, area.width, Style::BODY.size, Style::BODY.weight);
        lines.push(format!("The most probable one, at {}: {title}.", percent(first.probability)));
    }
    let mut y = area.y + HEADING + 8.0;
    for line in lines {
        y = drawing.paragraph([area.x, y], area.width, &line, Style::BODY, 3) + 4.0;
        if y > area.bottom() {
            break;
        }
    }
}

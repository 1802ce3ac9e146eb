//! Curves over minutes with a band: one chart.

use egui::{Align2, Rect, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_widgets::axis;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, Tokens, space};

/// Room for the numbers at the left and below, for the caption above, and for names at the right.
const LEFT: f32 = 40.0;
const BELOW: f32 = 30.0;
const CAPTION: f32 = 20.0;
const RIGHT: f32 = 48.0;
/// The least range that is shown, mm: noise shall look like noise.
const LEAST_RANGE_MM: f64 = 6.0;
/// More points than these are not told apart.
const MOST_POINTS: usize = 600;
/// A curve is broken where two looks lie farther apart than so many times the usual, and than so many minutes.
const GAP_TIMES: f64 = 4.0;
const GAP_MIN: f64 = 0.5;
/// Names stand at least so far below each other.
const NAME_HEIGHT: f32 = 12.0;

/// A curve.
pub struct Line {
    pub name: String,
    pub role: Role,
    /// Minutes, mm; in the order of time.
    pub points: Vec<[f64; 2]>,
}

/// Several curves with one scale.
pub struct Chart<'a> {
    pub label: &'a str,
    pub axis: &'a str,
    pub lines: &'a [Line],
    /// Where the curves may be, mm.
    pub band_mm: Option<[f64; 2]>,
    /// Minutes at which something moved.
    pub marks: &'a [f64],
}

impl Chart<'_> {
    pub fn show(&self, ui: &mut Ui, height: f32) {
        let size = vec2(ui.available_width(), height.max(80.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| {
            let last = self.lines.iter().filter_map(|line| {
                let [_, mm] = line.points.last()?;
                Some(format!("{} {}", line.name, format::fixed(*mm, 1)))
            });
            let said = last.collect::<Vec<_>>().join(", ");
            WidgetInfo::labeled(egui::Role::Image, true, format!("{}: {said}", self.label))
        });
        if !ui.is_rect_visible(rect) {
            return;
        }
        let plot = Rect::from_min_max(rect.min + vec2(LEFT, CAPTION), rect.max - vec2(RIGHT, BELOW));
        self.paint(ui, rect, plot);
    }

    /// Minutes and millimeters at the edges.
    fn range(&self) -> ([f64; 2], [f64; 2]) {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let span = |of: usize| {
            points().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], point| {
                [least.min(point[of]), most.max(point[of])]
            })
        };
        let ([from, to], [least, most]) = (span(0), span(1));
        if !(from.is_finite() && least.is_finite()) {
            return ([0.0, 1.0], [0.0, LEAST_RANGE_MM]);
        }
        let band = self.band_mm.unwrap_or([0.0, 0.0]);
        let (least, most) = (least.min(band[0]), most.max(band[1]));
        let missing = 0.5 * (LEAST_RANGE_MM - (most - least)).max(0.0);
        // What cannot be negative begins at zero.
        let below = if least < 0.0 { missing } else { 0.0 };
        ([from, to.max(from + 1.0)], [least - below, most + 2.0 * missing - below + 0.05 * (most - least)])
    }

    fn paint(&self, ui: &Ui, rect: Rect, plot: Rect) {
        let tokens = theme::tokens(ui);
        let small = TextStyle::Small.resolve(ui.style());
        let strong = theme::strong_style(ui).resolve(ui.style());
        let painter = ui.painter();
        painter.text(rect.left_top(), Align2::LEFT_TOP, self.label, strong, tokens.text_strong);
        let ([from, to], [least, most]) = self.range();
        let x = |minute: f64| plot.left() + ((minute - from) / (to - from)) as f32 * plot.width();
        let y = |mm: f64| plot.bottom() - ((mm - least) / (most - least)) as f32 * plot.height();
        if let Some([low, high]) = self.band_mm {
            let band = Rect::from_x_y_ranges(plot.x_range(), y(high)..=y(low));
            painter.rect_filled(band.intersect(plot), 0.0, tokens.raised);
        }
        let rows = axis::ticks(least, most, ((plot.height() / 24.0) as usize).max(3));
        for (mm, text) in rows.iter().zip(axis::labels(&rows)) {
            painter.hline(plot.x_range(), y(*mm), Stroke::new(0.5, tokens.text_weak.gamma_multiply(0.4)));
            let at = pos2(plot.left() - 4.0, y(*mm));
            painter.text(at, Align2::RIGHT_CENTER, text, small.clone(), tokens.text_weak);
        }
        let columns = axis::ticks(from, to, ((plot.width() / 60.0) as usize).max(3));
        for (minute, text) in columns.iter().zip(axis::labels(&columns)) {
            let at = pos2(x(*minute), plot.bottom() + 2.0);
            painter.text(at, Align2::CENTER_TOP, text, small.clone(), tokens.text_weak);
        }
        let under = pos2(plot.center().x, rect.bottom() - 2.0);
        painter.text(under, Align2::CENTER_BOTTOM, self.axis, small.clone(), tokens.text_weak);
        for minute in self.marks.iter().filter(|minute| (from..=to).contains(*minute)) {
            painter.vline(x(*minute), plot.y_range(), Stroke::new(1.0, Role::Warning.color(tokens)));
        }
        for line in self.lines {
            self.curve(painter, tokens, plot, line, |[minute, mm]| pos2(x(minute), y(mm)));
        }
        self.names(painter, tokens, plot, &small, y);
    }

    /// Names beside the ends of their curves, in the order of these and apart from each other.
    fn names(
        &self,
        painter: &egui::Painter,
        tokens: &Tokens,
        plot: Rect,
        small: &egui::FontId,
        y: impl Fn(f64) -> f32,
    ) {
        let mut ends: Vec<(f32, &Line)> =
            self.lines.iter().filter_map(|line| Some((y(line.points.last()?[1]), line))).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let places: Vec<f32> = ends.iter().map(|(at, _)| *at).collect();
        for ((_, line), at) in ends.iter().zip(apart(&places, [plot.top() - 4.0, plot.bottom() + 4.0])) {
            let name = pos2(plot.right() + 4.0, at);
            painter.text(name, Align2::LEFT_CENTER, &line.name, small.clone(), line.role.color(tokens));
        }
    }

    fn curve(
        &self,
        painter: &egui::Painter,
        tokens: &Tokens,
        plot: Rect,
        line: &Line,
        on: impl Fn([f64; 2]) -> egui::Pos2,
    ) {
        let step = line.points.len().div_ceil(MOST_POINTS).max(1);
        let color = line.role.color(tokens);
        let painter = painter.with_clip_rect(plot.expand(space::XS));
        for piece in pieces(&line.points) {
            let points: Vec<egui::Pos2> = piece.iter().rev().step_by(step).map(|point| on(*point)).collect();
            if let [only] = points.as_slice() {
                painter.circle_filled(*only, 2.0, color);
            }
            painter.add(Shape::line(points, Stroke::new(1.5, color)));
        }
    }
}

/// Parts of a curve between which nobody looked: nothing is drawn there as if it had been seen.
fn pieces(points: &[[f64; 2]]) -> Vec<&[[f64; 2]]> {
    let mut gaps: Vec<f64> = points.windows(2).map(|two| two[1][0] - two[0][0]).collect();
    gaps.sort_by(f64::total_cmp);
    let usual = gaps.get(gaps.len() / 2).copied().unwrap_or(0.0);
    let most = (GAP_TIMES * usual).max(GAP_MIN);
    points.chunk_by(|one, two| two[0] - one[0] <= most).collect()
}

/// Ascending places moved as little as keeps them apart and inside.
fn apart(places: &[f32], [top, bottom]: [f32; 2]) -> Vec<f32> {
    let mut moved: Vec<f32> = Vec::with_capacity(places.len());
    for (k, at) in places.iter().enumerate() {
        let above = moved.last().map_or(top, |last| last + NAME_HEIGHT);
        let below = bottom - NAME_HEIGHT * (places.len() - 1 - k) as f32;
        moved.push(at.max(above).min(below.max(above)));
    }
    // Those that were pushed down take the ones above them along, halfway.
    let pushed = moved.iter().zip(places).map(|(now, was)| now - was).fold(0.0, f32::max);
    let room = moved.first().map_or(0.0, |first| first - top);
    moved.iter().map(|at| at - (0.5 * pushed).min(room.max(0.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_broken_where_nobody_looked() {
        let at = |minutes: &[f64]| -> Vec<[f64; 2]> { minutes.iter().map(|at| [*at, 1.0]).collect() };
        let lengths =
            |points: &[[f64; 2]]| pieces(points).iter().map(|piece| piece.len()).collect::<Vec<_>>();
        assert_eq!(lengths(&at(&[0.0, 0.1, 0.2, 2.0, 2.1])), [3, 2]);
        // What is seldom looked at all the time is one curve, and so is a single look.
        assert_eq!(lengths(&at(&[0.0, 1.0, 2.0, 5.0])), [4]);
        assert_eq!(lengths(&at(&[3.0])), [1]);
        assert!(pieces(&[]).is_empty());
    }

    #[test]
    fn names_stay_apart_and_inside() {
        for places in [[50.0, 50.0, 50.0], [0.0, 1.0, 2.0], [98.0, 99.0, 100.0], [10.0, 50.0, 90.0]] {
            let moved = apart(&places, [0.0, 100.0]);
            assert!(
                moved.windows(2).all(|two| two[1] - two[0] > NAME_HEIGHT - 0.01),
                "{places:?}: {moved:?}"
            );
            assert!(moved.iter().all(|at| (-0.01..=100.01).contains(at)), "{places:?}: {moved:?}");
        }
        assert_eq!(apart(&[10.0, 50.0, 90.0], [0.0, 100.0]), [10.0, 50.0, 90.0], "far ones stay");
    }
}

//! The last seconds of a quantity, kept and drawn small.

use std::collections::VecDeque;

use egui::{Align2, Pos2, Rect, Response, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2};

use crate::format::Quantity;
use crate::theme::{self, Role, space};

/// More points than this are not told apart on a line of a few centimeters.
const MOST_SAMPLES: usize = 400;

/// Values of the last seconds; older ones are dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    span_s: f64,
    samples: VecDeque<Sample>,
}

/// A value (SI) at a time, or that there was none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// On the clock of the caller.
    pub at_s: f64,
    /// `None` where nothing was measured.
    pub value: Option<f64>,
}

impl History {
    /// Keeps so many seconds.
    pub fn new(span_s: f64) -> Self {
        Self { span_s, samples: VecDeque::new() }
    }

    /// Adds what was measured at a time, or that nothing was. Of values closer together than can
    /// be drawn, the one farthest from zero is kept, so that peaks stay. A clock that runs
    /// backwards begins anew; a time that is not a number is left out.
    pub fn push(&mut self, at_s: f64, value: Option<f64>) {
        if !at_s.is_finite() {
            return;
        }
        let value = value.filter(|value| value.is_finite());
        if self.samples.back().is_some_and(|last| at_s < last.at_s) {
            self.samples.clear();
        }
        let step_s = self.span_s / MOST_SAMPLES as f64;
        // Compared with the one before the last, so that a fast caller does not keep merging
        // into one sample that never becomes old.
        let before = self.samples.len().checked_sub(2).and_then(|i| self.samples.get(i)).copied();
        match self.samples.back_mut() {
            Some(last) if before.is_some_and(|before| at_s - before.at_s < step_s) => {
                let magnitude = |value: Option<f64>| value.map_or(-1.0, f64::abs);
                if magnitude(value) >= magnitude(last.value) {
                    last.value = value;
                }
                last.at_s = at_s;
            }
            _ => self.samples.push_back(Sample { at_s, value }),
        }
        while self.samples.front().is_some_and(|first| first.at_s < at_s - self.span_s) {
            self.samples.pop_front();
        }
    }

    /// All kept samples, oldest first.
    pub fn samples(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter()
    }

    /// The newest sample, if it has a value.
    pub fn latest(&self) -> Option<f64> {
        self.samples.back().and_then(|sample| sample.value)
    }

    /// How many seconds are kept.
    pub fn span_s(&self) -> f64 {
        self.span_s
    }

    fn extremes(&self) -> Option<[f64; 2]> {
        let values = || self.samples.iter().filter_map(|sample| sample.value);
        let low = values().min_by(f64::total_cmp)?;
        Some([low, values().max_by(f64::total_cmp)?])
    }
}

/// A history as a small line. Gaps stay gaps.
pub struct Sparkline<'a> {
    label: &'a str,
    history: &'a History,
    quantity: Quantity,
    range: Option<[f64; 2]>,
    levels: &'a [(f64, Role)],
    size: Vec2,
}

impl<'a> Sparkline<'a> {
    /// A line that fits its range to the values.
    pub fn new(label: &'a str, history: &'a History, quantity: Quantity) -> Self {
        Self { label, history, quantity, range: None, levels: &[], size: vec2(180.0, 36.0) }
    }

    /// Values (SI) at the bottom and the top; the range grows for values beyond.
    pub fn range(mut self, range: [f64; 2]) -> Self {
        self.range = Some(range);
        self
    }

    /// Dashed lines at values (SI), with what they mean.
    pub fn levels(mut self, levels: &'a [(f64, Role)]) -> Self {
        self.levels = levels;
        self
    }

    /// Size of the line without its caption, in points.
    pub fn size(mut self, size: Vec2) -> Self {
        self.size = size;
        self
    }

    /// Draws caption and line. The label for tests is `"{label}: {latest value}"`.
    pub fn show(self, ui: &mut Ui) -> Response {
        let caption_height = theme::size::SMALL + space::XS;
        let (rect, response) = ui.allocate_exact_size(self.size + vec2(0.0, caption_height), Sense::hover());
        let latest = self.quantity.text_or_none(self.history.latest());
        response.widget_info(|| {
            WidgetInfo::labeled(egui::Role::Image, true, format!("{}: {latest}", self.label))
        });
        if ui.is_rect_visible(rect) {
            let [caption, plot] = rect.split_top_bottom_at_y(rect.top() + caption_height).into();
            self.caption(ui, caption, &latest);
            self.plot(ui, plot);
        }
        response
    }

    fn caption(&self, ui: &Ui, rect: Rect, latest: &str) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let name = format!("{}, last {:.0} s", self.label, self.history.span_s);
        ui.painter().text(rect.left_top(), Align2::LEFT_TOP, name, font.clone(), tokens.text_weak);
        ui.painter().text(rect.right_top(), Align2::RIGHT_TOP, latest, font, tokens.text);
    }

    fn plot(&self, ui: &Ui, rect: Rect) {
        let tokens = theme::tokens(ui);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 3.0, tokens.raised.gamma_multiply(0.6));
        let Some([low, high]) = self.shown_range() else {
            let font = theme::font(ui, &TextStyle::Small);
            painter.text(rect.center(), Align2::CENTER_CENTER, "nothing measured", font, tokens.text_weak);
            return;
        };
        let inner = rect.shrink2(vec2(0.0, 3.0));
        let y = |value: f64| inner.bottom() - inner.height() * ((value - low) / (high - low)) as f32;
        if low < 0.0 && high > 0.0 {
            painter.hline(rect.x_range(), y(0.0), Stroke::new(1.0, tokens.line));
        }
        for (value, role) in self.levels.iter().filter(|(value, _)| (low..=high).contains(value)) {
            let ends = [pos2(rect.left(), y(*value)), pos2(rect.right(), y(*value))];
            let stroke = Stroke::new(1.0, role.color(tokens).gamma_multiply(0.8));
            painter.extend(Shape::dashed_line(&ends, stroke, 3.0, 3.0));
        }
        let newest_s = self.history.samples.back().map_or(0.0, |sample| sample.at_s);
        let x = |at_s: f64| rect.right() - rect.width() * ((newest_s - at_s) / self.history.span_s) as f32;
        let mut run: Vec<Pos2> = Vec::new();
        for sample in self.history.samples().chain(std::iter::once(&Sample { at_s: newest_s, value: None })) {
            match sample.value {
                Some(value) => run.push(pos2(x(sample.at_s), y(value))),
                None if run.len() > 1 => {
                    painter.line(std::mem::take(&mut run), Stroke::new(1.5, tokens.measured));
                }
                None => run.clear(),
            }
        }
        if let Some(value) = self.history.latest() {
            painter.circle_filled(pos2(rect.right() - 2.5, y(value)), 2.5, tokens.measured);
        }
    }

    fn shown_range(&self) -> Option<[f64; 2]> {
        let [low, high] = self.history.extremes()?;
        let [low, high] = match self.range {
            Some([bottom, top]) => [low.min(bottom), high.max(top)],
            None => [low, high],
        };
        // A constant is a line in the middle.
        let pad = if high > low { 0.0 } else { high.abs().max(1.0) * 0.5 };
        Some([low - pad, high + pad])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_samples_are_dropped_and_the_number_is_bounded() {
        let mut history = History::new(10.0);
        for i in 0..20_000 {
            history.push(f64::from(i) * 0.002, Some(f64::from(i % 7)));
        }
        let first = history.samples().next().expect("samples").at_s;
        assert!(first >= 40.0 - 10.1, "{first}");
        let count = history.samples().count();
        assert!((200..=2 * MOST_SAMPLES + 2).contains(&count), "{count}");
    }

    #[test]
    fn peaks_between_drawn_samples_stay() {
        let mut history = History::new(60.0);
        for i in 0..6000 {
            history.push(f64::from(i) * 0.01, Some(if i == 3001 { -0.9 } else { 0.1 }));
        }
        assert_eq!(history.extremes(), Some([-0.9, 0.1]));
    }

    #[test]
    fn gaps_and_unreal_values_are_gaps_and_a_restart_begins_anew() {
        let mut history = History::new(10.0);
        history.push(1.0, Some(1.0));
        history.push(2.0, Some(f64::NAN));
        history.push(f64::NAN, Some(1.0));
        assert_eq!((history.latest(), history.samples().count()), (None, 2));
        history.push(0.5, Some(3.0));
        assert_eq!((history.latest(), history.samples().count()), (Some(3.0), 1));
    }
}

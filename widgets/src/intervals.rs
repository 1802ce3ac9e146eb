//! Means with their intervals below each other on one scale, so that it is seen which can be told
//! apart and which cannot.

use egui::{
    Align2, Color32, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2,
    vec2,
};

use crate::axis;
use crate::format::Quantity;
use crate::theme::{self, Role, space};

const ROW: f32 = 34.0;
/// Least room for names; longer ones get theirs, up to this share of the width.
const NAME_WIDTH: f32 = 102.0;
const MOST_NAME_SHARE: f32 = 0.5;
const FIGURE_WIDTH: f32 = 118.0;
/// Room for the numbers below.
const AXIS: f32 = 20.0;
/// Room for the names of the lines above.
const HEAD: f32 = 18.0;

/// A mean with its interval.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalRow {
    /// Its name: "M3".
    pub name: String,
    /// Words below the name: "proposed"; empty for none.
    pub note: String,
    /// The mean, SI; `None` where it is not known.
    pub mean: Option<f64>,
    /// Lower and upper end of the interval, SI.
    pub interval: Option<[f64; 2]>,
    /// Color.
    pub role: Role,
}

/// A level to compare with: a dashed line down all rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level<'a> {
    /// Its name above the line.
    pub name: &'a str,
    /// SI.
    pub value: f64,
    /// Color.
    pub role: Role,
}

/// Rows of means.
#[derive(Clone, Copy, Debug)]
pub struct Intervals<'a> {
    label: &'a str,
    rows: &'a [IntervalRow],
    quantity: Quantity,
    levels: &'a [Level<'a>],
    band: Option<usize>,
    selected: Option<usize>,
}

impl<'a> Intervals<'a> {
    /// Means of a quantity; the scale begins at zero.
    pub fn new(label: &'a str, rows: &'a [IntervalRow], quantity: Quantity) -> Self {
        Self { label, rows, quantity, levels: &[], band: None, selected: None }
    }

    /// Levels to compare with.
    pub fn levels(mut self, levels: &'a [Level<'a>]) -> Self {
        self.levels = levels;
        self
    }

    /// The row whose interval runs through all rows as a band: what reaches into it cannot be told
    /// apart from that row.
    pub fn band(mut self, row: Option<usize>) -> Self {
        self.band = row;
        self
    }

    /// The row that is chosen.
    pub fn selected(mut self, row: Option<usize>) -> Self {
        self.selected = row;
        self
    }

    /// Draws it over the available width; returns the row that was clicked. Labels for tests:
    /// `"M3: 4.31 mm, 3.92 to 4.70 mm"`.
    pub fn show(self, ui: &mut Ui) -> Option<usize> {
        let size = vec2(ui.available_width(), HEAD + ROW * self.rows.len() as f32 + AXIS);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        let rows: Vec<(Rect, Response)> =
            (0..self.rows.len()).map(|i| self.row_response(ui, rect, i, &response)).collect();
        if ui.is_rect_visible(rect) {
            let chart = Chart::new(&self, rect, self.name_width(ui, rect.width()));
            chart.axis(ui, self.quantity);
            chart.band(ui, self.band.and_then(|row| self.rows.get(row)?.interval));
            for (i, (row_rect, row_response)) in rows.iter().enumerate() {
                if row_response.hovered() || self.selected == Some(i) {
                    let fill = theme::tokens(ui).raised.gamma_multiply(if self.selected == Some(i) {
                        0.9
                    } else {
                        0.5
                    });
                    ui.painter().rect_filled(*row_rect, 4.0, fill.gamma_multiply(0.6));
                }
                if row_response.has_focus() {
                    let ring = Stroke::new(1.5, theme::tokens(ui).accent);
                    ui.painter().rect_stroke(*row_rect, 4.0, ring, StrokeKind::Inside);
                }
                chart.row(ui, &self.rows[i], *row_rect, self.quantity);
            }
            for level in self.levels {
                chart.level(ui, level, self.levels);
            }
        }
        rows.iter().position(|(_, response)| response.clicked())
    }

    /// Room in which the longest name and note end before the scale begins.
    fn name_width(&self, ui: &Ui, width: f32) -> f32 {
        let (strong, small) = (theme::strong_font(ui), theme::font(ui, &TextStyle::Small));
        let of = |text: &str, font: &egui::FontId| {
            ui.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::PLACEHOLDER).size().x
        };
        let longest =
            self.rows.iter().map(|row| of(&row.name, &strong).max(of(&row.note, &small))).fold(0.0, f32::max);
        let most = MOST_NAME_SHARE * width;
        (longest + 2.0 * space::S).min(most).max(NAME_WIDTH)
    }

    fn row_response(&self, ui: &Ui, rect: Rect, i: usize, whole: &Response) -> (Rect, Response) {
        let top = rect.top() + HEAD + ROW * i as f32;
        let row = Rect::from_min_size(pos2(rect.left(), top), vec2(rect.width(), ROW));
        let response = ui.interact(row, whole.id.with(i), Sense::click());
        let text = self.words(&self.rows[i]);
        response
            .widget_info(|| WidgetInfo::selected(egui::Role::Button, true, self.selected == Some(i), &text));
        (row, response)
    }

    fn words(&self, row: &IntervalRow) -> String {
        let mean = self.quantity.text_or_none(row.mean);
        match row.interval {
            Some([low, high]) => {
                format!("{}: {mean}, {} to {}", row.name, self.quantity.number(low), self.quantity.text(high))
            }
            None => format!("{}: {mean}", row.name),
        }
    }
}

/// The scale, and where things stand on it.
struct Chart {
    plot: Rect,
    end: f64,
}

/// What has no interval may make the scale this much longer and no more.
const SQUEEZED: f64 = 4.0;

impl Chart {
    fn new(all: &Intervals<'_>, rect: Rect, name_width: f32) -> Self {
        // What has an interval decides the scale: something far worse would squeeze together what
        // has to be told apart.
        let ends = |with_interval: bool| {
            let rows = all.rows.iter().filter(move |row| row.interval.is_some() == with_interval);
            rows.flat_map(|row| row.mean.into_iter().chain(row.interval.map(|interval| interval[1])))
        };
        let levels = all.levels.iter().map(|level| level.value);
        let mut largest = ends(true).chain(levels).fold(0.0, f64::max);
        let decides = ends(true).next().is_some();
        let limit = if decides { SQUEEZED * largest } else { f64::INFINITY };
        largest = ends(false).filter(|end| *end <= limit).fold(largest, f64::max);
        let on_screen = all.quantity.on_screen(1.0);
        let plot = Rect::from_min_max(
            pos2(rect.left() + name_width, rect.top() + HEAD),
            pos2((rect.right() - FIGURE_WIDTH).max(rect.left() + name_width + 40.0), rect.bottom() - AXIS),
        );
        Self { plot, end: axis::round_up(largest * on_screen * 1.02) / on_screen }
    }

    fn x(&self, value: f64) -> f32 {
        self.plot.left() + self.plot.width() * (value / self.end) as f32
    }

    fn axis(&self, ui: &Ui, quantity: Quantity) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let most = ((self.plot.width() / 46.0) as usize).clamp(2, 8);
        let ticks = axis::ticks(0.0, quantity.on_screen(self.end), most);
        let stroke = Stroke::new(1.0, tokens.text_weak.gamma_multiply(0.25));
        let last = ticks.len().saturating_sub(1);
        for (i, (tick, text)) in ticks.iter().zip(axis::labels(&ticks)).enumerate() {
            let x = self.x(tick / quantity.on_screen(1.0));
            ui.painter().vline(x, self.plot.y_range(), stroke);
            let text = if i == last { format!("{text} {}", quantity.unit()) } else { text };
            let at = pos2(x, self.plot.bottom() + 4.0);
            ui.painter().text(at, Align2::CENTER_TOP, text, font.clone(), tokens.text_weak);
        }
    }

    fn band(&self, ui: &Ui, interval: Option<[f64; 2]>) {
        let Some([low, high]) = interval else { return };
        let band = Rect::from_x_y_ranges(self.x(low)..=self.x(high), self.plot.y_range());
        ui.painter().rect_filled(band, 0.0, theme::tokens(ui).text_weak.gamma_multiply(0.16));
    }

    fn row(&self, ui: &Ui, row: &IntervalRow, rect: Rect, quantity: Quantity) {
        let tokens = theme::tokens(ui);
        let small = theme::font(ui, &TextStyle::Small);
        let strong = theme::strong_font(ui);
        let painter = ui.painter();
        let y = rect.center().y;
        let lift = if row.note.is_empty() { 0.0 } else { 7.0 };
        let left = rect.left() + space::S;
        painter.text(pos2(left, y - lift), Align2::LEFT_CENTER, &row.name, strong, tokens.text_strong);
        painter.text(pos2(left, y + 8.0), Align2::LEFT_CENTER, &row.note, small.clone(), tokens.text_weak);
        let color = row.role.color(tokens);
        if let Some([low, high]) = row.interval {
            let stroke = Stroke::new(2.0, color);
            let ends = [self.x(low), self.x(high)];
            painter.hline(ends[0]..=ends[1], y, stroke);
            for x in ends {
                painter.vline(x, (y - 5.0)..=(y + 5.0), stroke);
            }
        }
        if row.mean.is_some_and(|mean| mean > self.end) {
            // Off the scale; its figure stands beside it.
            let foot = pos2(self.plot.right() - 18.0, y);
            painter.arrow(foot, vec2(16.0, 0.0), Stroke::new(2.0, color));
        } else if let Some(mean) = row.mean {
            painter.circle(Pos2::new(self.x(mean), y), 4.5, color, Stroke::new(1.5, tokens.panel));
        }
        let figure = quantity.text_or_none(row.mean);
        let right = rect.right() - space::S;
        let font = theme::font(ui, &TextStyle::Body);
        painter.text(pos2(right, y - 7.0), Align2::RIGHT_CENTER, figure, font, tokens.text_strong);
        if let Some([low, high]) = row.interval {
            let text = format!("{} to {}", quantity.number(low), quantity.text(high));
            painter.text(pos2(right, y + 8.0), Align2::RIGHT_CENTER, text, small, tokens.text_weak);
        }
    }

    /// A dashed line with its name above it.
    fn level(&self, ui: &Ui, level: &Level<'_>, all: &[Level<'_>]) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let x = self.x(level.value);
        let color = level.role.color(tokens);
        let ends = [pos2(x, self.plot.top() - 2.0), pos2(x, self.plot.bottom())];
        ui.painter().extend(Shape::dashed_line(&ends, Stroke::new(1.5, color), 4.0, 3.0));
        // Names of lines near each other go to both sides.
        let rightmost = all.iter().all(|other| other.value <= level.value);
        let (anchor, shift) = if rightmost && x > self.plot.center().x {
            (Align2::RIGHT_BOTTOM, 4.0)
        } else {
            (Align2::LEFT_BOTTOM, -4.0)
        };
        ui.painter().text(pos2(x + shift, self.plot.top() - 3.0), anchor, level.name, font, tokens.text_weak);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(mean: Option<f64>, interval: Option<[f64; 2]>) -> IntervalRow {
        IntervalRow { name: "M3".to_owned(), note: String::new(), mean, interval, role: Role::Predicted }
    }

    #[test]
    fn a_row_is_said_with_its_interval() {
        let rows = [row(Some(0.004_31), Some([0.003_92, 0.004_7])), row(None, None)];
        let all = Intervals::new("test", &rows, Quantity::Length);
        assert_eq!(all.words(&rows[0]), "M3: 4.31 mm, 3.92 to 4.70 mm");
        assert_eq!(all.words(&rows[1]), "M3: —");
    }

    #[test]
    fn everything_fits_on_the_scale_which_begins_at_zero() {
        let rows = [row(Some(0.004), Some([0.003, 0.0063])), row(None, None)];
        let levels = [Level { name: "repeats, rms", value: 0.0213, role: Role::Weak }];
        let all = Intervals::new("test", &rows, Quantity::Length).levels(&levels);
        let chart = Chart::new(&all, Rect::from_min_size(Pos2::ZERO, vec2(600.0, 120.0)), NAME_WIDTH);
        assert!((chart.x(0.0) - chart.plot.left()).abs() < 1e-3);
        assert!(chart.x(0.0213) <= chart.plot.right() && chart.end < 0.03);
    }

    #[test]
    fn what_has_no_interval_does_not_squeeze_the_others() {
        let rows = [row(Some(0.004), Some([0.003, 0.005])), row(Some(0.08), None)];
        let all = Intervals::new("test", &rows, Quantity::Length);
        let chart = |all| Chart::new(all, Rect::from_min_size(Pos2::ZERO, vec2(600.0, 120.0)), NAME_WIDTH);
        assert!(chart(&all).end < 0.007);
        let alone = Intervals::new("test", &rows[1..], Quantity::Length);
        assert!(chart(&alone).end >= 0.08);
    }
}

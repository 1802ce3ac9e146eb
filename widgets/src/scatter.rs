//! What is left against what it may depend on: points before and after, with the mean of each part of
//! the range, so that a dependence is seen through the noise.

use egui::{
    Align2, FontId, Pos2, Rect, Response, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use crate::axis;
use crate::format::Quantity;
use crate::theme::{self, Role, space};

/// Room for the numbers at the left and below.
const AXES: Vec2 = vec2(40.0, 32.0);
/// Room for the names above.
const HEAD: f32 = 18.0;
/// Parts of the range with a mean each.
const PARTS: usize = 9;
/// A mean of fewer points says little.
const FEWEST: usize = 3;

/// Points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterSeries {
    /// Its name: "before".
    pub name: &'static str,
    /// (what it may depend on, in its own unit; the residual, SI).
    pub points: Vec<[f64; 2]>,
    /// Color.
    pub role: Role,
}

/// The chart.
#[derive(Clone, Copy, Debug)]
pub struct Scatter<'a> {
    label: &'a str,
    across: &'a str,
    series: &'a [ScatterSeries],
    quantity: Quantity,
    floor: Option<f64>,
    size: Option<Vec2>,
}

impl<'a> Scatter<'a> {
    /// Residuals of a quantity against what is named `across`, with its unit.
    pub fn new(label: &'a str, across: &'a str, series: &'a [ScatterSeries], quantity: Quantity) -> Self {
        Self { label, across, series, quantity, floor: None, size: None }
    }

    /// A band from −floor to floor: what noise alone does.
    pub fn floor(mut self, floor: Option<f64>) -> Self {
        self.floor = floor.filter(|floor| floor.is_finite() && *floor > 0.0);
        self
    }

    /// Size in points, instead of all that is available.
    pub fn size(mut self, size: Vec2) -> Self {
        self.size = Some(size);
        self
    }

    /// Draws it. The label for tests is `"{label} against {across}"`.
    pub fn show(self, ui: &mut Ui) -> Response {
        let size = self.size.unwrap_or(ui.available_size()).max(vec2(140.0, 100.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let words = format!("{} against {}", self.label, self.across);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &words));
        if ui.is_rect_visible(rect) {
            self.paint(ui, rect);
        }
        response
    }

    fn paint(&self, ui: &Ui, rect: Rect) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let plot = Rect::from_min_max(rect.min + vec2(AXES.x, HEAD), rect.max - vec2(space::S, AXES.y));
        ui.painter().rect_filled(plot, 3.0, tokens.raised.gamma_multiply(0.35));
        let mut x = rect.left() + AXES.x;
        for series in self.series {
            let color = series.role.color(tokens);
            ui.painter().circle_filled(pos2(x + 4.0, rect.top() + 8.0), 3.5, color);
            let at = pos2(x + 12.0, rect.top() + 8.0);
            let name =
                ui.painter().text(at, Align2::LEFT_CENTER, series.name, font.clone(), tokens.text_weak);
            x = name.right() + space::M;
        }
        let below = pos2(plot.center().x, plot.bottom() + 17.0);
        ui.painter().text(below, Align2::CENTER_TOP, self.across, font.clone(), tokens.text_weak);
        let Some(scales) = Scales::of(self.series, self.floor, plot, self.quantity) else {
            let text = "No row has a value of this.";
            ui.painter().text(plot.center(), Align2::CENTER_CENTER, text, font, tokens.text_weak);
            return;
        };
        scales.axes(ui, self.quantity, &font);
        let painter = ui.painter_at(plot);
        if let Some(floor) = self.floor {
            let band = Rect::from_x_y_ranges(plot.x_range(), scales.y(floor)..=scales.y(-floor));
            painter.rect_filled(band, 0.0, Role::NoiseFloor.color(tokens).gamma_multiply(0.22));
        }
        painter.hline(plot.x_range(), scales.y(0.0), Stroke::new(1.0, tokens.text_weak.gamma_multiply(0.6)));
        for series in self.series {
            let color = series.role.color(tokens);
            for point in drawable(series) {
                painter.circle_filled(scales.at(*point), 1.8, color.gamma_multiply(0.55));
            }
        }
        for series in self.series {
            let line: Vec<Pos2> = means(series, scales.across).into_iter().map(|m| scales.at(m)).collect();
            if line.len() > 1 {
                painter.add(Shape::line(line, Stroke::new(2.0, series.role.color(tokens))));
            }
        }
    }
}

fn drawable(series: &ScatterSeries) -> impl Iterator<Item = &[f64; 2]> {
    series.points.iter().filter(|[a, b]| a.is_finite() && b.is_finite())
}

/// The mean of each part of the range that has enough points.
fn means(series: &ScatterSeries, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut sums = [[0.0; 3]; PARTS];
    let width = (high - low).max(f64::MIN_POSITIVE);
    for [across, residual] in drawable(series) {
        let part = (((across - low) / width * PARTS as f64) as usize).min(PARTS - 1);
        let [a, r, n] = &mut sums[part];
        (*a, *r, *n) = (*a + across, *r + residual, *n + 1.0);
    }
    sums.iter().filter(|[_, _, n]| *n >= FEWEST as f64).map(|[a, r, n]| [a / n, r / n]).collect()
}

struct Scales {
    plot: Rect,
    across: [f64; 2],
    /// Largest residual up and down.
    end: f64,
}

impl Scales {
    fn of(series: &[ScatterSeries], floor: Option<f64>, plot: Rect, quantity: Quantity) -> Option<Self> {
        let mut across = series.iter().flat_map(drawable).map(|[across, _]| *across);
        let first = across.next()?;
        let [low, high] = across.fold([first, first], |[low, high], a| [low.min(a), high.max(a)]);
        let margin = if high > low { 0.03 * (high - low) } else { 0.5 };
        // One outlier must not press everything else together.
        let mut sizes: Vec<f64> = series.iter().flat_map(drawable).map(|[_, r]| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let most = sizes.get((sizes.len() * 98).div_ceil(100).saturating_sub(1)).copied()?;
        let unit = quantity.on_screen(1.0);
        let end = axis::round_up(most.max(floor.unwrap_or(0.0)).max(1e-9) * unit * 1.05) / unit;
        Some(Self { plot, across: [low - margin, high + margin], end })
    }

    fn x(&self, across: f64) -> f32 {
        let [low, high] = self.across;
        self.plot.left() + self.plot.width() * ((across - low) / (high - low)) as f32
    }

    fn y(&self, residual: f64) -> f32 {
        self.plot.center().y - self.plot.height() / 2.0 * (residual / self.end) as f32
    }

    fn at(&self, [across, residual]: [f64; 2]) -> Pos2 {
        pos2(self.x(across), self.y(residual))
    }

    fn axes(&self, ui: &Ui, quantity: Quantity, font: &FontId) {
        let tokens = theme::tokens(ui);
        let unit = quantity.on_screen(1.0);
        let ticks = axis::ticks(self.across[0], self.across[1], 6);
        for (tick, text) in ticks.iter().zip(axis::labels(&ticks)) {
            let at = pos2(self.x(*tick), self.plot.bottom() + 3.0);
            ui.painter().text(at, Align2::CENTER_TOP, text, font.clone(), tokens.text_weak);
        }
        let ticks = axis::ticks(-self.end * unit, self.end * unit, 5);
        let last = ticks.len().saturating_sub(1);
        for (i, (tick, text)) in ticks.iter().zip(axis::labels(&ticks)).enumerate() {
            let text = if i == last { format!("{text} {}", quantity.unit()) } else { text };
            let y = self.y(tick / unit).clamp(self.plot.top() + 5.0, self.plot.bottom() - 5.0);
            let at = pos2(self.plot.left() - 4.0, y);
            ui.painter().text(at, Align2::RIGHT_CENTER, text, font.clone(), tokens.text_weak);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(points: Vec<[f64; 2]>) -> ScatterSeries {
        ScatterSeries { name: "before", points, role: Role::Difference }
    }

    #[test]
    fn means_follow_a_line_and_leave_out_what_is_no_number() {
        let mut points: Vec<[f64; 2]> = (0..90).map(|i| [f64::from(i), 0.001 * f64::from(i)]).collect();
        points.push([f64::NAN, 1.0]);
        let line = means(&series(points), [0.0, 89.0]);
        assert_eq!(line.len(), PARTS);
        for [across, mean] in line {
            assert!((mean - 0.001 * across).abs() < 1e-12);
        }
    }

    #[test]
    fn one_outlier_does_not_press_the_rest_together() {
        let mut points: Vec<[f64; 2]> = (0..100).map(|i| [f64::from(i), 0.003]).collect();
        points.push([50.0, 0.3]);
        let plot = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        let scales = Scales::of(&[series(points)], None, plot, Quantity::Length).expect("points");
        assert!(scales.end < 0.01, "{}", scales.end);
    }

    #[test]
    fn nothing_to_draw_has_no_scale() {
        let plot = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        assert!(Scales::of(&[series(vec![])], None, plot, Quantity::Length).is_none());
    }
}

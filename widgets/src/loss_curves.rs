//! How training goes: the loss of each network over its epochs, on a logarithmic scale. What is
//! learned from is solid, what was held out is dashed.

use egui::{
    Align2, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, pos2,
    vec2,
};

use crate::axis;
use crate::format::{self, Quantity};
use crate::theme::{self, Role, Tokens, space};

/// More points than this are not told apart on a chart of some centimeters.
const MOST_POINTS: usize = 300;
/// Room for the numbers at the left and below.
const AXES: egui::Vec2 = vec2(44.0, 30.0);
/// Room for the caption above.
const CAPTION: f32 = 20.0;

/// Loss of one network; a length, an angle or a number, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LossCurve {
    /// Which one, for people: "network 2".
    pub name: String,
    /// (epoch, loss) on what it learns from; losses that are not positive are left out.
    pub train: Vec<(f64, f64)>,
    /// (epoch, loss) on what was held out.
    pub held_out: Vec<(f64, f64)>,
}

/// Curves of the networks of one method, one chart.
#[derive(Clone, Copy, Debug)]
pub struct LossCurves<'a> {
    label: &'a str,
    caption: &'a str,
    curves: &'a [LossCurve],
    quantity: Quantity,
    range: Option<[f64; 2]>,
    running: bool,
    step: &'a str,
    size: Option<egui::Vec2>,
}

/// Smallest and largest positive loss of some curves, for charts with one scale.
pub fn loss_range(curves: &[LossCurve]) -> Option<[f64; 2]> {
    let mut losses = curves.iter().flat_map(points).map(|(_, loss)| loss);
    let first = losses.next()?;
    Some(losses.fold([first, first], |[low, high], loss| [low.min(loss), high.max(loss)]))
}

fn points(curve: &LossCurve) -> impl Iterator<Item = (f64, f64)> + '_ {
    let all = curve.train.iter().chain(&curve.held_out).copied();
    all.filter(|point| can_be_drawn(*point))
}

fn can_be_drawn((epoch, loss): (f64, f64)) -> bool {
    epoch.is_finite() && loss.is_finite() && loss > 0.0
}

impl<'a> LossCurves<'a> {
    /// A chart that fits its scales to the curves, whose losses are such a quantity (SI).
    pub fn new(label: &'a str, curves: &'a [LossCurve], quantity: Quantity) -> Self {
        Self { label, caption: "", curves, quantity, range: None, running: false, step: "epoch", size: None }
    }

    /// What came of it, in a few words: "held out 4.31 mm".
    pub fn caption(mut self, caption: &'a str) -> Self {
        self.caption = caption;
        self
    }

    /// Losses at the lower and the upper end, so that several charts can be compared.
    pub fn range(mut self, range: Option<[f64; 2]>) -> Self {
        self.range = range;
        self
    }

    /// Whether more is to come.
    pub fn running(mut self, running: bool) -> Self {
        self.running = running;
        self
    }

    /// What is counted to the right, instead of epochs.
    pub fn step(mut self, step: &'a str) -> Self {
        self.step = step;
        self
    }

    /// Size in points, instead of all that is available.
    pub fn size(mut self, size: egui::Vec2) -> Self {
        self.size = Some(size);
        self
    }

    /// Draws the chart. Its label for tests is `"{label}: {caption}"`.
    pub fn show(self, ui: &mut Ui) -> Response {
        let size = self.size.unwrap_or(ui.available_size()).max(vec2(120.0, 90.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| {
            WidgetInfo::labeled(egui::Role::Image, true, format!("{}: {}", self.label, self.caption))
        });
        if ui.is_rect_visible(rect) {
            let plot =
                Rect::from_min_max(rect.min + vec2(AXES.x, CAPTION), rect.max - vec2(space::S, AXES.y));
            self.paint(ui, rect, plot, response.hover_pos());
        }
        response
    }

    fn paint(&self, ui: &Ui, rect: Rect, plot: Rect, pointer: Option<Pos2>) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let strong = theme::strong_font(ui);
        let painter = ui.painter();
        let name = painter.text(rect.left_top(), Align2::LEFT_TOP, self.label, strong, tokens.text_strong);
        let words = painter.layout_no_wrap(self.caption.to_owned(), font.clone(), tokens.text_weak);
        if words.size().x < rect.right() - name.right() - space::M {
            let at = pos2(rect.right() - space::S - words.size().x, name.center().y - words.size().y / 2.0);
            painter.galley(at, words, tokens.text_weak);
        }
        painter.rect_filled(plot, 3.0, tokens.raised.gamma_multiply(0.35));
        let Some(scales) = Scales::of(self.curves, self.range, plot) else {
            let words = if self.running { "The first epochs are under way." } else { "Nothing trained yet." };
            painter.text(plot.center(), Align2::CENTER_CENTER, words, font, tokens.text_weak);
            return;
        };
        scales.axes(painter, tokens, &font, self.quantity);
        let below = pos2(plot.center().x, plot.bottom() + 16.0);
        painter.text(below, Align2::CENTER_TOP, self.step, font.clone(), tokens.text_weak);
        let clipped = ui.painter_at(plot);
        for (draw, role) in [(Draw::Solid, Role::Predicted), (Draw::Dashed, Role::HeldOut)] {
            for curve in self.curves {
                let points = if draw == Draw::Solid { &curve.train } else { &curve.held_out };
                scales.line(&clipped, points, draw, role.color(tokens), self.curves.len());
            }
        }
        let near = pointer.filter(|at| plot.contains(*at));
        if let Some((at, words)) = near.and_then(|at| scales.nearest(self.curves, at, self)) {
            readout(&clipped, plot, tokens, &font, (at, words));
        }
    }
}

/// What the lines mean: solid and dashed, in their colors.
pub fn loss_legend(ui: &mut Ui) {
    ui.horizontal(|ui| {
        for (draw, role, text) in
            [(Draw::Solid, Role::Predicted, "what it learns from"), (Draw::Dashed, Role::HeldOut, "held out")]
        {
            let (rect, _) = ui.allocate_exact_size(vec2(28.0, 14.0), Sense::hover());
            let ends = [rect.left_center(), rect.right_center()];
            draw.line(ui.painter(), &ends, Stroke::new(1.5, role.color(theme::tokens(ui))));
            ui.label(theme::small(ui, text));
            ui.add_space(space::S);
        }
    });
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Draw {
    Solid,
    Dashed,
}

impl Draw {
    fn line(self, painter: &Painter, points: &[Pos2], stroke: Stroke) {
        match self {
            Self::Solid => {
                painter.line(points.to_vec(), stroke);
            }
            Self::Dashed => {
                painter.extend(Shape::dashed_line(points, stroke, 5.0, 3.5));
            }
        }
    }
}

/// Epochs to the right, losses upward by their logarithm.
struct Scales {
    plot: Rect,
    epochs: f64,
    low: f64,
    high: f64,
}

impl Scales {
    fn of(curves: &[LossCurve], range: Option<[f64; 2]>, plot: Rect) -> Option<Self> {
        let [low, high] = range.or_else(|| loss_range(curves))?;
        if !(low > 0.0 && high >= low && high.is_finite()) {
            return None;
        }
        let epochs = curves.iter().flat_map(points).map(|(epoch, _)| epoch).fold(1.0, f64::max);
        // A little room above and below; a flat curve stands in the middle.
        let (low, high) = (low.log10(), high.log10());
        let pad = (0.06 * (high - low)).max(if high > low { 0.02 } else { 0.5 });
        Some(Self { plot, epochs, low: low - pad, high: high + pad })
    }

    fn at(&self, (epoch, loss): (f64, f64)) -> Pos2 {
        let x = epoch / self.epochs;
        let y = (loss.log10() - self.low) / (self.high - self.low);
        self.plot.left_bottom() + vec2(self.plot.width() * x as f32, -self.plot.height() * y as f32)
    }

    fn axes(&self, painter: &Painter, tokens: &Tokens, font: &FontId, quantity: Quantity) {
        let stroke = Stroke::new(1.0, tokens.text_weak.gamma_multiply(0.25));
        let unit = quantity.on_screen(1.0);
        let ticks = decades(self.low + unit.log10(), self.high + unit.log10());
        let last = ticks.len().saturating_sub(1);
        for (i, value) in ticks.iter().enumerate() {
            let y = self.at((0.0, value / unit)).y;
            painter.hline(self.plot.x_range(), y, stroke);
            let text = if i == last { format!("{value} {}", quantity.unit()) } else { format!("{value}") };
            let at = pos2(self.plot.left() - 5.0, y);
            painter.text(at, Align2::RIGHT_CENTER, text.trim(), font.clone(), tokens.text_weak);
        }
        let ticks = axis::ticks(0.0, self.epochs, ((self.plot.width() / 70.0) as usize).clamp(2, 6));
        for (epoch, text) in ticks.iter().zip(axis::labels(&ticks)) {
            let x = self.at((*epoch, 1.0)).x;
            painter.vline(x, self.plot.y_range(), stroke);
            let at = pos2(x, self.plot.bottom() + 3.0);
            painter.text(at, Align2::CENTER_TOP, text, font.clone(), tokens.text_weak);
        }
    }

    fn line(&self, painter: &Painter, points: &[(f64, f64)], draw: Draw, color: egui::Color32, of: usize) {
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        let last = points.len().saturating_sub(1);
        let shown: Vec<Pos2> = points
            .iter()
            .enumerate()
            .filter(|(i, point)| (i % stride == 0 || *i == last) && can_be_drawn(**point))
            .map(|(_, point)| self.at(*point))
            .collect();
        // Of many networks the single line matters less than the bundle.
        let color = if of > 3 { color.gamma_multiply(0.7) } else { color };
        if shown.len() > 1 {
            draw.line(painter, &shown, Stroke::new(if of > 3 { 1.0 } else { 1.5 }, color));
        } else if let [only] = shown[..] {
            painter.circle_filled(only, 2.0, color);
        }
    }

    /// The point of a curve that is nearest to the pointer, and its words.
    fn nearest(&self, curves: &[LossCurve], at: Pos2, of: &LossCurves<'_>) -> Option<(Pos2, String)> {
        let near = curves
            .iter()
            .flat_map(|curve| points(curve).map(move |point| (curve, point)))
            .map(|(curve, point)| (curve, point, self.at(point).distance(at)))
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let (curve, (epoch, loss), _) = near.filter(|(.., distance)| *distance < 40.0)?;
        let text =
            format!("{}, {} {}: {}", curve.name, of.step, format::fixed(epoch, 0), of.quantity.text(loss));
        Some((self.at((epoch, loss)), text))
    }
}

fn readout(painter: &Painter, plot: Rect, tokens: &Tokens, font: &FontId, (at, text): (Pos2, String)) {
    let galley = painter.layout_no_wrap(text, font.clone(), tokens.text_strong);
    let corner = plot.right_top() + vec2(-space::XS, space::XS);
    let chip = Align2::RIGHT_TOP.anchor_size(corner, galley.size() + vec2(12.0, 6.0));
    painter.circle_stroke(at, 3.5, Stroke::new(1.5, tokens.text_strong));
    painter.rect_filled(chip, 4.0, tokens.panel);
    painter.galley(chip.min + vec2(6.0, 3.0), galley, tokens.text_strong);
}

/// Round values on a logarithmic scale: powers of ten, or 1, 2 and 5 of them where those are few.
fn decades(low: f64, high: f64) -> Vec<f64> {
    let factors: &[f64] = match high - low {
        span if span > 2.2 => &[1.0],
        span if span > 0.5 => &[1.0, 2.0, 5.0],
        _ => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0],
    };
    let powers = low.floor() as i32..=high.ceil() as i32;
    let all = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)));
    all.filter(|value| (low..=high).contains(&value.log10())).map(tidy).collect()
}

/// Without the dust of binary fractions, so that it is written short.
fn tidy(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(train: &[(f64, f64)], held_out: &[(f64, f64)]) -> LossCurve {
        LossCurve { name: "network 1".to_owned(), train: train.to_vec(), held_out: held_out.to_vec() }
    }

    #[test]
    fn the_scale_leaves_out_what_has_no_logarithm() {
        let curves = [curve(&[(0.0, 1.0), (1.0, 0.0), (2.0, f64::NAN)], &[(1.0, 0.01), (2.0, -3.0)])];
        assert_eq!(loss_range(&curves), Some([0.01, 1.0]));
        assert_eq!(loss_range(&[curve(&[(0.0, 0.0)], &[])]), None);
        assert_eq!(loss_range(&[]), None);
    }

    #[test]
    fn a_tenth_of_the_loss_is_always_the_same_step_down() {
        let plot = Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 100.0));
        let curves = [curve(&[(0.0, 1.0), (100.0, 0.001)], &[])];
        let scales = Scales::of(&curves, None, plot).expect("curves");
        let y = |loss| scales.at((50.0, loss)).y;
        assert!((y(0.1) - y(1.0) - (y(0.01) - y(0.1))).abs() < 1e-3 && y(0.1) > y(1.0));
        assert!((scales.at((50.0, 1.0)).x - 100.0).abs() < 1e-3);
        assert!(plot.contains(scales.at((100.0, 0.001))));
    }

    #[test]
    fn a_flat_curve_stands_in_the_middle() {
        let plot = Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 100.0));
        let scales = Scales::of(&[curve(&[(0.0, 0.3), (9.0, 0.3)], &[])], None, plot).expect("curves");
        assert!((scales.at((1.0, 0.3)).y - 50.0).abs() < 1e-3);
    }

    #[test]
    fn ticks_are_inside_and_more_than_one() {
        for (low, high) in [(-4.0, 0.3), (-2.3, -1.1), (-2.05, -1.8)] {
            let ticks = decades(low, high);
            assert!((2..9).contains(&ticks.len()), "{ticks:?}");
            assert!(ticks.iter().all(|tick| (low..=high).contains(&tick.log10())));
        }
    }

    #[test]
    fn ticks_are_written_short() {
        let texts: Vec<String> = decades(-1.5, 0.4).iter().map(|tick| format!("{tick}")).collect();
        assert_eq!(texts, ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
    }

    #[test]
    fn the_pointer_finds_the_nearest_curve_and_nothing_far_away() {
        let plot = Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 100.0));
        let curves = [curve(&[(0.0, 0.1), (100.0, 0.001)], &[])];
        let scales = Scales::of(&curves, None, plot).expect("curves");
        let end = scales.at((100.0, 0.001));
        let words = |at| {
            scales
                .nearest(&curves, at, &LossCurves::new("M3", &curves, Quantity::Length))
                .map(|(_, words)| words)
        };
        assert_eq!(words(end - vec2(3.0, 3.0)).as_deref(), Some("network 1, epoch 100: 1.00 mm"));
        assert_eq!(words(pos2(100.0, 0.0)), None);
    }
}

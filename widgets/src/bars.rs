//! Errors of all pairs as bars, one per eye, to find and to choose the bad ones.

use egui::{
    Align2, Rect, Response, ScrollArea, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2,
    vec2,
};
use plumbline_model::Eye;

use crate::axis;
use crate::format::Quantity;
use crate::theme::{self, Tokens, space};

const AXIS_WIDTH: f32 = 40.0;
const NAME_HEIGHT: f32 = 18.0;
const LEAST_PAIR_WIDTH: f32 = 12.0;
const MOST_PAIR_WIDTH: f32 = 34.0;

/// One pair and its error in each eye.
#[derive(Clone, Debug, PartialEq)]
pub struct PairBar {
    /// Name of the pair.
    pub name: String,
    /// Error in the left eye, SI or pixels; `None` if it did not see the board.
    pub left: Option<f64>,
    /// Same, right eye.
    pub right: Option<f64>,
    /// Left out by the operator; drawn hollow.
    pub dropped: bool,
}

impl PairBar {
    /// The error of one eye.
    pub fn value(&self, eye: Eye) -> Option<f64> {
        match eye {
            Eye::Left => self.left,
            Eye::Right => self.right,
        }
    }

    fn worst(&self) -> f64 {
        Eye::BOTH.into_iter().filter_map(|eye| self.value(eye)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A bar: the index of the pair in the data given, and the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BarRef {
    /// Index of the pair.
    pub pair: usize,
    /// Whose error.
    pub eye: Eye,
}

/// A bar chart of pairs.
pub struct PairBars<'a> {
    label: &'a str,
    pairs: &'a [PairBar],
    quantity: Quantity,
    threshold: Option<f64>,
    sorted: bool,
    selected: Option<usize>,
    height: f32,
}

/// What the line is that good pairs stay below.
const THRESHOLD: &str = "good pairs stay below";

/// What happened to the chart.
#[derive(Clone, Debug)]
pub struct BarsResponse {
    /// The bar that was clicked, or pressed by keyboard.
    pub clicked: Option<BarRef>,
    /// The bar under the pointer or with keyboard focus.
    pub hovered: Option<BarRef>,
}

impl<'a> PairBars<'a> {
    /// Bars in the order given, in pixels.
    pub fn new(label: &'a str, pairs: &'a [PairBar]) -> Self {
        Self {
            label,
            pairs,
            quantity: Quantity::Pixels,
            threshold: None,
            sorted: false,
            selected: None,
            height: 180.0,
        }
    }

    /// Another quantity than pixels.
    pub fn quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// A line that good pairs stay below.
    pub fn threshold(mut self, threshold: Option<f64>) -> Self {
        self.threshold = threshold;
        self
    }

    /// Worst first instead of in the order given.
    pub fn sorted(mut self, sorted: bool) -> Self {
        self.sorted = sorted;
        self
    }

    /// The pair that is shown elsewhere.
    pub fn selected(mut self, pair: Option<usize>) -> Self {
        self.selected = pair;
        self
    }

    /// Height in points.
    pub fn height(mut self, height: f32) -> Self {
        self.height = height;
        self
    }

    /// Draws it over the available width; scrolls sideways when there are too many pairs. The
    /// label of a bar for tests is `"{name}, left eye: 0.0820 px"`, with `", dropped"` behind it.
    pub fn show(self, ui: &mut Ui) -> BarsResponse {
        let order = self.order();
        let largest = self.pairs.iter().map(PairBar::worst).chain(self.threshold).fold(0.0, f64::max);
        let top = axis::round_up(1.05 * self.quantity.on_screen(largest));
        let mut result = BarsResponse { clicked: None, hovered: None };
        ui.horizontal(|ui| {
            ui.label(theme::small(ui, format!("{}, {}", self.label, self.quantity.unit())));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), legend);
        });
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            let (scale, _) = ui.allocate_exact_size(vec2(AXIS_WIDTH, self.height), Sense::hover());
            let room = ui.available_width() - space::XS;
            let pair_width = (room / self.pairs.len().max(1) as f32).clamp(LEAST_PAIR_WIDTH, MOST_PAIR_WIDTH);
            ScrollArea::horizontal().id_salt(self.label).show(ui, |ui| {
                let size = vec2((pair_width * self.pairs.len() as f32).max(room), self.height);
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                let chart = Chart { rect: rect.with_max_y(rect.bottom() - NAME_HEIGHT), top, pair_width };
                self.grid(ui, &chart, scale);
                for (place, pair) in order.into_iter().enumerate() {
                    self.pair(ui, &chart, place, pair, &mut result);
                }
                self.threshold_line(ui, &chart);
            });
        });
        result
    }

    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.pairs.len()).collect();
        if self.sorted {
            order.sort_by(|a, b| self.pairs[*b].worst().total_cmp(&self.pairs[*a].worst()));
        }
        order
    }

    fn grid(&self, ui: &Ui, chart: &Chart, scale: Rect) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let ticks = axis::ticks(0.0, chart.top, 5);
        // The numbers stand outside of the part that scrolls.
        let beside = ui.ctx().layer_painter(ui.layer_id()).with_clip_rect(scale.expand2(vec2(0.0, 8.0)));
        for (tick, text) in ticks.iter().zip(axis::labels(&ticks)) {
            let y = chart.y(*tick);
            ui.painter().hline(chart.rect.x_range(), y, Stroke::new(1.0, tokens.grid));
            let at = pos2(scale.right() - space::XS, y);
            beside.text(at, Align2::RIGHT_CENTER, text, font.clone(), tokens.text_weak);
        }
    }

    fn threshold_line(&self, ui: &Ui, chart: &Chart) {
        if let Some(threshold) = self.threshold {
            let y = chart.y(self.quantity.on_screen(threshold));
            let ends = [pos2(chart.rect.left(), y), pos2(chart.rect.right(), y)];
            let stroke = Stroke::new(1.0, theme::tokens(ui).text);
            ui.painter().extend(Shape::dashed_line(&ends, stroke, 4.0, 4.0));
            let font = theme::font(ui, &TextStyle::Small);
            let at = pos2(chart.rect.left() + space::XS, y - 1.0);
            let color = theme::tokens(ui).text_weak;
            ui.painter().text(at, Align2::LEFT_BOTTOM, THRESHOLD, font, color);
        }
    }

    fn pair(&self, ui: &mut Ui, chart: &Chart, place: usize, pair: usize, result: &mut BarsResponse) {
        let tokens = theme::tokens(ui);
        let column = chart.column(place);
        let mut active = false;
        let mut responses = Vec::with_capacity(2);
        for eye in Eye::BOTH {
            let bar = BarRef { pair, eye };
            let response = self.interact(ui, chart.half(column, eye), bar);
            if response.clicked() {
                result.clicked = Some(bar);
            }
            if response.hovered() || response.has_focus() {
                result.hovered = Some(bar);
                active = true;
            }
            if response.has_focus() {
                response.scroll_to_me(None);
            }
            responses.push(response);
        }
        let chosen = self.selected == Some(pair);
        if chosen || active {
            let back = if chosen { tokens.selected } else { tokens.raised.gamma_multiply(0.7) };
            ui.painter().rect_filled(column.with_max_y(column.bottom() + NAME_HEIGHT), 3.0, back);
            self.name(ui, column, pair);
        }
        for (eye, response) in Eye::BOTH.into_iter().zip(responses) {
            self.bar(ui, chart, chart.half(column, eye), pair, eye);
            if response.has_focus() {
                let ring = Stroke::new(1.5, tokens.accent);
                ui.painter().rect_stroke(response.rect, 2.0, ring, StrokeKind::Inside);
            }
            response.on_hover_text_at_pointer(self.describe(BarRef { pair, eye }));
        }
    }

    fn interact(&self, ui: &Ui, rect: Rect, bar: BarRef) -> Response {
        let id = ui.scope_id().with((self.label, bar.pair, bar.eye));
        let response = ui.interact(rect, id, Sense::click());
        let selected = self.selected == Some(bar.pair);
        response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, selected, self.describe(bar)));
        response
    }

    fn describe(&self, bar: BarRef) -> String {
        let pair = &self.pairs[bar.pair];
        let value = match pair.value(bar.eye) {
            Some(value) => self.quantity.text(value),
            None => "board not seen".to_owned(),
        };
        let dropped = if pair.dropped { ", dropped" } else { "" };
        format!("{}, {} eye: {value}{dropped}", pair.name, bar.eye)
    }

    fn name(&self, ui: &Ui, column: Rect, pair: usize) {
        let font = theme::font(ui, &TextStyle::Small);
        let tokens = theme::tokens(ui);
        let galley = ui.painter().layout_no_wrap(self.pairs[pair].name.clone(), font, tokens.text_strong);
        let clip = ui.clip_rect();
        let half = galley.size().x / 2.0;
        let x = column.center().x.clamp(clip.left() + half, (clip.right() - half).max(clip.left() + half));
        ui.painter().galley(pos2(x - half, column.bottom() + 2.0), galley, tokens.text);
    }

    fn bar(&self, ui: &Ui, chart: &Chart, half: Rect, pair: usize, eye: Eye) {
        let Some(value) = self.pairs[pair].value(eye).filter(|value| value.is_finite()) else { return };
        let tokens = theme::tokens(ui);
        let top = chart.y(self.quantity.on_screen(value));
        let inset = (half.width() * 0.12).max(1.0);
        let rect = half.with_min_y(top).shrink2(vec2(inset, 0.0));
        if self.pairs[pair].dropped {
            let outline = Stroke::new(1.0, tokens.noise_floor);
            ui.painter().rect_stroke(rect, 0.0, outline, StrokeKind::Inside);
            return;
        }
        ui.painter().rect_filled(rect, 0.0, eye_color(tokens, eye));
        if let Some(threshold) = self.threshold.filter(|threshold| value > *threshold) {
            let limit = chart.y(self.quantity.on_screen(threshold));
            ui.painter().rect_filled(rect.with_max_y(limit), 0.0, tokens.warning);
        }
    }
}

/// Both eyes show a difference and have its color; the right one is paler.
fn eye_color(tokens: &Tokens, eye: Eye) -> egui::Color32 {
    match eye {
        Eye::Left => tokens.difference,
        Eye::Right => tokens.difference.lerp_to_gamma(tokens.panel, 0.45),
    }
}

/// From right to left.
fn legend(ui: &mut Ui) {
    let tokens = theme::tokens(ui);
    ui.spacing_mut().item_spacing.x = space::XS;
    for eye in Eye::BOTH.into_iter().rev() {
        ui.label(theme::small(ui, format!("{eye} eye")));
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
        ui.painter().rect_filled(rect, 2.0, eye_color(tokens, eye));
        ui.add_space(space::S);
    }
}

struct Chart {
    rect: Rect,
    top: f64,
    pair_width: f32,
}

impl Chart {
    fn y(&self, on_screen: f64) -> f32 {
        self.rect.bottom() - self.rect.height() * (on_screen / self.top).clamp(0.0, 1.0) as f32
    }

    fn column(&self, place: usize) -> Rect {
        let left = self.rect.left() + place as f32 * self.pair_width;
        Rect::from_x_y_ranges(left..=left + self.pair_width, self.rect.y_range())
    }

    fn half(&self, column: Rect, eye: Eye) -> Rect {
        let margin = 1.0;
        let middle = column.center().x;
        match eye {
            Eye::Left => Rect::from_x_y_ranges(column.left() + margin..=middle, column.y_range()),
            Eye::Right => Rect::from_x_y_ranges(middle..=column.right() - margin, column.y_range()),
        }
    }
}

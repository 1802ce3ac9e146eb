//! Aligned figures for the inspector: what, how much, in which unit, and what it means.

use egui::{Align2, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::format::{self, Quantity};
use crate::theme::{self, Role, space};

const ROW_HEIGHT: f32 = 22.0;
const UNIT_WIDTH: f32 = 50.0;
const UNIT_GAP: f32 = 6.0;
const MOST_WIDTH: f32 = 340.0;

/// One row: a name, a figure, and an explanation on hover.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyValue {
    label: String,
    value: String,
    unit: &'static str,
    help: Option<String>,
    role: Option<Role>,
}

impl KeyValue {
    /// A quantity in SI.
    pub fn quantity(label: impl Into<String>, quantity: Quantity, si: f64) -> Self {
        Self::text(label, quantity.number(si)).unit(quantity.unit())
    }

    /// A quantity in SI with one standard deviation.
    pub fn uncertain(label: impl Into<String>, quantity: Quantity, si: f64, sigma_si: f64) -> Self {
        Self::text(label, quantity.number_with(si, sigma_si)).unit(quantity.unit())
    }

    /// A quantity that may be missing.
    pub fn optional(label: impl Into<String>, quantity: Quantity, si: Option<f64>) -> Self {
        match si {
            Some(si) => Self::quantity(label, quantity, si),
            None => Self::text(label, format::NONE),
        }
    }

    /// Words, or a number that is already written.
    pub fn text(label: impl Into<String>, value: impl Into<String>) -> Self {
        Self { label: label.into(), value: value.into(), unit: "", help: None, role: None }
    }

    /// Unit behind the value.
    pub fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// What it means, on hover.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Colors the value by a meaning: accepted, warning.
    pub fn role(mut self, role: Role) -> Self {
        self.role = Some(role);
        self
    }
}

/// Draws rows in three aligned columns over the available width, at most 340 points: name on the
/// left, figures ending at the same place, units behind them. Groups of rows below each other
/// line up. The label of a row for tests is `"{label}: {value} {unit}"`.
pub fn key_value_grid(ui: &mut Ui, id: &str, rows: &[KeyValue]) {
    ui.push_id(id, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let width = ui.available_width().min(MOST_WIDTH);
        for row in rows {
            show_row(ui, row, width);
        }
    });
}

fn show_row(ui: &mut Ui, row: &KeyValue, width: f32) {
    let tokens = theme::tokens(ui);
    let font = theme::font(ui, &TextStyle::Body);
    let value_color = row.role.map_or(tokens.text_strong, |role| role.color(tokens));
    let layout = |text: &str, color| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), color);
    let name = layout(&row.label, tokens.text_weak);
    let value = layout(&row.value, value_color);
    let unit = layout(row.unit, tokens.text_weak);
    // Words that need it go over the room of the unit that they lack; where both do not fit beside each other even so, the
    // name gets a line of its own, and what is longer than a line goes on in the next one.
    let beside = name.size().x + space::S + value.size().x;
    let line = if beside <= width { beside } else { value.size().x };
    let unit_room = if row.unit.is_empty() && line + UNIT_WIDTH > width { 0.0 } else { UNIT_WIDTH };
    let stacked = beside + unit_room > width;
    let value = if stacked && value.size().x > width - unit_room {
        ui.painter().layout(row.value.clone(), font.clone(), value_color, width - unit_room)
    } else {
        value
    };
    let value_height = ROW_HEIGHT.max(value.size().y + ROW_HEIGHT - name.size().y);
    let height = if stacked { value_height + name.size().y } else { ROW_HEIGHT };

    let sense = if row.help.is_some() { Sense::focusable_noninteractive() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), sense);
    response.widget_info(|| {
        let text = format!("{}: {} {}", row.label, row.value, row.unit);
        WidgetInfo::labeled(egui::Role::Row, true, text.trim())
    });
    if row.help.is_some() {
        theme::paint_hover(ui, &response, rect);
    }
    let painter = ui.painter();
    let first = if stacked { rect.top() } else { rect.bottom() - ROW_HEIGHT };
    let last = if stacked { first + name.size().y } else { first };
    let line = |galley: &egui::Galley, top: f32| top + (ROW_HEIGHT - galley.size().y) / 2.0;
    let value_top = last + (ROW_HEIGHT - unit.size().y) / 2.0;
    let end = rect.right() - unit_room;
    let value_left = (end - value.size().x).max(rect.left());
    painter.galley(pos2(rect.left(), line(&name, first)), name, tokens.text_weak);
    painter.galley(pos2(value_left, value_top), value, value_color);
    painter.galley(pos2(end + UNIT_GAP, line(&unit, last)), unit, tokens.text_weak);
    if let Some(help) = &row.help {
        response.on_hover_text(help);
    }
}

/// The figure that decides, large, with its name below: "0.0955 px", "stereo rms".
pub fn big_figure(ui: &mut Ui, label: &str, value: &str, role: Role) -> egui::Response {
    let tokens = theme::tokens(ui);
    let color = if role == Role::Ink { tokens.text_strong } else { role.color(tokens) };
    let heading = theme::font(ui, &TextStyle::Heading);
    let small = theme::font(ui, &TextStyle::Small);
    let figure = ui.painter().layout_no_wrap(value.to_owned(), heading, color);
    let name = ui.painter().layout_no_wrap(label.to_owned(), small, tokens.text_weak);
    let size = vec2(figure.size().x.max(name.size().x), figure.size().y + name.size().y + 2.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{label}: {value}")));
    let below = Align2::LEFT_BOTTOM.anchor_size(rect.left_bottom(), name.size()).min;
    ui.painter().galley(rect.min, figure, color);
    ui.painter().galley(below, name, tokens.text_weak);
    response
}

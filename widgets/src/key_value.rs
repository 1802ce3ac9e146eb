//! Aligned figures for the inspector: what, how much, in which unit, and what it means.

use egui::{Align, Align2, Grid, Layout, RichText, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::format::{self, Quantity};
use crate::theme::{self, Role, space};

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

/// Draws rows in three aligned columns. `id` must be unique within the panel. The label of a row
/// for tests is `"{label}: {value} {unit}"`.
pub fn key_value_grid(ui: &mut Ui, id: &str, rows: &[KeyValue]) {
    let tokens = theme::tokens(ui);
    Grid::new(id).num_columns(3).spacing(vec2(space::S, space::XS)).min_row_height(20.0).show(ui, |ui| {
        for row in rows {
            let first =
                ui.add(egui::Label::new(RichText::new(&row.label).color(tokens.text_weak)).selectable(false));
            let color = row.role.map_or(tokens.text_strong, |role| role.color(tokens));
            let second = ui
                .with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.add(
                        egui::Label::new(RichText::new(&row.value).color(color))
                            .wrap_mode(egui::TextWrapMode::Extend),
                    )
                })
                .inner;
            ui.label(RichText::new(row.unit).color(tokens.text_weak));
            ui.end_row();
            let whole = first.rect.union(second.rect);
            let response = ui.interact(whole, ui.scope_id().with((id, &row.label)), Sense::hover());
            response.widget_info(|| {
                let text = format!("{}: {} {}", row.label, row.value, row.unit);
                WidgetInfo::labeled(egui::Role::Row, true, text.trim())
            });
            if let Some(help) = &row.help {
                response.on_hover_text(help);
            }
        }
    });
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

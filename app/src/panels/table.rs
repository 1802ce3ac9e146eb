//! Maps of the table: how well places are known, and how far they move against the calibration
//! in use.

use egui::Ui;
use plumbline_engine::view::TableMap;
use plumbline_widgets::colormap::{ColorScale, Colormap};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::table_map::{self, Outline, Place, ScalarField, TableScene};
use plumbline_widgets::theme;

use super::PanelContext;
use crate::operator::{Action, Screen};

pub fn uncertainty(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    let proposed = eyes.proposal.as_ref().map(|proposal| proposal.uncertainty.as_ref());
    let in_use = eyes.in_use.as_ref().map(|in_use| in_use.uncertainty.as_ref());
    match proposed.or(in_use) {
        Some(Some(map)) => draw(
            ui,
            "Uncertainty",
            map,
            "One standard deviation of a measured point, with the head as it stood when this was made",
            2.0,
        ),
        Some(None) => message(
            ui,
            cx,
            "Not known",
            "The file says nothing about how well its numbers are known: solve from pairs to get this map.",
        ),
        None => message(
            ui,
            cx,
            "Nothing solved yet",
            "Collect pairs and solve them to see how well places are known.",
        ),
    }
}

pub fn difference(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    match (&eyes.proposal, &eyes.in_use) {
        (Some(proposal), Some(_)) => match &proposal.difference {
            Some(map) => {
                draw(
                    ui,
                    "Difference",
                    map,
                    "How far a point moves if the proposal is accepted, with the head as it stood when this was made",
                    2.0,
                );
            }
            None => message(
                ui,
                cx,
                "No difference to show",
                "The two calibrations see no part of the table in common.",
            ),
        },
        (None, Some(_)) => {
            message(
                ui,
                cx,
                "Nothing is proposed",
                "Solve or import a calibration to compare it with the one in use.",
            );
        }
        (_, None) => message(ui, cx, "Nothing to compare with", "This will be the first calibration in use."),
    }
}

fn message(ui: &mut Ui, cx: &mut PanelContext<'_>, title: &str, what_to_do: &str) {
    let collect = cx.view.eyes.proposal.is_none() && cx.screen != Screen::Collect;
    let message = Message::new(title, what_to_do);
    let message = if collect { message.button("Collect pairs") } else { message };
    if EmptyState::empty(message).show(ui) {
        cx.outbox.act(Action::Go(Screen::Collect));
    }
}

/// Colors from zero to at least `least_mm`, so that a good map does not look dramatic.
fn draw(ui: &mut Ui, name: &str, map: &TableMap, meaning: &str, least_mm: f64) {
    super::padded(ui, |ui| {
        let figures = match (map.median_m(), map.greatest_m()) {
            (Some(median), Some(most)) => {
                format!(
                    "{meaning}: half of the table within {}, all within {}.",
                    format::mm(median),
                    format::mm(most)
                )
            }
            _ => format!("{meaning}: both eyes see no part of the table."),
        };
        ui.label(theme::small(ui, figures));
        let field = field(name, map);
        let most = map.greatest_m().unwrap_or(0.0).max(least_mm / 1000.0);
        let scale = ColorScale::new(Colormap::Viridis, [0.0, most as f32]);
        let mut scene = TableScene::new();
        scene.outlines.push(Outline::rectangle(
            Place::Patch,
            "workspace",
            [map.x_range_m.0, map.x_range_m.1],
            [map.y_range_m.0, map.y_range_m.1],
        ));
        let height = ui.available_height();
        table_map::TableMap::new(name, &scene).field(&field, scale).height(height).show(ui);
    });
}

/// The engine's grid as the widget wants it; rows run along x in both.
fn field(name: &str, map: &TableMap) -> ScalarField {
    let (x, y) = (map.x_range_m, map.y_range_m);
    let at = |value: f64, range: (f64, f64), n: usize| {
        ((value - range.0) / (range.1 - range.0) * (n - 1) as f64).round() as usize
    };
    let nodes = [map.columns_x, map.rows_y];
    ScalarField::sample(name, Quantity::Length, [x.0, x.1], [y.0, y.1], nodes, |[x_m, y_m]| {
        map.at(at(x_m, x, map.columns_x), at(y_m, y, map.rows_y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_not_turned_or_mirrored_on_its_way_to_the_screen() {
        let map =
            TableMap::fill(5, 9, (0.2, 0.6), (-0.4, 0.4), 0.05, |x, y, _| (y > -0.3).then_some(x + 10.0 * y));
        let field = field("test", &map);
        let value = field.at([0.3, 0.2]).expect("inside");
        assert!((value - 2.3).abs() < 1e-9, "{value}");
        assert_eq!(field.at([0.3, -0.35]), None);
    }
}

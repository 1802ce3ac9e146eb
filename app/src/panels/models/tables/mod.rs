//! The tables of grasp height and yaw: their points on the table map, to choose, drag, add and
//! remove; the error of each point when it is left out.

mod editor;
mod list;
mod panel;
mod points;
mod rows;

pub use panel::TablesPanel;

use std::time::Instant;

use egui::{Button, ScrollArea, Ui};
use plumbline_engine::view::TablesView;
use plumbline_engine::{GraspTable, ModelsCommand, TablesCommand, View};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::table_map::{Outline, Place, ScalarField, TableMap, TableScene};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::{ModelsAction, screen_of};
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};
use panel::{Moved, SeenTable, quantity};
use rows::{PointRow, layers_m, rows};

/// After this time a move that was not carried out is shown where it was.
const ANSWER_WITHIN_S: u64 = 2;
/// The part of the table that is shown where there are no points yet.
const X_M: [f64; 2] = [0.20, 0.56];
const Y_M: [f64; 2] = [-0.30, 0.30];
/// Height of the fields and the list below the map, points.
const BELOW: f32 = 244.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            header(ui, cx);
            let tables = cx.view.models.tables.clone();
            let rows = rows(&tables, cx.state.models.tables.table);
            forget_what_is_gone(cx, &tables, rows.len());
            layer(ui, cx, &rows);
            hint(ui, cx, &tables, &rows);
            let below = if cx.state.models.tables.table == GraspTable::Yaw { BELOW + 32.0 } else { BELOW };
            let height = (ui.available_height() - below).max(190.0);
            map(ui, cx, &tables, &rows, height);
            edit_buttons(ui, cx, &tables, &rows);
            ui.add_space(space::XS);
            ui.columns(2, |columns| {
                // Columns are justified by themselves, which tears sentences apart.
                let layout = egui::Layout::top_down(egui::Align::Min);
                if let [left, right] = columns {
                    left.with_layout(layout, |ui| editor::show(ui, cx, &rows));
                    right.with_layout(layout, |ui| list::show(ui, cx, &rows));
                }
            });
        });
    });
}

/// Which table, how it is colored, its files.
fn header(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        let panel = &mut cx.state.models.tables;
        let options = [(GraspTable::Height, "Height"), (GraspTable::Yaw, "Yaw")];
        if choice(ui, "Which table", &mut panel.table, &options) {
            panel.chosen = None;
            panel.draft = None;
            panel.moved = None;
        }
        ui.add_space(space::S);
        let colors = [(false, "Color by value"), (true, "Color by error")];
        choice(ui, "Color of the points", &mut panel.by_error, &colors);
        ui.add_space(space::S);
        let table = panel.table;
        action_button(ui, cx, ModelsAction::ImportTable(table), "Import CSV…")
            .on_hover_text(import_words(table));
        action_button(ui, cx, ModelsAction::ExportTable(table), "Export CSV…");
    });
}

/// Heights at which yaw was measured.
fn layer(ui: &mut Ui, cx: &mut PanelContext<'_>, rows: &[PointRow]) {
    let panel = &mut cx.state.models.tables;
    if panel.table == GraspTable::Height {
        return;
    }
    let layers = layers_m(rows);
    if layers.len() < 2 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::small(ui, "Height z"));
        let names: Vec<String> = layers.iter().map(|z| plumbline_widgets::format::mm(*z)).collect();
        let all = (None, "All");
        let each = layers.iter().zip(&names).map(|(z, name)| (Some(*z), name.as_str()));
        let options: Vec<(Option<f64>, &str)> = std::iter::once(all).chain(each).collect();
        choice(ui, "Layer", &mut panel.layer_m, &options);
    });
}

/// How to fill it, or what to do with it.
fn hint(ui: &mut Ui, cx: &PanelContext<'_>, tables: &TablesView, rows: &[PointRow]) {
    let panel = &cx.state.models.tables;
    let what = words(panel.table);
    let text = if rows.is_empty() {
        format!(
            "No {what} yet: import a CSV file, bring the arm to a good grasp and add its pose, or add points by clicks."
        )
    } else if panel.adding {
        "Click the map where the new point shall lie.".to_owned()
    } else if rows.len() < 4 {
        format!("It needs {} more before the {what} can answer.", format::count(4 - rows.len(), "point"))
    } else {
        let errors: Vec<f64> = rows.iter().filter_map(|row| row.error).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt();
        let rms = if errors.is_empty() { "not known".to_owned() } else { quantity(panel.table).text(rms) };
        format!(
            "{}. Left out, a point is missed by {rms} (rms). Larger dots miss by more.",
            format::count(rows.len(), "point")
        )
    };
    ui.label(theme::small(ui, text));
    let color = Role::Warning.color(theme::tokens(ui));
    for remark in &tables.remarks {
        ui.label(theme::small(ui, remark).color(color));
    }
}

/// What an import does to the points that are there.
fn import_words(table: GraspTable) -> &'static str {
    match table {
        GraspTable::Height => "Replaces the whole table.",
        GraspTable::Yaw => {
            "Replaces the points at the heights that are in the file and keeps the others: import one file per height."
        }
    }
}

fn words(table: GraspTable) -> &'static str {
    match table {
        GraspTable::Height => "table of grasp height",
        GraspTable::Yaw => "table of yaw",
    }
}

fn forget_what_is_gone(cx: &mut PanelContext<'_>, tables: &TablesView, count: usize) {
    let panel = &mut cx.state.models.tables;
    panel.chosen = panel.chosen.filter(|point| *point < count);
    let now = SeenTable::of(tables, panel.table);
    panel.moved = panel
        .moved
        .take()
        .filter(|moved| moved.of == now && moved.when.elapsed().as_secs() < ANSWER_WITHIN_S);
}

fn map(ui: &mut Ui, cx: &mut PanelContext<'_>, tables: &TablesView, rows: &[PointRow], height: f32) {
    let panel = &cx.state.models.tables;
    let scene = scene(cx.view, rows);
    let scale = points::scale(rows, panel.by_error);
    let points = points::on_map(rows, panel, scale);
    let map = TableMap::new("Points of the table", &scene).points(&points, panel.chosen).height(height);
    let field = match panel.table {
        GraspTable::Height if !panel.by_error => field(tables),
        _ => None,
    };
    let shown = match (&field, scale) {
        (Some(field), Some(scale)) => map.field(field, scale).show(ui),
        (None, Some(scale)) => map.scale(scale_name(panel), scale, quantity(panel.table)).show(ui),
        _ => map.show(ui),
    };
    let panel = &mut cx.state.models.tables;
    if let Some(point) = shown.points.chosen {
        panel.chosen = Some(point);
        panel.draft = None;
    }
    if let Some((point, at_m)) = shown.points.moved
        && let Some(row) = rows.get(point)
    {
        let of = SeenTable::of(tables, panel.table);
        panel.moved = Some(Moved { point, at_m, of, when: Instant::now() });
        panel.draft = None;
        let at_m = [at_m[0], at_m[1], row.at_m[2]];
        let change = TablesCommand::Change { table: panel.table, point, at_m, value: row.value };
        cx.outbox.send(ModelsCommand::Tables(change));
        return;
    }
    if let Some([x_m, y_m]) = shown.clicked_m {
        if panel.adding {
            let (table, z_m) = (panel.table, panel.layer_m.unwrap_or(0.0));
            let value = points::value_at(rows, field.as_ref(), [x_m, y_m], table);
            panel.adding = false;
            panel.chosen = Some(rows.len());
            cx.outbox.send(ModelsCommand::Tables(TablesCommand::Add { table, at_m: [x_m, y_m, z_m], value }));
        } else {
            panel.chosen = None;
            panel.draft = None;
        }
    }
}

fn scale_name(panel: &TablesPanel) -> &'static str {
    match (panel.by_error, panel.table) {
        (true, _) => "Left out",
        (false, GraspTable::Height) => "Height",
        (false, GraspTable::Yaw) => "Yaw",
    }
}

/// The heights between the points.
fn field(tables: &TablesView) -> Option<ScalarField> {
    let field = &tables.height_field;
    ScalarField::of_grid("Height", Quantity::Length, field.x_m, field.y_m, field.columns, &field.values_m)
}

fn scene(view: &View, rows: &[PointRow]) -> TableScene {
    let range = |least: [f64; 2], axis: usize| {
        let values = rows.iter().map(|row| row.at_m[axis]);
        values.fold(least, |[low, high], value| [low.min(value - 0.03), high.max(value + 0.03)])
    };
    let mut scene = TableScene { x_m: range(X_M, 0), y_m: range(Y_M, 1), ..TableScene::new() };
    if let Some(screen) = screen_of(view) {
        let corners_m = screen.corners().map(|corner| [corner.coords.x, corner.coords.y]).to_vec();
        let name = "touchscreen".to_owned();
        scene.outlines.push(Outline { place: Place::Touchscreen, name, corners_m });
    }
    scene
}

fn edit_buttons(ui: &mut Ui, cx: &mut PanelContext<'_>, tables: &TablesView, rows: &[PointRow]) {
    let (table, chosen) = (cx.state.models.tables.table, cx.state.models.tables.chosen);
    ui.horizontal_wrapped(|ui| {
        let adding = &mut cx.state.models.tables.adding;
        if ui.add(Button::new("Add at a click").selected(*adding)).clicked() {
            *adding = !*adding;
        }
        let here = ui.add_enabled(tables.palm.is_some(), Button::new("Add the arm's present pose"));
        let here = here
            .on_hover_text("Adds a point where the palm is now, with its height or yaw")
            .on_disabled_hover_text("no robot is connected: where the palm is is not known");
        if here.clicked() {
            cx.state.models.tables.chosen = Some(rows.len());
            cx.outbox.send(ModelsCommand::Tables(TablesCommand::AddHere { table }));
        }
        let remove = ui.add_enabled(chosen.is_some(), Button::new("Remove the point"));
        if remove.on_disabled_hover_text("choose a point first").clicked()
            && let Some(point) = chosen
        {
            cx.state.models.tables.chosen = None;
            cx.outbox.send(ModelsCommand::Tables(TablesCommand::Remove { table, point }));
        }
    });
}

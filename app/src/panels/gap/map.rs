//! What is left over the table: an arrow per row, before and after.

use egui::Ui;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::seen::Seen;
use plumbline_widgets::table_map::{BeforeAfter, TableMap};
use plumbline_widgets::theme::{self, space};

use super::drawn::Drawn;
use super::parts::finding;
use crate::operator::snapshot::gap::What;
use crate::operator::words::gap as words;
use crate::panels::arrows::{Errors, entry};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "The map then shows how far measured and predicted places lie apart, before and after.";
    let Some(shown) = finding(ui, cx, what) else { return };
    let drawn = cx.state.gap.map.get(Seen::of(&shown), || {
        let kinds = &shown.finding.comparison.kinds;
        let touched = kinds.iter().any(|kind| kind.what == What::Touch);
        let corners =
            cx.view.gap.rig.as_ref().filter(|_| touched).map(|rig| {
                rig.touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y]).to_vec()
            });
        Drawn::of(&shown, corners.unwrap_or_default())
    });
    padded(ui, |ui| {
        let is_wide = ui.available_width() > LEGEND_WIDTH;
        ui.horizontal_wrapped(|ui| {
            let options = [(Errors::Before, "Before"), (Errors::After, "After"), (Errors::Both, "Both")];
            choice(ui, "Errors of the gap", &mut cx.state.gap.errors, &options);
            // In a small tile the map needs the line; the tile below says it, too.
            if is_wide {
                let floor = words::error(&shown.finding.shown, shown.finding.shown.floor);
                let said = format!("{}: {floor}", words::floor_name(&shown.finding));
                ui.add(egui::Label::new(theme::small(ui, said)).extend());
            }
        });
        ui.add_space(space::XS);
        let errors = cx.state.gap.errors;
        let height = (ui.available_height() - 72.0).max(110.0);
        let scene = drawn.scene(errors);
        let at = |at_m| drawn.words(at_m);
        TableMap::new("Map of the gap", &scene).words(&at).height(height).show(ui);
        legend(ui, errors, &drawn);
    });
}

/// What both entries take side by side, pt.
const LEGEND_WIDTH: f32 = 400.0;

fn legend(ui: &mut Ui, errors: Errors, drawn: &Drawn) {
    ui.spacing_mut().item_spacing.y = 2.0;
    let scale = drawn.scale(errors);
    let times =
        if scale > 1.0 { format!("{scale} times as long as the error") } else { "in true length".to_owned() };
    let outliers = match drawn.outliers {
        0 => String::new(),
        n => format!(" Gray dots: {}, not used.", format::count(n, "outlier")),
    };
    ui.label(theme::small(
        ui,
        format!("Measured − predicted in the plane of the table, {times}; each row held out.{outliers}"),
    ));
    // Side by side where there is room.
    let beside = egui::Layout::left_to_right(egui::Align::Center);
    let below = egui::Layout::top_down(egui::Align::Min);
    let layout = if ui.available_width() > LEGEND_WIDTH { beside } else { below };
    ui.allocate_ui_with_layout(egui::vec2(ui.available_width(), 0.0), layout, |ui| {
        if errors != Errors::After {
            entry(ui, BeforeAfter::BEFORE, &format!("before, {} on average", format::mm(drawn.mean_m[0])));
        }
        if errors != Errors::Before {
            entry(ui, BeforeAfter::AFTER, &format!("after, {} on average", format::mm(drawn.mean_m[1])));
        }
    });
}

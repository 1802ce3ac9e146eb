//! What is known of the chosen model.

use egui::{Label, RichText, Ui};
use plumbline_engine::View;
use plumbline_widgets::format;
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, Role, group_heading};

use super::parts::{figure, interval};
use super::table::said_of;
use crate::operator::Outbox;
use crate::panels::PanelState;

/// What is known of the chosen model.
pub fn show(ui: &mut Ui, view: &View, state: &mut PanelState, _outbox: &mut Outbox) {
    group_heading(ui, "Detector");
    let row = view.scores.table.as_ref().and_then(|table| table.rows.get(state.scores.model));
    let Some(row) = row else {
        ui.label(theme::weak(ui, "Nothing was judged yet."));
        return;
    };
    ui.add(Label::new(theme::strong(ui, &*row.model)).truncate()).on_hover_text(&*row.model);
    for text in said_of(row) {
        ui.add(Label::new(RichText::new(text).color(Role::Warning.color(theme::tokens(ui)))).wrap());
    }
    let Ok(scores) = &row.scores else { return };
    let [before_ms, network_ms, after_ms] = scores.times_ms;
    let total = before_ms + network_ms + after_ms;
    let mut rows = vec![
        KeyValue::text("mAP50–95", figure(Some(scores.all.map50_95))),
        KeyValue::text("95 %", interval(scores.all.map50_95_interval)),
        KeyValue::text("mAP50", figure(Some(scores.all.map50))),
        KeyValue::text("Per image", format::ms(1e-3 * total)),
        KeyValue::text("fitting it", format::ms(1e-3 * before_ms)),
        KeyValue::text("network", format::ms(1e-3 * network_ms)),
        KeyValue::text("its boxes", format::ms(1e-3 * after_ms)),
    ];
    // Of what it proposed itself an interval says nothing.
    if scores.all.map50_95_interval.is_none() || scores.judged_by_itself.is_some() {
        rows.remove(1);
    }
    key_value_grid(ui, "score figures", &rows);
    group_heading(ui, "How to read it");
    for text in [
        "mAP50–95 is the mean average precision over overlaps from 0.50 to 0.95, by the rule of COCO; 1 is perfect.",
        "An interval says where the score would mostly lie on other scenes of the same kind.",
        "Never judge on images that the detector was trained on.",
    ] {
        ui.add(Label::new(theme::weak(ui, text)).wrap());
    }
}

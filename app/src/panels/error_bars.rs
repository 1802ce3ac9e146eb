//! Error of every pair and eye; a click shows the pair.

use egui::Ui;
use plumbline_engine::EyesCommand;
use plumbline_engine::view::EyesView;
use plumbline_model::StereoCalibration;
use plumbline_widgets::bars::{PairBar, PairBars};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme;

use super::PanelContext;
use crate::operator::words::eyes::cold_among;

/// A pair this many times worse than the median deserves a look.
const SUSPICIOUS: f64 = 2.5;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(calibration) = super::shown_calibration(&cx.view.eyes).filter(|c| !c.per_pair.is_empty()) else {
        let message = Message::new("No pairs to show", "Solve collected pairs to see which of them fit.");
        EmptyState::empty(message).show(ui);
        return;
    };
    let bars = bars(&calibration, &cx.view.eyes);
    let chosen = cx.state.chosen_pair.as_ref().and_then(|name| bars.iter().position(|bar| bar.name == *name));
    super::padded(ui, |ui| {
        let cold = cold_among(&cx.view.eyes, calibration.per_pair.iter().map(|fit| fit.name.as_str()));
        let footer = if cx.view.eyes.dropped.is_empty() { 0.0 } else { 32.0 };
        let footer = footer + if cold.is_some() { 44.0 } else { 0.0 };
        let height = (ui.available_height() - 34.0 - footer).clamp(80.0, 400.0);
        let shown = PairBars::new("Rms of the corners", &bars)
            .threshold(threshold(&bars))
            .selected(chosen)
            .height(height)
            .show(ui);
        if let Some(bar) = shown.clicked {
            cx.state.chosen_pair = Some(bars[bar.pair].name.clone());
            cx.state.chosen_eye = Some(bar.eye);
        }
        if let Some(cold) = cold {
            ui.label(theme::weak(ui, cold));
        }
        dropped(ui, cx);
    });
}

/// Pairs that the next solution leaves out, to take them back.
fn dropped(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.view.eyes.dropped.is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        ui.label(theme::small(ui, "Dropped, click to restore:"));
        for name in cx.view.eyes.dropped.iter() {
            let button = ui.add(egui::Button::new(name).small());
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Restore {name}"))
            });
            if button.clicked() {
                cx.outbox.send(EyesCommand::RestorePair { pair: name.clone() });
            }
        }
    });
}

/// The fitted pairs in their order.
fn bars(calibration: &StereoCalibration, eyes: &EyesView) -> Vec<PairBar> {
    calibration
        .per_pair
        .iter()
        .map(|fit| PairBar {
            name: fit.name.clone(),
            left: fit.left_px,
            right: fit.right_px,
            dropped: eyes.dropped.contains(&fit.name),
        })
        .collect()
}

fn threshold(bars: &[PairBar]) -> Option<f64> {
    let mut errors: Vec<f64> = bars.iter().flat_map(|bar| [bar.left, bar.right]).flatten().collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).map(|median| SUSPICIOUS * median)
}

//! Objects, in the inspector of the Live screen.

use egui::Ui;
use plumbline_engine::View;
use plumbline_engine::view::{DetectView, DetectionTiming};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, group_heading};

use super::{ObjectsPanels, classes, details, detector, list, objects};
use crate::window::{Action, DetectAction, Outbox};

/// Draws all of it.
pub fn show_inspector(ui: &mut Ui, view: &View, panels: &mut ObjectsPanels, outbox: &mut Outbox) {
    let detect = &view.detect;
    group_heading(ui, "Objects");
    let mut shown = panels.shown;
    let toggle =
        ui.checkbox(&mut shown, "Boxes").on_hover_text("Key B. Nothing is detected while they are hidden.");
    if toggle.changed() {
        outbox.act(Action::Detect(DetectAction::ToggleBoxes));
    }
    if !panels.shown {
        return;
    }
    detector::state(ui, detect, outbox);
    found(ui, view, panels);
    detector::choice(ui, detect, outbox);
    let Some(facts) = detect.facts() else { return };
    group_heading(ui, "Shown objects");
    classes::filter(ui, detect, facts, outbox);
    classes::thresholds(ui, detect, panels, outbox);
    classes::rates(ui, detect, outbox);
}

fn found(ui: &mut Ui, view: &View, panels: &mut ObjectsPanels) {
    let detect = &view.detect;
    let Some(found) = &detect.found else {
        if detect.facts().is_some() && detect.failed.is_none() {
            ui.label(theme::weak(ui, "Looking at the first pair."));
        }
        return;
    };
    if let Some(why) = &detect.stale {
        ui.label(egui::RichText::new(why).color(super::drawing::DOUBT.color(theme::tokens(ui))));
    }
    if objects(view).is_empty() {
        let left_out = match found.left_out {
            0 => "Nothing was found on this pair.".to_owned(),
            count => format!(
                "Nothing is sure enough: {} below the threshold or of a hidden class.",
                if count == 1 { "1 box is".to_owned() } else { format!("{count} boxes are") }
            ),
        };
        ui.label(theme::weak(ui, left_out));
    }
    list::show(ui, view, panels);
    details::show(ui, view, panels);
    timing(ui, detect, &found.timing);
}

/// "Before 2.1 · network 38.0 · after 0.4 · places 3.1 ms, both eyes; 9.8 Hz".
fn timing(ui: &mut Ui, detect: &DetectView, timing: &DetectionTiming) {
    let ms = |duration: std::time::Duration| format!("{:.1}", 1e3 * duration.as_secs_f64());
    let rate =
        detect.statistics.per_second.map_or_else(String::new, |rate| format!("; {}", format::hertz(rate)));
    let line = format!(
        "before {} · network {} · after {} · places {} ms{rate}",
        ms(timing.before),
        ms(timing.network),
        ms(timing.after),
        ms(timing.places),
    );
    ui.label(theme::small(ui, line)).on_hover_text("Time for both eyes together, and pairs per second");
}

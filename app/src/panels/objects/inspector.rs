//! Objects, in the inspector of the Live screen.

use egui::Ui;
use plumbline_engine::View;
use plumbline_engine::view::{DetectView, DetectionTiming};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, group_heading, space};

use super::state::{ObjectsPanels, objects};
use super::{classes, details, detector, list};
use crate::operator::{Action, DetectAction, Outbox};

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
    detector::choice(ui, detect, outbox);
    let Some(facts) = detect.facts() else { return };
    ui.add_space(space::XS);
    found(ui, view, panels);
    group_heading(ui, "Shown objects");
    classes::filter(ui, detect, facts, outbox);
    classes::thresholds(ui, detect, panels, outbox);
    classes::rates(ui, detect, outbox);
    group_heading(ui, "Detector");
    detector::about(ui, detect, facts, outbox);
}

fn found(ui: &mut Ui, view: &View, panels: &mut ObjectsPanels) {
    let detect = &view.detect;
    let Some(found) = &detect.found else {
        if detect.facts().is_some() && detect.failed.is_none() {
            let waits =
                if view.live.raw.is_some() { "Looking at the first pair." } else { "No pictures yet." };
            ui.label(theme::weak(ui, waits));
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
    ui.add_space(space::S);
    ui.label(theme::small(ui, format!("Looked at: {}", found.looked_at.words()))).on_hover_text(
        "Where the table and what stands on it can be, with the head as it stands, at the full scale of the detector; \
         every eighth pair, and whenever something moved beyond it, all that the lenses show",
    );
    timing(ui, detect, &found.timing);
}

/// How long a pair takes and how many there are, and where the time goes.
fn timing(ui: &mut Ui, detect: &DetectView, timing: &DetectionTiming) {
    let ms = |duration: std::time::Duration| format::ms(duration.as_secs_f64());
    let rate =
        detect.statistics.per_second.map_or_else(String::new, |rate| format!(", {}", format::hertz(rate)));
    ui.label(theme::small(ui, format!("{} a pair{rate}", ms(timing.total()))))
        .on_hover_text("Both eyes, from the images to the places; and pairs per second");
    let number = |duration: std::time::Duration| {
        let ms = 1e3 * duration.as_secs_f64();
        if ms < 10.0 { format!("{ms:.1}") } else { format!("{ms:.0}") }
    };
    let parts = format!(
        "before {}, network {}, after {}, places {} ms",
        number(timing.before),
        number(timing.network),
        number(timing.after),
        number(timing.places),
    );
    ui.label(theme::small(ui, parts)).on_hover_text(
        "Scaling and padding; the network; reading its answer; pairing and places. Both eyes, ms; of eyes that are \
         looked at at once, the one that takes longer",
    );
}

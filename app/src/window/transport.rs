//! Playing a recording.

use egui::{Button, Panel, Slider, Ui};
use plumbline_engine::view::{Growth, ReplayView, SourceStatus};
use plumbline_engine::{SourceCommand, View};
use plumbline_widgets::NumberField;
use plumbline_widgets::theme::{self, space};

use crate::operator::{Action, Outbox, shortcut_text};

pub(super) fn show(view: &View, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(replay) = view.source.replay else { return };
    let frame = egui::Frame::side_top_panel(ui.style())
        .inner_margin(egui::Margin::symmetric(space::M as i8, space::XS as i8));
    Panel::bottom("transport").frame(frame).show_separator_line(false).show(ui, |ui| {
        ui.horizontal(|ui| contents(ui, view, replay, outbox));
    });
}

fn contents(ui: &mut Ui, view: &View, replay: ReplayView, outbox: &mut Outbox) {
    let mut button = |ui: &mut Ui, text: &str, action: Action| {
        let hint = shortcut_text(ui.ctx(), action)
            .map_or(action.label(), |keys| format!("{}   {keys}", action.label()));
        if ui.add(Button::new(text)).on_hover_text(hint).clicked() {
            outbox.act(action);
        }
    };
    button(ui, "Back", Action::StepBack);
    button(ui, if replay.playing { "Pause" } else { "Play" }, Action::PlayPause);
    button(ui, "Forward", Action::StepForward);

    let last = replay.length.saturating_sub(1);
    let mut shown = replay.position.unwrap_or(0).min(last) + 1;
    let settings_width = 300.0;
    ui.spacing_mut().slider_width = (ui.available_width() - settings_width - 90.0).max(80.0);
    let slider = ui.add(Slider::new(&mut shown, 1..=replay.length.max(1)).show_value(false));
    slider.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Position in the recording"));
    if slider.changed() {
        outbox.send(SourceCommand::Seek(shown - 1));
    }
    let position = replay.position.map_or(0, |position| position + 1);
    ui.label(format!("{position} of {}", replay.length));
    if view.source.status == SourceStatus::Ended {
        ui.label(theme::weak(ui, "ended"));
    }

    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let mut looping = replay.looping;
        if ui.checkbox(&mut looping, "Loop").changed() {
            outbox.send(SourceCommand::Loop(looping));
        }
        let mut followed = replay.growth == Growth::Followed;
        let is_written = replay.growth != Growth::Ended;
        let hint = "It is still being written: stay at its end, and see what comes.";
        if is_written && ui.checkbox(&mut followed, "Follow").on_hover_text(hint).changed() {
            outbox.send(SourceCommand::Follow(followed));
        }
        let mut rate = replay.pairs_per_second.unwrap_or(30.0);
        let field = NumberField {
            name: "Pairs per second",
            range: 0.2..=120.0,
            suffix: " pairs/s",
            speed: 0.2,
            decimals: 1,
        };
        if field.show(ui, &mut rate).on_hover_text("Speed: drag, or click to type").changed() {
            outbox.send(SourceCommand::PairsPerSecond(rate));
        }
    });
}

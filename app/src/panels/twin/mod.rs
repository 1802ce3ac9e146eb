//! The twin: what stands on its table, the board, the clock of its eyes, its faults. Nothing of
//! what its scenario hides is here, but the switch of truth mode is.

mod board;
pub mod state;
mod table;

use egui::{ComboBox, ScrollArea, Ui};
use plumbline_engine::view::{Connection, TwinView};
use plumbline_engine::{RobotCommand, TwinCommand};
use plumbline_model::duration;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::parts::action_button;
use super::{PanelContext, padded};
use crate::operator::{Action, RobotAction, default_scenario};

/// How many times as fast as everything else the clock of the eyes can run.
const PACES: [f64; 3] = [1.0, 10.0, 20.0];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let twin = &view.twin;
    if !twin.running {
        return without_twin(ui, cx);
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.label(theme::weak(ui, "A simulated robot: nothing real moves."));
            table::show(ui, cx);
            board::show(ui, cx);
            clock(ui, cx, twin);
            truth(ui, cx);
            scenario(ui, cx, twin);
            faults(ui, cx, twin);
        });
    });
}

fn without_twin(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let connecting = match &view.robot.connection {
        Connection::Connecting { to, doing } if to.contains("twin") => {
            Some(format!("Starting {to}: {doing}"))
        }
        _ => None,
    };
    if let Some(text) = connecting {
        EmptyState::loading(&text).show(ui);
        return;
    }
    let action = Action::Robot(RobotAction::ConnectTwin);
    let clicked = match &view.twin.failed {
        Some(why) => {
            EmptyState::failed(Message::new("The twin does not run", why).button("Start the twin")).show(ui)
        }
        None => {
            let message = Message::new(
                "The twin does not run",
                "It is a simulated robot with eyes, table and toys: everything can be tried on it.",
            );
            EmptyState::empty(message.button("Start the twin")).show(ui)
        }
    };
    if clicked {
        cx.outbox.act(action);
    }
}

/// The eyes turn in their mounts while they warm up.
fn clock(ui: &mut Ui, cx: &mut PanelContext<'_>, twin: &TwinView) {
    group_heading(ui, "Warm-up");
    let on = duration::seconds(twin.eyes_on_s).unwrap_or_default();
    ui.label(format!("Eyes on for {}", format::clock(on))).on_hover_text(
        "Eyes turn in their mounts while they warm up: a calibration made cold does not hold warm",
    );
    ui.horizontal_wrapped(|ui| {
        for (text, minutes) in [("+5 min", 5.0), ("+10 min", 10.0)] {
            if ui.button(text).clicked() {
                cx.outbox.send(TwinCommand::AdvanceWarmUp { minutes });
            }
        }
        for times in PACES {
            let is_chosen = (twin.warm_up_pace - times).abs() < 0.5;
            let chip = ui.selectable_label(is_chosen, format!("×{times}"));
            if chip
                .on_hover_text("How many times as fast their clock runs: at ×20 twenty minutes take one")
                .clicked()
            {
                cx.outbox.send(TwinCommand::WarmUpPace { times });
            }
        }
        if ui.button("Cool").on_hover_text("Switches the eyes off and on: they are cold again").clicked() {
            cx.outbox.send(TwinCommand::CoolEyes);
        }
    });
}

/// For who wants to know how good it really is; marked on every screen while it is on.
fn truth(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    group_heading(ui, "Truth mode");
    let label = if cx.view.truth.is_on { "Hide the truth" } else { "Show the truth" };
    action_button(ui, cx, Action::ToggleTruth, label).on_hover_text(
        "Shows measured − true on every screen. Nothing that calibrates, searches, touches or grasps sees it.",
    );
}

fn scenario(ui: &mut Ui, cx: &mut PanelContext<'_>, twin: &TwinView) {
    let heading = group_heading(ui, "Scenario");
    ui.horizontal_wrapped(|ui| {
        let chosen = default_scenario(cx.view);
        let combo = ComboBox::from_id_salt("scenario").selected_text(&chosen).show_ui(ui, |ui| {
            for (name, about) in &twin.scenarios {
                let entry = ui.selectable_label(*name == chosen, name).on_hover_text(about);
                if entry.clicked() && *name != chosen {
                    cx.outbox.send(RobotCommand::ConnectTwin { scenario: name.clone() });
                }
            }
        });
        combo.response.labelled_by(heading.id);
        if ui.button("Put all back").on_hover_text("Table and robot as at the start").clicked() {
            cx.outbox.act(Action::Robot(RobotAction::ResetTwin));
        }
    });
    if let Some((_, about)) = twin.scenarios.iter().find(|(name, _)| *name == twin.scenario) {
        ui.label(theme::small(ui, about));
    }
    let pace = format!("Runs at {} of real time", format::percent(twin.real_time_factor));
    let slow = twin.real_time_factor < 0.9;
    let text = theme::small(ui, pace);
    let color = Role::Warning.color(theme::tokens(ui));
    ui.label(if slow { text.color(color) } else { text });
}

fn faults(ui: &mut Ui, cx: &mut PanelContext<'_>, twin: &TwinView) {
    if twin.faults.is_empty() {
        return;
    }
    ui.add_space(space::S);
    let on = twin.faults.iter().filter(|fault| fault.on).count();
    let title = if on == 0 {
        "Faults of the servo bus".to_owned()
    } else {
        format!("Faults of the servo bus ({on} on)")
    };
    egui::CollapsingHeader::new(title).id_salt("faults").show(ui, |ui| {
        for fault in &twin.faults {
            let mut on = fault.on;
            if ui.checkbox(&mut on, &fault.about).changed() {
                cx.outbox.send(TwinCommand::Fault { name: fault.name.clone(), on });
            }
        }
    });
}

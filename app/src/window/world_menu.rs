//! What the program looks at and moves: the twin, or a real robot with its cameras, or recorded
//! images.

use std::collections::VecDeque;

use egui::{Button, Popup, Ui};
use plumbline_engine::view::{Connection, SourceStatus};
use plumbline_engine::{SourceSpec, View};
use plumbline_widgets::theme;

use super::source_menu;
use crate::operator::words::source_name;
use crate::operator::{Action, Outbox, RobotAction, shortcut_text};

pub(super) fn show(view: &View, recent: &VecDeque<SourceSpec>, ui: &mut Ui, outbox: &mut Outbox) {
    let response = ui.button(format!("World: {}", name(view)));
    let hover = [view.source.description.as_str(), &robot_text(view)].join("\n");
    let response = response.on_hover_text(hover.trim());
    Popup::menu(&response).show(|ui| {
        ui.set_min_width(280.0);
        ui.label(theme::small(ui, "Robot"));
        ui.label(robot_text(view));
        for action in [RobotAction::Connect, RobotAction::ConnectTwin, RobotAction::Disconnect] {
            entry(ui, view, Action::Robot(action), outbox);
        }
        ui.separator();
        ui.label(theme::small(ui, "Images"));
        entry(ui, view, Action::Robot(RobotAction::TwinEyes), outbox);
        source_menu::entries(view, recent, ui, outbox);
    });
}

fn entry(ui: &mut Ui, view: &View, action: Action, outbox: &mut Outbox) {
    let why = action.refusal(view);
    let keys = shortcut_text(ui.ctx(), action).unwrap_or_default();
    let button = ui.add_enabled(why.is_none(), Button::new(action.label()).shortcut_text(keys));
    if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
        outbox.act(action);
        ui.close();
    }
}

/// The twin, or where the images come from and which robot is connected.
fn name(view: &View) -> String {
    let images = view.source.spec.as_ref().filter(|_| view.source.status != SourceStatus::None);
    let robot = match &view.robot.connection {
        Connection::Connected { to, .. }
        | Connection::Connecting { to, .. }
        | Connection::Lost { to, .. } => {
            Some(source_menu::shortened(&crate::operator::words::capitalized(to)))
        }
        Connection::None => None,
    };
    match (robot, images) {
        (Some(robot), Some(SourceSpec::Twin) | None) => robot,
        (Some(robot), Some(spec)) => {
            format!("{robot}, {}", source_menu::shortened(&source_name(spec)))
        }
        (None, Some(spec)) => source_menu::shortened(&source_name(spec)),
        (None, None) => "none".to_owned(),
    }
}

fn robot_text(view: &View) -> String {
    match &view.robot.connection {
        Connection::None => "No robot is connected".to_owned(),
        Connection::Connecting { to, doing } => format!("Connecting to {to}: {doing}"),
        Connection::Connected { to, .. } => format!("Connected to {to}"),
        Connection::Lost { to, reason } => format!("{to} is lost: {reason}"),
    }
}

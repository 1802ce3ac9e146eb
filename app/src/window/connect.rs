//! The sheet that connects the robot: to the twin or to a serial port. Connecting moves nothing.

use egui::{ComboBox, RichText, ScrollArea, Ui};
use plumbline_engine::view::{Connection, PortView, RobotView};
use plumbline_engine::{RobotCommand, View};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::sheet::{Asked, buttons, done_button, title};
use crate::operator::default_scenario;

/// What has been chosen so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConnectChoice {
    to_port: bool,
    scenario: Option<String>,
    port: Option<String>,
}

pub(super) fn show(ui: &mut Ui, view: &View, chosen: &mut ConnectChoice) -> Asked {
    title(ui, "Connect the robot", "Nothing moves, and torque stays as it is.");
    choice(ui, "Connect to", &mut chosen.to_port, &[(false, "Twin"), (true, "Serial port")]);
    ui.add_space(space::S);
    let command = if chosen.to_port { port(ui, view, chosen) } else { Some(twin(ui, view, chosen)) };
    if chosen.to_port && ui.button("Look again").clicked() {
        return Asked::CommandKeepOpen(RobotCommand::ListPorts.into());
    }
    present(ui, &view.robot);
    if is_connected_to(view, chosen) {
        return if done_button(ui) { Asked::Closed } else { offer_disconnect(ui, &view.robot) };
    }
    let (verb, asked) = match (&view.robot.connection, command) {
        (Connection::Connecting { .. }, _) => ("Connecting", None),
        (_, command) if chosen.to_port => ("Connect", command),
        (_, command) => ("Connect the twin", command),
    };
    match buttons(ui, verb, asked.is_some()) {
        Some(false) => Asked::Closed,
        Some(true) => asked.map_or(Asked::Open, |command| Asked::CommandKeepOpen(command.into())),
        None => offer_disconnect(ui, &view.robot),
    }
}

/// Whether what is chosen is what the program is connected to: then there is nothing left to do here.
fn is_connected_to(view: &View, chosen: &ConnectChoice) -> bool {
    let Connection::Connected { to, twin } = &view.robot.connection else { return false };
    match (chosen.to_port, twin) {
        (false, true) => chosen.scenario.as_ref().is_none_or(|scenario| *scenario == view.twin.scenario),
        (true, false) => chosen.port.as_ref().is_none_or(|port| port == to),
        _ => false,
    }
}

fn twin(ui: &mut Ui, view: &View, chosen: &mut ConnectChoice) -> RobotCommand {
    let scenario = chosen.scenario.clone().unwrap_or_else(|| default_scenario(view));
    let scenarios = &view.twin.scenarios;
    ui.horizontal(|ui| {
        let label = ui.label("Scenario");
        let combo = ComboBox::from_id_salt("scenario of the twin").width(200.0).selected_text(&scenario);
        let combo = combo.show_ui(ui, |ui| {
            for (name, about) in scenarios {
                if ui.selectable_label(*name == scenario, name).on_hover_text(about).clicked() {
                    chosen.scenario = Some(name.clone());
                }
            }
        });
        combo.response.labelled_by(label.id);
    });
    let about = scenarios.iter().find(|(name, _)| *name == scenario).map(|(_, about)| about.as_str());
    let about = about.unwrap_or("A simulated robot with eyes, table and toys. Nothing real can be hurt.");
    ui.label(theme::weak(ui, about));
    RobotCommand::ConnectTwin { scenario }
}

fn port(ui: &mut Ui, view: &View, chosen: &mut ConnectChoice) -> Option<RobotCommand> {
    match &view.robot.ports {
        None => {
            ui.label(theme::weak(ui, "Looking for serial ports."));
        }
        Some(ports) if ports.is_empty() => {
            ui.label("No serial port is found.");
            ui.label(theme::weak(
                ui,
                "Plug the robot's USB adapter in, then look again. If it is plugged in: ./plumbline doctor says what is missing.",
            ));
        }
        Some(ports) => {
            // One port needs no choosing.
            if chosen.port.is_none() && ports.len() == 1 {
                chosen.port = Some(ports[0].path.clone());
            }
            for port in ports.iter() {
                port_row(ui, port, chosen);
            }
        }
    }
    ui.add_space(space::XS);
    chosen.port.clone().map(|path| RobotCommand::ConnectPort { path: path.into() })
}

fn port_row(ui: &mut Ui, port: &PortView, chosen: &mut ConnectChoice) {
    let is_chosen = chosen.port.as_deref() == Some(port.path.as_str());
    ui.horizontal(|ui| {
        if ui.radio(is_chosen, &port.path).clicked() {
            chosen.port = Some(port.path.clone());
        }
        ui.label(theme::weak(ui, &port.what));
    });
}

/// How the connection is: what answers, what is missing, what nobody expected.
fn present(ui: &mut Ui, robot: &RobotView) {
    ui.add_space(space::S);
    match &robot.connection {
        Connection::None => {}
        Connection::Connecting { to, doing } => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(format!("Connecting to {to}: {doing}"));
            });
        }
        Connection::Lost { to, reason } => warn(ui, &format!("{to}: {reason}")),
        Connection::Connected { to, .. } => {
            ui.label(theme::strong(ui, format!("Connected to {to}")));
            found(ui, robot);
        }
    }
}

fn found(ui: &mut Ui, robot: &RobotView) {
    let bus = &robot.bus;
    let is_heard = |id: &u8| !bus.missing.contains(id) && !bus.late.contains(id);
    let answering = robot.joints.iter().filter(|joint| is_heard(&joint.servo)).count();
    let of = robot.joints.len();
    ui.label(if answering == of && bus.missing.is_empty() {
        format!("All {} answer.", format::count(of, "servo"))
    } else {
        format!("{answering} of {} answer in time.", format::count(of, "servo"))
    });
    ScrollArea::vertical().id_salt("servos").max_height(150.0).auto_shrink([false, true]).show(ui, |ui| {
        for id in &bus.missing {
            let name = robot.joints.iter().find(|joint| joint.servo == *id).map_or("unknown", |j| &j.title);
            warn(ui, &format!("Servo {id} ({name}) does not answer: look at its cable and its supply."));
        }
        if let Some(late) = bus.late_answers() {
            warn(ui, &late);
        }
        for (id, model) in &bus.unexpected {
            warn(
                ui,
                &format!("Servo {id} ({model}) is not in the description of this robot; it is left alone."),
            );
        }
        for warning in &bus.warnings {
            warn(ui, warning);
        }
    });
}

fn offer_disconnect(ui: &mut Ui, robot: &RobotView) -> Asked {
    let connected = robot.connection.is_connected();
    if connected && ui.button("Disconnect").on_hover_text("The arm holds where it is").clicked() {
        return Asked::CommandKeepOpen(RobotCommand::Disconnect.into());
    }
    Asked::Open
}

fn warn(ui: &mut Ui, text: &str) {
    let text = crate::operator::words::capitalized(text);
    ui.label(RichText::new(text).color(Role::Warning.color(theme::tokens(ui))));
}

//! The robot in the top line: the bus, the hottest servo, what STOP says, and releasing it.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{Connection, MotionState, RobotView};
use plumbline_widgets::buttons::ArmState;
use plumbline_widgets::format;
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::lamp::Health;
use plumbline_widgets::theme::{self, Role, space};

use super::PlumblineWindow;
use super::lamps::{Then, TopLamp};
use crate::operator::words::robot as words;
use crate::operator::{Action, Outbox, RobotAction, Screen};

/// Fewer complete cycles per second than this make motion rough.
const SLOW_BUS_HZ: f64 = 50.0;

/// What the STOP button says.
pub(super) fn arm_state(view: &View) -> ArmState {
    match of_robot(&view.robot) {
        ArmState::Moving if view.mount.tour.is_some_and(|tour| !tour.waits) => ArmState::HeadMoving,
        state => state,
    }
}

fn of_robot(robot: &RobotView) -> ArmState {
    match robot.connection {
        Connection::None | Connection::Connecting { .. } => return ArmState::NotConnected,
        // It is still there, and holds, or does not.
        Connection::Lost { .. } => return ArmState::Unknown,
        Connection::Connected { .. } => {}
    }
    match robot.motion {
        // Until it is known to stand, it is said to move.
        MotionState::Moving { .. } if !robot.rests_on_the_way => ArmState::Moving,
        MotionState::Limp => ArmState::Free,
        MotionState::Unknown => ArmState::Unknown,
        _ if !robot.unknown.is_empty() => ArmState::PartlyKnown,
        _ if robot.stopped => ArmState::Stopped,
        _ if robot.joints.iter().any(|joint| joint.torque_on == Some(false)) => ArmState::PartlyFree,
        MotionState::Moving { .. } | MotionState::Holding { .. } => ArmState::Held,
    }
}

/// Whether STOP was pressed, so that *Release STOP* stands beside it.
pub(super) fn can_be_released(robot: &RobotView) -> bool {
    robot.stopped && robot.connection != Connection::None
}

/// Beside STOP while it is latched; where it is tight, STOP's own words say that it is. Space never reaches it: it stops.
pub(super) fn release_button(tight: bool, view: &View, ui: &mut Ui, outbox: &mut Outbox) {
    if !can_be_released(&view.robot) {
        return;
    }
    let color = Role::Warning.color(theme::tokens(ui));
    let text = RichText::new(RobotAction::ReleaseStop.label()).color(color);
    if ui.button(text).on_hover_text("Moves may be asked for again; nothing moves by this").clicked() {
        outbox.act(Action::Robot(RobotAction::ReleaseStop));
    }
    if !tight {
        ui.label(RichText::new("Stopped.").color(color));
    }
    ui.add_space(space::S);
}

/// Nothing where no robot is: the button that connects one is in the menu beside.
pub(super) fn lamps(view: &View) -> Vec<TopLamp> {
    bus(&view.robot).into_iter().chain(servos(&view.robot)).collect()
}

fn bus(robot: &RobotView) -> Option<TopLamp> {
    let (value, health, reason) = match &robot.connection {
        Connection::None => return None,
        Connection::Connecting { doing, .. } => {
            ("connecting".to_owned(), Health::Working(0.5), Some(doing.clone()))
        }
        Connection::Lost { reason, .. } => ("lost".to_owned(), Health::Failed, Some(reason.clone())),
        Connection::Connected { .. } => connected(robot),
    };
    Some(TopLamp { name: "Bus", value, health, reason, then: Then::Open(320.0, details) })
}

fn connected(robot: &RobotView) -> (String, Health, Option<String>) {
    let bus = &robot.bus;
    if matches!(robot.motion, MotionState::Unknown)
        && let Some(warning) = bus.warnings.first()
    {
        // All answer, but too late: that is load, too.
        let is_late = bus.missing.is_empty() && !bus.late.is_empty();
        let word = if is_late { "late" } else { "silent" };
        return (word.to_owned(), Health::Failed, Some(warning.clone()));
    }
    let Some(rate) = bus.cycles_per_s else { return ("starting".to_owned(), Health::Working(0.5), None) };
    let value = format::hertz(rate);
    if let Some(silent) = words::silent(robot) {
        return (value, Health::Warning, Some(silent));
    }
    // Load, not a cable: nobody is sent to look at one.
    if let Some(late) = bus.late_answers() {
        return (value, Health::Warning, Some(late));
    }
    if let Some(warning) = bus.warnings.first() {
        return (value, Health::Warning, Some(warning.clone()));
    }
    if rate < SLOW_BUS_HZ {
        return (value, Health::Warning, Some("Below 50 cycles per second motion gets rough.".to_owned()));
    }
    (value, Health::Good, None)
}

fn details(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let view = &window.view;
    let bus = &view.robot.bus;
    let rate = bus.cycles_per_s.map_or(format::NONE.to_owned(), format::hertz);
    let mut rows = vec![
        KeyValue::text("Complete cycles", rate),
        KeyValue::text("Asked again", bus.retries.to_string()).help("Within the cycle's deadline"),
    ];
    rows.extend(
        bus.faults.iter().map(|(kind, count)| {
            KeyValue::text(crate::operator::words::capitalized(kind), count.to_string())
        }),
    );
    key_value_grid(ui, "bus", &rows);
    for warning in &bus.warnings {
        ui.label(RichText::new(warning).color(Role::Warning.color(theme::tokens(ui))));
    }
    for action in
        [RobotAction::Scan, RobotAction::ShortenAnswers, RobotAction::Connect, RobotAction::Disconnect]
    {
        if action.refusal(view).is_none() && ui.button(action.label()).clicked() {
            outbox.act(Action::Robot(action));
            ui.close();
        }
    }
}

/// The hottest servo, because it is the one that ends the work.
fn servos(robot: &RobotView) -> Option<TopLamp> {
    if !robot.connection.is_connected() {
        return None;
    }
    let warm = robot.joints.iter().filter_map(|joint| Some((joint.temperature_c?, joint)));
    let (hottest_c, joint) = warm.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let gate = robot.rig.as_ref().map(|rig| rig.gate);
    let (health, reason) = match gate {
        Some(gate) if hottest_c >= gate.hot_c => {
            (Health::Danger, Some(format!("{} is too hot to move: let it cool.", joint.title)))
        }
        Some(gate) if hottest_c >= gate.warm_c => {
            (Health::Warning, Some(format!("{} gets hot: give it a rest soon.", joint.title)))
        }
        _ if words::silent_together(robot).is_some() => (Health::Warning, words::silent_together(robot)),
        _ => match robot.joints.iter().find_map(|joint| Some((joint, joint.problem.as_ref()?))) {
            Some((joint, problem)) => (Health::Warning, Some(format!("{}: {problem}", joint.title))),
            None => (Health::Good, None),
        },
    };
    let value = format!("{} °C", format::fixed(hottest_c, 0));
    Some(TopLamp { name: "Servos", value, health, reason, then: Then::Go(Screen::Robot) })
}

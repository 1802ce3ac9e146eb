//! The chosen joint, the shown move, and torque, for the inspector.

use egui::{Button, Ui};
use plumbline_engine::view::{JointView, RobotView};
use plumbline_engine::{RobotCommand, View};
use plumbline_model::robot::JointIndex;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::state::RobotPanels;
use crate::operator::words::robot::{seconds, tip_title, whole_degrees};
use crate::operator::{Action, Outbox, RobotAction};
use crate::panels::parts::warning;

/// Shares of the usual speed that can be chosen.
const SPEEDS: [(u32, &str); 4] = [(25, "25 %"), (50, "50 %"), (100, "100 %"), (150, "150 %")];

pub fn show(ui: &mut Ui, view: &View, panels: &mut RobotPanels, outbox: &mut Outbox) {
    shown_move(ui, view, outbox);
    let robot = &view.robot;
    let chosen = panels.chosen_joint.and_then(|index| robot.joints.iter().find(|joint| joint.joint == index));
    match chosen {
        Some(joint) => chosen_joint(ui, view, joint, &mut panels.letting_go, outbox),
        None if robot.joints.is_empty() => {}
        None => {
            group_heading(ui, "Joint");
            ui.label(theme::weak(ui, "Click a joint in the list or a part in the scene."));
        }
    }
    if robot.connection.is_connected() {
        tip(ui, robot);
        speed(ui, robot, outbox);
        torque(ui, view, outbox);
    }
}

fn tip(ui: &mut Ui, robot: &RobotView) {
    let Some(place) = &robot.tip_place else { return };
    group_heading(ui, &tip_title(robot));
    let at = place.point.coords;
    let rows = [
        KeyValue::quantity("x", Quantity::Length, at.x),
        KeyValue::quantity("y", Quantity::Length, at.y),
        KeyValue::quantity("z", Quantity::Length, at.z),
        KeyValue::quantity("Turn", Quantity::Angle, place.yaw_rad),
    ];
    key_value_grid(ui, "tip", &rows);
}

fn speed(ui: &mut Ui, robot: &RobotView, outbox: &mut Outbox) {
    group_heading(ui, "Speed of moves");
    let before = (robot.speed * 100.0).round() as u32;
    let mut percent = before;
    choice(ui, "Speed of moves", &mut percent, &SPEEDS);
    if percent != before {
        outbox.send(RobotCommand::Speed(f64::from(percent) / 100.0));
    }
}

fn shown_move(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    group_heading(ui, "Shown move");
    let Some(preview) = &view.robot.preview else {
        ui.label(theme::weak(
            ui,
            "Drag a joint, choose a pose or click a point: it is shown as a ghost first.",
        ));
        return;
    };
    ui.label(crate::operator::words::capitalized(&preview.title));
    let mut rows = vec![KeyValue::text("Takes", seconds(preview.duration.as_secs_f64()))];
    if let Some((joint, by_rad)) = &preview.largest_turn {
        rows.push(KeyValue::text("Largest turn", whole_degrees(*by_rad)).help(joint.clone()));
    }
    rows.push(KeyValue::text("Robot", &*preview.model).help("The model that the move was found with"));
    if let Some(sigma_m) = preview.tip_sigma_m.filter(|sigma_m| *sigma_m > 0.0) {
        let help = "With 95 %, along the worst direction, by what is not known of the effects";
        rows.push(
            KeyValue::quantity("Tip to within", Quantity::Length, format::NORMAL_95 * sigma_m).help(help),
        );
    }
    match &preview.path {
        Ok(check) => {
            let near = KeyValue::quantity("Keeps apart", Quantity::Length, check.smallest_m);
            rows.push(near.help(format!("Smallest distance on the way, between {}", check.between)));
            key_value_grid(ui, "preview", &rows);
            ui.label(theme::small(ui, format!("nearest: {}", check.between)));
        }
        Err(why) => {
            key_value_grid(ui, "preview", &rows);
            warning(ui, &why.to_string());
        }
    }
    ui.add_space(space::XS);
    if ui.button(RobotAction::ForgetMove.label()).clicked() {
        outbox.act(Action::Robot(RobotAction::ForgetMove));
    }
}

fn chosen_joint(
    ui: &mut Ui,
    view: &View,
    joint: &JointView,
    letting_go: &mut Option<JointIndex>,
    outbox: &mut Outbox,
) {
    let robot = &view.robot;
    group_heading(ui, &joint.title);
    let angle = joint.angle_rad.map_or_else(|| format::NONE.to_owned(), |a| Quantity::Angle.text(a));
    big_figure(ui, "by the encoder", &angle, Role::Ink);
    ui.add_space(space::S);
    key_value_grid(ui, "joint", &joint_rows(joint));
    if let Some(problem) = &joint.problem {
        warning(ui, problem);
    }
    ui.add_space(space::S);
    let limp = joint.torque_on == Some(false);
    let text = if limp { "Hold this joint" } else { "Let this joint go limp…" };
    let why = if !robot.connection.is_connected() {
        Some("No robot is connected")
    } else if joint.torque_on.is_none() {
        Some("Its servo was not heard yet: it is not known whether it holds")
    } else {
        (limp && robot.stopped).then_some("STOP is latched: release it first")
    };
    let hover = if limp { "It holds where it is" } else { "It sinks by its own weight: hold it by hand" };
    let button = ui.add_enabled(why.is_none(), Button::new(text)).on_hover_text(hover);
    let asked = button.on_disabled_hover_text(why.unwrap_or_default()).clicked();
    if asked && limp {
        outbox.send(RobotCommand::Torque { joints: vec![joint.joint], on: true });
    } else if asked {
        *letting_go = Some(joint.joint);
    }
    letting_go.take_if(|asked| *asked != joint.joint || limp || why.is_some());
    if letting_go.is_some() {
        go_limp(ui, view, joint, letting_go, outbox);
    }
}

/// Asks first, below the button: who presses that twice has let nothing go.
fn go_limp(
    ui: &mut Ui,
    view: &View,
    joint: &JointView,
    letting_go: &mut Option<JointIndex>,
    outbox: &mut Outbox,
) {
    let arm_of = |name: &str| view.robot.rig.as_ref()?.arm(name);
    let held = view.grasp.held.as_ref().filter(|held| {
        arm_of(held.hand.name())
            .is_some_and(|arm| arm.hand.contains(&joint.joint) || arm.joints.contains(&joint.joint))
    });
    let lost = held.map_or_else(String::new, |held| {
        format!(" The {} may fall out of the {} hand.", held.object.to_lowercase(), held.hand.name())
    });
    let said = format!("It sinks by its own weight, with all that hangs on it: hold it by hand.{lost}");
    warning(ui, &said);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Let it go limp").clicked() {
            outbox.send(RobotCommand::Torque { joints: vec![joint.joint], on: false });
            *letting_go = None;
        }
        if ui.button("Cancel").clicked() {
            *letting_go = None;
        }
    });
}

fn joint_rows(joint: &JointView) -> Vec<KeyValue> {
    let limits = joint.limits_now;
    let [low, high] = [limits.lower_rad, limits.upper_rad].map(|a| format::fixed(a.to_degrees(), 1));
    let narrowed = joint.limits_now != joint.limits;
    let limit_help = if narrowed {
        "Narrower than usual at the angles of other joints"
    } else {
        "By description and servo"
    };
    let age = joint.age.map_or_else(|| format::NONE.to_owned(), format::age);
    vec![
        KeyValue::optional("Goal", Quantity::Angle, joint.goal_rad),
        KeyValue::text("Limits", format!("{low} to {high}")).unit("°").help(limit_help),
        KeyValue::optional("Load", Quantity::Ratio, joint.load)
            .help("Of the torque at which the servo stalls"),
        KeyValue::optional("Temperature", Quantity::Temperature, joint.temperature_c),
        KeyValue::text("Supply", joint.voltage_v.map_or(format::NONE.to_owned(), |v| format::fixed(v, 1)))
            .unit("V"),
        KeyValue::text(
            "Torque",
            match joint.torque_on {
                Some(true) => "holds",
                Some(false) => "limp",
                None => format::NONE,
            },
        ),
        KeyValue::text("Read", age),
        KeyValue::text("Servo", format!("{}, {}", joint.servo, joint.model)),
    ]
}

fn torque(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    group_heading(ui, "All joints");
    ui.horizontal_wrapped(|ui| {
        for action in [RobotAction::TorqueOn, RobotAction::TorqueOff] {
            let why = action.refusal(view);
            let button = ui.add_enabled(why.is_none(), Button::new(action.label()));
            if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
                outbox.act(Action::Robot(action));
            }
        }
    });
}

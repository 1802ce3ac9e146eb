//! The joints in their groups: where they are, where they should be, how warm and how loaded.
//! Proposing an angle shows a move; the bottom line runs it.

mod compact;
mod proposing;

use egui::{RichText, ScrollArea, Ui};
use plumbline_engine::RobotCommand;
use plumbline_engine::view::{JointView, MotionState, RobotView};
use plumbline_model::robot::JointIndex;
use plumbline_widgets::format;
use plumbline_widgets::joint_row::{
    Freshness, JointHistory, JointRow, JointState, ReducedRange, joint_header,
};
use plumbline_widgets::theme::{self, Role, space};

use self::proposing::{OTHER_MOVES_RAD, preview_angle, propose};
use super::parts::{OLD, refusal_line, stale_line};
use super::state::Asked;
use crate::operator::words::robot as words;
use crate::panels::{PanelContext, padded};

/// Below this width the rows leave out what the inspector says too.
const NARROW: f32 = 560.0;
/// History shown in an open row, s.
const HISTORY_S: f64 = 120.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if super::parts::without_joints(
        ui,
        cx,
        Some("One line per joint stands here: where it is, where it would go, load and temperature."),
    ) {
        return;
    }
    let view = cx.view;
    let Some(rig) = &view.robot.rig else { return };
    padded(ui, |ui| {
        stale_line(ui, &view.robot);
        refusal_line(ui, cx, Asked::Joints);
        problems_line(ui, &view.robot);
        let narrow = ui.available_width() < NARROW;
        if !narrow {
            // As wide as the rows, which leave room for the scroll bar.
            joint_header(ui);
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (title, joints) in words::groups(rig) {
                group(ui, cx, &title, &joints, narrow);
            }
        });
    });
}

fn group(ui: &mut Ui, cx: &mut PanelContext<'_>, title: &str, joints: &[JointIndex], narrow: bool) {
    let view = cx.view;
    let found = |index: &JointIndex| view.robot.joints.iter().find(|joint| joint.joint == *index);
    let shown: Vec<&JointView> = joints.iter().filter_map(found).collect();
    if shown.is_empty() {
        return;
    }
    theme::group_heading(ui, title);
    ui.spacing_mut().item_spacing.y = 0.0;
    for joint in shown {
        if narrow {
            compact::row(ui, cx, joint);
        } else {
            row(ui, cx, joint);
        }
    }
    ui.add_space(space::XS);
}

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, joint: &JointView) {
    let robot = &cx.view.robot;
    let chosen = cx.state.robot.chosen_joint == Some(joint.joint);
    let limits = joint.limits;
    let narrowed = (joint.limits_now != limits).then(|| ReducedRange {
        range_rad: [joint.limits_now.lower_rad, joint.limits_now.upper_rad],
        reason: coupled_reason(robot, joint.joint),
    });
    let servo = format!("servo {}", joint.servo);
    // Only the open row needs its minutes.
    let history = if chosen { history(joint) } else { JointHistory::new(HISTORY_S) };
    let shown =
        JointRow::new(&joint.title, &joint.name, [limits.lower_rad, limits.upper_rad], state(robot, joint))
            .reduced(narrowed)
            .freshness(freshness(robot, joint, &servo))
            .history(&history)
            .expanded(chosen)
            .show(ui);
    if shown.expand_toggled {
        cx.state.robot.chosen_joint = (!chosen).then_some(joint.joint);
    }
    if let Some(angle_rad) = shown.proposed_rad {
        propose(cx, joint, angle_rad);
    }
    match shown.torque.filter(|_| robot.connection.is_connected()) {
        Some(true) => cx.outbox.send(RobotCommand::Torque { joints: vec![joint.joint], on: true }),
        // The inspector asks first.
        Some(false) => {
            (cx.state.robot.chosen_joint, cx.state.robot.letting_go) = (Some(joint.joint), Some(joint.joint));
        }
        None => {}
    }
}

/// Always one line, so that rows do not move away from under the pointer: the first problem, or
/// that there is none.
fn problems_line(ui: &mut Ui, robot: &RobotView) {
    let mut with = robot.joints.iter().filter_map(|joint| Some((joint, joint.problem.as_ref()?)));
    if let Some(silent) = words::silent_together(robot) {
        let text = RichText::new(&silent).small().color(Role::Warning.color(theme::tokens(ui)));
        ui.add(egui::Label::new(text).truncate()).on_hover_text(silent);
        return;
    }
    let Some((joint, problem)) = with.next() else {
        let all = format::count(robot.joints.len(), "joint");
        let free = robot.joints.iter().filter(|joint| joint.torque_on == Some(false)).count();
        let how = match (robot.connection.is_connected(), &robot.motion) {
            (true, MotionState::Limp) => "limp",
            (true, _) if free > 0 => {
                let text = format!("{} limp", format::count(free, "joint"));
                let text = RichText::new(text).small().color(Role::Warning.color(theme::tokens(ui)));
                ui.label(text);
                return;
            }
            (true, _) => "without a problem",
            (false, _) => "as last seen",
        };
        let Some(missing) = words::silent(robot) else {
            ui.label(theme::small(ui, format!("{all} {how}")));
            return;
        };
        let text = format!("{missing} Every joint that answers is {how}.");
        let text = RichText::new(text).small().color(Role::Warning.color(theme::tokens(ui)));
        ui.add(egui::Label::new(text).truncate());
        return;
    };
    let more = match with.count() {
        0 => String::new(),
        n => format!(" And {n} more."),
    };
    let text = format!("{}: {problem}.{more}", joint.title);
    let text = RichText::new(text).small().color(Role::Warning.color(theme::tokens(ui)));
    ui.add(egui::Label::new(text).truncate());
}

fn state(robot: &RobotView, joint: &JointView) -> JointState {
    let proposed = preview_angle(robot, joint)
        .filter(|there| joint.angle_rad.is_none_or(|here| (there - here).abs() > OTHER_MOVES_RAD));
    JointState {
        present_rad: joint.angle_rad,
        goal_rad: joint.goal_rad,
        proposed_rad: proposed,
        load: joint.load,
        temperature_c: joint.temperature_c,
        // What is not taken hold of, or has no force, is offered to be switched on.
        torque_on: joint.torque_on.map(|on| on && !joint.let_go && !joint.no_force),
    }
}

fn freshness<'a>(robot: &RobotView, joint: &JointView, servo: &'a str) -> Freshness<'a> {
    if robot.bus.missing.contains(&joint.servo) {
        return Freshness::NoAnswer { from: servo, since: joint.age };
    }
    match joint.age {
        _ if !robot.connection.is_connected() => Freshness::Stale(joint.age),
        // It answers too late.
        _ if robot.bus.late.contains(&joint.servo) => Freshness::Stale(joint.age),
        Some(age) if age > OLD => Freshness::Stale(Some(age)),
        _ => Freshness::Live,
    }
}

fn coupled_reason(robot: &RobotView, joint: JointIndex) -> &str {
    let rig = robot.rig.as_ref();
    let coupled = rig.and_then(|rig| rig.coupled_limits.iter().find(|limit| limit.joint == joint));
    coupled.map_or("another joint is in the way", |limit| &limit.why)
}

fn history(joint: &JointView) -> JointHistory {
    let mut history = JointHistory::new(HISTORY_S);
    for sample in joint.history.iter() {
        history.load.push(sample.at_s, sample.load);
        history.temperature_c.push(sample.at_s, sample.temperature_c);
    }
    history
}

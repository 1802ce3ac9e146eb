//! The robot in three dimensions, with what it would do as a ghost.

use egui::{Align, Layout, Ui, vec2};
use plumbline_engine::Destination;
use plumbline_engine::view::Connection;
use plumbline_widgets::empty::Message;
use plumbline_widgets::format;
use plumbline_widgets::scene3d::{Line, Scene3d, Tint};
use plumbline_widgets::theme::{self, space};

use super::bodies::{Thing, is_part_of_robot, scene, thing};
use super::parts::{cannot_show, refusal_line, stale_sentence};
use super::state::Asked;
use crate::operator::{Action, RobotAction, Screen};
use crate::panels::PanelContext;

/// Below the picture: the chosen point and what can be done with it.
const STRIP: f32 = 36.0;
/// Below this width there is room for one button only.
const NARROW: f32 = 420.0;
/// From this width on there is room for the names of the toys.
const NAMES_FROM: f32 = 520.0;
/// A tip that is sent to a point stops this far above it, m.
const ABOVE_M: f64 = 0.08;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let ghost = crate::panels::touch_ghost(cx).or_else(|| crate::panels::grasp_ghost(cx));
    let mut drawn = scene(cx.view, &cx.state.robot, ghost.as_ref(), ui.available_width() >= NAMES_FROM);
    let palm_way = crate::panels::palm_way(cx);
    if palm_way.len() > 1 {
        drawn.lines.push(Line::new(palm_way, Tint::Ghost).width(2.0));
    }
    crate::panels::mark_things(cx, &mut drawn);
    if drawn.is_empty() && super::parts::without_joints(ui, cx, None) {
        return;
    }
    let robot = &cx.view.robot;
    if robot.refusal.is_some() && cx.state.robot.asked == Asked::Scene {
        crate::panels::padded(ui, |ui| refusal_line(ui, cx, Asked::Scene));
    }
    let stale = stale_sentence(robot);
    let size = vec2(ui.available_width(), (ui.available_height() - STRIP).max(60.0));
    let shown = Scene3d::new("Robot", &drawn)
        .size(size)
        .stale(stale.as_deref())
        .empty(Message::new("Nothing to draw yet", "The scene follows the first reading of the joints."))
        .show(ui, &mut cx.state.robot.camera);
    // A click on a thing chooses what is grasped; one beside it, a part of the robot or a point to look at.
    let taken = crate::panels::point_at_thing(ui, cx, &shown, is_part_of_robot);
    if let Some(picked) = shown.clicked.filter(|_| !taken) {
        if let Some(Thing::Joint(joint)) = picked.pick.map(thing) {
            cx.state.robot.chosen_joint = Some(joint);
        }
        cx.state.robot.chosen_point_m = picked.point_m;
    }
    strip(ui, cx);
}

fn strip(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let size = vec2(ui.available_width(), STRIP);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.add_space(space::S + 4.0);
        let Some(at_m) = cx.state.robot.chosen_point_m else {
            let said = theme::small(ui, hint(cx, ui.available_width() < NARROW));
            ui.add(egui::Label::new(said).truncate());
            return;
        };
        let narrow = ui.available_width() < NARROW;
        let why = cannot_show(&cx.view.robot);
        if point_button(ui, "Look here", "Shows how the head would turn; nothing moves yet", why) {
            cx.preview(Asked::Scene, Destination::LookAt { point_m: at_m.into() });
        }
        if !narrow && point_button(ui, "Tip above", "Shows the tip 80 mm above; nothing moves yet", why) {
            let point_m = [at_m.x, at_m.y, at_m.z + ABOVE_M];
            cx.preview(Asked::Scene, Destination::TipPosition { point_m });
        }
        if ui.button("Forget").on_hover_text("Lets the chosen point and the shown move go").clicked() {
            cx.state.robot.chosen_point_m = None;
            if cx.view.robot.preview.is_some() {
                cx.outbox.act(Action::Robot(RobotAction::ForgetMove));
            }
        }
        if !narrow {
            ui.label(theme::small(ui, format::position_mm(at_m.into())));
        }
    });
}

fn hint(cx: &PanelContext<'_>, narrow: bool) -> &'static str {
    match &cx.view.robot.connection {
        Connection::Connected { .. } if narrow && cx.screen == Screen::Grasp => "Click a thing to grasp it.",
        Connection::Connected { .. } if narrow => "Click a point to look there.",
        Connection::Connected { .. } if cx.screen == Screen::Grasp => {
            "Click a thing to grasp it, or a point to look there. Drag turns, wheel zooms."
        }
        Connection::Connected { .. } => "Click a point to look there. Drag turns, wheel zooms.",
        _ => "Drag turns, wheel zooms.",
    }
}

fn point_button(ui: &mut Ui, text: &str, hover: &str, why_not: Option<&str>) -> bool {
    let button = ui.add_enabled(why_not.is_none(), egui::Button::new(text)).on_hover_text(hover);
    button.on_disabled_hover_text(why_not.unwrap_or_default()).clicked()
}

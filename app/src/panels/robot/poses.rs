//! Poses with a name: those of the rig, and the operator's own.

use egui::{Button, ScrollArea, Ui};
use plumbline_engine::view::PoseView;
use plumbline_engine::{Destination, RobotCommand};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::parts::{cannot_show, refusal_line};
use super::state::Asked;
use crate::operator::{Action, RobotAction};
use crate::panels::{PanelContext, padded};

const ROW: f32 = 30.0;
/// How many joints a pose moves is said where a title of usual length still fits beside it, pt.
const WITH_JOINTS: f32 = 230.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if super::parts::without_joints(ui, cx, Some("Poses to go to, and to keep, stand here.")) {
        return;
    }
    padded(ui, |ui| {
        refusal_line(ui, cx, Asked::Poses);
        let action = Action::Robot(RobotAction::SavePose);
        let why = action.refusal(cx.view);
        let save = ui.add_enabled(why.is_none(), Button::new(action.label()));
        if save.on_hover_text("Keeps where the joints are now under a name").clicked() {
            cx.outbox.act(action);
        }
        ui.add_space(space::XS);
        let poses = cx.view.robot.poses.clone();
        if poses.is_empty() {
            EmptyState::empty(Message::new("No poses yet", "Move the robot somewhere and save the posture."))
                .show(ui);
            return;
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for pose in poses.iter() {
                row(ui, cx, pose);
            }
        });
    });
}

/// Choosing a pose shows it; the bottom line moves there.
fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, pose: &PoseView) {
    let shown = cx.view.robot.preview.as_ref().is_some_and(|p| p.title.contains(&pose.title));
    let why = cannot_show(&cx.view.robot);
    let line = egui::vec2(ui.available_width(), ROW);
    // What stands at the end takes its place first: the title gets what is left.
    ui.allocate_ui_with_layout(line, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        if pose.own {
            delete(ui, cx, pose);
        } else if ui.available_width() > WITH_JOINTS {
            ui.label(theme::small(ui, joints(pose)));
        }
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.add_enabled_ui(why.is_none(), |ui| {
                let hover = format!("{}\n{}; shows it, nothing moves yet.", pose.about, joints(pose));
                let title = Button::selectable(shown, &pose.title).truncate();
                let label = ui.add(title).on_hover_text(hover);
                if label.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
                    cx.preview(Asked::Poses, Destination::Pose { name: pose.name.clone() });
                }
            });
        });
    });
}

/// Asks once more in place: there is no undo for a pose.
fn delete(ui: &mut Ui, cx: &mut PanelContext<'_>, pose: &PoseView) {
    let asked = cx.state.robot.deleting.as_deref() == Some(pose.name.as_str());
    let text = if asked { "Delete for good" } else { "Delete" };
    let button = ui.add(Button::new(theme::small(ui, text)).frame(asked));
    button.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{text}: {}", pose.title))
    });
    if !button.clicked() {
        return;
    }
    cx.state.robot.deleting = (!asked).then(|| pose.name.clone());
    if asked {
        cx.outbox.send(RobotCommand::DeletePose { name: pose.name.clone() });
    }
}

fn joints(pose: &PoseView) -> String {
    format::count(pose.joints.len(), "joint")
}

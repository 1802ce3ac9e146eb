//! The views that were taken, and the head poses that are planned.

use egui::{Align, Button, Layout, ScrollArea, Ui};
use plumbline_engine::MountCommand;
use plumbline_engine::view::{HeadViewSummary, MountView};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::{Action, MountAction};
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

const ROW: f32 = 24.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let mount = &view.mount;
    padded(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            action_button(ui, cx, MountAction::Plan, "Plan");
            action_button(ui, cx, MountAction::Capture, "Take a view");
            action_button(ui, cx, MountAction::DeleteAll, "Delete all");
            if mount.can_undo
                && ui.button("Undo").on_hover_text("Brings back the views deleted last").clicked()
            {
                cx.outbox.send(MountCommand::Undo);
            }
        });
        ui.add_space(space::XS);
        if mount.views.is_empty() && mount.planned.is_empty() {
            let message = Message::new(
                "No views yet",
                "Lay the board on the table and plan: the head turns, the board stays, both eyes look.",
            );
            if EmptyState::empty(message.button("Plan head poses")).show(ui) {
                cx.outbox.act(Action::Mount(MountAction::Plan));
            }
            return;
        }
        ui.label(theme::small(ui, summary(mount)));
        ui.spacing_mut().item_spacing.y = 0.0;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for seen in mount.views.iter() {
                row(ui, cx, seen);
            }
            for (pan_rad, tilt_rad) in mount.planned.iter() {
                planned_row(ui, *pan_rad, *tilt_rad);
            }
        });
    });
}

fn summary(mount: &MountView) -> String {
    match mount.planned.len() {
        0 => format::count(mount.views.len(), "view"),
        planned if mount.views.is_empty() => format!("{} planned", format::count(planned, "view")),
        planned => format!("{}, {planned} more planned", format::count(mount.views.len(), "view")),
    }
}

/// Where less is left, what fits is better told by the inspector, pt.
const FIT_WIDTH: f32 = 24.0;

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, seen: &HeadViewSummary) {
    let mount = &cx.view.mount;
    let left_out =
        mount.proposal.as_ref().and_then(|p| p.rejected.iter().find(|(name, _)| *name == seen.name));
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let delete = ui.add(Button::new(theme::small(ui, "Delete")).frame(false));
            delete.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Delete {}", seen.name))
            });
            if delete.clicked() {
                cx.outbox.send(MountCommand::Delete { view: seen.name.clone() });
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = space::XS;
                let color = theme::tokens(ui).text;
                head_label(ui, seen.pan_rad, seen.tilt_rad, color).on_hover_text(format!(
                    "{}: {} left, {} right",
                    seen.name,
                    format::count(seen.corners.0, "corner"),
                    seen.corners.1
                ));
                if seen.is_colder {
                    let text = egui::RichText::new("colder").color(Role::Warning.color(theme::tokens(ui)));
                    ui.add(egui::Label::new(text).truncate()).on_hover_text(
                        "Taken while the eyes were colder than in other views: it does not go with them",
                    );
                } else if ui.available_width() > FIT_WIDTH {
                    fit(ui, left_out.map(|(_, why)| why.as_str()), seen.rms_px);
                }
            });
        });
    });
}

/// The residual, or that the view is left out, with why where it is pointed at.
fn fit(ui: &mut Ui, left_out: Option<&str>, rms_px: Option<f64>) {
    let tokens = theme::tokens(ui);
    match (left_out, rms_px) {
        (Some(why), _) => {
            let text = egui::RichText::new("left out").color(Role::Warning.color(tokens));
            ui.add(egui::Label::new(text).truncate()).on_hover_text(why);
        }
        (None, Some(rms)) => {
            // A row has room for two digits; that one view fits a little better says nothing.
            let rms = format!("{} px", format::significant(rms, 2));
            ui.add(egui::Label::new(rms).truncate());
        }
        (None, None) => {
            ui.label(egui::RichText::new("seen").color(tokens.text_weak));
        }
    }
}

/// In a column of its own.
fn head_label(ui: &mut Ui, pan_rad: f64, tilt_rad: f64, color: egui::Color32) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(132.0, ROW), egui::Sense::hover());
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = head_text(pan_rad, tilt_rad);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &text));
    ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, &text, font, color);
    response
}

/// Weak, for the head was not turned there yet; the line above says how many these are.
fn planned_row(ui: &mut Ui, pan_rad: f64, tilt_rad: f64) {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let color = theme::tokens(ui).text_weak;
        head_label(ui, pan_rad, tilt_rad, color).on_hover_text("planned");
    });
}

/// "left 12°, down 30°".
fn head_text(pan_rad: f64, tilt_rad: f64) -> String {
    let side = if pan_rad >= 0.0 { "left" } else { "right" };
    let height = if tilt_rad > 0.0 { "up" } else { "down" };
    let degrees = |angle: f64| format::fixed(angle.abs().to_degrees(), 0);
    format!("{side} {}°, {height} {}°", degrees(pan_rad), degrees(tilt_rad))
}

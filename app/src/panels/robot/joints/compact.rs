//! A joint in a narrow panel: title, slider, angle, temperature. The inspector says the rest.

use egui::Ui;
use plumbline_engine::view::JointView;
use plumbline_widgets::format;
use plumbline_widgets::theme;

use super::proposing::{preview_angle, propose};
use crate::panels::PanelContext;
use crate::panels::robot::parts::cannot_show;

/// A name is shortened to no less than this, and never needs more, points.
const TITLE: [f32; 2] = [112.0, 148.0];
const FIGURES: f32 = 104.0;
const LEAST_SLIDER: f32 = 60.0;

/// One line: title, slider, angle, temperature.
pub(super) fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, joint: &JointView) {
    let robot = &cx.view.robot;
    let chosen = cx.state.robot.chosen_joint == Some(joint.joint);
    let shown_deg = preview_angle(robot, joint).or(joint.angle_rad).map(f64::to_degrees);
    let limits = joint.limits_now;
    ui.horizontal(|ui| {
        ui.set_min_height(24.0);
        let name = short_title(&joint.title);
        // With something at its right end, the name stands at its left one, below the others.
        let button = egui::Button::selectable(chosen, name).right_text("").truncate();
        let beside = FIGURES + LEAST_SLIDER + 2.0 * ui.spacing().item_spacing.x;
        let title = (ui.available_width() - beside).clamp(TITLE[0], TITLE[1]);
        let label = ui.add_sized([title, 22.0], button);
        label.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, &joint.title));
        if label.clicked() {
            cx.state.robot.chosen_joint = Some(joint.joint);
        }
        let why = cannot_show(robot);
        let mut degrees = shown_deg.unwrap_or_default();
        ui.spacing_mut().slider_width = (ui.available_width() - FIGURES).max(LEAST_SLIDER);
        let range = limits.lower_rad.to_degrees()..=limits.upper_rad.to_degrees();
        let slider = egui::Slider::new(&mut degrees, range).show_value(false);
        let slider = ui.add_enabled(why.is_none() && shown_deg.is_some(), slider);
        slider.widget_info(|| {
            egui::WidgetInfo::slider(why.is_none(), degrees, format!("{} goal", joint.title))
        });
        let slider = slider.on_disabled_hover_text(why.unwrap_or_default());
        // A slider also rounds what it is given, which is no wish.
        if slider.changed() && shown_deg.is_some_and(|before| (before - degrees).abs() > 0.02) {
            propose(cx, joint, degrees.to_radians());
        }
        figures(ui, joint);
    });
}

fn figures(ui: &mut Ui, joint: &JointView) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let warm = joint.temperature_c.map(|warm| format!("{} °C", format::fixed(warm, 0)));
        ui.label(theme::small(ui, warm.unwrap_or_else(|| format::NONE.to_owned())));
        ui.label(joint.angle_rad.map_or_else(|| format::NONE.to_owned(), format::joint_degrees));
    });
}

/// Without the side, which the group says.
fn short_title(title: &str) -> String {
    let rest = ["Right ", "Left "].iter().find_map(|side| title.strip_prefix(side));
    crate::operator::words::capitalized(rest.unwrap_or(title))
}

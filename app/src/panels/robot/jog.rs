//! Moving a tip by hand. Nothing is sent unless the enabling key is held: Shift over the pad, its
//! enable button, or the left shoulder button of a gamepad.

use egui::{ComboBox, ScrollArea, Ui};
use plumbline_engine::view::RobotView;
use plumbline_engine::{JogRates, RobotCommand};
use plumbline_widgets::jog_pad::{JogPad, JogSpeed};
use plumbline_widgets::theme;

use super::parts::{cannot_jog, refusal_line};
use super::state::Asked;
use crate::operator::words::robot::tip_title;
use crate::operator::{GamepadState, STOP_BUTTONS, led_by};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if super::parts::without_joints(ui, cx, Some("Moves the tip of an arm while a key is held.")) {
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| contents(ui, cx));
    });
}

fn contents(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    ui.horizontal(|ui| {
        choose_tip(ui, &view.robot, &mut |link| cx.outbox.send(RobotCommand::ChooseTip { link }));
    });
    let why = cannot_jog(&view.robot).or_else(|| led_by(view).map(Into::into));
    let tip = tip_title(&view.robot).to_lowercase();
    let pad = cx.state.robot.gamepad.clone().filter(|pad| pad.enabled && why.is_none());
    let is_refused = cx.state.robot.asked == Asked::Jog && view.robot.refusal.is_some();
    let shown = JogPad::new(&tip)
        .why_not(why.as_deref())
        .enabled_elsewhere(pad.is_some())
        .refused(is_refused.then_some("the bottom line says why"))
        .show(ui, &mut cx.state.robot.jog_speed);
    // Below, where the pad does not move under the finger that holds it, and is in sight in a small window.
    refusal_line(ui, cx, Asked::Jog);
    if !view.robot.model.is_empty() {
        ui.label(theme::small(ui, format!("Moved by the robot {}.", view.robot.model)));
    }
    ui.label(theme::small(ui, "The tip goes that way; the hand turns with it as the arm has to."));
    gamepad(ui, cx.state.robot.gamepad.as_ref());
    let by_hand = shown.intent.map(|intent| JogRates {
        velocity_m_s: intent.velocity_m_s.into(),
        yaw_rad_s: intent.yaw_rate_rad_s,
    });
    let by_stick = pad.as_ref().and_then(|pad| stick_rates(pad, cx.state.robot.jog_speed));
    if let Some(rates) = by_hand.or(by_stick) {
        cx.state.robot.asked = Asked::Jog;
        cx.outbox.jog = Some(rates);
    }
}

/// A stick all the way pushed is as fast as a button; a diagonal is no faster.
fn stick_rates(pad: &GamepadState, speed: JogSpeed) -> Option<JogRates> {
    let [x, y, z, turn] = pad.push;
    if !pad.push.iter().all(|push| push.is_finite()) || pad.push.iter().all(|push| push.abs() < 1e-9) {
        return None;
    }
    let norm = (x * x + y * y + z * z).sqrt().max(1.0);
    let velocity_m_s = [x, y, z].map(|part| part / norm * speed.linear_m_s());
    Some(JogRates { velocity_m_s, yaw_rad_s: turn.clamp(-1.0, 1.0) * speed.yaw_rad_s() })
}

fn choose_tip(ui: &mut Ui, robot: &RobotView, choose: &mut dyn FnMut(String)) {
    let Some(rig) = &robot.rig else { return };
    let label = ui.label("Tip");
    let shown = tip_title(robot);
    let combo = ComboBox::from_id_salt("tip")
        .width(170.0_f32.min(ui.available_width()))
        .selected_text(shown)
        .show_ui(ui, |ui| {
            for tip in rig.arms.iter().flat_map(|arm| &arm.tips) {
                if ui.selectable_label(tip.link == robot.tip, &tip.title).clicked() {
                    choose(tip.link.clone());
                }
            }
        });
    combo.response.labelled_by(label.id);
}

fn gamepad(ui: &mut Ui, pad: Option<&GamepadState>) {
    let how = format!(
        "Hold the left shoulder button to enable it. Left stick: forward, back, left, right. Right stick: up, down, turn. It stops with {STOP_BUTTONS}, on every screen."
    );
    let (text, hover) = match pad {
        Some(pad) if pad.enabled => ("gamepad enabled", format!("{}. {how}", pad.name)),
        Some(pad) => ("gamepad: hold left shoulder", format!("{}. {how}", pad.name)),
        None => ("no gamepad", format!("Plug one in to jog with it. {how}")),
    };
    ui.label(theme::small(ui, text)).on_hover_text(hover);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(push: [f64; 4]) -> Option<JogRates> {
        stick_rates(&GamepadState { push, enabled: true, ..GamepadState::default() }, JogSpeed::Normal)
    }

    #[test]
    fn sticks_are_no_faster_than_buttons_and_half_a_push_is_half_as_fast() {
        assert_eq!(pushed([0.0; 4]), None);
        assert_eq!(pushed([f64::NAN, 0.0, 0.0, 0.0]), None);
        let both = pushed([1.0, 1.0, 0.0, 0.0]).expect("a way").velocity_m_s;
        let speed = both.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!((speed - JogSpeed::Normal.linear_m_s()).abs() < 1e-12);
        let slow = pushed([0.5, 0.0, 0.0, 0.0]).expect("half way").velocity_m_s;
        assert!((slow[0] - 0.5 * JogSpeed::Normal.linear_m_s()).abs() < 1e-12);
    }
}

//! What is grasped, how, and with which hand.

use egui::Ui;
use plumbline_engine::view::GraspPhase;
use plumbline_engine::{GraspCommand, GraspTarget};
use plumbline_model::listed;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::things::seen_but_not_held;
use crate::operator::words::grasp::{about_hand, hand_choice, method};
use crate::panels::PanelContext;

/// Three rows of chips.
pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let idle = cx.view.grasp.phase == GraspPhase::Idle;
    ui.add_enabled_ui(idle, |ui| {
        objects(ui, cx);
        methods(ui, cx);
        hands(ui, cx);
    });
}

fn row(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(2.0, 2.0);
        ui.add_sized([46.0, 20.0], egui::Label::new(theme::small(ui, name)).halign(egui::Align::Min));
        contents(ui);
    });
}

fn objects(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let grasp = &cx.view.grasp;
    row(ui, "Object", |ui| {
        let target = &grasp.target;
        let any = ui.selectable_label(target.class.is_none(), "Any");
        if any.on_hover_text("What can be held and is seen best").clicked() {
            cx.outbox.send(GraspCommand::Target(GraspTarget::default()));
        }
        for class in grasp.classes.iter() {
            let chosen = target.class.as_deref() == Some(class);
            if ui.selectable_label(chosen, *class).clicked() {
                let class = Some((*class).to_owned());
                cx.outbox.send(GraspCommand::Target(GraspTarget { class, near_m: None }));
            }
        }
        if let Some([x_m, y_m]) = target.near_m {
            ui.add_space(space::S);
            ui.label(theme::small(ui, format!("near x {}, y {}", format::mm(x_m), format::mm(y_m))));
        }
        if let Some(others) = seen_but_not_held(cx.view) {
            ui.add_space(space::S);
            ui.label(theme::small(ui, others));
        }
    });
}

fn methods(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let grasp = &cx.view.grasp;
    row(ui, "Method", |ui| {
        for known in grasp.methods.iter() {
            let chosen = grasp.method == Some(known.method);
            let chip = egui::Button::selectable(chosen, method(known.method));
            let chip = ui.add_enabled(known.lacks.is_none() || chosen, chip);
            let chip = chip.on_hover_text(known.about);
            if chip.on_disabled_hover_text(known.lacks.clone().unwrap_or_default()).clicked() {
                cx.outbox.send(GraspCommand::Method(known.method));
            }
        }
        if let Some(chosen) = grasp.methods.iter().find(|known| grasp.method == Some(known.method)) {
            ui.add_space(space::S);
            ui.label(theme::small(ui, chosen.about));
        }
    });
    let lacking: Vec<String> = (grasp.methods.iter())
        .filter(|known| known.lacks.is_some() && grasp.method != Some(known.method))
        .map(|known| method(known.method))
        .collect();
    if !lacking.is_empty() {
        let names = listed(&lacking.iter().map(String::as_str).collect::<Vec<_>>());
        let said = format!("For {names} train models from touches first: step 4, Models.");
        ui.label(theme::small(ui, said));
    }
}

fn hands(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let grasp = &cx.view.grasp;
    if grasp.hands.len() < 2 {
        return;
    }
    row(ui, "Hand", |ui| {
        for choice in grasp.hands.iter().copied() {
            // The published methods know the right hand only.
            let known = grasp.method.is_none_or(|method| method.hands(choice).is_ok());
            let chosen = grasp.hand == choice;
            let chip = egui::Button::selectable(chosen, hand_choice(choice));
            let chip = ui.add_enabled(known || chosen, chip).on_hover_text(about_hand(choice));
            if chip.on_disabled_hover_text("The published methods grasp with the right hand").clicked() {
                cx.outbox.send(GraspCommand::Arm(choice));
            }
        }
    });
}

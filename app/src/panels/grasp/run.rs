//! The pane of the work: what and how, gates, lamps, result, and every step by itself.

use egui::{RichText, ScrollArea, Slider, Ui};
use plumbline_engine::view::{GateState, GraspPhase, Need};
use plumbline_engine::{GraspCommand, HandStep, View};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::{aligned, choice, lamps, result, things};
use crate::operator::GraspAction;
use crate::operator::words::capitalized;
use crate::operator::words::grasp::{again, go_on, hand as hand_words, holds, try_of};
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            choice::show(ui, cx);
            ui.add_space(space::S);
            buttons(ui, cx);
            ui.add_space(space::S);
            if let Some(run) = cx.view.grasp.run.clone() {
                if let Some(which) = try_of(&run).filter(|_| cx.view.grasp.phase.moves()) {
                    ui.label(theme::strong(ui, capitalized(&which)));
                }
                if let Some(again) = again(&run) {
                    ui.label(again);
                }
                lamps::show(ui, &run.lamps);
                ui.add_space(space::XS);
                result::show(ui, cx, &run);
                if !run.iterations.is_empty() {
                    ui.add_space(space::S);
                    aligned::show(ui, &run.iterations);
                }
                ui.add_space(space::S);
            }
            planned(ui, cx);
            gates(ui, cx.view);
            ui.add_space(space::S);
            hand(ui, cx);
        });
    });
}

/// The attempt as a whole.
fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        match &cx.view.grasp.phase {
            GraspPhase::Idle => {
                action_button(ui, cx, GraspAction::Plan, "Plan");
                if cx.view.grasp.plan.is_some() {
                    action_button(ui, cx, GraspAction::Forget, "Forget the plan");
                }
            }
            GraspPhase::Planning => {
                ui.spinner();
                ui.label(theme::weak(ui, doing(cx.view)));
                action_button(ui, cx, GraspAction::End, "End");
            }
            phase if phase.is_paused() => {
                let label = go_on(&cx.view.grasp);
                action_button(ui, cx, GraspAction::End, "End");
                action_button(ui, cx, GraspAction::Resume, &label);
            }
            GraspPhase::Grasping { .. } | GraspPhase::Hand { .. } => {
                // End stays where it is, whatever its neighbor says.
                action_button(ui, cx, GraspAction::End, "End");
                action_button(ui, cx, GraspAction::Pause, "Pause");
            }
        }
    });
    stop_after_each(ui, cx);
    match &cx.view.grasp.phase {
        GraspPhase::Idle | GraspPhase::Planning => {}
        phase if phase.is_paused() => {
            let said = holds(&cx.view.grasp).unwrap_or_else(|| "Paused: the arm holds.".to_owned());
            ui.label(theme::weak(ui, said));
        }
        GraspPhase::Grasping { .. } | GraspPhase::Hand { .. } => {
            ui.label(theme::weak(ui, doing(cx.view)));
        }
    }
}

/// Whether an attempt goes step by step. Also while one is under way.
fn stop_after_each(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let mut on = cx.view.grasp.stops_after_each;
    let about = "A grasp holds after each step, says what comes next and what will move, and goes on when you say \
                 so. The experiment goes on without a stop.";
    if ui.checkbox(&mut on, "Stop after each step").on_hover_text(about).changed() {
        cx.outbox.send(GraspCommand::StopAfterEachStep(on));
    }
}

/// What is done just now, in a few words.
fn doing(view: &View) -> String {
    let running = view.running_job().and_then(|job| match &job.state {
        plumbline_engine::view::JobState::Running { doing, .. } => Some(doing.clone()),
        _ => None,
    });
    capitalized(&running.unwrap_or_default())
}

/// What keeps anything from moving; when nothing does and nothing else is shown, one word. Notes stand in
/// the inspector, and of what is in the hand the bottom line tells, with its button.
fn gates(ui: &mut Ui, view: &View) {
    let grasp = &view.grasp;
    if grasp.phase != GraspPhase::Idle {
        return;
    }
    let tokens = theme::tokens(ui);
    if grasp.trouble().is_none() && grasp.run.is_none() {
        let doubt = grasp.gates.iter().find(|gate| gate.state == GateState::Doubtful);
        match (things::nothing_to_hold(view), doubt) {
            (Some(why), _) => ui.label(theme::weak(ui, why)),
            (None, None) => ui.label(RichText::new("Ready.").color(Role::Accepted.color(tokens))),
            (None, Some(doubt)) => {
                let text = format!("Ready, in doubt: {}", doubt.text);
                ui.label(RichText::new(text).color(Role::Warning.color(tokens)))
            }
        };
    }
    for gate in grasp.gates.iter().filter(|gate| gate.state == GateState::Shut && gate.of != Need::Hand) {
        let text = format!("{}, not ok: {}", gate.of.name(), gate.text);
        ui.label(RichText::new(text).color(Role::Warning.color(tokens)));
    }
}

/// What would be sent, in words, and where along it the ghost stands.
fn planned(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(plan) = cx.view.grasp.plan.clone() else { return };
    let [x_m, y_m] = plan.at_m;
    let sigma = plan
        .sigma_m
        .map_or_else(String::new, |sigma_m| format!(" (known to {})", format::mm_known_to(sigma_m)));
    ui.label(theme::strong(
        ui,
        format!("{} at x {}, y {}{sigma}", plan.object, format::mm(x_m), format::mm(y_m)),
    ));
    let turns: Vec<String> = plan
        .turns
        .iter()
        .take(4)
        .map(|(joint, turn_rad)| format!("{joint} {}", format::degrees(*turn_rad)))
        .collect();
    ui.label(theme::weak(
        ui,
        format!(
            "With the {}, by the robot {}, about {} s. Turns in all: {}; the head and the other arm stay.",
            hand_words(plan.hand),
            plan.model,
            plan.duration.as_secs(),
            turns.join(", ")
        ),
    ));
    // The words beside it need about so much, points.
    ui.spacing_mut().slider_width = (ui.available_width() - 150.0).clamp(60.0, 140.0);
    let slider =
        Slider::new(&mut cx.state.grasp.along, 0.0..=1.0).show_value(false).text("ghost along the way");
    ui.add(slider);
    ui.reset_style();
    ui.add_space(space::S);
}

/// Every step by itself.
fn hand(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.label(theme::small(ui, "The hand by itself: each moves the arm at once"));
    ui.horizontal_wrapped(|ui| {
        for step in HandStep::ALL {
            action_button(ui, cx, GraspAction::Hand(step), step.title());
        }
    });
}

//! What shall be touched, how long that takes, and what it will tell.

use egui::{ScrollArea, Ui};
use plumbline_engine::view::{PlanView, TouchPhase};
use plumbline_model::touch_plan::PlanOptions;
use plumbline_widgets::empty::EmptyState;
use plumbline_widgets::key_value::big_figure;
use plumbline_widgets::theme::{self, Role, space};

use super::{draft, options, score};
use crate::operator::{Action, Preset, TouchAction, is_under_way, minutes, screen_of, what_moves};
use crate::panels::parts::warning;
use crate::panels::{PanelContext, padded};

/// Presets: name, and what it is good for.
const PRESETS: [(Preset, &str, &str); 5] = [
    (
        Preset::Corners,
        "Place screen",
        "Its corners, each twice: measures where the screen lies. Do this first.",
    ),
    (Preset::Quick, "Quick", "24 touches: enough to train M1, M2 and M3 on, roughly."),
    (
        Preset::First,
        "First calibration",
        "About 80 touches: a grid, lines, and five places again and again for the noise floor.",
    ),
    (
        Preset::Rich,
        "Find causes",
        "Two sides, three heights, with and without a weight: shows why the finger misses.",
    ),
    (Preset::Check, "Check", "20 new targets: how well the finger lands with the model in use."),
];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    draft::keep_up(ui, cx);
    if screen_of(cx.view).is_none() {
        let message = plumbline_widgets::empty::Message::new(
            "No touchscreen is known",
            "Connect the twin or a robot: its description says how large the touchscreen is.",
        );
        EmptyState::empty(message).show(ui);
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let Some(options) = cx.state.touch.draft.options().cloned() else {
                return choose_first(ui, cx);
            };
            let locked = is_under_way(&cx.view.touch.phase);
            if locked {
                ui.label(theme::weak(ui, "A run is under way; finish it to plan anew."));
            }
            ui.add_enabled_ui(!locked, |ui| chips(ui, cx, &options));
            ui.add_space(space::S);
            result(ui, cx);
            ui.add_space(space::S);
            // A preset may have been chosen just now.
            let options = cx.state.touch.draft.options().cloned().unwrap_or(options);
            ui.add_enabled_ui(!locked, |ui| options::show(ui, cx, &options));
        });
    });
}

/// Nothing is planned: what there is to choose from.
fn choose_first(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.add_space(space::XS);
    ui.label(theme::strong(ui, "What shall be touched?"));
    ui.label(theme::weak(ui, "Planning moves nothing. Everything can be changed afterwards."));
    ui.add_space(space::S);
    for (preset, name, about) in PRESETS {
        let action = Action::Touch(TouchAction::Plan(preset));
        let refusal = action.refusal(cx.view);
        let width = ui.available_width().min(132.0);
        let button = egui::Button::new(name).min_size(egui::vec2(width, 26.0));
        let button = ui.add_enabled(refusal.is_none(), button);
        if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
            cx.outbox.act(action);
        }
        ui.label(theme::small(ui, about));
        ui.add_space(space::XS);
    }
}

/// The same, in a row; the one that the fields stand for is marked. The area is kept.
fn chips(ui: &mut Ui, cx: &mut PanelContext<'_>, options: &PlanOptions) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(2.0, 2.0);
        for (preset, name, about) in PRESETS {
            let wanted = PlanOptions { finger: options.finger, ..preset.options(options.area) };
            let chosen = PlanOptions { seed: options.seed, ..wanted.clone() } == *options;
            if ui.selectable_label(chosen, name).on_hover_text(about).clicked() && !chosen {
                cx.state.touch.draft.change(wanted);
            }
        }
    });
}

fn result(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let touch = &cx.view.touch;
    if touch.phase == TouchPhase::Planning || cx.state.touch.draft.is_ahead() {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(theme::weak(ui, "Looks which targets the arm reaches"));
        });
        return;
    }
    let Some(plan) = touch.plan.clone() else { return };
    figures(ui, &plan, touch.counts.planned);
    reach(ui, &plan, touch.phase == TouchPhase::Finished);
    if let Some(score) = &plan.score {
        score::show(ui, score);
    }
}

fn figures(ui: &mut Ui, plan: &PlanView, planned: usize) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        let role = if plan.reachable < planned { Role::Warning } else { Role::Ink };
        big_figure(ui, "touches in reach", &format!("{} of {planned}", plan.reachable), role);
        big_figure(ui, "takes about", &minutes(plan.duration), Role::Ink);
        if let Some(score) = &plan.score {
            let seen = score.seen.iter().filter(|effect| effect.is_seen()).count();
            big_figure(
                ui,
                "causes of misses it shows",
                &format!("{seen} of {}", score.candidates),
                Role::Ink,
            );
        }
    });
}

fn reach(ui: &mut Ui, plan: &PlanView, is_over: bool) {
    for (why, count) in &plan.refusals {
        warning(ui, &format!("{count} left out: {why}"));
    }
    if plan.reachable > 0 {
        ui.label(theme::weak(ui, what_moves(plan)));
        if !plan.model.is_empty() {
            let when = if is_over { "Was corrected" } else { "Corrected" };
            ui.label(theme::weak(ui, format!("{when} by the robot {}.", plan.model)));
        }
        if plan.options.beside_described {
            ui.label(theme::weak(ui, "Every place twice: by the robot as described, then with the effects."));
        }
    }
}

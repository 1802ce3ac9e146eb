//! The inspector of touching: the chosen touch, the model that corrects, the touch window.

use egui::Ui;
use plumbline_engine::view::{ContactSource, TouchOutcome, TouchPhase, TouchState, TouchView};
use plumbline_engine::{Correction, TouchCommand, View};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::parts::{error_length_m, next_touch, touch_number};
use super::words;
use crate::operator::snapshot::models::Method;
use crate::operator::{Action, Monitor, Outbox, TouchAction, is_under_way, screen_of, window_problem};
use crate::panels::PanelState;
use crate::panels::parts::warning;

/// What is known of the touch that is chosen, and how touches are made.
pub fn show(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    let touch = &view.touch;
    let number = state.touch.chosen.or_else(|| next_touch(touch));
    match number.and_then(|number| touch_number(touch, number)) {
        Some(one) => chosen(ui, view, one, state.touch.chosen.is_none(), outbox),
        None => {
            group_heading(ui, "Touch");
            ui.label(theme::weak(ui, "Click a touch on the map or in the list."));
        }
    }
    corrected(ui, view, outbox);
    window(ui, view, state, outbox);
}

fn chosen(ui: &mut Ui, view: &View, one: &TouchState, next: bool, outbox: &mut Outbox) {
    let waits = next && one.outcome != TouchOutcome::UnderWay;
    group_heading(ui, &format!("Touch {}{}", one.number, if waits { " (next)" } else { "" }));
    match &one.outcome {
        TouchOutcome::Unreachable(_) | TouchOutcome::Missed(_) => warning(ui, &words::outcome(one)),
        TouchOutcome::Touched => {}
        TouchOutcome::Waiting if view.touch.phase == TouchPhase::Finished => {
            ui.label(theme::weak(ui, "Never made"));
        }
        _ => {
            ui.label(theme::weak(ui, crate::operator::words::capitalized(&words::outcome(one))));
        }
    }
    if !one.inside {
        warning(ui, "outside of what the model knows");
    }
    key_value_grid(ui, "touch", &rows(one));
    if !matches!(one.outcome, TouchOutcome::Waiting | TouchOutcome::UnderWay | TouchOutcome::Unreachable(_)) {
        ui.add_space(space::S);
        ui.horizontal_wrapped(|ui| buttons(ui, view, one, outbox));
    }
}

fn rows(one: &TouchState) -> Vec<KeyValue> {
    let pixel = |u_px: f64, v_px: f64| format!("{}, {}", format::fixed(u_px, 0), format::fixed(v_px, 0));
    let mut rows = vec![KeyValue::text("Target", pixel(one.target.u_px, one.target.v_px)).unit("px")];
    if let Some(touched) = one.touched {
        rows.push(KeyValue::text("Touched", pixel(touched.u_px, touched.v_px)).unit("px"));
    }
    if let Some([right, near]) = one.error_m {
        rows.push(KeyValue::optional("Error", Quantity::Length, error_length_m(one)).role(Role::Difference));
        rows.push(KeyValue::quantity("to the right", Quantity::Length, right));
        rows.push(KeyValue::quantity("toward robot", Quantity::Length, near));
    }
    let [x, y, z] = [one.sent.coords.x, one.sent.coords.y, one.sent.coords.z];
    rows.extend([
        KeyValue::quantity("Sent x", Quantity::Length, x).help("Where the simulated fingertip is sent"),
        KeyValue::quantity("Sent y", Quantity::Length, y),
        KeyValue::quantity("Sent z", Quantity::Length, z),
        KeyValue::text("Comes from", words::side(one.side)),
        KeyValue::text("Set", one.set.clone()).help("Touches of one set are held out together"),
    ]);
    rows
}

fn buttons(ui: &mut Ui, view: &View, one: &TouchState, outbox: &mut Outbox) {
    let number = one.number;
    let begun = is_under_way(&view.touch.phase) || view.touch.phase == TouchPhase::Finished;
    let mut button = |ui: &mut Ui, text: String, hover: &str, command: TouchCommand| {
        let button = ui.add_enabled(begun, egui::Button::new(text)).on_hover_text(hover);
        if button.on_disabled_hover_text("The run was not begun yet").clicked() {
            outbox.send(command);
        }
    };
    match one.outcome {
        TouchOutcome::Touched => {
            button(
                ui,
                format!("Reject touch {number}"),
                "Kept on disk, but does not count",
                TouchCommand::Reject { number },
            );
            redo(ui, number, &mut button);
        }
        TouchOutcome::Rejected => {
            button(ui, format!("Restore touch {number}"), "Counts again", TouchCommand::Restore { number });
            redo(ui, number, &mut button);
        }
        TouchOutcome::Missed(_) | TouchOutcome::Skipped => redo(ui, number, &mut button),
        TouchOutcome::Waiting | TouchOutcome::UnderWay | TouchOutcome::Unreachable(_) => {}
    }
}

fn redo(ui: &mut Ui, number: usize, button: &mut impl FnMut(&mut Ui, String, &str, TouchCommand)) {
    let hover = "Touched once more at the end; the arm moves when the run goes on";
    button(ui, format!("Redo touch {number}"), hover, TouchCommand::Redo { number });
}

/// With which model targets are corrected before they are sent.
fn corrected(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    group_heading(ui, "Targets corrected by");
    let known = known_models(view);
    let has_effects = !view.gap.model.effects.is_empty();
    if known.is_empty() && !has_effects {
        ui.label(theme::weak(ui, "No model yet: targets are sent as they are."));
        return;
    }
    let locked = is_under_way(&view.touch.phase) || view.touch.phase == TouchPhase::Planning;
    let mut with = view.touch.correct_with;
    ui.add_enabled_ui(!locked, |ui| {
        let models = known.into_iter().map(Correction::Model);
        let named = models.chain(has_effects.then_some(Correction::Effects));
        let shown = |correction: Correction| match correction {
            Correction::Model(method) => method.name(),
            Correction::Effects => "Named effects",
        };
        let names: Vec<(Option<Correction>, &str)> =
            [(None, "None")].into_iter().chain(named.map(|c| (Some(c), shown(c)))).collect();
        if plumbline_widgets::buttons::choice(ui, "Targets corrected by", &mut with, &names) {
            outbox.send(TouchCommand::CorrectWith(with));
        }
    });
}

fn known_models(view: &View) -> Vec<Method> {
    let models = &view.models;
    let mut known: Vec<Method> =
        models.in_use.iter().chain(&models.proposals).map(|model| model.method()).collect();
    known.sort();
    known.dedup();
    known
}

fn window(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    group_heading(ui, "Touch window");
    let touch = &view.touch;
    window_state(ui, view, touch);
    let panels = &mut state.touch;
    if !panels.window_open && panels.monitors.len() > 1 {
        ui.add_space(space::XS);
        ui.label(theme::small(ui, "Open it on"));
        for (i, monitor) in panels.monitors.iter().enumerate() {
            if ui.selectable_label(panels.monitor == Some(i), monitor_text(i, monitor, view)).clicked() {
                panels.monitor = Some(i);
                panels.monitor_chosen = true;
            }
        }
        if ui.selectable_label(panels.monitor.is_none(), "A window, to try it out").clicked() {
            panels.monitor = None;
            panels.monitor_chosen = true;
        }
    }
    ui.add_space(space::XS);
    let action = Action::Touch(TouchAction::ToggleWindow);
    let text = if panels.window_open { "Close touch window" } else { "Open touch window" };
    let refusal = action.refusal(view);
    let button = ui.add_enabled(refusal.is_none(), egui::Button::new(text));
    if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
        outbox.act(action);
    }
    if panels.window_open && panels.monitor.is_none() {
        ui.label(theme::small(ui, "Drag it onto the touch monitor, then press F11 in it."));
    }
}

fn window_state(ui: &mut Ui, view: &View, touch: &TouchView) {
    if touch.source == ContactSource::Twin {
        ui.label(theme::weak(ui, "The twin's glass feels by itself; the window only shows it."));
    }
    match (&touch.window, screen_of(view)) {
        (Some(window), Some(screen)) => match window_problem(window, screen) {
            Some(problem) => warning(ui, &problem),
            None => {
                let text = format!("Fills its monitor, {}×{} px.", window.width_px, window.height_px);
                ui.label(egui::RichText::new(text).color(Role::Accepted.color(theme::tokens(ui))));
            }
        },
        (None, _) if touch.source == ContactSource::Window => {
            ui.label(theme::weak(ui, "Closed: touches are not felt. Open it on the touch monitor."));
        }
        _ => {}
    }
}

/// "2: HDMI-1, 1920×1080, fits".
fn monitor_text(i: usize, monitor: &Monitor, view: &View) -> String {
    let [width, height] = monitor.size_px;
    let fits = screen_of(view).is_some_and(|screen| monitor.size_px == [screen.width_px, screen.height_px]);
    let fits = if fits { ", fits" } else { "" };
    format!("{}: {}, {width}×{height}{fits}", i + 1, monitor.name)
}

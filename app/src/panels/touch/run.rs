//! The run: how far it is, what the arm does, what was found, what was touched last.

use egui::{Button, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::TouchCommand;
use plumbline_engine::view::{TouchFigures, TouchOutcome, TouchPhase, TouchState, TouchView};
use plumbline_model::touch_plan::{Finger, PlanOptions, Purpose};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::key_value::big_figure;
use plumbline_widgets::progress::progress_bar;
use plumbline_widgets::theme::{self, Role, space};

use super::parts::error_length_m;
use super::words;
use crate::operator::guidance::{check_in_words, go_on, is_screen_to_be_decided};
use crate::operator::words::noise_of_repeats;
use crate::operator::words::proof::Proof;
use crate::operator::words::robot::is_limp;
use crate::operator::{Action, RobotAction, Screen, TouchAction, done_of, is_under_way, wanted};
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let touch = &cx.view.touch;
    match &touch.phase {
        TouchPhase::Idle if touch.unfinished.is_empty() => {
            EmptyState::empty(Message::new(
                "No run yet",
                "Plan what shall be touched. Every touch is on disk before the next one begins.",
            ))
            .show(ui);
        }
        TouchPhase::Idle => padded(ui, |ui| unfinished(ui, cx)),
        TouchPhase::Planning => {
            EmptyState::loading("Looks which targets the arm reaches").show(ui);
        }
        _ => padded(ui, |ui| {
            head(ui, cx);
            ui.add_space(space::S);
            if let Some(found) = &cx.view.touch.figures {
                proven(ui, &cx.view.touch);
                figures(ui, found);
                ui.add_space(space::S);
            }
            list(ui, cx);
        }),
    }
}

/// The state of the run in a sentence, with what can be done.
fn head(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    state(ui, cx);
    if cx.state.touch.finishing && is_under_way(&cx.view.touch.phase) {
        ui.label(theme::small(ui, FINISHES));
    }
    // What holds something has more to do than to go home.
    let near = cx.view.touch.near_screen.clone().filter(|_| cx.view.grasp.held.is_none());
    let Some(arm) = near else { return };
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::weak(ui, format!("{arm} stays at the screen.")));
        action_button(ui, cx, RobotAction::ShowHome, RobotAction::ShowHome.label());
    });
}

fn state(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let touch = &cx.view.touch;
    match &touch.phase {
        TouchPhase::Waiting { what, prepare } => {
            warning(ui, what);
            ui.add_space(space::XS);
            ui.horizontal(|ui| {
                if prepare.is_some() {
                    action_button(ui, cx, TouchAction::Prepared, "Done, go on");
                } else {
                    action_button(ui, cx, TouchAction::Resume, "Try again");
                }
                action_button(ui, cx, TouchAction::Skip, "Skip");
                finish_button(ui, cx);
            });
        }
        TouchPhase::Running { number, doing } => {
            progress(ui, touch);
            ui.label(match number {
                Some(number) => format!("Touch {number}: {doing}"),
                None => format!("No touch is left: {doing}"),
            });
            ui.horizontal(|ui| {
                action_button(ui, cx, TouchAction::Pause, "Pause");
                action_button(ui, cx, TouchAction::Skip, "Skip");
                finish_button(ui, cx);
            });
        }
        TouchPhase::Paused { why } => {
            progress(ui, touch);
            match why {
                _ if is_limp(&cx.view.robot) => {
                    warning(ui, "the joints are limp and sink: hold all joints first")
                }
                Some(why) => warning(ui, why),
                None => {
                    ui.label(theme::weak(ui, "Paused. What was touched is on disk."));
                }
            }
            ui.horizontal(|ui| {
                action_button(ui, cx, TouchAction::Resume, &go_on(touch));
                action_button(ui, cx, TouchAction::Skip, "Skip");
                finish_button(ui, cx);
            });
        }
        TouchPhase::Finished => finished(ui, cx),
        TouchPhase::Planned | TouchPhase::Idle | TouchPhase::Planning => {
            ui.label(theme::weak(ui, "Planned. Nothing was touched yet."));
        }
    }
}

fn finished(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let counts = cx.view.touch.counts;
    let mut text = format!("Finished: {} count", words::touches(counts.touched));
    let never = wanted(counts).saturating_sub(done_of(counts));
    let rest = [
        (counts.missed, "without contact"),
        (counts.skipped, "skipped"),
        (counts.rejected, "rejected"),
        (never, "never made"),
    ];
    for (count, what) in rest.into_iter().filter(|(count, _)| *count > 0) {
        text.push_str(&format!(", {count} {what}"));
    }
    ui.label(RichText::new(format!("{text}.")).color(theme::tokens(ui).text_strong));
    if let Some(name) = cx.view.touch.session.as_ref().and_then(|path| path.file_name()) {
        ui.label(theme::small(ui, format!("Session {}", name.to_string_lossy())));
    }
    if let Some(checked) = check_in_words(cx.view) {
        ui.label(checked);
    }
    // A place that another run measured, or touches that were made for something else, stands in the tile of the place.
    let is_decided_here = is_screen_to_be_decided(&cx.view.touch) && !cx.view.touch.proposal_is_older;
    if let Some(placement) = cx.view.touch.placement_proposal.clone().filter(|_| is_decided_here) {
        ui.add_space(space::XS);
        super::place::figures(ui, &placement, "proposed");
        ui.horizontal(|ui| {
            action_button(ui, cx, TouchAction::AcceptScreen, "Use this place");
            action_button(ui, cx, TouchAction::DiscardScreen, "Discard proposal");
        });
        return;
    }
    ui.horizontal(|ui| {
        action_button(ui, cx, TouchAction::Close, "Close the run");
        // Models learn from touches of the right finger that were made for them.
        let teaches = |plan: &PlanOptions| plan.finger == Finger::Right && plan.purpose == Purpose::Train;
        let leads_to_models =
            counts.touched > 0 && cx.view.touch.plan.as_ref().is_some_and(|plan| teaches(&plan.options));
        if leads_to_models && ui.button("Go to Models").clicked() {
            cx.outbox.act(Action::Go(Screen::Models));
        }
    });
}

/// What ending a run early does.
const FINISHES: &str = "Ends the run with what there is: the session stays, and so does the arm, where it is. Where the screen stands on a block you are asked to take that away first.";

/// Asks once more in place: what is left of the plan would have to be begun anew.
fn finish_button(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let asked = cx.state.touch.finishing;
    // Where "Finish" was: pressed twice by mistake, it ends nothing.
    if asked && ui.button("Not yet").clicked() {
        cx.state.touch.finishing = false;
    }
    let text = if asked { "Finish now" } else { "Finish" };
    if ui.button(text).on_hover_text(FINISHES).clicked() {
        cx.state.touch.finishing = !asked;
        if asked {
            cx.outbox.act(Action::Touch(TouchAction::Finish));
        }
    }
}

fn progress(ui: &mut Ui, touch: &TouchView) {
    let (done, wanted) = (done_of(touch.counts), wanted(touch.counts));
    let fraction = if wanted > 0 { done as f64 / wanted as f64 } else { 0.0 };
    ui.horizontal(|ui| {
        ui.label(theme::strong(ui, format!("{done} of {wanted}")));
        let width = (ui.available_width() - 90.0).clamp(60.0, 260.0);
        progress_bar(ui, "Touches done", fraction, vec2(width, 6.0));
        if let Some(left) = touch.remaining.filter(|_| is_under_way(&touch.phase)) {
            ui.label(theme::weak(ui, format::time_left(left)));
        }
    });
}

/// What the effects are worth: touches of the same places as the robot is described, and with them.
fn proven(ui: &mut Ui, touch: &TouchView) {
    let (Some(described), Some(found)) = (&touch.figures_described, &touch.figures) else { return };
    let half = |figures: &TouchFigures| 0.5 * (figures.mean_interval_m[1] - figures.mean_interval_m[0]);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::L, space::XS);
        let before = format::mm_within(described.mean_m, half(described));
        big_figure(ui, "as described, ± 95 %", &before, Role::Ink);
        let after = format::mm_within(found.mean_m, half(found));
        big_figure(ui, "with the effects, ± 95 %", &after, Role::HeldOut);
    });
    // While touches are still to come nothing is proven.
    if let Some(proof) = Proof::of_run(touch).filter(|_| touch.phase == TouchPhase::Finished) {
        ui.label(theme::strong(ui, proof.headline()));
        ui.label(theme::weak(ui, proof.figures()));
    }
}

/// Less than that no touchscreen tells, m.
const UNSEEN_M: f64 = 5e-5;

fn figures(ui: &mut Ui, found: &TouchFigures) {
    let [low, high] = found.mean_interval_m;
    let [right, near] = found.bias_m;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::L, space::XS);
        // What reaches down to zero has no ± that means something.
        let (label, mean) = if low > 0.0 {
            ("mean error, ± 95 %", format::mm_within(found.mean_m, (high - low) / 2.0))
        } else {
            ("mean error, too scattered for a ±", format::mm(found.mean_m))
        };
        let mean = big_figure(ui, label, &mean, Role::Difference);
        mean.on_hover_text(format!(
            "Distance of touch and target in the glass over {}; between {} and {} in 95 of 100 cases",
            words::touches(found.count),
            format::mm(low),
            format::mm(high)
        ));
        big_figure(ui, "largest", &format::mm(found.largest_m), Role::Ink);
        let bias = format!("{}, {}", format::mm(right.abs()), format::mm(near.abs()));
        let aside = if right < 0.0 { "left" } else { "right" };
        let along = if near < 0.0 { "away from" } else { "toward" };
        big_figure(ui, &format!("bias: to the {aside}, {along} the robot"), &bias, Role::Ink);
        // Repeats that meet the same pixel scatter by less than it can tell, which is not by nothing.
        let noise = match found.noise_m {
            None => format::NONE.to_owned(),
            Some(noise_m) if noise_m < UNSEEN_M => "less than a pixel".to_owned(),
            Some(noise_m) => format::mm(noise_m),
        };
        let label = match found.noise_m {
            None => "noise floor: no repeats".to_owned(),
            Some(_) => noise_of_repeats(Some(found.repeats)),
        };
        big_figure(ui, &label, &noise, Role::NoiseFloor);
    });
}

/// What has become of touches, newest first; without any, what is to come.
fn list(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let touch = cx.view.touch.clone();
    let mut ended: Vec<&TouchState> = touch.touches.iter().filter(|one| has_ended(one)).collect();
    // The order of work is that of the numbers; the newest is the highest of them.
    ended.reverse();
    if ended.is_empty() {
        return;
    }
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for one in ended {
            row(ui, cx, one);
        }
    });
}

fn has_ended(touch: &TouchState) -> bool {
    matches!(
        touch.outcome,
        TouchOutcome::Touched | TouchOutcome::Missed(_) | TouchOutcome::Skipped | TouchOutcome::Rejected
    )
}

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, touch: &TouchState) {
    let chosen = cx.state.touch.chosen == Some(touch.number);
    let role = match touch.outcome {
        TouchOutcome::Missed(_) => Role::Warning,
        TouchOutcome::Touched => Role::Ink,
        _ => Role::Weak,
    };
    let text = format!("{:>3}   {}", touch.number, words::outcome(touch));
    let text = RichText::new(text).color(role.color(theme::tokens(ui)));
    let button =
        ui.add(Button::selectable(chosen, text).truncate().min_size(vec2(ui.available_width(), 22.0)));
    let about = error_length_m(touch).map_or_else(String::new, |_| format!(", set {}", touch.set));
    if button.on_hover_text(format!("Touch {}{about}", touch.number)).clicked() {
        cx.state.touch.chosen = (!chosen).then_some(touch.number);
    }
}

/// Runs that were begun and not finished.
fn unfinished(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.add_space(space::XS);
    ui.label(theme::strong(ui, "Begun and not finished"));
    ui.label(theme::weak(ui, "They go on exactly where they were."));
    ui.add_space(space::S);
    for run in cx.view.touch.unfinished.iter() {
        let age = jiff::Timestamp::now().duration_since(run.started);
        let age = format::age(std::time::Duration::try_from(age).unwrap_or_default());
        ui.horizontal_wrapped(|ui| {
            let label = format!("Open: {} of {}", run.touched, run.planned);
            if ui.button(&label).clicked() {
                cx.outbox.send(TouchCommand::Open { session: run.session.clone() });
            }
            ui.label(theme::weak(ui, format!("{}, begun {age}", words::purpose(run.purpose).to_lowercase())));
        });
    }
}

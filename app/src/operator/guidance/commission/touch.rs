//! Touches on the way: the screen is placed, touched to learn from, and touched to check.

use plumbline_engine::View;
use plumbline_engine::view::{LEAST_CHECKED, LEAST_TOUCHES, TouchPhase};
use plumbline_model::touch_plan::Purpose;
use plumbline_widgets::format;

use super::super::robot;
use super::super::touch::{done_of, held, measured, touch, wanted, what_moves};
use super::Said;
use crate::operator::{Action, CommissionAction, TouchAction, needs_window};

pub(super) fn placing(view: &View) -> Said {
    let touch = &view.touch;
    if let Some(place) = touch.placement_proposal.as_ref().filter(|_| !is_moving(view)) {
        let (good, said) = measured(place);
        let accept = vec![Action::Touch(TouchAction::AcceptScreen)];
        let said = Said::press(said, "Use this place of the screen", accept);
        return if good { said } else { said.warn() };
    }
    let plan = Said::press(
        "The corners of the screen are touched to measure where it lies. Planning moves nothing.",
        "Plan to touch the corners",
        vec![Action::Commission(CommissionAction::PlanCorners)],
    );
    run(view, Purpose::PlaceScreen, plan)
}

pub(super) fn training(view: &View) -> Said {
    let plan = Said::press(
        "The screen is touched where, and with the hand held as, tells most of what makes the arm miss. Planning moves nothing.",
        "Plan touches to learn from",
        vec![Action::Commission(CommissionAction::PlanTouches)],
    );
    run(view, Purpose::Train, plan)
}

pub(super) fn checking(view: &View) -> Said {
    let with = match view.gap.model.effects.len() {
        0 => "as the robot is described, for nothing was found to be missing",
        _ => "with the model in use",
    };
    let plan = Said::press(
        format!(
            "New places are touched {with}, to see how far the finger misses now. Planning moves nothing."
        ),
        "Plan touches to check",
        vec![Action::Commission(CommissionAction::PlanCheck)],
    );
    run(view, Purpose::Check, plan)
}

fn is_moving(view: &View) -> bool {
    matches!(
        view.touch.phase,
        TouchPhase::Running { .. } | TouchPhase::Waiting { .. } | TouchPhase::Paused { .. }
    )
}

/// That a run for a purpose ended with too few touches to go on with, a sentence.
fn too_few(view: &View, purpose: Purpose) -> Option<String> {
    let touch = &view.touch;
    let least = match purpose {
        Purpose::PlaceScreen => return None,
        Purpose::Train => LEAST_TOUCHES,
        Purpose::Check => LEAST_CHECKED,
    };
    let is_of_it = touch.plan.as_ref().is_some_and(|plan| plan.options.purpose == purpose);
    let count = touch.counts.touched;
    (is_of_it && touch.phase == TouchPhase::Finished && count < least).then(|| {
        format!(
            "{} of the run before are too few: at least {least} are needed.",
            format::count(count, "touch")
        )
    })
}

/// A run for a purpose: planned, begun, waited for.
fn run(view: &View, purpose: Purpose, plan: Said) -> Said {
    let of_view = &view.touch;
    match &of_view.phase {
        TouchPhase::Running { doing, .. } => {
            let (done, all) = (done_of(of_view.counts), wanted(of_view.counts));
            let held = held(of_view.held);
            let why = format!("{done} of {all} touches. The arm is {doing}. Esc or space stops.{held}");
            return Said::wait(why, (all > 0).then(|| done as f64 / all as f64));
        }
        TouchPhase::Waiting { .. } | TouchPhase::Paused { .. } => return touch(view).into(),
        TouchPhase::Planning => {
            return Said::wait("Looks which targets the arm reaches. Nothing moves.", None);
        }
        _ => {}
    }
    if let Some(trouble) = robot::trouble(&view.robot) {
        return trouble.into();
    }
    let planned = of_view.plan.as_ref().filter(|plan| plan.options.purpose == purpose);
    let plan = match too_few(view, purpose) {
        Some(why) => Said { sentence: format!("{why} {}", plan.sentence), ..plan }.warn(),
        None => plan,
    };
    match (&of_view.phase, planned) {
        (TouchPhase::Planned, Some(_)) if needs_window(view) => touch(view).into(),
        (TouchPhase::Planned, Some(planned)) if planned.reachable > 0 => {
            let sentence = what_moves(planned);
            let label = super::super::touch::start_label(planned);
            Said::press(sentence, label, vec![Action::Touch(TouchAction::Start)])
        }
        (TouchPhase::Planned, Some(_)) => touch(view).into(),
        (TouchPhase::Idle, _) => unfinished(view, purpose).unwrap_or(plan),
        _ => plan,
    }
}

/// A run that was begun on this way and not finished, as after a restart: it is gone on with.
fn unfinished(view: &View, purpose: Purpose) -> Option<Said> {
    let began = view.commission.began?;
    let run = view.touch.unfinished.first().filter(|run| run.purpose == purpose && run.started >= began)?;
    let sentence = format!(
        "{} of {} touches were made, then it ended. It goes on exactly where it was; opening moves nothing.",
        run.touched, run.planned
    );
    Some(Said::press(sentence, "Open the unfinished run", vec![Action::Touch(TouchAction::OpenUnfinished)]))
}

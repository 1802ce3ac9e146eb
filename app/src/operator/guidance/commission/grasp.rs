//! The first grasp on the way.

use plumbline_engine::view::{GateState, GraspOutcome, GraspPhase, Need};
use plumbline_engine::{HandStep, View};

use super::super::{grasp, handeye, robot};
use super::Said;
use crate::operator::actions::{FIRST_CLASS, FIRST_PLACE_M};
use crate::operator::words::grasp::{closed, holds};
use crate::operator::{Action, CommissionAction, GraspAction, RobotAction};

/// What lies farther from where it was laid out has rolled away, m.
const ROLLED_M: f64 = 0.03;

pub(super) fn said(view: &View) -> Said {
    let of_view = &view.grasp;
    match &of_view.phase {
        GraspPhase::Idle => {}
        // The button says "Next: " by itself.
        phase if phase.is_paused() => {
            let next = of_view.between().filter(|_| of_view.stops_after_each);
            let Some((next, said)) = next.zip(holds(of_view)) else { return grasp::grasp(view).into() };
            let resume = vec![Action::Grasp(GraspAction::Resume)];
            return Said::press(said, next.next.title().to_lowercase(), resume);
        }
        GraspPhase::Planning => return Said::wait("Looks and plans. Nothing moves.", None),
        _ => return Said::wait(grasp::under_way(of_view), None),
    }
    if let Some(trouble) = robot::trouble(&view.robot) {
        return trouble.into();
    }
    let run = of_view.run.as_ref().filter(|run| run.outcome.is_some());
    let slipped = run.is_some_and(|run| grasp::has_slipped(run));
    let held =
        !slipped && run.is_some_and(|run| run.outcome == Some(GraspOutcome::Success) && run.told.is_none());
    if held {
        return Said::press(
            "The fingers meet something. Look: is it held, or not?",
            "Say that it is held",
            vec![Action::Grasp(GraspAction::Held)],
        );
    }
    if let Some(in_hand) = &of_view.held {
        return grasp::in_hand(view, in_hand, run.map(|run| &**run)).into();
    }
    if let Some(waits) = of_view.hand_waits {
        return grasp::of_waiting(of_view, waits).into();
    }
    let cold = of_view.gates.iter().find(|gate| gate.of == Need::Warmth && gate.state == GateState::Doubtful);
    if let Some(warm) = cold.and_then(|cold| handeye::to_be_warmed(view, cold)) {
        return warm.into();
    }
    if of_view.target.class.as_deref() != Some(FIRST_CLASS) || !is_laid_out(view) {
        return lay_out(view, run.is_some());
    }
    if let Some(trouble) = of_view.trouble() {
        if grasp::has_to_be_held(view) {
            let hold = vec![Action::Robot(RobotAction::TorqueOn)];
            return Said::press("All joints hold where they are.", "Hold all joints", hold);
        }
        return Said::wait(trouble, None).warn();
    }
    let grasps = "Both eyes look for the tomato; then one arm reaches for it, closes the hand and lifts it.";
    let sentence = match run.and_then(|run| run.outcome.as_ref()) {
        _ if slipped => format!("It was held and has slipped out. It is tried once more. {grasps}"),
        Some(GraspOutcome::Failed { why, .. } | GraspOutcome::Refused { why }) => {
            format!("{} It is tried once more. {grasps}", closed(why))
        }
        _ => grasps.to_owned(),
    };
    let sentence = match cold {
        Some(cold) => format!("{} {sentence}", cold.text),
        None => sentence,
    };
    Said::press(sentence, "Grasp the tomato", vec![Action::Grasp(GraspAction::Grasp)])
}

/// On the twin's table, where it was laid; on the robot's a person looks.
fn is_laid_out(view: &View) -> bool {
    if !view.twin.running {
        return true;
    }
    let toy = view.twin.toys.iter().find(|toy| toy.name.eq_ignore_ascii_case(FIRST_CLASS));
    let place = toy.and_then(|toy| toy.place.as_ref());
    view.twin.board.is_none()
        && place.is_some_and(|at| {
            (at.coords.x - FIRST_PLACE_M[0]).hypot(at.coords.y - FIRST_PLACE_M[1]) < ROLLED_M
        })
}

fn lay_out(view: &View, again: bool) -> Said {
    let [x_mm, y_mm] = FIRST_PLACE_M.map(|place_m| (1000.0 * place_m).round());
    let place = format!("{x_mm:.0} mm ahead of the robot and {:.0} mm to its right", -y_mm);
    let lay = Action::Commission(CommissionAction::LayOut);
    if !view.twin.running {
        let sentence = format!("Lay a tomato {place}, and take your hands away. Nothing moves yet.");
        return Said::press(sentence, "The tomato lies there", vec![lay]);
    }
    if again {
        // The hand may hold it, or stand where it is to lie.
        let sentence = format!("The arm goes home; an unseen hand lays the tomato {place}.");
        let home = Action::Grasp(GraspAction::Hand(HandStep::Home));
        return Said::press(sentence, "Lay the tomato out again", vec![home, lay]);
    }
    let sentence = format!("An unseen hand lays the tomato {place}. The robot stays.");
    Said::press(sentence, "Lay the tomato on the table", vec![lay])
}

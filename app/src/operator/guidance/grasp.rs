//! What to do next with grasping: one button, named by what it does.

use plumbline_engine::view::{
    Gate, GateState, GraspHand, GraspOutcome, GraspPhase, GraspRun, GraspView, HandWaits, InHand, JointView,
    LampState, Need, RobotView, SinceHeld, StepNotMade, TrialsPhase,
};
use plumbline_engine::{HandStep, View};
use plumbline_model::robot::Arm;
use plumbline_widgets::format;

use super::robot;
use super::sentence::{Guidance, say};
use crate::operator::words::grasp::{
    again, closed, go_on, held_now, holds, made_room, method, object_of, try_of,
};
use crate::operator::words::robot::{turns_most, whole_degrees};
use crate::operator::words::trials::ask;
use crate::operator::{Action, GraspAction, RobotAction, Screen, TrialsAction, is_under_way};

pub(super) fn grasp(view: &View) -> Guidance {
    let grasp = &view.grasp;
    match &grasp.phase {
        GraspPhase::Planning => say("Looks and plans. Nothing moves."),
        GraspPhase::Grasping { ending: true, .. } => say("Ends; the arm holds where it is."),
        phase if phase.is_paused() => {
            let said = holds(grasp).unwrap_or_else(|| "Paused: the arm holds. Going on moves it.".to_owned());
            say(said).then(go_on(grasp), Action::Grasp(GraspAction::Resume))
        }
        GraspPhase::Grasping { .. } => say(under_way(grasp)).then("Pause", Action::Grasp(GraspAction::Pause)),
        GraspPhase::Hand { step, .. } => say(format!("{}. The arm moves; Esc or space stops.", step.title()))
            .then("Pause", Action::Grasp(GraspAction::Pause)),
        GraspPhase::Idle => idle(view),
    }
}

fn idle(view: &View) -> Guidance {
    let grasp = &view.grasp;
    if let Some(guidance) = experiment(view) {
        return guidance;
    }
    if let Some(trouble) = robot::trouble(&view.robot) {
        return trouble;
    }
    // What is in a hand, or may be, waits for joints that hold.
    if let Some(limp) = limp_of_needed(view) {
        return limp;
    }
    if let Some(held) = &grasp.held {
        return in_hand(view, held, grasp.run.as_deref());
    }
    // All else that is shut goes before: nothing moves then.
    let is_shut = grasp.shut().is_some_and(|gate| gate.of != Need::Hand);
    if let Some(waits) = grasp.hand_waits.filter(|_| !is_shut) {
        return of_waiting(grasp, waits);
    }
    if let Some(trouble) = grasp.trouble() {
        let limp = has_to_be_held(view);
        let guidance = say(trouble).warn();
        return if limp {
            guidance.then("Hold all joints", Action::Robot(RobotAction::TorqueOn))
        } else {
            guidance
        };
    }
    if let Some(away) = made_room(view) {
        return match is_under_way(&view.touch.phase) {
            true => say(away).then("Go to Touch", Action::Go(Screen::Touch)),
            false => {
                let home = RobotAction::ShowHome;
                say(format!("{away} Bring the arm home: its way is shown first."))
                    .then(home.label(), home.into())
            }
        };
    }
    let by = grasp.method.map(method).unwrap_or_default();
    if let Some(plan) = &grasp.plan {
        let most = plan.turns.first().map_or_else(String::new, |(joint, turn_rad)| {
            format!(" {}, {} in all.", turns_most(joint), format::degrees(*turn_rad))
        });
        let label = format!("Grasp {} with {by}", plan.object.to_lowercase());
        let seconds = plan.duration.as_secs();
        let shown = match plan.method.aligns() {
            true => format!("Shown as a ghost.{most} It moves for about {seconds} s, and looks in between."),
            false => format!("Shown as a ghost.{most} It takes about {seconds} s."),
        };
        let guidance = match in_doubt(view) {
            true => say(format!("{shown} Its places are in doubt: the list at the right says why.")).warn(),
            false => say(shown),
        };
        return guidance.then(label, Action::Grasp(GraspAction::Grasp));
    }
    let waits = grasp.run.as_ref().filter(|run| run.outcome.is_some() && run.told.is_none());
    let label = format!("Grasp {} with {by}", object_of(grasp));
    match waits.and_then(|run| run.outcome.as_ref()) {
        Some(GraspOutcome::Success)
            if grasp
                .run
                .as_deref()
                .is_some_and(|run| has_slipped(run) || run.since == SinceHeld::Unknown) =>
        {
            let said = grasp.run.as_deref().map(held_now).unwrap_or_default();
            say(said).warn().then(label, Action::Grasp(GraspAction::Grasp))
        }
        Some(GraspOutcome::Failed { why, .. } | GraspOutcome::Refused { why }) if !grasp.hand_moved => {
            say(closed(why)).warn().then(label, Action::Grasp(GraspAction::Grasp))
        }
        _ => {
            let plan = "Plan shows what would be sent; Grasp plans and moves the arm at once.";
            let guidance = match doubt(view) {
                Some(doubt) => say(format!("{doubt} {plan}")).warn(),
                None => say(plan),
            };
            guidance.then(label, Action::Grasp(GraspAction::Grasp))
        }
    }
}

/// Limp joints of the arm whose hand holds something, or may; of either arm where either may be taken.
fn limp_of_needed(view: &View) -> Option<Guidance> {
    let hand = view.grasp.held.as_ref().map(|held| held.hand).or(view.grasp.may_hold);
    let is_needed = |arm: &&Arm| match hand.or(view.grasp.hand.asked()) {
        Some(hand) => arm.name == hand.name(),
        None => true,
    };
    let arms: Vec<&Arm> = view.robot.rig.as_ref()?.arms.iter().filter(is_needed).collect();
    robot::limp_in_part(&view.robot, |joint| {
        arms.iter().any(|arm| arm.joints.contains(&joint) || arm.hand.contains(&joint))
    })
}

/// What is around something is opened, and lifted straight up; then the arm leaves the picture.
pub(super) fn of_waiting(grasp: &GraspView, waits: HandWaits) -> Guidance {
    if let Some(other) = grasp.not_made.as_ref().and_then(|not_made| instead(not_made, waits)) {
        return other;
    }
    let (sentence, step) = match waits {
        HandWaits::Offers => return held_out(),
        HandWaits::Around => (
            "The hand was stopped where its fingers may be around something: open it first. What it holds falls.",
            HandStep::Open,
        ),
        HandWaits::Carries => (
            "The fingers may carry something. Putting it down lowers the arm and opens the hand.",
            HandStep::Place,
        ),
        HandWaits::Low => (
            "The hand is open and low over the table: lift it straight up, before the arm goes anywhere.",
            HandStep::Lift,
        ),
        HandWaits::InView => (
            "The hand stands in the picture, where it hides what is grasped next: bring it home first.",
            HandStep::Home,
        ),
    };
    say(sentence).warn().then(step.title(), Action::Grasp(GraspAction::Hand(step)))
}

/// The hand opens only once somebody has what it holds.
fn held_out() -> Guidance {
    say("Take what the hand holds out; then open the hand. The fingers open at once, and what nobody has falls.")
        .then(HandStep::Open.title(), Action::Grasp(GraspAction::Hand(HandStep::Open)))
}

/// What is offered where the step that would be offered could not be made; `None`: another was tried.
fn instead(not_made: &StepNotMade, waits: HandWaits) -> Option<Guidance> {
    let (advice, step) = match (waits, not_made.step) {
        (HandWaits::Around, HandStep::Open | HandStep::Place) => {
            ("Lifting takes what the fingers are around along.", HandStep::Lift)
        }
        (HandWaits::Around, HandStep::Lift) => {
            ("The hand opens where it is; what it holds falls.", HandStep::Open)
        }
        (HandWaits::Carries, HandStep::Place) => (
            "Handing over holds it out in front of the robot; the hand opens only when you say so.",
            HandStep::Give,
        ),
        (HandWaits::Carries, HandStep::Give) => {
            ("The hand opens where it is; what it holds falls: hold yours below.", HandStep::Open)
        }
        (HandWaits::Low, HandStep::Lift) => ("The arm goes home from where it is.", HandStep::Home),
        (HandWaits::Low | HandWaits::InView, HandStep::Home) => {
            let said =
                format!("{} was not done: {}. Move the arm there.", not_made.step.title(), not_made.why);
            return Some(say(said).warn().then("Go to Robot", Action::Go(Screen::Robot)));
        }
        _ => return None,
    };
    let said = format!("{} was not done: {}. {advice}", not_made.step.title(), not_made.why);
    Some(say(said).warn().then(step.title(), Action::Grasp(GraspAction::Hand(step))))
}

/// Whether nothing but joints that have to be taken hold of keeps the arm from grasping: every joint is known.
pub(super) fn has_to_be_held(view: &View) -> bool {
    let of_arm = view.grasp.shut().is_some_and(|gate| gate.of == Need::Arm);
    let robot = &view.robot;
    of_arm && robot.unknown.is_empty() && robot.joints.iter().any(JointView::has_to_be_held)
}

/// Whether something speaks against where things are taken to lie.
fn in_doubt(view: &View) -> bool {
    doubt(view).is_some()
}

/// What that is.
fn doubt(view: &View) -> Option<&str> {
    let of_places = |gate: &Gate| matches!(gate.of, Need::Places | Need::Warmth);
    let is_doubt = |gate: &&Gate| of_places(gate) && gate.state == GateState::Doubtful;
    view.grasp.gates.iter().find(is_doubt).map(|gate| gate.text.as_str())
}

/// What is in a hand has to leave it before anything else is grasped.
pub(super) fn in_hand(view: &View, held: &InHand, run: Option<&GraspRun>) -> Guidance {
    let grasp = &view.grasp;
    if grasp.hand_waits == Some(HandWaits::Offers) {
        return held_out();
    }
    let other = grasp.not_made.as_ref().and_then(|not_made| instead(not_made, HandWaits::Carries));
    if let Some(other) = other {
        return other;
    }
    let there = format!("The {} is in the {} hand.", held.object.to_lowercase(), held.hand.name());
    let asked = run.is_some_and(|run| run.outcome == Some(GraspOutcome::Success) && run.told.is_none());
    let then = match asked {
        true => "Say whether you see it held; putting it down lowers the arm and opens the hand.",
        false => "Putting it down lowers the arm and opens the hand.",
    };
    let gives_way = grasp.gives_way_rad.map(|by_rad| {
        format!(
            "Its fingers have bent on by {} since it was grasped: it may slip out.",
            whole_degrees(by_rad)
        )
    });
    let doubts: Vec<String> = gives_way.into_iter().chain(warm_of_holding(&view.robot, held.hand)).collect();
    let said = match doubts.is_empty() {
        true => say(format!("{there} {then}")),
        false => say(format!("{there} {} {then}", doubts.join(" "))).warn(),
    };
    said.then("Put it down", Action::Grasp(GraspAction::Hand(HandStep::Place)))
}

/// That a hand gets warm of what it holds.
fn warm_of_holding(robot: &RobotView, hand: GraspHand) -> Option<String> {
    let rig = robot.rig.as_ref()?;
    let fingers = &rig.arm(hand.name())?.hand;
    let of_hand = robot.joints.iter().filter(|joint| fingers.contains(&joint.joint));
    let warm = of_hand.filter_map(|joint| Some((joint.temperature_c?, joint)));
    let (warmest_c, joint) = warm.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (warmest_c >= rig.gate.warm_c).then(|| {
        let (at_c, hot_c) = (format::fixed(warmest_c, 0), format::fixed(rig.gate.hot_c, 0));
        format!("{} is at {at_c} °C from holding it, and must not come to {hot_c} °C.", joint.title)
    })
}

/// Whether what was held is not in the hand any more.
pub(super) fn has_slipped(run: &GraspRun) -> bool {
    matches!(run.since, SinceHeld::Slipped(_))
}

/// "Grasps tomato with M5, try 2 of 3: approach. The arm moves; Esc or space stops."
pub(super) fn under_way(grasp: &GraspView) -> String {
    let Some(run) = &grasp.run else { return "Grasps. The arm moves; Esc or space stops.".to_owned() };
    if let Some(again) = again(run) {
        return format!("{again} Esc or space stops.");
    }
    let step = run.lamps.iter().find(|(_, lamp)| *lamp == LampState::Lit);
    let step = step.map_or("getting ready", |(step, _)| step.title()).to_lowercase();
    let by = run.method.map(method).unwrap_or_default();
    let which = try_of(run).map_or_else(String::new, |which| format!(", {which}"));
    format!(
        "Grasps {} with {by}{which}: {step}. The arm moves; Esc or space stops.",
        run.object.to_lowercase()
    )
}

/// What a person has to do for the experiment.
fn experiment(view: &View) -> Option<Guidance> {
    let shown = view.trials.shown.as_ref()?;
    match &view.trials.phase {
        TrialsPhase::Asks { at_m, .. } => Some(
            say(ask(&shown.experiment.object, *at_m)).then("Placed", Action::Trials(TrialsAction::Placed)),
        ),
        TrialsPhase::WaitsForWord { .. } => {
            Some(say("Look: is it held? Say Held or Not held; the experiment goes on by itself."))
        }
        TrialsPhase::Running { .. } => Some(
            say(format!(
                "The experiment goes on: {} of {} attempts. The arm moves; Esc or space stops.",
                shown.made, shown.all
            ))
            .then("Pause after this attempt", Action::Trials(TrialsAction::Pause)),
        ),
        TrialsPhase::Idle | TrialsPhase::Paused { .. } => None,
    }
}

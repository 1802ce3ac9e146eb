//! What to do next with the robot and with the mount of its eyes.

use plumbline_engine::view::{
    CaptureHint, Connection, JointView, MotionState, MountView, PoseView, Preview, RobotView, SourceStatus,
    StepState, TourWaits,
};
use plumbline_engine::{SourceSpec, View};
use plumbline_model::robot::JointIndex;
use plumbline_widgets::format;

use super::onward;
use super::sentence::{Guidance, say};
use crate::operator::actions::would_drop;
use crate::operator::words::eyes::still_cold;
use crate::operator::words::mount;
use crate::operator::words::robot::{BY_STOP, is_close, is_limp, move_sentence, moved_name, silent_together};
use crate::operator::{Action, MountAction, RobotAction, Screen};

/// A move that turns no joint by half a degree is said to be a small one, rad.
const LITTLE_RAD: f64 = 8.7e-3;
/// A joint this near to where a pose has it stands in the pose: servos give way by a degree or two, rad.
const IN_POSE_RAD: f64 = 0.05;
/// A pose of at least so many joints is one of arms.
const POSE_OF_ARMS: usize = 6;
/// A move that turns no joint by more than this is none, rad.
const NO_WAY_RAD: f64 = 2e-3;
/// Less than that beyond a limit nobody sees, rad.
const BEYOND_RAD: f64 = 0.005;

/// What keeps the robot from being moved; `None` when it is connected and stands.
pub(super) fn trouble(robot: &RobotView) -> Option<Guidance> {
    let connect = Action::Robot(RobotAction::Connect);
    match &robot.connection {
        Connection::None => {
            Some(say("No robot is connected; connecting moves nothing.").then("Connect the robot…", connect))
        }
        Connection::Connecting { to, doing } => Some(say(format!("Connecting to {to}: {doing}."))),
        Connection::Lost { reason, .. } => {
            Some(say(reason.clone()).warn().then("Connect the robot…", connect))
        }
        Connection::Connected { .. } => moving(robot).or_else(|| silent(robot)),
    }
}

/// No servo answers, or some joint is not known: what that means comes before anything else.
fn silent(robot: &RobotView) -> Option<Guidance> {
    if robot.motion == MotionState::Unknown
        && let Some(warning) = robot.bus.warnings.first()
    {
        return Some(say(warning.clone()).warn());
    }
    None
}

/// A joint that has to be taken hold of anew, or is not known.
fn joint_trouble(robot: &RobotView) -> Option<Guidance> {
    let troubled = |joint: &&plumbline_engine::view::JointView| joint.let_go || joint.no_force;
    let joint = robot
        .joints
        .iter()
        .find(|joint| robot.unknown.contains(&joint.joint))
        .or_else(|| robot.joints.iter().find(troubled))?;
    let guidance = say(format!("{}: {}", joint.title, closed(joint.problem.as_deref()?))).warn();
    Some(if robot.unknown.contains(&joint.joint) {
        guidance
    } else {
        guidance.then("Hold all joints", Action::Robot(RobotAction::TorqueOn))
    })
}

/// A joint that was held and fell silent: it is waited for until it answers, then taken hold of.
pub(super) fn let_go(robot: &RobotView) -> Option<Guidance> {
    let joint = robot.joints.iter().find(|joint| joint.let_go)?;
    let guidance = say(format!("{}: {}", joint.title, closed(joint.problem.as_deref()?))).warn();
    let answers = !robot.unknown.contains(&joint.joint);
    Some(if answers {
        guidance.then("Hold all joints", Action::Robot(RobotAction::TorqueOn))
    } else {
        guidance
    })
}

/// The same where it answers again, so that it can be taken hold of: nothing goes on before that. One that is still
/// silent stops only what needs it, and is said there.
pub(super) fn to_take_hold_of(robot: &RobotView) -> Option<Guidance> {
    limp(robot).or_else(|| let_go(robot).filter(|guidance| guidance.next.is_some()))
}

/// No joint holds: whatever moves has to wait until they do.
pub(super) fn limp(robot: &RobotView) -> Option<Guidance> {
    is_limp(robot).then(|| {
        let held = beyond(robot).unwrap_or_else(|| "They are held where they stand then.".to_owned());
        say(format!("The joints are limp: they can be turned by hand, and sink. {held}"))
            .warn()
            .then("Hold all joints", Action::Robot(RobotAction::TorqueOn))
    })
}

/// Some joints are limp and others hold: they give way, and no move begins with them.
pub(super) fn limp_in_part(robot: &RobotView, of: impl Fn(JointIndex) -> bool) -> Option<Guidance> {
    let limp: Vec<&str> = (robot.joints.iter())
        .filter(|joint| joint.torque_on == Some(false) && of(joint.joint))
        .map(|joint| joint.title.as_str())
        .collect();
    let (said, held) = match limp.as_slice() {
        [] => return None,
        [one] => (format!("{one} is limp: it gives way, and sinks."), "Held, it stays where it is."),
        several => (
            format!("{} are limp: they give way, and sink.", format::count(several.len(), "joint")),
            "Held, they stay where they are.",
        ),
    };
    let then = if robot.stopped { "Release STOP first." } else { held };
    let guidance = say(format!("{said} {then}")).warn();
    Some(guidance.then("Hold all joints", Action::Robot(RobotAction::TorqueOn)))
}

/// Which joints turn when they are taken hold of: no servo holds beyond its limits.
fn beyond(robot: &RobotView) -> Option<String> {
    let off = |joint: &JointView| joint.angle_rad.map(|angle_rad| joint.limits.excess_rad(angle_rad));
    let far = |joint: &&JointView| off(joint).is_some_and(|rad| rad.abs() > BEYOND_RAD);
    let said: Vec<String> = robot
        .joints
        .iter()
        .filter(far)
        .filter_map(|joint| Some(format!("{} by {}", joint.title, format::degrees(off(joint)?.abs()))))
        .collect();
    let others = "the others are held where they stand";
    (!said.is_empty()).then(|| {
        format!("Held, what sank beyond its limit turns back to it ({}); {others}.", said.join(", "))
    })
}

fn moving(robot: &RobotView) -> Option<Guidance> {
    let MotionState::Moving { what, fraction, remaining } = &robot.motion else { return None };
    if robot.rests_on_the_way {
        return Some(say(format!("Paused in the middle of {what}: the arm holds. Going on moves it.")));
    }
    let far = fraction.map_or_else(String::new, |part| format!(", {}", format::percent(part)));
    let left = remaining.map_or_else(String::new, |left| format!(", {}", format::time_left(left)));
    let moving = if what == "jogging" { "Jogging".to_owned() } else { format!("Moving {what}") };
    Some(say(format!("{moving}{far}{left}. Esc or space stops.")))
}

pub(super) fn robot(view: &View) -> Guidance {
    let robot = &view.robot;
    if let Some(guidance) = trouble(robot) {
        return with_way_back(guidance, view);
    }
    // What gives way goes before what is shown, and before why that was refused. What lost its torque says more itself.
    let has_no_problem =
        |joint: JointIndex| robot.joints.iter().any(|one| one.joint == joint && one.problem.is_none());
    if let Some(guidance) = limp(robot).or_else(|| limp_in_part(robot, has_no_problem)) {
        return guidance;
    }
    // Nothing moves before they are heard.
    if let Some(silent) = silent_together(robot) {
        return say(silent).warn();
    }
    if let Some(preview) = &robot.preview {
        return shown(preview, view);
    }
    if let Some(why) = &robot.refusal {
        return say(why.clone()).warn();
    }
    if let Some(guidance) = joint_trouble(robot) {
        return guidance;
    }
    match &robot.motion {
        // Once it is released nobody has to be told what he did.
        MotionState::Holding { why: Some(why) } if robot.stopped || !why.starts_with(BY_STOP) => {
            say(format!("Holds where it stands: {} Show a move, or jog.", closed(why))).warn()
        }
        _ => {
            let said = "Drag a joint or choose a pose: it is shown first, and moves only when you say so.";
            let stands = stands_in(robot).map(|pose| format!("It stands in the pose {}.", pose.title));
            let all = [stands, carried(view), Some(said.to_owned())];
            say(all.into_iter().flatten().collect::<Vec<_>>().join(" "))
        }
    }
}

/// The pose in which the robot stands, the first of those offered. That of a hand, or of the head, says nothing of the arms.
fn stands_in(robot: &RobotView) -> Option<&PoseView> {
    robot.poses.iter().find(|pose| {
        let joints: Vec<JointIndex> = pose.joints.iter().map(|(joint, _)| *joint).collect();
        let measured = robot.known(&joints).filter(|_| joints.len() >= POSE_OF_ARMS);
        measured.is_some_and(|measured| {
            pose.joints.iter().all(|(joint, rad)| (measured[*joint] - rad).abs() < IN_POSE_RAD)
        })
    })
}

/// What a hand holds, or may, goes along with whatever the arm does.
fn carried(view: &View) -> Option<String> {
    let grasp = &view.grasp;
    match (&grasp.held, grasp.may_hold) {
        (Some(held), _) => {
            let object = held.object.to_lowercase();
            Some(format!("The {} hand holds the {object}, which goes along.", held.hand.name()))
        }
        (None, Some(hand)) => Some(format!("The {} hand may hold something, which goes along.", hand.name())),
        (None, None) => None,
    }
}

/// What is shown and would be gone.
pub(super) fn shown_move(view: &View) -> Option<Guidance> {
    let robot = &view.robot;
    let stands = robot.connection.is_connected() && !matches!(robot.motion, MotionState::Moving { .. });
    let preview = robot.preview.as_ref().filter(|_| stands)?;
    // What is in the hand comes first there.
    would_drop(view, &preview.end).is_none().then(|| shown(preview, view))
}

/// What the move does; one that passes close by something is no matter of course.
fn shown(preview: &Preview, view: &View) -> Guidance {
    if let Some(why) = would_drop(view, &preview.end) {
        return say(format!("Shown as a ghost, and not made: {why}."))
            .warn()
            .then("Go to Grasp", Action::Go(Screen::Grasp));
    }
    let turn_rad = preview.largest_turn.as_ref().map_or(0.0, |(_, by_rad)| by_rad.abs());
    if turn_rad < LITTLE_RAD && preview.path.is_ok() {
        let there =
            say(format!("Shown as a ghost: {}. The joints stand there, to half a degree.", preview.title));
        return match turn_rad < NO_WAY_RAD {
            true => there,
            false => there.then(moved_name(preview), Action::Robot(RobotAction::Move)),
        };
    }
    let guidance = say(move_sentence(preview)).then(moved_name(preview), Action::Robot(RobotAction::Move));
    if is_close(preview) { guidance.warn() } else { guidance }
}

/// Screens with a scene can show a move too; it is run and watched there as well.
pub(super) fn under_way(view: &View) -> Option<Guidance> {
    let robot = &view.robot;
    if !robot.connection.is_connected() || view.mount.step == StepState::Running {
        return None;
    }
    moving(robot).map(|guidance| with_way_back(guidance, view)).or_else(|| shown_move(view))
}

/// Where a grasp holds in the middle, it is gone on with, or ended, on its own screen.
fn with_way_back(guidance: Guidance, view: &View) -> Guidance {
    let is_paused = view.robot.rests_on_the_way && view.grasp.phase.is_paused();
    if is_paused && guidance.next.is_none() {
        guidance.then("Back to the grasp", Action::Go(Screen::Grasp))
    } else {
        guidance
    }
}

pub(super) fn mount(view: &View) -> Guidance {
    let mount = &view.mount;
    let connected = view.robot.connection.is_connected();
    if connected && mount.step == StepState::Running {
        return say(format!("{} Esc or space stops.", next_or(view, "Work on the mount is under way.")));
    }
    if let Some(guidance) = trouble(&view.robot) {
        return guidance;
    }
    if let Some(guidance) = to_take_hold_of(&view.robot) {
        return guidance;
    }
    let stale = match &mount.step {
        StepState::Stale { why } => Some(why),
        _ => None,
    };
    if view.eyes.in_use.is_none() {
        let first = "Calibrate the eyes first: how they sit in the head rests on their lenses.";
        let guidance = stale.map_or_else(|| say(first), |why| say(why.clone()).warn());
        return guidance.then("Calibrate the eyes", Action::Go(Screen::Collect));
    }
    let colder = mount.views.iter().filter(|view| view.is_colder).count();
    if colder > 0 {
        let (views, were) =
            (format::count(mount.views.len(), "view"), if colder == 1 { "was" } else { "were" });
        let said = format!(
            "{colder} of {views} {were} taken while the eyes were colder. They turn while they warm up: these do not go with the others."
        );
        let colder = format::count(colder, "view");
        let delete = Action::Mount(MountAction::DeleteColder);
        return say(said).warn().then(format!("Delete {colder} of colder eyes"), delete);
    }
    if let Some(why) = mount.proposal_stale.as_ref().filter(|_| mount.views.len() >= MountView::LEAST_VIEWS) {
        let views = format::count(mount.views.len(), "view");
        return say(why.clone()).then(format!("Solve {views} again"), Action::Mount(MountAction::Solve));
    }
    if let Some(proposal) = mount.proposal.as_ref().filter(|_| mount.proposal_stale.is_none()) {
        let (good, verdict) = mount::verdict(proposal);
        let said = say(format!("Solved. {verdict}"));
        let said = if good { said } else { said.warn() };
        return said.then("Accept the mount", Action::Mount(MountAction::Accept));
    }
    if !mount.planned.is_empty() {
        let poses = format::count(mount.planned.len(), "pose");
        let said = next_or(view, &format!("The head turns to {poses} and looks at each; the arms stay."));
        return say(format!("{said}{}", still_cold(&view.eyes)))
            .then(format!("Turn the head to {poses}"), Action::Mount(MountAction::Tour));
    }
    if mount.views.len() >= MountView::LEAST_VIEWS && !mount.is_solved {
        let views = format::count(mount.views.len(), "view");
        return say(next_or(view, &format!("{views} taken. Next: solve.")))
            .then(format!("Solve {views}"), Action::Mount(MountAction::Solve));
    }
    if let Some(guidance) = onward::after_the_mount(view, "The mount of the eyes is in use.") {
        return guidance;
    }
    let told = |then: String| match stale {
        Some(why) => say(format!("{why} {then}")).warn(),
        None => say(then),
    };
    if view.twin.running && !view.twin.has_lying_board() {
        let lies = "The board has to lie where both eyes see it; the head turns, the board stays.";
        return told(lies.to_owned())
            .then("Lay the board on the table", Action::Robot(RobotAction::LayBoard));
    }
    let lay = "Lay the board where both eyes see it and leave it there. Then plan: nothing moves yet.";
    told(format!("{}{}", next_or(view, lay), still_cold(&view.eyes)))
        .then("Plan head poses", Action::Mount(MountAction::Plan))
}

/// The engine's own sentence, where it has one.
fn next_or(view: &View, otherwise: &str) -> String {
    if view.mount.next.is_empty() { otherwise.to_owned() } else { view.mount.next.clone() }
}

/// The twin's board is shown at places, or was and is not at all of them.
pub(super) fn board_on_its_way(view: &View, pairs: usize) -> Option<Guidance> {
    let twin = &view.twin;
    if !twin.running {
        return None;
    }
    let so_far = format::count(pairs, "pair");
    // It goes on without anybody who looks.
    if let Some(tour) = twin.board_tour.filter(|_| view.source.spec != Some(SourceSpec::Twin)) {
        let at = format!("The board is at place {} of {}: {so_far} collected.", tour.place, tour.of);
        let instead = match &view.source.spec {
            None => "the twin's eyes are closed",
            Some(_) => "another source is shown, not the twin's eyes",
        };
        return Some(
            say(format!("{at} Nobody looks at it there: {instead}."))
                .warn()
                .then("Look through the twin's eyes", Action::Robot(RobotAction::TwinEyes)),
        );
    }
    if view.source.status != SourceStatus::Running {
        return None;
    }
    if let Some(tour) = twin.board_tour {
        let how = match view.eyes.auto_capture {
            true => format!("{so_far} captured by themselves"),
            false => format!("{so_far} collected, none is captured by itself"),
        };
        let at = format!("The board is at place {} of {}: {how}.", tour.place, tour.of);
        let Some(waits) = tour.waits else { return Some(say(format!("{at} Esc or space ends it."))) };
        let skip = RobotAction::SkipPlace;
        return Some(
            say(format!("{at} It waits {}", waits_for(waits, view))).then(skip.label(), Action::Robot(skip)),
        );
    }
    // With enough pairs the rest of the places is left to the operator's choice: they can be solved.
    let goes_on = twin.board_places_left > 0 && twin.board.is_some() && pairs < super::ENOUGH_PAIRS;
    goes_on.then(|| {
        let left = format::count(twin.board_places_left, "place");
        say(format!("{so_far} collected; the board was not shown at {left} yet."))
            .then(RobotAction::TourRest.label(), Action::Robot(RobotAction::TourRest))
    })
}

/// "until …", with which eye does not see the board there.
fn waits_for(waits: TourWaits, view: &View) -> String {
    let until = match waits {
        TourWaits::Look => "until it is looked for: this computer has much to do.",
        TourWaits::Sight => "until both eyes see it sharp and still.",
    };
    match &view.eyes.hint {
        Some(hint @ CaptureHint::NotSeen { .. }) => format!("{until} {}", super::hint_text(hint)),
        _ => until.to_owned(),
    }
}

/// With the twin, showing it the board is the first step of calibrating its eyes.
pub(super) fn board_of_the_twin(view: &View) -> Option<Guidance> {
    let first = view.twin.running && view.twin.board.is_none() && view.twin.board_places > 0;
    first.then(|| {
        let shows =
            "An unseen hand shows the twin the board at all places; pairs are captured by themselves.";
        say(format!("{shows}{}", still_cold(&view.eyes)))
            .then("Show the board at all places", Action::Robot(RobotAction::TourBoard))
    })
}

/// With a full stop at its end.
fn closed(text: &str) -> String {
    format!("{}.", text.trim_end_matches('.'))
}

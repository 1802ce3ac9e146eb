//! What is happening and what to do next, in one sentence and one button.

mod commission;
mod detect;
mod drift;
mod gap;
mod grasp;
mod handeye;
mod judged;
mod models;
mod onward;
mod robot;
mod sentence;
mod standing;
mod timeline;
mod touch;

pub use commission::{Course, Press, course, done_in_words, name as commission_name, spent};
pub use gap::is_of_choice;
pub use onward::way_to;
pub use sentence::Guidance;
pub use touch::{
    check_in_words, done_of, go_on, is_screen_to_be_decided, minutes, waiting_touch, wanted, what_moves,
};

use plumbline_engine::view::{CaptureHint, Connection, EyesView, GhostBoard, Proposal, SourceStatus};
use plumbline_engine::{SourceSpec, View};
use plumbline_widgets::format;

use super::words::eyes::still_cold;
use super::words::more_doubts;
use super::words::robot::is_limp;
use super::{Action, CommissionAction, RobotAction, Screen, faults};
use sentence::say;

/// Fewest pairs that are worth solving without asking for more.
pub const ENOUGH_PAIRS: usize = 10;

/// The bottom line of a screen.
pub fn guidance(view: &View, screen: Screen) -> Guidance {
    if let Some(guidance) = failed_inside(view, screen) {
        return guidance;
    }
    if let Some(guidance) = stopped(view, screen) {
        return guidance;
    }
    // Limp joints sink, whatever else there is to do.
    let uses_arm = matches!(screen, Screen::Commission | Screen::HandEye);
    if let Some(guidance) = robot::limp(&view.robot).filter(|_| uses_arm) {
        return guidance;
    }
    let with_scene = matches!(screen, Screen::Live | Screen::Mount);
    if let Some(guidance) = robot::under_way(view).filter(|_| with_scene) {
        return guidance;
    }
    // A move that is shown in the scene can be gone where it is shown, and be forgotten below the scene.
    let may_show = matches!(screen, Screen::Commission | Screen::HandEye | Screen::Grasp);
    let rests = view.running_job().is_none() && !view.grasp.phase.is_paused();
    if let Some(guidance) = robot::shown_move(view).filter(|_| may_show && rests) {
        return guidance;
    }
    match screen {
        Screen::Commission => commissioning(view),
        Screen::Live => live(view),
        Screen::Collect => collect(view),
        Screen::Judge => judged::judge(view),
        Screen::Accept => judged::accept(view),
        Screen::Mount => robot::mount(view),
        Screen::Touch => touch::touch(view),
        Screen::Models => models::models(view),
        Screen::Gap => gap::gap(view),
        Screen::HandEye => handeye::handeye(view),
        Screen::Grasp => grasp::grasp(view),
        Screen::Drift => drift::drift(view),
        Screen::Timeline => timeline::timeline(view),
        Screen::Robot => robot::robot(view),
        Screen::Scores => detect::scores(view),
        Screen::Images => detect::images(view),
    }
}

/// A part of the program has failed, and what starts it again.
pub fn failed_inside(view: &View, screen: Screen) -> Option<Guidance> {
    let fault = faults::most_urgent(view, screen)?;
    let guidance = say(&*fault.meaning).warn();
    // Where it cannot be started again the sentence says what to do instead.
    let again = fault.can_start_again || !fault.is_silent();
    Some(if again { guidance.then("Start again", Action::StartAgain(fault.thread)) } else { guidance })
}

/// What only looks goes on while STOP is latched; what moves says so.
fn stopped(view: &View, screen: Screen) -> Option<Guidance> {
    let moves = matches!(
        screen,
        Screen::Commission
            | Screen::Live
            | Screen::Mount
            | Screen::Touch
            | Screen::HandEye
            | Screen::Grasp
            | Screen::Robot
    );
    let connected = view.robot.connection.is_connected();
    (moves && connected && view.robot.stopped).then(|| say(stopped_words(view)).warn())
}

/// What STOP means just now: limp joints sink all the same.
fn stopped_words(view: &View) -> &'static str {
    match is_limp(&view.robot) {
        true => {
            "Stopped, and the joints are limp: they sink where nobody holds them. Press Release STOP, at the top right, then hold all joints."
        }
        false => "Stopped: nothing moves until you press Release STOP, at the top right.",
    }
}

/// What is wrong or not yet there with the source; `None` when it delivers.
fn source_trouble(view: &View) -> Option<Guidance> {
    match &view.source.status {
        SourceStatus::None if view.twin.running => Some(
            say("The twin runs; its eyes are closed.")
                .then("Look through the twin's eyes", Action::Robot(RobotAction::TwinEyes)),
        ),
        SourceStatus::None if matches!(view.robot.connection, Connection::Connecting { .. }) => {
            robot::trouble(&view.robot)
        }
        SourceStatus::None => Some(
            say("No images yet: open a folder of pairs, or drop one on the window.")
                .then("Open a folder of pairs…", Action::OpenFolder),
        ),
        SourceStatus::Opening => Some(say("Opening the source.")),
        SourceStatus::Lost { reason, .. } => {
            Some(say(reason.clone()).warn().then("Try again", Action::RetrySource))
        }
        SourceStatus::Running | SourceStatus::Paused | SourceStatus::Ended => None,
    }
}

/// Where the calibration of the eyes in use does not hold: why, and what to do.
fn eyes_off(view: &View) -> Option<Guidance> {
    let why = view.eyes.health.does_not_hold.as_ref()?;
    Some(say(why.clone()).warn().then("Calibrate the eyes again", Action::Go(Screen::Collect)))
}

/// Before the operator is led; then the course says what comes next.
fn commissioning(view: &View) -> Guidance {
    let commission = &view.commission;
    if let Some(course) = course(view) {
        let guidance = say(course.sentence);
        return if course.warning { guidance.warn() } else { guidance };
    }
    if !commission.is_known {
        return say("Looks how far commissioning is.");
    }
    let start = Action::Commission(CommissionAction::Start);
    match commission.began {
        _ if commission.is_done() => match &view.grasp.held {
            Some(held) => grasp::in_hand(view, held, None),
            None => say("All steps are done.").then("Grasp", Action::Go(Screen::Grasp)),
        },
        Some(_) => say("Commissioning goes on where it was. The button moves nothing.")
            .then("Next: go on with commissioning", start),
        None => {
            say("Eight steps lead to the first good grasp, each with one button. This one moves nothing.")
                .then("Next: begin commissioning", start)
        }
    }
}

fn live(view: &View) -> Guidance {
    if let Some(guidance) = source_trouble(view) {
        return guidance;
    }
    if view.eyes.in_use.is_none() && view.twin.running {
        return say(
            "This is the twin, a simulated robot: nothing real moves. Try first: calibrate its eyes, by clicks.",
        )
        .then("Calibrate the eyes", Action::Go(Screen::Collect));
    }
    if view.eyes.in_use.is_none() {
        return say("The eyes are not calibrated, so nothing can be measured yet.")
            .then("Calibrate the eyes", Action::Go(Screen::Collect));
    }
    if let Some(guidance) = eyes_off(view) {
        return guidance;
    }
    if let Some(guidance) = onward::after_the_eyes(view, "The eyes are calibrated.") {
        return guidance;
    }
    match view.source.replay {
        Some(replay) if !replay.playing => {
            say("Held still. Point at an image to read where things are.").then("Play", Action::PlayPause)
        }
        _ => say("Point at an image to read where things are; click to keep the point."),
    }
}

fn collect(view: &View) -> Guidance {
    let eyes = &view.eyes;
    let count = eyes.collected.len() - dropped(eyes);
    if let Some(proposal) = eyes.proposal.as_ref().filter(|p| p.stale.is_none()) {
        return say(format!("Solved. {}", verdict(proposal).sentence))
            .then("Judge the result", Action::Go(Screen::Judge));
    }
    if let Some(seen) = eyes.board_seen.as_ref().filter(|_| eyes.collected.is_empty())
        && let Some((columns, rows)) = other_board(eyes)
    {
        let label = format!("Use {columns}×{rows} squares");
        return say(seen.text.clone()).warn().then(label, Action::UseSeenBoard);
    }
    if let Some(guidance) = robot::board_on_its_way(view, count) {
        return guidance;
    }
    if eyes.collected.is_empty() {
        if let Some(guidance) = source_trouble(view) {
            return guidance;
        }
        if let Some(guidance) = robot::board_of_the_twin(view) {
            return guidance;
        }
        let (columns, rows) = eyes.board.squares();
        let square_mm = eyes.board.square_m * 1000.0;
        return say(format!(
            "The board is {columns}×{rows} squares of {square_mm} mm: check that, then collect.{}",
            still_cold(eyes)
        ))
        .then(collect_label(view), collect_action(view));
    }
    // The twin's board was shown everywhere it can be held, or a tour of it was broken off; nobody can hold it
    // to the outline.
    let twin = &view.twin;
    let toured = twin.running && (twin.board.is_none() || twin.board_places_left > 0);
    let enough = count >= ENOUGH_PAIRS && (eyes.ghost.is_none() || toured);
    if eyes.is_solved_in_use
        && let Some(why) = &eyes.health.does_not_hold
    {
        // What was taken before tells how the eyes were then.
        return say(format!("{why} Delete these pairs and take new ones."))
            .warn()
            .then("Delete all pairs", Action::DeleteAll);
    }
    if eyes.is_solved_in_use {
        let said = format!(
            "The calibration in use was solved from {}.",
            match count {
                1 => "this pair".to_owned(),
                _ => format!("these {}", format::count(count, "pair")),
            }
        );
        return onward::after_the_eyes(view, &said).unwrap_or_else(|| {
            say(format!("{said} Collect more only to solve again."))
                .then("Go to Live", Action::Go(Screen::Live))
        });
    }
    // A few pairs may have been taken one by one; nobody can hold the twin's board to the outline.
    if count < ENOUGH_PAIRS
        && view.source.replay.is_none()
        && let Some(guidance) = robot::board_of_the_twin(view)
    {
        return guidance;
    }
    if enough || view.source.replay.is_some() || view.source.status == SourceStatus::None {
        let said = if count < ENOUGH_PAIRS {
            format!("{}: {ENOUGH_PAIRS} or more are better.", format::count(count, "pair"))
        } else {
            format!("{} collected. Next: solve them.", format::count(count, "pair"))
        };
        return say(said).then(format!("Solve {}", format::count(count, "pair")), Action::Solve);
    }
    let wanted = wanted_board(view).map_or_else(String::new, |g| format!(" Next: {}.", g.reason));
    say(format!(
        "{} collected. {}{wanted}",
        format::count(count, "pair"),
        capture_waits_for(view).unwrap_or_default()
    ))
    .then("Capture pair", Action::Capture)
}

/// Whether a person holds the board before the eyes: not where it is shown by the twin, or was shown to a recording.
pub fn is_held_by_a_person(view: &View) -> bool {
    view.source.replay.is_none() && view.source.spec != Some(SourceSpec::Twin)
}

/// Where a person is to hold the board next; `None`: nowhere in particular, or nobody holds it.
pub fn wanted_board(view: &View) -> Option<&GhostBoard> {
    view.eyes.ghost.as_deref().filter(|_| is_held_by_a_person(view))
}

/// What capturing waits for, as a sentence for who collects.
pub fn capture_waits_for(view: &View) -> Option<String> {
    let hint = view.eyes.hint.as_ref()?;
    Some(match hint {
        CaptureHint::NothingNew if !is_held_by_a_person(view) => "The board has been here.".to_owned(),
        hint => hint_text(hint),
    })
}

/// Squares of the board that was recognized, if it is not the chosen one.
pub fn other_board(eyes: &EyesView) -> Option<(u32, u32)> {
    let seen = eyes.board_seen.as_ref()?.inner_corners?;
    let chosen = (eyes.board.inner_columns, eyes.board.inner_rows);
    ((seen.columns, seen.rows) != chosen).then_some((seen.columns + 1, seen.rows + 1))
}

fn collect_label(view: &View) -> String {
    match view.source.replay {
        Some(replay) if view.source.photographs => {
            format!("Use all {} of this folder", format::count(replay.length as usize, "pair"))
        }
        Some(_) => "Use all pairs of this recording".to_owned(),
        None => "Capture pair".to_owned(),
    }
}

fn collect_action(view: &View) -> Action {
    if view.source.replay.is_some() { Action::CollectRecording } else { Action::Capture }
}

/// What capturing waits for, as a sentence.
pub fn hint_text(hint: &CaptureHint) -> String {
    match hint {
        CaptureHint::NotSeen { eyes } => match eyes.as_slice() {
            [eye] => format!("The {eye} eye does not see the board."),
            _ => "Neither eye sees the board.".to_owned(),
        },
        CaptureHint::Moving { .. } => "Hold the board still.".to_owned(),
        CaptureHint::Blurred { .. } => "The image is blurred: more light, or hold it still.".to_owned(),
        CaptureHint::NothingNew => "The board has been here: move it to the outline.".to_owned(),
        CaptureHint::Ready => "Ready to capture.".to_owned(),
        CaptureHint::Captured { pair } => format!("Captured as {pair}."),
    }
}

/// Pairs among the collected ones that the next solution leaves out.
pub fn dropped(eyes: &EyesView) -> usize {
    eyes.collected.iter().filter(|pair| eyes.dropped.contains(&pair.name)).count()
}

/// Whether to accept a proposal, in words for an operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Nothing speaks against it.
    pub good: bool,
    /// "Good: …" or "Do not accept: …".
    pub sentence: String,
}

/// The verdict on a proposal.
pub fn verdict(proposal: &Proposal) -> Verdict {
    if let Some(doubt) = proposal.doubts.first() {
        let more = more_doubts(proposal.doubts.len() - 1);
        return Verdict { good: false, sentence: format!("Do not accept: {doubt}{more}") };
    }
    let sentence = match &proposal.calibration.summary {
        Some(summary) => {
            let pairs = proposal.calibration.per_pair.len();
            let error_px = summary.cross_validated_px.unwrap_or(summary.rms_stereo_px);
            let kind =
                if summary.cross_validated_px.is_some() { "on unseen pairs" } else { "on its own pairs" };
            let agree = match pairs {
                1 => "1 pair agrees".to_owned(),
                pairs => format!("{} agree", format::count(pairs, "pair")),
            };
            format!(
                "Good: {agree} to {error_px:.3} px {kind}, and the board's squares measure {:.2} mm.",
                summary.square_mean_m * 1000.0
            )
        }
        None => "Good as far as the file tells: it says nothing about how it was made.".to_owned(),
    };
    Verdict { good: true, sentence }
}

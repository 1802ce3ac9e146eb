//! What to do next with touching the screen: one button, named by what it does.

use plumbline_engine::view::{
    Figure, ModelStep, PlanView, StepState, Subject, TouchCounts, TouchFigures, TouchOutcome, TouchPhase,
    TouchView,
};
use plumbline_engine::{Correction, View};
use plumbline_model::touch_plan::{Finger, Purpose};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_widgets::format;

use super::onward::to_grasping;
use super::robot;
use super::sentence::{Guidance, say};
use crate::operator::actions::full_hand;
use crate::operator::snapshot::models::FEWEST_FOR_A_NETWORK;
use crate::operator::words::grasp::is_on_twin;
use crate::operator::words::proof::{Proof, Worth, model_was_better};
use crate::operator::words::{self, capitalized, sentence};
use crate::operator::{Action, Preset, Screen, TouchAction, is_under_way, needs_window};

pub(super) fn touch(view: &View) -> Guidance {
    let touch = &view.touch;
    match &touch.phase {
        TouchPhase::Running { number, doing } => running(touch, number.is_some(), doing),
        TouchPhase::Waiting { what, prepare } => {
            robot::limp(&view.robot).unwrap_or_else(|| waiting(what, prepare.is_some()))
        }
        _ => {
            if let Some(trouble) = robot::trouble(&view.robot)
                .or_else(|| robot::to_take_hold_of(&view.robot))
                .or_else(|| robot::under_way(view))
            {
                return trouble;
            }
            standing(view)
        }
    }
}

/// The arm stands: what begins, or goes on, or is read.
fn standing(view: &View) -> Guidance {
    let touch = &view.touch;
    if let (TouchPhase::Planned | TouchPhase::Paused { .. }, Some(why)) = (&touch.phase, full_hand(view)) {
        return say(sentence(&why)).warn().then("Go to Grasp", Action::Go(Screen::Grasp));
    }
    match &touch.phase {
        TouchPhase::Planning => say("Looks which targets the arm reaches. Nothing moves."),
        TouchPhase::Planned | TouchPhase::Paused { .. } if needs_window(view) => {
            say("The touch window shows the targets and feels the touches: it has to fill the touch monitor.")
                .then("Open the touch window", Action::Touch(TouchAction::ToggleWindow))
        }
        TouchPhase::Planned => touch.plan.as_deref().map_or_else(|| first(view), |plan| planned(view, plan)),
        TouchPhase::Paused { why } => paused(touch, why.as_deref()),
        TouchPhase::Finished => finished(view),
        _ => first(view),
    }
}

fn running(touch: &TouchView, is_left: bool, doing: &str) -> Guidance {
    let (done, wanted) = (done_of(touch.counts), wanted(touch.counts));
    let left = touch.remaining.map_or_else(String::new, |left| format!(" {}.", format::time_left(left)));
    let held = held(touch.held);
    let guidance =
        say(format!("{done} of {wanted} done. The arm is {doing}.{left} Esc or space stops.{held}"));
    // Once no touch is left the run ends by itself.
    if is_left { guidance.then("Pause", Action::Touch(TouchAction::Pause)) } else { guidance }
}

/// That the arm stood still by itself, and why: " It held 3 times because …"; empty where it did not.
pub(super) fn held(times: usize) -> String {
    match times {
        0 => String::new(),
        times => format!(
            " It held {} because this computer was too busy to hear the joints, and went on by itself.",
            if times == 1 { "once".to_owned() } else { format!("{times} times") }
        ),
    }
}

fn waiting(what: &str, prepare: bool) -> Guidance {
    let guidance = say(what).warn();
    if prepare {
        guidance.then("Done, go on", Action::Touch(TouchAction::Prepared))
    } else {
        guidance.then("Try again", Action::Touch(TouchAction::Resume))
    }
}

/// What moves, and what stays.
pub fn what_moves(plan: &PlanView) -> String {
    let touches = if plan.reachable == 1 { "once".to_owned() } else { format!("{} times", plan.reachable) };
    let (moves, stays) = match plan.options.finger {
        Finger::Right => ("right", "left"),
        Finger::Left => ("left", "right"),
    };
    format!(
        "The {moves} arm touches the glass {touches}, about {}, and goes home; the head and the {stays} arm stay.",
        minutes(plan.duration)
    )
}

/// In the precision that an estimate has: "40 s", "9 min".
pub fn minutes(duration: std::time::Duration) -> String {
    let seconds = duration.as_secs();
    if seconds < 90 { format!("{seconds} s") } else { format!("{} min", (seconds + 30) / 60) }
}

/// Places of the glass that are touched; repeats count once.
fn places(touch: &TouchView) -> usize {
    let reached = touch.touches.iter().filter(|one| !matches!(one.outcome, TouchOutcome::Unreachable(_)));
    let mut places: Vec<(u64, u64)> =
        reached.map(|one| (one.target.u_px.to_bits(), one.target.v_px.to_bits())).collect();
    places.sort_unstable();
    places.dedup();
    places.len()
}

fn planned(view: &View, plan: &PlanView) -> Guidance {
    let touch = &view.touch;
    if plan.reachable == 0 {
        return say("The arm reaches none of these targets: choose another area.").warn();
    }
    let placing = plan.options.purpose == Purpose::PlaceScreen;
    if placing && places(touch) < 3 {
        let text = format!(
            "The arm reaches {} of these places; three corners are needed to tell how the screen lies. Make the area smaller.",
            places(touch)
        );
        let corners = Action::Touch(TouchAction::Plan(Preset::Corners));
        return say(text).warn().then("Plan to touch the corners", corners);
    }
    say(format!("{}{}", what_moves(plan), makes_room(view)))
        .then(start_label(plan), Action::Touch(TouchAction::Start))
}

/// What goes from the twin's table meanwhile.
fn makes_room(view: &View) -> &'static str {
    let twin = &view.twin;
    let stands = twin.board.is_some() || twin.toys.iter().any(|toy| toy.place.is_some());
    if is_on_twin(view) && stands { " What lies on the screen or near it makes room." } else { "" }
}

/// What starting does: "Touch 80 targets".
pub fn start_label(plan: &PlanView) -> String {
    match plan.options.purpose {
        Purpose::PlaceScreen => {
            let middle = if plan.options.patterns.len() > 1 { " and the middle" } else { "" };
            format!("Touch the corners{middle}, {}", format::count(plan.reachable, "touch"))
        }
        Purpose::Train | Purpose::Check => format!("Touch {}", format::count(plan.reachable, "target")),
    }
}

fn paused(touch: &TouchView, why: Option<&str>) -> Guidance {
    let done = done_of(touch.counts);
    let why = why.map_or_else(String::new, |why| format!(" {}.", capitalized(why.trim_end_matches('.'))));
    let kept = if done == 0 { "nothing was touched yet" } else { "what was touched is on disk" };
    let guidance = say(format!("Paused after {done} of {}; {kept}.{why}", wanted(touch.counts)))
        .then(go_on(touch), Action::Touch(TouchAction::Resume));
    if why.is_empty() { guidance } else { guidance.warn() }
}

/// The number of the first touch that is still to be made.
pub fn waiting_touch(touch: &TouchView) -> Option<usize> {
    touch.touches.iter().find(|one| one.outcome == TouchOutcome::Waiting).map(|one| one.number)
}

/// What resuming does: "Go on with touch 15", by its number in the plan, as everywhere.
pub fn go_on(touch: &TouchView) -> String {
    match waiting_touch(touch) {
        Some(number) => format!("Go on with touch {number}"),
        // All may be done, and only the screen be left to be put back.
        None => "Go on".to_owned(),
    }
}

/// Touches that can be done.
pub fn wanted(counts: TouchCounts) -> usize {
    counts.planned.saturating_sub(counts.unreachable)
}

/// Touches that are behind.
pub fn done_of(counts: TouchCounts) -> usize {
    counts.touched + counts.missed + counts.skipped + counts.rejected
}

fn finished(view: &View) -> Guidance {
    let touch = &view.touch;
    let purpose = touch.plan.as_ref().map(|plan| plan.options.purpose);
    if is_screen_to_be_decided(touch)
        && let Some(place) = &touch.placement_proposal
    {
        let (good, said) = measured(place);
        let guidance = match touch.proposal_is_older {
            true => say(format!("By an earlier run than the one shown: {said}")).warn(),
            false if good => say(said),
            false => say(said).warn(),
        };
        return guidance.then("Use this place of the screen", Action::Touch(TouchAction::AcceptScreen));
    }
    let touched = format::count(touch.counts.touched, "touch");
    let held = held(touch.held);
    let finger = touch.plan.as_ref().map(|plan| plan.options.finger);
    match purpose {
        Some(Purpose::PlaceScreen) if touch.placement.is_none() => {
            say("The screen could not be placed from these touches; the messages say why. Touch its corners again.")
                .warn()
                .then("Plan to touch the corners", Action::Touch(TouchAction::Plan(Preset::Corners)))
        }
        Some(Purpose::PlaceScreen) => {
            say("The place of the screen is in use. Next: touch targets to train models.")
                .then("Plan a first calibration", Action::Touch(TouchAction::Plan(Preset::First)))
        }
        Some(Purpose::Check) => checked(view, &touched),
        Some(Purpose::Train) | None if touch.counts.touched == 0 => {
            say("No target was touched, so there is nothing to learn from. Touch targets to train models.")
                .warn()
                .then("Plan a first calibration", Action::Touch(TouchAction::Plan(Preset::First)))
        }
        Some(Purpose::Train) if finger == Some(Finger::Left) => {
            say(format!("{touched} of the left finger are on disk. Next: find what makes its arm miss."))
                .then("Go to Gap", Action::Go(Screen::Gap))
        }
        Some(Purpose::Train) | None if touch.counts.touched < FEWEST_FOR_A_NETWORK => say(format!(
            "{touched} are on disk, fewer than the {FEWEST_FOR_A_NETWORK} that M2 and M3 need. Next: find what makes the arm miss."
        ))
        .then("Go to Gap", Action::Go(Screen::Gap)),
        Some(Purpose::Train) | None => say(format!("{touched} are on disk.{held} Next: train models on them."))
            .then("Train models", Action::Go(Screen::Models)),
    }
}

/// Whether the place that was found can be trusted, a sentence, and where the screen was found to lie.
pub fn measured(place: &ScreenPlacement) -> (bool, String) {
    let moved_m = place.moved_m.iter().map(|m| m * m).sum::<f64>().sqrt();
    let (good, verdict) = words::screen::verdict(place);
    let moved = format::mm(moved_m);
    (good, format!("{verdict} It lies {moved} from where it was built to lie. Nothing moves."))
}

/// Whether a measured place of the screen is what the operator waits for. Touches that were made for something
/// else measure it as well: what they were made for goes first, and their place waits beside them, also once their
/// run is closed.
pub fn is_screen_to_be_decided(touch: &TouchView) -> bool {
    let purpose = touch.plan.as_ref().map(|plan| plan.options.purpose);
    let measured_for_it = purpose == Some(Purpose::PlaceScreen);
    touch.placement_proposal.is_some() && (touch.placement.is_none() || measured_for_it)
}

/// How well the finger lands; what the effects are worth where touches were sent both ways.
fn checked(view: &View, touched: &str) -> Guidance {
    let touch = &view.touch;
    let again = Action::Touch(TouchAction::Plan(Preset::Check));
    let Some(figures) = touch.figures else {
        return say(format!("{touched} checked: too few to say how well the finger lands."))
            .then("Plan new targets", again);
    };
    if let Some(proof) = Proof::of_run(touch) {
        let better = model_was_better(view, proof.with_m());
        let better = better.map_or_else(String::new, |better| format!(" {better}"));
        let said = format!("{} {} It stands on the timeline.{better}", proof.headline(), proof.figures());
        return match proof.worth() {
            Worth::Help => to_grasping(view, &said),
            Worth::Untold => say(said).then("Go to Gap", Action::Go(Screen::Gap)),
            Worth::Harm => say(said).warn().then("Go to Gap", Action::Go(Screen::Gap)),
        };
    }
    let beside = beside_held_out(view, figures.mean_m).unwrap_or_default();
    let said = format!("{touched} checked: {}{beside}", lands(view, &figures));
    if touch.correct_with.is_some() {
        return to_grasping(view, &format!("{said} It stands on the timeline."));
    }
    say(format!("{said} Nothing corrected these targets.")).then("Plan new targets", again)
}

/// What lies so many times the mean off is said by itself.
const FAR_OFF: f64 = 3.0;

/// How far beside its target the finger lands, and did without a model, a sentence.
fn lands(view: &View, figures: &TouchFigures) -> String {
    let mean_m = figures.mean_m;
    let before = before_check_m(view, mean_m)
        .map_or_else(String::new, |before_m| format!(", {} without a model", format::mm(before_m)));
    let far = (figures.largest_m > FAR_OFF * mean_m)
        .then(|| format!("; once {}: look at that one on the map", format::mm(figures.largest_m)));
    let far = far.unwrap_or_default();
    format!("the finger lands {} beside the target, on average{before}{far}.", format::mm(mean_m))
}

/// A check that misses by so much more than was left on held-out rows asks why.
const MUCH_MORE: f64 = 1.3;

/// Why the search for the effects in use said less, where it said much less, a sentence.
fn beside_held_out(view: &View, mean_m: f64) -> Option<String> {
    let by_effects = view.touch.correct_with == Some(Correction::Effects);
    let taken =
        || view.gap.model.history.iter().enumerate().rev().filter(|(_, step)| !step.undone && by_effects);
    // The last one may have tied the arms to the eyes, whose errors are of another kind.
    let of_search = |step: &ModelStep| step.errors.filter(|_| !step.in_pixels && !step.is_rms);
    let (place, [_, said_m, _]) = taken().find_map(|(place, step)| Some((place, of_search(step)?)))?;
    let since = match taken().next() {
        Some((last, _)) if last > place => ", and the arms were tied to the eyes since",
        _ => "",
    };
    (mean_m > MUCH_MORE * said_m).then(|| {
        format!(
            " Held-out rows said {}: that was at places like those that were learned from, these are new \
             ones{since}.",
            format::mm(said_m)
        )
    })
}

/// What came of a check that is over, a sentence; `None`: nothing was checked, or it proved something, which says more.
pub fn check_in_words(view: &View) -> Option<String> {
    let touch = &view.touch;
    let options = &touch.plan.as_ref()?.options;
    let is_over = touch.phase == TouchPhase::Finished && options.purpose == Purpose::Check;
    let figures = touch.figures.filter(|_| is_over && !options.beside_described)?;
    let beside = beside_held_out(view, figures.mean_m).unwrap_or_default();
    Some(format!("{}{beside}", capitalized(&lands(view, &figures))))
}

/// A check on the timeline is the one that is shown when both miss by the same, m.
const SAME_M: f64 = 1e-9;

/// What the timeline says that the finger missed by before what this check checked, m.
fn before_check_m(view: &View, mean_m: f64) -> Option<f64> {
    let mut newest = view.timeline.entries.iter().rev();
    let check = newest.find(|entry| entry.subject == Subject::Check)?;
    match (check.before, check.after) {
        (Some(Figure::Meters(before_m)), Some(Figure::Meters(after_m)))
            if (after_m - mean_m).abs() < SAME_M =>
        {
            Some(before_m)
        }
        _ => None,
    }
}

fn first(view: &View) -> Guidance {
    let touch = &view.touch;
    debug_assert!(!is_under_way(&touch.phase));
    if is_screen_to_be_decided(touch) {
        return finished(view);
    }
    if !touch.unfinished.is_empty() {
        return say("A run was begun and not finished. It goes on exactly where it was.")
            .then("Open the unfinished run", Action::Touch(TouchAction::OpenUnfinished));
    }
    if touch.placement.is_none() {
        return say("First measure where the screen lies: touch its corners. Planning moves nothing.")
            .then("Plan to touch the corners", Action::Touch(TouchAction::Plan(Preset::Corners)));
    }
    let said = match &touch.step {
        StepState::Stale { why } => say(format!("{why} Planning moves nothing.")).warn(),
        _ => say("Plan what shall be touched; planning moves nothing."),
    };
    said.then("Plan a first calibration", Action::Touch(TouchAction::Plan(Preset::First)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use jiff::Timestamp;
    use plumbline_engine::view::{EntryKind, GapModelView, GapView, TimelineEntry, TimelineView};
    use plumbline_model::robot::default_rig;
    use plumbline_model::touch_plan::{PlanOptions, TouchArea};

    use super::*;

    fn check(before_m: Option<f64>, after_m: f64) -> View {
        let entry = TimelineEntry {
            number: 1,
            at: jiff::Timestamp::UNIX_EPOCH,
            subject: Subject::Check,
            kind: EntryKind::Measured,
            title: "25 touches at new targets, corrected with M3".to_owned(),
            before: before_m.map(Figure::Meters),
            after: Some(Figure::Meters(after_m)),
            basis: String::new(),
            id_before: None,
            id_after: Some("session".to_owned()),
            outside: false,
            by_undo: false,
        };
        let entries = Arc::from([entry]);
        View {
            timeline: Arc::new(TimelineView { is_known: true, entries, ..TimelineView::default() }),
            ..View::default()
        }
    }

    #[test]
    fn a_check_that_is_over_says_how_far_the_finger_lands_and_nothing_else_does() {
        let of = |phase: TouchPhase, purpose: Purpose| {
            let area = TouchArea::within(&default_rig().touchscreen, 0.02);
            let options = PlanOptions::few(area, purpose, 1);
            let plan = PlanView {
                options,
                reachable: 6,
                refusals: vec![],
                duration: std::time::Duration::from_secs(60),
                model: Arc::from(""),
                score: None,
                postures: Arc::from([]),
            };
            let figures = TouchFigures {
                count: 6,
                mean_m: 0.93e-3,
                mean_interval_m: [0.5e-3, 1.4e-3],
                largest_m: 2e-3,
                bias_m: [0.0; 2],
                noise_m: None,
                repeats: 0,
            };
            let touch = TouchView {
                phase,
                plan: Some(Arc::new(plan)),
                figures: Some(figures),
                ..TouchView::default()
            };
            check_in_words(&View { touch: Arc::new(touch), ..check(Some(5.88e-3), 0.93e-3) })
        };
        let said = of(TouchPhase::Finished, Purpose::Check).expect("it is over");
        assert_eq!(said, "The finger lands 0.93 mm beside the target, on average, 5.88 mm without a model.");
        assert_eq!(of(TouchPhase::Planned, Purpose::Check), None);
        assert_eq!(of(TouchPhase::Finished, Purpose::Train), None);
    }

    #[test]
    fn what_a_check_is_compared_with_is_of_the_check_that_is_shown() {
        assert_eq!(before_check_m(&check(Some(5.88e-3), 0.93e-3), 0.93e-3), Some(5.88e-3));
        assert_eq!(before_check_m(&check(Some(5.88e-3), 0.93e-3), 1.4e-3), None, "another check");
        assert_eq!(before_check_m(&check(None, 0.93e-3), 0.93e-3), None, "nothing to compare with");
        assert_eq!(before_check_m(&View::default(), 0.93e-3), None);
    }

    #[test]
    fn a_check_that_misses_by_much_more_than_the_search_said_says_why() {
        let said = |correct_with, mean_m, ties: bool| {
            let mut view = check(None, mean_m);
            let step = |after_m: f64, is_rms| ModelStep {
                at: Timestamp::UNIX_EPOCH,
                title: String::new(),
                undone: false,
                errors: Some([6e-3, after_m, 0.5e-3]),
                in_pixels: false,
                is_rms,
                sessions: vec![],
            };
            let mut history = vec![step(0.8e-3, false)];
            history.extend(ties.then(|| step(1.6e-3, true)));
            let model = GapModelView { history, ..GapModelView::default() };
            view.gap = Arc::new(GapView { model, ..GapView::default() });
            view.touch = Arc::new(TouchView { correct_with, ..TouchView::default() });
            beside_held_out(&view, mean_m)
        };
        let much = said(Some(Correction::Effects), 1.67e-3, false).expect("twice as much");
        assert!(much.contains("Held-out rows said 0.80 mm") && !much.contains("tied"), "{much}");
        let tied = said(Some(Correction::Effects), 1.67e-3, true).expect("twice as much");
        assert!(
            tied.contains("Held-out rows said 0.80 mm") && tied.contains("were tied to the eyes since"),
            "{tied}"
        );
        assert_eq!(said(Some(Correction::Effects), 0.9e-3, true), None, "about as much");
        assert_eq!(said(None, 1.67e-3, false), None, "it was not corrected by them");
    }
}

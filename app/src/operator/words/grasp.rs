//! A grasp in words.

use plumbline_engine::View;
use plumbline_engine::view::{
    AttemptView, BetweenSteps, Connection, GraspHand, GraspMethod, GraspOutcome, GraspRun, GraspStep,
    GraspView, HandChoice, SinceHeld, is_halted, is_unseen,
};
use plumbline_widgets::format;

use crate::operator::is_under_way;

/// "M5".
pub fn method(method: GraspMethod) -> String {
    method.name().to_uppercase()
}

/// "right hand".
pub fn hand(hand: GraspHand) -> String {
    format!("{} hand", hand.name())
}

/// "Auto".
pub fn hand_choice(choice: HandChoice) -> String {
    super::capitalized(choice.name())
}

/// What a choice of the hand means.
pub fn about_hand(choice: HandChoice) -> &'static str {
    match choice {
        HandChoice::Auto => "The hand whose plan is best: level palm, short way, well known place",
        HandChoice::Right => "The right hand, always",
        HandChoice::Left => "The left hand, always",
    }
}

/// What is grasped: "tomato", or "what is seen best".
pub fn object_of(grasp: &GraspView) -> String {
    grasp.target.class.as_ref().map_or_else(|| "what is seen best".to_owned(), |class| class.to_lowercase())
}

/// Whether the robot is the twin that runs.
pub fn is_on_twin(view: &View) -> bool {
    view.twin.running && matches!(view.robot.connection, Connection::Connected { twin: true, .. })
}

/// Whether a hand can hold what has this name.
pub fn can_be_held(view: &View, name: &str) -> bool {
    view.grasp.classes.iter().any(|class| class.eq_ignore_ascii_case(name))
}

/// Why no toy that a hand can hold lies on the twin's table although none was put away by the operator, and when they come
/// back; `None`: one does, or touches are not the reason, or the robot is not the twin.
pub fn made_room(view: &View) -> Option<String> {
    let twin = &view.twin;
    let mut standing = twin.toys.iter().filter(|toy| toy.place.is_some());
    let is_empty = is_on_twin(view) && !standing.any(|toy| can_be_held(view, &toy.name));
    let toys: Vec<&str> = twin.made_room.iter().map(String::as_str).collect();
    (is_empty && !toys.is_empty()).then(|| {
        let listed = super::capitalized(&plumbline_model::listed(&toys));
        let come = if toys.len() == 1 { "comes" } else { "come" };
        let when = match is_under_way(&view.touch.phase) {
            true => "the run of touches is over",
            false => "no hand is over the screen",
        };
        format!("{listed} made room for touches and {come} back once {when}.")
    })
}

/// A clause as a sentence.
pub fn closed(clause: &str) -> String {
    let clause = super::capitalized(clause);
    if clause.ends_with(['.', '!', '?']) { clause } else { format!("{clause}.") }
}

/// "try 2 of 3"; `None` of a first one, of which nothing need be said.
pub fn try_of(run: &GraspRun) -> Option<String> {
    let [number, tries] = run.tries;
    (number > 1).then(|| format!("try {number} of {tries}"))
}

/// Before an arm moves to try again: why, and what will move. `None` while it does not.
pub fn again(run: &GraspRun) -> Option<String> {
    let why = closed(run.again.as_ref()?);
    let which = try_of(run).map_or_else(String::new, |which| format!(" {}:", super::capitalized(&which)));
    Some(format!(
        "{why}{which} the hand opens, the arm goes back to where it began, both eyes look, and it is grasped once more."
    ))
}

/// What makes an attempt that holds go on: "Next step: lower" where it will hold again, else "Go on".
pub fn go_on(grasp: &GraspView) -> String {
    match grasp.between().filter(|_| grasp.stops_after_each) {
        Some(between) => format!("Next step: {}", between.next.title().to_lowercase()),
        None => "Go on".to_owned(),
    }
}

/// Where an attempt holds by itself: what is done, which step comes next and what moves by it. `None` where it
/// does not.
pub fn holds(grasp: &GraspView) -> Option<String> {
    let (between, run) = (grasp.between()?, grasp.run.as_deref()?);
    let rest = match grasp.stops_after_each {
        true => "",
        false => " All that comes after follows without a stop.",
    };
    if between.next == GraspStep::Again {
        return Some(format!("{}{rest}", again(run).unwrap_or_else(|| "It is tried again.".to_owned())));
    }
    let (done, next) = (is_done(between, run), between.next.title().to_lowercase());
    Some(format!("{done}; the arm holds. Next, {next}: {}.{rest}", what_moves(between, run)))
}

fn is_done(between: BetweenSteps, run: &GraspRun) -> String {
    let object = run.object.to_lowercase();
    match between.done {
        GraspStep::Plan => "The way is planned".to_owned(),
        GraspStep::Approach => format!("The hand is above the {object}"),
        GraspStep::Align => match run.iterations.last() {
            Some(look) => match look.distance_m {
                Some(m) => format!("Both eyes have seen the hand {} beside where it belongs", format::mm(m)),
                None => "Both eyes have looked for the hand and have not found it".to_owned(),
            },
            None => "Nothing was to be aligned".to_owned(),
        },
        GraspStep::Lower => format!("The open hand is down at the {object}"),
        GraspStep::Close => "Thumb and fingers are closed".to_owned(),
        GraspStep::Lift => "The hand is up".to_owned(),
        other => format!("{} is done", other.title()),
    }
}

fn what_moves(between: BetweenSteps, run: &GraspRun) -> String {
    let object = run.object.to_lowercase();
    match between.next {
        GraspStep::Approach => {
            let hand = run.hand.map_or_else(|| "hand".to_owned(), hand);
            format!("the {hand} goes to above the {object}; an arm that is in its way goes home first")
        }
        GraspStep::Align if between.done == GraspStep::Align => {
            format!("the arm brings the hand nearer to where it belongs over the {object}")
        }
        GraspStep::Align if run.method == Some(GraspMethod::M4) => {
            "the arm turns the palm to the eyes, which look at it".to_owned()
        }
        GraspStep::Align => "both eyes look at the hand; the arm stays".to_owned(),
        GraspStep::Lower => format!("the arm goes straight down at the {object}"),
        GraspStep::Close => "the thumb closes, then the fingers; the arm stays".to_owned(),
        GraspStep::Lift => "the arm goes up with the closed hand".to_owned(),
        GraspStep::Check => {
            format!("fingers and eyes tell whether the {object} is held; the arm stays")
        }
        GraspStep::Ready | GraspStep::Look | GraspStep::Plan | GraspStep::Again => "the arm stays".to_owned(),
    }
}

/// How it is with what was found to be held, as a sentence.
pub fn held_now(run: &GraspRun) -> String {
    let object = run.object.to_lowercase();
    match run.since {
        SinceHeld::Held => format!("Fingers and eyes say: the {object} is held."),
        SinceHeld::Slipped(_) => format!("The {object} was held and has slipped out."),
        SinceHeld::LetGo => format!("The {object} was held."),
        SinceHeld::Unknown => {
            format!("The {object} was held; nobody knows whether it still is, for the hand is not heard.")
        }
    }
}

/// What became of an attempt, in a word or two.
pub fn result(attempt: &AttemptView) -> &'static str {
    match (attempt.told, &attempt.outcome) {
        (Some(true), _) if attempt.slipped_after.is_some() => "held, as you said; lost later",
        (None, Some(GraspOutcome::Success)) if attempt.slipped_after.is_some() => "held, then lost",
        (Some(true), _) => "held, as you said",
        (Some(false), _) => "not held, as you said",
        (None, Some(GraspOutcome::Success)) => "held, by fingers and eyes",
        (None, Some(outcome)) if is_halted(outcome) => "broken off",
        (None, Some(outcome)) if is_unseen(outcome) => "not seen",
        (None, Some(GraspOutcome::Failed { .. })) => "not held",
        (None, Some(GraspOutcome::Refused { .. })) => "refused",
        (None, None) => "broken off",
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{GraspIteration, GraspPhase};

    use super::*;

    fn held(done: GraspStep, next: GraspStep, stops_after_each: bool) -> GraspView {
        let run = GraspRun {
            object: "Tomato".to_owned(),
            method: Some(GraspMethod::M5),
            hand: Some(GraspHand::Right),
            tries: [1, 3],
            between: Some(BetweenSteps { done, next }),
            ..GraspRun::default()
        };
        GraspView {
            phase: GraspPhase::Grasping { paused: true, ending: false },
            run: Some(Arc::new(run)),
            stops_after_each,
            ..GraspView::default()
        }
    }

    #[test]
    fn a_hold_says_what_is_done_what_comes_next_and_what_moves() {
        let said = |done, next| holds(&held(done, next, true)).expect("it holds");
        assert_eq!(
            said(GraspStep::Plan, GraspStep::Approach),
            "The way is planned; the arm holds. Next, approach: the right hand goes to above the tomato; an arm \
             that is in its way goes home first."
        );
        assert_eq!(
            said(GraspStep::Lower, GraspStep::Close),
            "The open hand is down at the tomato; the arm holds. Next, close: the thumb closes, then the fingers; \
             the arm stays."
        );
        assert_eq!(go_on(&held(GraspStep::Align, GraspStep::Lower, true)), "Next step: lower");
        // Every step that it can hold before is said, with what moves.
        for pair in GraspStep::ALL.windows(2).skip(2) {
            let said = said(pair[0], pair[1]);
            let next = format!("Next, {}: ", pair[1].title().to_lowercase());
            assert!(said.contains(&next) && said.ends_with('.'), "{said}");
        }
    }

    #[test]
    fn between_two_looks_it_says_how_far_the_hand_was_beside_or_that_it_was_not_found() {
        let mut grasp = held(GraspStep::Align, GraspStep::Align, true);
        let mut look = GraspIteration {
            at_s: None,
            sent_m: [0.3, -0.1, 0.2],
            hand_m: None,
            not_found: None,
            distance_m: Some(0.0042),
            sigma_m: None,
        };
        let mut said = |look: &GraspIteration| {
            let run = Arc::make_mut(grasp.run.as_mut().expect("made up"));
            run.iterations = vec![look.clone()];
            holds(&grasp).expect("it holds")
        };
        assert!(said(&look).contains("seen the hand 4.20 mm beside where it belongs"), "{}", said(&look));
        look.distance_m = None;
        assert!(said(&look).contains("have not found it"), "{}", said(&look));
    }

    #[test]
    fn with_the_switch_turned_off_meanwhile_going_on_is_going_on_to_the_end() {
        let grasp = held(GraspStep::Approach, GraspStep::Align, false);
        assert_eq!(go_on(&grasp), "Go on");
        assert!(holds(&grasp).expect("it holds").ends_with("All that comes after follows without a stop."));
    }

    #[test]
    fn a_pause_in_the_middle_of_a_step_and_a_step_of_the_hand_are_no_holds() {
        let mut grasp = held(GraspStep::Approach, GraspStep::Align, true);
        for phase in [
            GraspPhase::Grasping { paused: false, ending: false },
            GraspPhase::Grasping { paused: true, ending: true },
            GraspPhase::Hand { step: plumbline_engine::HandStep::Lift, paused: true },
            GraspPhase::Idle,
        ] {
            grasp.phase = phase;
            assert_eq!((holds(&grasp), go_on(&grasp)), (None, "Go on".to_owned()), "{:?}", grasp.phase);
        }
    }

    #[test]
    fn before_it_tries_again_it_says_why_and_what_will_move() {
        let mut grasp = held(GraspStep::Check, GraspStep::Again, true);
        let run = Arc::make_mut(grasp.run.as_mut().expect("made up"));
        (run.tries, run.again) = ([2, 3], Some("the hand is empty".to_owned()));
        let said = holds(&grasp).expect("it holds");
        assert!(said.starts_with("The hand is empty. Try 2 of 3: the hand opens"), "{said}");
        assert_eq!(go_on(&grasp), "Next step: again");
    }
}

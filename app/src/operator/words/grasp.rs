//! A grasp in words.

use plumbline_engine::view::{
    AttemptView, GraspHand, GraspMethod, GraspOutcome, GraspRun, GraspView, HandChoice, SinceHeld,
};

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

/// How it is with what was found to be held, as a sentence.
pub fn held_now(run: &GraspRun) -> String {
    let object = run.object.to_lowercase();
    match run.since {
        SinceHeld::Held => format!("The {object} is held."),
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
        (None, Some(GraspOutcome::Success)) => "held",
        (None, Some(GraspOutcome::Failed { .. })) => "not held",
        (None, Some(GraspOutcome::Refused { .. })) => "refused",
        (None, None) => "broken off",
    }
}

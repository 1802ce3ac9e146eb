//! A grasp in words.

use plumbline_engine::view::{AttemptView, GraspHand, GraspMethod, GraspOutcome, GraspView, HandChoice};

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

/// What became of an attempt, in a word or two.
pub fn result(attempt: &AttemptView) -> &'static str {
    match (attempt.told, &attempt.outcome) {
        (Some(true), _) => "held, as you said",
        (Some(false), _) => "not held, as you said",
        (None, Some(GraspOutcome::Success)) => "held",
        (None, Some(GraspOutcome::Failed { .. })) => "not held",
        (None, Some(GraspOutcome::Refused { .. })) => "refused",
        (None, None) => "broken off",
    }
}

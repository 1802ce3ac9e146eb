//! What watching drift cannot tell.

use plumbline_engine::view::{Anew, BeganAnew};

/// That what is shown is of the time since watching began anew by itself, and what had moved before.
pub fn anew(anew: &Anew) -> String {
    let when = match anew.why {
        BeganAnew::Opened => "when the cameras or the recording were opened again",
        BeganAnew::ClockSet => "when the time since the cameras were switched on was set",
        BeganAnew::ClockKnown => "when it changed whether that time is known",
        BeganAnew::SwitchedOn => "when the cameras were switched on again",
        BeganAnew::WoundBack => "when the recording was wound back",
        BeganAnew::OtherModel => "with the model that is in use now",
    };
    let before = match &anew.moved_before {
        Some(moved) => format!(" Before, it had said: \u{201c}{moved}\u{201d}"),
        None => String::new(),
    };
    format!("Watching began anew {when}: whether anything had moved by then is not known.{before}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_had_moved_stays_said() {
        let of = |moved_before: Option<&str>| Anew {
            why: BeganAnew::SwitchedOn,
            moved_before: moved_before.map(str::to_owned),
        };
        let nothing = anew(&of(None));
        assert!(nothing.ends_with("whether anything had moved by then is not known."), "{nothing}");
        let moved = anew(&of(Some("The right eye has turned.")));
        assert!(moved.ends_with("Before, it had said: \u{201c}The right eye has turned.\u{201d}"), "{moved}");
    }
}

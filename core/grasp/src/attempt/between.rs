//! Between two steps: whoever watches may want each of them by itself.

use super::{End, Running};
use crate::body::Halt;
use crate::record::{Failure, Step};

impl Running<'_> {
    /// Where whoever watches wants it: holds until it is let go on. What is known is kept first, for a person may
    /// take hours, and what ends it here leaves the step that is done as the one it came to.
    pub(super) fn hold_before(&mut self, next: Step) -> Result<(), End> {
        let Some(done) = self.record.step.filter(|done| self.watch.holds_between(*done, next)) else {
            return Ok(());
        };
        self.watch.about_to(self.record);
        let from_s = self.body.now_s();
        let held = self.body.wait(0.0);
        // A person who looks at it is no slow arm: that time is none of the attempt's.
        self.began_s += self.body.now_s() - from_s;
        held.map_err(|halt| ended_between(&halt, done, next))
    }
}

/// What ended it while it held, and where.
fn ended_between(halt: &Halt, done: Step, next: Step) -> End {
    let title = |step: Step| step.title().to_lowercase();
    let between = if done == next {
        "between two looks at the hand".to_owned()
    } else {
        format!("after {}, before {}", title(done), title(next))
    };
    End::Failed(Failure::Halted, format!("{halt} while the arm held {between}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_a_hold_is_said_with_the_steps_that_it_was_between() {
        let why = |halt, done, next| match ended_between(&halt, done, next) {
            End::Failed(Failure::Halted, why) => why,
            End::Failed(..) | End::Refused(_) => panic!("it was halted"),
        };
        assert_eq!(
            why(Halt::Cancelled, Step::Approach, Step::Lower),
            "it was ended by the operator while the arm held after approach, before lower"
        );
        assert_eq!(
            why(Halt::Stopped, Step::Align, Step::Align),
            "STOP was pressed while the arm held between two looks at the hand"
        );
    }
}

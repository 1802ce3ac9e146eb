//! Why places in the robot's frame are stated with a wide uncertainty while something was not measured.

use plumbline_effects::robot_model::Unmeasured;

/// Why the uncertainty of places in the robot's frame is wide, and what to do: a sentence or two. `None`: all that
/// they rest on was measured.
pub fn wide_because(unmeasured: Unmeasured) -> Option<&'static str> {
    match unmeasured {
        Unmeasured { mount: false, lenses: false } => None,
        Unmeasured { mount: true, lenses: false } => Some(MOUNT),
        Unmeasured { mount: false, lenses: true } => Some(LENSES),
        Unmeasured { mount: true, lenses: true } => Some(BOTH),
    }
}

const MOUNT: &str = "The ± is wide because nobody measured how the eyes sit in the head: it holds how far that usually \
     is off. Calibrate the mount in step 2, Mount.";
const LENSES: &str = "The ± is wide because these eyes are not calibrated: it holds how far lenses usually are off. \
     Calibrate them in step 1, Eyes.";
const BOTH: &str = "The ± is wide because neither the eyes are calibrated nor their mount: it holds how far both \
     usually are off. Begin with step 1, Eyes, then step 2, Mount.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_measured_is_told_with_the_step_that_measures_it_and_what_was_measured_is_not() {
        let said = |mount, lenses| wide_because(Unmeasured { mount, lenses });
        assert_eq!(said(false, false), None);
        for (mount, lenses) in [(true, false), (false, true), (true, true)] {
            let said = said(mount, lenses).expect("wide");
            assert_eq!(said.contains("step 1, Eyes"), lenses, "{said}");
            assert_eq!(said.contains("step 2, Mount"), mount, "{said}");
        }
    }
}

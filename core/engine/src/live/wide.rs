//! Why places in the robot's frame are stated with a wide uncertainty while something was not measured, and that the
//! uncertainty leaves out what nobody knows.

use plumbline_effects::robot_model::{Turned, Unmeasured};

/// Why the uncertainty of places in the robot's frame is wide, or what it leaves out, and what to do: two or three
/// sentences. `None`: all that they rest on was measured, and is as well known as it says. `is_told`: whether the
/// calibration of the eyes says how well it is known. `turned`: how far the eyes usually have turned since.
pub fn wide_because(unmeasured: Unmeasured, is_told: bool, turned: Turned) -> Option<&'static str> {
    match unmeasured {
        Unmeasured { mount: false, lenses: false, neck } if turned.counts() => {
            Some(if neck { TURNED_AND_NECK } else { TURNED })
        }
        Unmeasured { mount: false, lenses: false, neck: true } => {
            Some(if is_told { NECK } else { NECK_UNTOLD })
        }
        Unmeasured { mount: false, lenses: false, neck: false } => (!is_told).then_some(UNTOLD),
        Unmeasured { mount: true, lenses: false, .. } => Some(if is_told { MOUNT } else { MOUNT_UNTOLD }),
        Unmeasured { mount: false, lenses: true, .. } => Some(LENSES),
        Unmeasured { mount: true, lenses: true, .. } => Some(BOTH),
    }
}

/// Where somebody has seen that the eyes have turned: that goes before all that is merely usual.
pub(super) const SEEN_TURNED: &str = "The ± is wide because the calibration of the eyes does not hold any more: it holds how \
     far the right eye was seen to have turned. Calibrate the eyes again in step 1, Eyes; the screen Drift says what has \
     turned.";
const TURNED: &str = "The ± is wide because the eyes are colder or warmer than when they were calibrated: it holds how far \
     eyes usually turn meanwhile. Where they are warm by now (the clock in the top line), calibrate them again in step 1, \
     Eyes.";
const TURNED_AND_NECK: &str = "The ± is wide because the eyes are colder or warmer than when they were calibrated (the clock in \
     the top line), and nobody measured where the head looks straight ahead (the hands, in step 6, Hand-eye): it holds how far \
     both usually are off.";
const MOUNT: &str = "The ± is wide because nobody measured how the eyes sit in the head: it holds how far that usually \
     is off. Calibrate the mount in step 2, Mount.";
const NECK: &str = "The ± is wide because nobody measured where the head looks straight ahead, which no board tells: it \
     holds how far zeros of necks usually are off. Look at the hands, in step 6, Hand-eye.";
const NECK_UNTOLD: &str = "The ± is wide because nobody measured where the head looks straight ahead: it holds how far zeros \
     of necks usually are off. Look at the hands, in step 6, Hand-eye. It leaves out how well the eyes are calibrated, \
     which the file of the calibration does not say.";
const LENSES: &str = "The ± is wide because these eyes are not calibrated: it holds how far lenses usually are off. \
     Calibrate them in step 1, Eyes.";
const BOTH: &str = "The ± is wide because neither the eyes are calibrated nor their mount: it holds how far both \
     usually are off. Begin with step 1, Eyes, then step 2, Mount.";
const UNTOLD: &str = "The ± leaves out how well the eyes are calibrated: the file that the calibration was read from does \
     not say it. Calibrate them here in step 1, Eyes, and it is in the ±.";
const MOUNT_UNTOLD: &str = "The ± is wide because nobody measured how the eyes sit in the head: it holds how far that \
     usually is off. It leaves out how well the eyes are calibrated, which the file of the calibration does not say. \
     Calibrate them here in step 1, Eyes, then the mount in step 2, Mount.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_measured_is_told_with_the_step_that_measures_it_and_what_was_measured_is_not() {
        let said =
            |mount, lenses| wide_because(Unmeasured { mount, lenses, neck: mount }, true, Turned::default());
        assert_eq!(said(false, false), None);
        let neck = wide_because(Unmeasured { neck: true, ..Unmeasured::default() }, true, Turned::default());
        assert!(neck.is_some_and(|said| said.contains("step 6, Hand-eye")), "{neck:?}");
        for (mount, lenses) in [(true, false), (false, true), (true, true)] {
            let said = said(mount, lenses).expect("wide");
            assert_eq!(said.contains("step 1, Eyes"), lenses, "{said}");
            assert_eq!(said.contains("step 2, Mount"), mount, "{said}");
        }
    }

    #[test]
    fn eyes_that_have_turned_by_millimeters_since_they_were_calibrated_are_told_and_less_is_not() {
        let said = |apart_rad| {
            wide_because(Unmeasured::default(), true, Turned { apart_rad, together_rad: apart_rad })
        };
        assert_eq!(said(0.001), None);
        assert!(
            said(0.006).is_some_and(|said| said.contains("colder or warmer than when they were calibrated"))
        );
        let neck = Unmeasured { neck: true, ..Unmeasured::default() };
        let both = wide_because(neck, true, Turned { apart_rad: 0.006, together_rad: 0.006 });
        assert!(
            both.is_some_and(|said| said.contains("colder or warmer") && said.contains("step 6, Hand-eye")),
            "{both:?}"
        );
    }

    #[test]
    fn a_calibration_that_does_not_say_how_well_it_is_known_is_not_passed_off_as_exact() {
        for mount in [false, true] {
            let said =
                wide_because(Unmeasured { mount, lenses: false, neck: mount }, false, Turned::default());
            let said = said.expect("something is left out");
            assert!(said.contains("leaves out how well the eyes are calibrated"), "{said}");
            assert_eq!(said.contains("step 2, Mount"), mount, "{said}");
        }
        // Of eyes that nobody calibrated it holds how far lenses usually are off.
        let all = |is_told| wide_because(Unmeasured::ALL, is_told, Turned::default());
        assert_eq!(all(false), all(true));
    }
}

//! Whether a measured place of the screen can be trusted, in a sentence.

use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_widgets::format;

use super::{more_doubts, sentence};

/// Whether nothing speaks against it, and that as a sentence: "Good: …", or "Doubtful." and the first doubt.
pub fn verdict(place: &ScreenPlacement) -> (bool, String) {
    if let [first, more @ ..] = place.doubts().as_slice() {
        let more = more_doubts(more.len());
        return (false, format!("Doubtful. {}{more}", sentence(first)));
    }
    let touches = format::count(place.touches, "touch");
    let [left, known] = [place.rms_m, place.known_to_m()].map(format::mm);
    let known = format!("the middle of the screen is known to {known} (95 %)");
    let said = match place.arm_errs() {
        true => {
            format!(
                "Good enough to go on: {known}. The {left} that {touches} leave are the arm's own error, learned next."
            )
        }
        false => format!("Good: {touches} agree to {left}, and {known}."),
    };
    (true, said)
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;
    use plumbline_model::touchscreen::place_screen;
    use plumbline_model::{Pixel, Point};

    use super::*;

    fn placed(slip_m: f64) -> ScreenPlacement {
        let screen = Rig::built_in("nico").expect("comes with the program").touchscreen;
        let touches: Vec<_> = (0..12)
            .map(|i| {
                let pixel = Pixel::new(f64::from(i % 4) * 600.0 + 50.0, f64::from(i / 4) * 500.0 + 40.0);
                let up_m = 0.5e-3 * f64::from(i % 2) + if i == 4 { slip_m } else { 0.0 };
                let on_glass = screen.point_at(pixel).coords;
                (pixel, Point::new(on_glass.x, on_glass.y, on_glass.z + up_m))
            })
            .collect();
        place_screen(&screen, &touches).expect("a place")
    }

    #[test]
    fn what_has_no_doubt_is_good_and_says_how_far_it_is_known() {
        let (good, said) = verdict(&placed(0.0));
        assert!(good && said.starts_with("Good: 12 touches agree to 0.2"), "{said}");
        assert!(said.contains("is known to 0."), "{said}");
    }

    #[test]
    fn an_arm_that_errs_is_no_doubt_of_the_place_but_is_said() {
        let mut place = placed(0.0);
        place.residuals_m.iter_mut().enumerate().for_each(|(i, left_m)| left_m[i % 3] += 7e-3);
        let (good, said) = verdict(&place);
        assert!(good && said.starts_with("Good enough to go on:") && said.contains("own error"), "{said}");
        // In every direction at once, all by more than a centimeter: none of them slipped.
        place.residuals_m.iter_mut().for_each(|left_m| *left_m = [7e-3, -6e-3, 6e-3]);
        let (good, said) = verdict(&place);
        assert!(good && said.starts_with("Good enough to go on:"), "{said}");
    }

    #[test]
    fn a_slip_is_a_doubt_and_is_named() {
        let (good, said) = verdict(&placed(0.025));
        assert!(!good && said.starts_with("Doubtful. Touch 5 lies"), "{said}");
    }
}

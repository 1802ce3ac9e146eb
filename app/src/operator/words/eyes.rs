//! What is said of pairs of the eyes.

use plumbline_engine::view::EyesView;
use plumbline_model::counted;

/// Housings are about as warm as they get so long after the eyes were switched on, min.
pub const WARM_AFTER_MINUTES: f64 = 20.0;

/// How long the eyes had been on when a collected pair was taken, min; `None`: nobody knows.
pub fn minutes_on(eyes: &EyesView, pair: &str) -> Option<f64> {
    let index = eyes.collected.iter().position(|known| known.name == pair)?;
    *eyes.minutes_on.get(index)?
}

/// "cold, 3 min", "warm, 25 min".
pub fn warmth(minutes_on: f64) -> String {
    format!("{}, {minutes_on:.0} min", if is_cold(minutes_on) { "cold" } else { "warm" })
}

/// That some of these pairs were taken with cold eyes and others with warm ones, a sentence.
pub fn cold_among<'a>(eyes: &EyesView, pairs: impl Iterator<Item = &'a str>) -> Option<String> {
    let known: Vec<f64> = pairs.filter_map(|pair| minutes_on(eyes, pair)).collect();
    let cold = known.iter().filter(|minutes| is_cold(**minutes)).count();
    let were = if cold == 1 { "was" } else { "were" };
    (cold > 0 && cold < known.len()).then(|| {
        format!(
            "{cold} of {} {were} taken with cold eyes, in their first {WARM_AFTER_MINUTES:.0} minutes: where these fit \
             worse, that may be why.",
            counted(known.len(), "pair")
        )
    })
}

/// That all of the pairs were taken with cold eyes, and what that means; a sentence.
pub fn all_cold(eyes: &EyesView) -> Option<String> {
    let mut known = eyes.minutes_on.iter().flatten().peekable();
    known.peek()?;
    known.all(|minutes| is_cold(*minutes)).then(|| {
        format!(
            "The eyes were cold and still turn a little: calibrate them again once they have been on for \
             {WARM_AFTER_MINUTES:.0} minutes."
        )
    })
}

/// That the eyes still warm up, behind what is to be done with them: a sentence that begins with a space, or nothing.
pub fn still_cold(eyes: &EyesView) -> String {
    let wait_min = eyes.health.cold_for_min.map(|wait_min| wait_min.ceil() as usize);
    wait_min.map_or_else(String::new, |wait_min| {
        format!(
            " The eyes are still cold and turn while they warm up: what is taken now does not fit later. Wait {} if you can.",
            counted(wait_min, "minute")
        )
    })
}

fn is_cold(minutes_on: f64) -> bool {
    minutes_on < WARM_AFTER_MINUTES
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::CollectedPair;

    use super::*;

    fn eyes(minutes_on: &[Option<f64>]) -> EyesView {
        let pair = |number: usize| CollectedPair {
            name: number.to_string(),
            left: None,
            right: None,
            left_image: None,
            right_image: None,
            place: None,
            taken: None,
        };
        EyesView {
            collected: (0..minutes_on.len()).map(|number| Arc::new(pair(number))).collect(),
            minutes_on: minutes_on.into(),
            ..EyesView::default()
        }
    }

    #[test]
    fn cold_and_warm_pairs_are_told_apart_and_what_is_not_known_is_not_told() {
        assert_eq!((warmth(2.6), warmth(25.0)), ("cold, 3 min".to_owned(), "warm, 25 min".to_owned()));
        let said =
            |minutes_on: &[Option<f64>]| cold_among(&eyes(minutes_on), ["0", "1", "2", "file"].into_iter());
        let both = said(&[Some(3.0), Some(25.0), None]).expect("both");
        assert!(both.starts_with("1 of 2 pairs was taken with cold eyes"), "{both}");
        let both = said(&[Some(3.0), Some(25.0), Some(4.0)]).expect("both");
        assert!(both.starts_with("2 of 3 pairs were taken with cold eyes"), "{both}");
        assert_eq!(said(&[Some(25.0), Some(30.0), None]), None);
        assert_eq!(said(&[Some(2.0), Some(3.0), None]), None, "all alike");
        assert_eq!(said(&[None, None, None]), None);
        assert_eq!(minutes_on(&eyes(&[Some(3.0)]), "file"), None);
    }

    #[test]
    fn a_calibration_of_cold_eyes_alone_says_so() {
        let said = |minutes_on: &[Option<f64>]| all_cold(&eyes(minutes_on));
        assert!(said(&[Some(2.0), None, Some(3.0)]).is_some_and(|said| said.contains("20 minutes")));
        assert_eq!(said(&[Some(2.0), Some(25.0)]), None, "that is told where the pairs are");
        assert_eq!((said(&[None]), said(&[])), (None, None), "nobody knows");
    }
}

//! What experiments are called and what they are good for.

use crate::finding::Experiment;

use super::rival::Rival;

/// What to do, to be read after "you could" and by itself.
pub(super) fn what(kind: Experiment, places: usize, verb: &str, noun: &str) -> String {
    let these = format!("{verb} {places} {noun}");
    match kind {
        Experiment::OtherSide => format!("{these} coming from the left and again coming from the right"),
        Experiment::Weight => format!("{these} with and without a weight of 250 g at the palm"),
        Experiment::RaisedScreen => {
            format!("{these} with the screen as it lies and on blocks of 60 mm and 120 mm")
        }
        Experiment::OtherPosture => format!("{these} with the elbow as it is and held higher or lower"),
        Experiment::Slower => format!("{these} at the usual speed and three times slower"),
        Experiment::ColdAndWarm => format!("{these} cold, and again after 40 minutes of work"),
        Experiment::Repeats => format!("{these}, each three times"),
        Experiment::MorePlaces => format!("{these} that are new, spread wider"),
        Experiment::CardBehind => format!("{these} with and without a card 10 cm behind"),
        Experiment::OtherDistance => {
            format!("{these} at two thirds and at one and a half times the distance")
        }
        Experiment::HeadTurned => {
            format!("{these} with the head straight ahead and turned by 12° to either side")
        }
        Experiment::LogLater => format!("{these} and log the encoders once more a second after contact"),
    }
}

/// The same where one thing was watched; `None`: that is no experiment then.
pub(super) fn watched(kind: Experiment) -> Option<&'static str> {
    match kind {
        Experiment::OtherDistance => Some(
            "switch the cameras off, let them cool, and watch three things from switching on for a quarter of an \
             hour: one where it was, one at two thirds and one at one and a half times the distance",
        ),
        Experiment::HeadTurned => Some(
            "switch the cameras off, let them cool, and watch the thing from switching on for a quarter of an hour, \
             each minute with the head straight ahead and turned by 12° to either side",
        ),
        _ => None,
    }
}

/// Which names it tells apart.
pub(super) fn tells(a: &Rival, b: &Rival) -> String {
    let only = |a: &Rival, b: &Rival| -> Vec<String> {
        a.assumed
            .effects
            .iter()
            .filter(|present| !b.names.contains(&present.effect.name()))
            .map(|present| format!("“{}”", present.effect.title))
            .collect()
    };
    match (only(a, b).as_slice(), only(b, a).as_slice()) {
        ([], []) => String::new(),
        ([], alone) | (alone, []) => format!("It shows whether {} is there at all", alone.join(" and ")),
        (these, those) => format!("It tells {} from {}", these.join(" and "), those.join(" and ")),
    }
}

/// How much better sizes will be known.
pub(super) fn pins(rival: &Rival, less_doubt: f64) -> String {
    let titles: Vec<String> =
        rival.assumed.effects.iter().map(|present| format!("“{}”", present.effect.title)).collect();
    format!(
        "The names are settled; it narrows the intervals of {} by {:.0} %",
        titles.join(" and "),
        100.0 * less_doubt
    )
}

//! What is the matter, for the operator.

use crate::monitor::{Alarm, Mover, OwnMotion, Verdict};
use crate::warm_up::ToGo;
use crate::watch::ReferenceKind;

/// A verdict as a sentence.
pub fn verdict(verdict: &Verdict) -> String {
    match verdict {
        Verdict::NotSeen => "Nothing was seen yet.".to_owned(),
        Verdict::Learning { looks, needed } => {
            format!("Learns how far looks scatter: {looks} of {needed}.")
        }
        Verdict::Steady { cost_m } => {
            format!("Places stay where they were: {} at the far end of the table.", off(cost_m[2]))
        }
        Verdict::Warming { to_go: Some(to_go), cost_m, what, .. } if to_go.is_over() => {
            let turned = has_turned(*what).trim_end_matches(',');
            format!("Warmed up. {turned}. {} Calibrate the eyes again, warm.", costs(cost_m))
        }
        Verdict::Warming { to_go, cost_m, what, .. } => {
            let to_go = match to_go {
                Some(told) => to_go_words(told),
                None => "how long it takes cannot be told yet".to_owned(),
            };
            format!("Still warming up, {to_go}: {} slowly. {}", turns(*what), costs(cost_m))
        }
        Verdict::Moved(moved) => alarm(moved),
    }
}

/// What moved, since when, what it costs, and what to do.
pub fn alarm(alarm: &Alarm) -> String {
    let how = if alarm.sudden { "suddenly, " } else { "" };
    let since = minutes(alarm.since_s);
    let cost = costs(&alarm.cost_m);
    let then = match alarm.what {
        Mover::Head => "Move the head to its place again, or calibrate how the eyes sit in the head.",
        _ => "Calibrate the eyes again.",
    };
    format!("{} {how}since minute {}. {cost} {then}", has_turned(alarm.what), since.trim_end_matches(" min"))
}

/// What a reference did by itself.
pub fn own_motion(motion: &OwnMotion) -> String {
    let minute = |at_s: f64| minutes(at_s).trim_end_matches(" min").to_owned();
    let at = minute(motion.since_s);
    let until = motion.until_s.map(minute);
    let OwnMotion { name, kind, by_m, .. } = motion;
    let by = by_m.map(|by_m| millimeters(by_m.norm()));
    match (by, kind, until) {
        (None, _, None) => format!("{name}: gone or covered since minute {at}."),
        (None, _, Some(until)) => format!("{name}: was gone or covered from minute {at} to {until}."),
        (Some(by), ReferenceKind::Hand, None) => {
            format!("{name}: sags by {by} since minute {at}; its encoders stand still.")
        }
        (Some(by), ReferenceKind::Hand, Some(until)) => {
            format!("{name}: sagged by {by} from minute {at} to {until}; its encoders stood still.")
        }
        (Some(by), _, None) => format!("{name}: was moved by {by} at minute {at}; the eyes stand still."),
        (Some(by), _, Some(until)) => {
            format!("{name}: was moved by {by} at minute {at}, and is where it was since minute {until}.")
        }
    }
}

/// What moved, as the beginning of a sentence.
fn has_turned(what: Mover) -> &'static str {
    match what {
        Mover::LeftEye => "The left eye has turned in its mount,",
        Mover::RightEye => "The right eye has turned in its mount,",
        Mover::BothEyes => "Both eyes have turned in their mounts,",
        Mover::OneEye => "One eye has turned against the other,",
        Mover::Head => "Both eyes have turned together, though the head's encoders stand still,",
    }
}

fn turns(what: Mover) -> &'static str {
    match what {
        Mover::LeftEye => "the left eye turns",
        Mover::RightEye => "the right eye turns",
        Mover::BothEyes => "both eyes turn",
        Mover::OneEye => "one eye turns against the other",
        Mover::Head => "the head turns",
    }
}

/// What is known to a quarter, or to a minute and a half, is said as one number.
fn to_go_words(told: &ToGo) -> String {
    let [least_s, about_s, most_s] = [told.least_s, told.about_s, told.most_s].map(|s| s.max(60.0));
    let about = format!("about {} to go", whole_minutes(about_s));
    if most_s - least_s < (0.25 * about_s).max(90.0) {
        return about;
    }
    let [least, most] = [least_s, most_s].map(|s| format!("{:.0}", s / 60.0));
    format!("{about} ({least} to {most})")
}

fn whole_minutes(s: f64) -> String {
    format!("{:.0} min", s / 60.0)
}

fn costs(cost_m: &[f64; 3]) -> String {
    let [near, middle, far] = cost_m.map(millimeters);
    format!("Places are off by {near} near, {middle} in the middle and {far} far.")
}

fn off(cost_m: f64) -> String {
    format!("{} off", millimeters(cost_m))
}

fn millimeters(m: f64) -> String {
    let mm = m * 1e3;
    if mm < 9.95 { format!("{mm:.1} mm") } else { format!("{mm:.0} mm") }
}

fn minutes(s: f64) -> String {
    let minutes = s / 60.0;
    if minutes < 9.95 && minutes.fract() > 0.05 {
        format!("{minutes:.1} min")
    } else {
        format!("{minutes:.0} min")
    }
}

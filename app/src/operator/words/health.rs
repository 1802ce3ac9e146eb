//! Whether a calibration still holds, in words.

use jiff::Timestamp;
use plumbline_engine::view::{EyesHealth, EyesView, HealthFigures, JudgedWhen, ProposalHealth};
use plumbline_widgets::format;

/// "Judged 14 min ago, with cold eyes."
pub fn judged(when: &JudgedWhen, now: Timestamp) -> String {
    let ago = format::age(when.age(now));
    match when.is_cold() {
        // About as warm as when they were calibrated, or warmer, which is said where it matters.
        _ if when.colder == Some(false) => format!("Judged {ago}."),
        Some(true) => format!("Judged {ago}, with cold eyes."),
        Some(false) => format!("Judged {ago}, with warm eyes."),
        None => format!("Judged {ago}."),
    }
}

/// Why what was judged does not stand any more; `None`: it stands.
pub fn outdated(when: &JudgedWhen, now: Timestamp) -> Option<String> {
    if let Some(moved_m) = when.moved_too_far_m() {
        return Some(format!(
            "Places have moved by {} since it was judged: it does not stand any more. Ask again.",
            format::mm(moved_m)
        ));
    }
    if when.warmed_since {
        return Some(
            "The eyes have got warmer since it was judged: it does not stand any more. Ask again.".to_owned(),
        );
    }
    when.is_outdated(now)
        .then(|| "It was judged a while ago, and nobody has looked since. Ask again.".to_owned())
}

/// What was said of the calibration in use, where it does not stand any more.
pub fn said_then(health: &EyesHealth) -> String {
    let was = if health.in_use.is_good { "still good" } else { "not good" };
    format!("Then the calibration in use was {was}: places were off by {}.", off(&health.in_use))
}

/// How far off the calibration in use puts places, and whether that is still good; `colder_wait_min`: the eyes are colder than
/// when it was made, for so many minutes more.
pub fn in_use(health: &EyesHealth, colder_wait_min: Option<f64>) -> String {
    let off = off(&health.in_use);
    if health.in_use.is_good {
        return format!("The calibration in use is still good: places are off by {off}.");
    }
    if let Some(wait_min) = colder_wait_min {
        return format!(
            "The eyes are colder than when the calibration in use was made: until they are as warm, places are off by \
             {off}. Wait {wait_min:.0} min, then ask again."
        );
    }
    format!(
        "The calibration in use is not good any more: places are off by {off}. The right eye has turned by {}. Calibrate \
         the eyes again.",
        format::degrees(health.in_use.turn_rad)
    )
}

/// Whether the proposed calibration is better, with both in figures; `None`: none was judged.
pub fn proposed(health: &EyesHealth) -> Option<String> {
    let (figures, verdict) = health.proposed.as_ref()?;
    let both = format!("In use: {}; proposed: {}.", off(&health.in_use), off(figures));
    Some(match verdict {
        ProposalHealth::Better => format!("The proposed calibration is better. {both}"),
        ProposalHealth::Worse => {
            format!("Not offered: the proposed calibration is worse than the one in use. {both}")
        }
        ProposalHealth::Undecided => {
            format!("Not offered: the proposed calibration cannot be told apart from the one in use. {both}")
        }
        ProposalHealth::KnowsWhen => format!(
            "The proposed calibration cannot be told apart from the one in use, but it says for how long the cameras had \
             been on, which a correction by time needs. {both}"
        ),
        ProposalHealth::Untold => {
            format!(
                "With the proposed calibration the eyes are another distance apart, which cannot be seen without a \
                 board. {both}"
            )
        }
    })
}

/// Why the proposal is not offered; `None`: it is, or nobody has judged it.
pub fn not_offered(eyes: &EyesView, now: Timestamp) -> Option<NotOffered> {
    let health = eyes.health.judged.as_deref().filter(|_| eyes.health.is_against_proposal())?;
    let sentence = proposed(health)?;
    Some(match eyes.health.when.as_ref().and_then(|when| outdated(when, now)) {
        None => NotOffered { sentence, may_be_judged_again: false },
        Some(why) => {
            let was = "The proposed calibration was not better than the one in use.";
            NotOffered { sentence: format!("{was} {why}"), may_be_judged_again: true }
        }
    })
}

/// Why a proposal is not offered.
pub struct NotOffered {
    /// For people.
    pub sentence: String,
    /// What was judged of it does not stand any more.
    pub may_be_judged_again: bool,
}

/// "2 mm near, 4 mm in the middle, 9 mm far".
fn off(figures: &HealthFigures) -> String {
    let [near, middle, far] = figures.off_m.map(format::whole_mm);
    format!("{near} near, {middle} in the middle, {far} far")
}

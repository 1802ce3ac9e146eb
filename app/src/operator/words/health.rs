//! Whether a calibration still holds, in words.

use plumbline_engine::view::{EyesHealth, EyesView, HealthFigures, ProposalHealth};
use plumbline_widgets::format;

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
pub fn not_offered(eyes: &EyesView) -> Option<String> {
    eyes.health.judged.as_deref().filter(|_| eyes.health.is_against_proposal()).and_then(proposed)
}

/// "0.2 cm near, 0.4 cm in the middle, 0.9 cm far".
fn off(figures: &HealthFigures) -> String {
    let [near, middle, far] = figures.off_m.map(format::cm);
    format!("{near} near, {middle} in the middle, {far} far")
}

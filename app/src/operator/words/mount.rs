//! Whether a solved mount of the eyes can be trusted, in a sentence.

use plumbline_engine::view::MountSummary;
use plumbline_widgets::format;

use super::{more_doubts, sentence};

/// What no view of a board tells, and where it is told.
pub const NOT_IN_IT: &str = "As the neck counts its angles: the zero of its nod, which no board tells from a nod of the eyes, \
     is in these numbers. Not in their ±: where the head looks straight ahead. No board tells the zero of the neck's \
     turn, which is off by some degrees; the ± of places hold it until the hands are looked at, in step 6, Hand-eye.";

/// Whether nothing speaks against it, and that as a sentence: "Good: …", or "Doubtful." and the first doubt. A remark on what
/// the stated uncertainty holds already is none.
pub fn verdict(summary: &MountSummary) -> (bool, String) {
    let (doubts, held) = summary.doubts();
    if let [first, more @ ..] = doubts.as_slice() {
        let more = more_doubts(more.len());
        return (false, format!("Doubtful. {}{more}", sentence(first)));
    }
    let sd_rad = summary.turned_sd_rad.iter().fold(0.0_f64, |most, sd| most.max(*sd));
    let views = match summary.views {
        1 => "1 view agrees".to_owned(),
        n => format!("{} agree", format::count(n, "view")),
    };
    let error = format::px(summary.rms_px);
    let known = format::degrees(format::NORMAL_95 * sd_rad);
    let with = if held.is_empty() { "" } else { "; what is remarked below is in it" };
    let said = format!(
        "Good: {views} to {error}, and where the eyes look, as the neck counts its turn, is known to {known} (95 %{with})."
    );
    (true, said)
}

#[cfg(test)]
mod tests {
    use plumbline_model::Pose;

    use super::*;

    fn summary() -> MountSummary {
        MountSummary {
            head_from_left: Pose::identity(),
            moved_m: [0.0; 3],
            turned_rad: [0.0; 3],
            moved_sd_m: [0.001; 3],
            turned_sd_rad: [0.0005, 0.001, 0.0002],
            rms_px: 0.21,
            views: 12,
            rejected: vec![],
            not_seen: vec![],
            remarks: vec![],
            at: jiff::Timestamp::UNIX_EPOCH,
        }
    }

    #[test]
    fn what_has_no_doubt_is_good_and_says_how_far_it_is_known() {
        let (good, said) = verdict(&summary());
        assert!(good);
        assert_eq!(
            said,
            format!(
                "Good: 12 views agree to {}, and where the eyes look, as the neck counts its turn, is known to {} (95 %).",
                format::px(0.21),
                format::degrees(1.96e-3)
            )
        );
    }

    #[test]
    fn what_the_uncertainty_holds_is_no_doubt_of_it() {
        let slack = "the neck has slack; the stated uncertainty includes it".to_owned();
        let (good, said) = verdict(&MountSummary { remarks: vec![slack.clone()], ..summary() });
        assert!(good && said.ends_with("(95 %; what is remarked below is in it)."), "{said}");
        let lenses = "calibrate the eyes from board pairs to have it".to_owned();
        let (good, said) = verdict(&MountSummary { remarks: vec![slack, lenses], ..summary() });
        assert!(!good && said.starts_with("Doubtful. Calibrate the eyes"), "{said}");
    }

    #[test]
    fn a_doubt_comes_first_and_the_others_are_counted() {
        let doubtful = MountSummary {
            not_seen: vec!["How far the eyes lie forward was not seen.".to_owned()],
            remarks: vec!["the gears have slack".to_owned()],
            ..summary()
        };
        let (good, said) = verdict(&doubtful);
        assert!(!good);
        assert!(said.starts_with("Doubtful. How far the eyes lie forward was not seen."), "{said}");
        assert!(said.ends_with("One more doubt is listed."), "{said}");
    }
}

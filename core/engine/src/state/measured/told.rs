//! What was measured, each as one line of the timeline.

use std::path::Path;

use jiff::Timestamp;
use plumbline_model::counted;

use crate::drift::PlacesResult;
use crate::eyes::ToldHealth;
use crate::scores::Evaluation;
use crate::scores::view::ScoreRow;
use crate::timeline::Measured;
use crate::timeline::view::{Figure, Subject};
use crate::trials::view::ShownTrials;

/// Of a session, the name of its folder.
pub(super) fn name_of(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}

fn worst(off_m: [f64; 3]) -> f64 {
    off_m.into_iter().fold(0.0, f64::max)
}

/// Whether the calibration in use holds.
pub(super) fn of_health(told: &ToldHealth) -> Measured {
    let ToldHealth { at, health, is_live } = told;
    let [near, middle, far] = health.in_use.off_m.map(|off_m| format!("{:.0}", 1e3 * off_m));
    let holds = if health.in_use.is_good { "still good" } else { "not good any more" };
    // Images of another day say how the eyes were then.
    let by = if *is_live { "" } else { ", by images taken before" };
    let in_use = format!(
        "calibration in use {holds}{by}: off by {near}, {middle} and {far} mm near, in the middle and far"
    );
    let from = format!(
        "how far off places come out where that is most, by {} in {}",
        counted(health.places, "place"),
        counted(health.pairs, "pair")
    );
    let in_use_m = Figure::Meters(worst(health.in_use.off_m));
    let (before, after, basis) = match &health.proposed {
        Some((proposed, _)) => {
            let after = Figure::Meters(worst(proposed.off_m));
            (Some(in_use_m), after, format!("{from}; before: the one in use, after: the one proposed"))
        }
        None => (None, in_use_m, from),
    };
    let title = if health.proposed.is_some() { format!("{in_use}; one proposed beside it") } else { in_use };
    Measured { subject: Subject::Health, id: at.to_string(), at: Some(*at), title, before, after, basis }
}

/// What the 9 by 4 evaluation gave.
pub(super) fn of_places(result: &PlacesResult) -> Measured {
    let PlacesResult { session, object, measured, of, described_m, model_m } = result;
    Measured {
        subject: Subject::Places,
        id: name_of(session),
        at: None,
        title: format!("{} at {measured} of {of} places", object.to_lowercase()),
        before: Some(Figure::Meters(*described_m)),
        after: Figure::Meters(*model_m),
        basis: "mean error on the table, the same looks; before: as the robot is described, after: by the model then in \
                use"
            .to_owned(),
    }
}

/// How often things were lifted; `None`: nothing was attempted.
pub(super) fn of_trials(shown: &ShownTrials) -> Option<Measured> {
    let lifted = |method: &plumbline_report::experiment::Method| {
        let sum = |of: fn(&plumbline_report::experiment::Position) -> usize| {
            method.positions.iter().map(of).sum::<usize>()
        };
        let (lifted, attempts) = (sum(|at| at.successes), sum(|at| at.attempts));
        (attempts > 0).then(|| (method.name.clone(), lifted as f64 / attempts as f64))
    };
    let methods: Vec<(String, f64)> = shown.page.methods.iter().filter_map(lifted).collect();
    let (last, share) = methods.last()?;
    let words: Vec<String> =
        methods.iter().map(|(name, share)| format!("{name} {:.0} %", 100.0 * share)).collect();
    let object = shown.experiment.object.to_lowercase();
    let of = format!("share lifted, {} by {}", counted(shown.made, "attempt"), shown.experiment.who());
    let (before, basis) = match methods.split_last() {
        Some((_, [(first, share), ..])) => {
            (Some(Figure::Share(*share)), format!("{of}; before: by {first}, after: by {last}"))
        }
        _ => (None, of),
    };
    Some(Measured {
        subject: Subject::Grasps,
        id: name_of(&shown.folder),
        at: None,
        title: format!("{object} lifted: {}", words.join(", ")),
        before,
        after: Figure::Share(*share),
        basis,
    })
}

/// How detectors did; `None`: none could be judged.
pub(super) fn of_detectors(at: Timestamp, judged: &Evaluation) -> Option<Measured> {
    let table = &judged.table;
    let scored =
        table.rows.iter().filter_map(|row| Some((&row.model, row.scores.as_ref().ok()?.all.map50_95)));
    let scored: Vec<(&String, f64)> = scored.filter(|(_, score)| (0.0..=1.0).contains(score)).collect();
    let best = scored.iter().map(|(_, score)| *score).fold(f64::NAN, f64::max);
    let is_own = |row: &ScoreRow| row.scores.as_ref().is_ok_and(|scores| scores.judged_by_itself.is_some());
    let own = if table.rows.iter().any(is_own) { ", labels of its own among them" } else { "" };
    let words: Vec<String> =
        scored.iter().map(|(model, score)| format!("{model} {:.1} %", 100.0 * score)).collect();
    (!words.is_empty()).then(|| Measured {
        subject: Subject::Detectors,
        id: at.to_string(),
        at: Some(at),
        title: words.join(", "),
        before: None,
        after: Figure::Share(best),
        basis: format!(
            "mAP50–95{} on {} of {}{own}",
            if scored.len() > 1 { " of the best" } else { "" },
            counted(table.images, "image"),
            name_of(&table.set)
        ),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::eyes::view::{EyesHealth, HealthFigures, ProposalHealth};

    fn figures(far_m: f64) -> HealthFigures {
        HealthFigures {
            is_good: far_m < 0.01,
            off_m: [0.002, 0.004, far_m],
            sigma_m: [0.0005; 3],
            turn_rad: 0.001,
            epipolar_px: 0.3,
        }
    }

    #[test]
    fn health_is_told_by_where_places_are_off_most_and_a_proposal_stands_beside_what_is_in_use() {
        let mut health = EyesHealth { in_use: figures(0.021), proposed: None, pairs: 4, places: 120 };
        let told = |health: EyesHealth, is_live| {
            of_health(&ToldHealth { at: Timestamp::UNIX_EPOCH, health: Arc::new(health), is_live })
        };
        let alone = told(health, true);
        assert_eq!((alone.before, alone.after), (None, Figure::Meters(0.021)));
        assert!(
            alone.title.contains("not good any more")
                && alone.title.contains("21 mm near, in the middle and far"),
            "{}",
            alone.title
        );
        health.proposed = Some((figures(0.006), ProposalHealth::Better));
        let both = told(health, true);
        assert!(!both.title.contains("taken before"), "{}", both.title);
        let recorded = told(health, false);
        assert!(recorded.title.contains("by images taken before: off"), "{}", recorded.title);
        assert_eq!((both.before, both.after), (Some(Figure::Meters(0.021)), Figure::Meters(0.006)));
        assert!(both.basis.contains("120 places in 4 pairs") && both.basis.contains("the one proposed"));
    }

    #[test]
    fn an_evaluation_says_by_how_many_places_and_what_the_model_is_worth() {
        let result = PlacesResult {
            session: "sessions/2026-09-14T12-00-00_grid".into(),
            object: "Tomato",
            measured: 35,
            of: 36,
            described_m: 0.0368,
            model_m: 0.0061,
        };
        let told = of_places(&result);
        assert_eq!((&*told.title, &*told.id), ("tomato at 35 of 36 places", "2026-09-14T12-00-00_grid"));
        assert_eq!((told.before, told.after), (Some(Figure::Meters(0.0368)), Figure::Meters(0.0061)));
    }

    /// An experiment of these methods, each with so many lifted of ten.
    fn trials(methods: &[(plumbline_grasp::Method, usize)]) -> ShownTrials {
        use plumbline_report::experiment as page;
        let experiment = crate::trials::Experiment {
            format: crate::trials::FORMAT,
            twin: "lab".to_owned(),
            methods: methods.iter().map(|(method, _)| *method).collect(),
            attempts: 10,
            positions_m: vec![[0.3, -0.1]],
            hand: plumbline_grasp::HandChoice::Auto,
            object: "Tomato".to_owned(),
            seed: 1,
            lab: None,
        };
        let methods = methods
            .iter()
            .map(|(method, lifted)| page::Method {
                name: method.name().to_uppercase(),
                cells: vec![],
                positions: vec![page::Position {
                    at_m: [0.3, -0.1],
                    successes: *lifted,
                    attempts: if *lifted > 10 { 0 } else { 10 },
                    published: None,
                    hand_found: None,
                }],
            })
            .collect::<Vec<_>>();
        let made = 10 * methods.len();
        let page = page::Experiment {
            title: String::new(),
            sentences: vec![],
            screen_m: [[0.0; 2]; 4],
            area_m: [[0.0; 2]; 2],
            beyond_m: vec![],
            methods,
            version: String::new(),
        };
        ShownTrials { folder: "experiments/tomato".into(), experiment, made, all: made, page }
    }

    #[test]
    fn grasps_are_told_by_the_share_that_was_lifted_and_more_is_better() {
        use plumbline_grasp::Method::{M1, M5};
        let both = of_trials(&trials(&[(M1, 3), (M5, 9)])).expect("attempts");
        assert_eq!(both.title, "tomato lifted: M1 30 %, M5 90 %");
        let (before, after) = (both.before.expect("two methods"), both.after);
        assert_eq!((before, after), (Figure::Share(0.3), Figure::Share(0.9)));
        assert!(after.is_better_than(before) && !before.is_better_than(after));
        assert!(
            both.basis.contains("20 attempts by the twin lab; before: by M1, after: by M5"),
            "{}",
            both.basis
        );
        let one = of_trials(&trials(&[(M5, 9)])).expect("attempts");
        assert_eq!((one.before, one.after), (None, Figure::Share(0.9)));
        assert!(of_trials(&trials(&[(M5, 11)])).is_none(), "nothing was attempted");
    }
}

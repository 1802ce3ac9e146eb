//! What came of an experiment, with the keys of the command line's JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use plumbline_grasp::{Failure, Method};
use serde::Serialize;

use super::judged::Attempt;
use super::plan::Experiment;

/// A hand that was seen no farther than this from where it truly was is located, m.
const LOCATED_M: f64 = 0.015;
/// The area of the published networks: x and y, m.
pub(super) const AREA_M: [[f64; 2]; 2] = [[0.27, 0.48], [-0.23, 0.23]];

/// What came of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// By short name of the method.
    pub methods: BTreeMap<String, MethodSummary>,
    /// Attempts that are still to be made.
    pub missing: usize,
}

/// What came of a method.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Lifted.
    pub successes: usize,
    /// Lifted by the first try of an attempt.
    pub at_first: usize,
    /// Of these.
    pub attempts: usize,
    /// Lifted inside the area of the published networks.
    pub inside: usize,
    /// Of these.
    pub inside_attempts: usize,
    /// Positions at which the hand was located in every attempt.
    pub hand_located: usize,
    /// Positions at which it was looked for.
    pub hand_positions: usize,
    /// Nothing was risked.
    pub refused: usize,
    /// Failures by their class.
    pub failures: BTreeMap<&'static str, usize>,
    /// Distance of the palm from where it belongs, before the hand closed.
    pub alignment_mm: Spread,
    /// The same by the place of the object that was seen: the arm alone.
    pub reach_error_mm: Spread,
    /// Distance of the object that was seen from where it was: the eyes alone.
    pub camera_error_mm: Spread,
    /// From the button to the end of the lift, s.
    pub seconds_median: Option<f64>,
    /// One after the other.
    pub positions: Vec<PositionSummary>,
}

/// Middle and end of a list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Half are smaller.
    pub median: Option<f64>,
    /// The largest.
    pub worst: Option<f64>,
}

/// What came of a position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PositionSummary {
    /// m.
    pub x_m: f64,
    /// m.
    pub y_m: f64,
    /// Lifted.
    pub successes: usize,
    /// Of these.
    pub attempts: usize,
    /// Whether the hand was located in all of them; `None`: it was not looked for.
    pub hand_located: Option<bool>,
}

/// Adds up what was attempted so far.
pub fn summary(experiment: &Experiment, attempts: &[Attempt]) -> Summary {
    let of_method = |method: Method| {
        let mine: Vec<&Attempt> = attempts.iter().filter(|attempt| attempt.trial.method == method).collect();
        (method.name().to_owned(), of_method(experiment, method, &mine))
    };
    let missing = experiment.trials().count().saturating_sub(attempts.len());
    Summary { methods: experiment.methods.iter().copied().map(of_method).collect(), missing }
}

fn of_method(experiment: &Experiment, method: Method, attempts: &[&Attempt]) -> MethodSummary {
    let inside = |attempt: &&&Attempt| {
        let place = experiment.positions_m[attempt.trial.position];
        place.iter().zip(AREA_M).all(|(at, [low, high])| (low..=high).contains(at))
    };
    let lifted = |attempt: &&&Attempt| attempt.judged.lifted;
    let mut failures = BTreeMap::new();
    for failure in attempts.iter().filter_map(|attempt| attempt.judged.failure) {
        *failures.entry(name(failure)).or_insert(0) += 1;
    }
    let positions: Vec<PositionSummary> = experiment
        .positions_m
        .iter()
        .enumerate()
        .filter_map(|(i, [x_m, y_m])| {
            let here: Vec<&&Attempt> =
                attempts.iter().filter(|attempt| attempt.trial.position == i).collect();
            let located = here
                .iter()
                .all(|attempt| attempt.judged.hand_error_m.is_some_and(|error_m| error_m <= LOCATED_M));
            (!here.is_empty()).then(|| PositionSummary {
                x_m: *x_m,
                y_m: *y_m,
                successes: here.iter().filter(|attempt| attempt.judged.lifted).count(),
                attempts: here.len(),
                hand_located: method.aligns().then_some(located),
            })
        })
        .collect();
    let spread = |value: fn(&Attempt) -> Option<f64>| {
        Spread::of(attempts.iter().filter_map(|attempt| value(attempt)).map(|m| m * 1e3).collect())
    };
    let seconds = attempts.iter().filter_map(|attempt| attempt.record.seconds).collect();
    MethodSummary {
        successes: attempts.iter().filter(lifted).count(),
        at_first: attempts.iter().filter(|attempt| attempt.judged.at_first).count(),
        attempts: attempts.len(),
        inside: attempts.iter().filter(inside).filter(lifted).count(),
        inside_attempts: attempts.iter().filter(inside).count(),
        hand_located: positions.iter().filter(|position| position.hand_located == Some(true)).count(),
        hand_positions: positions.iter().filter(|position| position.hand_located.is_some()).count(),
        refused: attempts.iter().filter(|attempt| attempt.judged.refused).count(),
        failures,
        alignment_mm: spread(|attempt| attempt.judged.alignment_m),
        reach_error_mm: spread(|attempt| attempt.judged.reach_error_m),
        camera_error_mm: spread(|attempt| attempt.judged.camera_error_m),
        seconds_median: Spread::of(seconds).median,
        positions,
    }
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self { median: values.get(values.len() / 2).copied(), worst: values.last().copied() }
    }
}

fn name(failure: Failure) -> &'static str {
    match failure {
        Failure::NotSeen => "not-seen",
        Failure::PlaceWrong => "place-wrong",
        Failure::HandWrong => "hand-wrong",
        Failure::ReachWrong => "reach-wrong",
        Failure::Slipped => "slipped",
        Failure::Halted => "halted",
        Failure::EyesLost => "eyes-lost",
    }
}

/// One line per attempt, for a spreadsheet.
pub fn csv(experiment: &Experiment, attempts: &[Attempt]) -> String {
    let mut text = String::from(
        "number,method,hand,x_m,y_m,attempt,placed_x_m,placed_y_m,lifted,refused,failure,camera_error_m,reach_error_m,alignment_m,off_x_m,off_y_m,off_z_m,hand_error_m,looks,tries,seconds\n",
    );
    for Attempt { trial, placed_m, record, judged } in attempts {
        let [x_m, y_m] = experiment.positions_m[trial.position];
        let number = |value: Option<f64>| value.map(|value| format!("{value:.6}")).unwrap_or_default();
        let _ = writeln!(
            text,
            "{},{},{},{x_m},{y_m},{},{:.6},{:.6},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            trial.number,
            trial.method.name(),
            record.hand.name(),
            trial.attempt + 1,
            placed_m[0],
            placed_m[1],
            u8::from(judged.lifted),
            u8::from(judged.refused),
            judged.failure.map(name).unwrap_or_default(),
            number(judged.camera_error_m),
            number(judged.reach_error_m),
            number(judged.alignment_m),
            number(judged.palm_off_m.map(|off| off[0])),
            number(judged.palm_off_m.map(|off| off[1])),
            number(judged.palm_off_m.map(|off| off[2])),
            number(judged.hand_error_m),
            record.iterations.len(),
            record.earlier.len() + 1,
            number(record.seconds),
        );
    }
    text
}

//! The page of an experiment, beside what was published of the robot.

use plumbline_grasp::{Method, PLACES_M};
use plumbline_model::counted;
use plumbline_model::robot::Rig;
use plumbline_report::experiment::{self as page, Position};

use super::plan::{Experiment, ROBOT};
use super::summary::{AREA_M, MethodSummary, Summary};

/// Lifted, of three attempts, at the positions of [`PLACES_M`] by M1 to M4 on the real robot, a plush tomato
/// on the table. M4 made no attempt where the hand was not located. Source: J. Gavura, I. Farkaš,
/// "Optimization of sim-to-real transfer in the humanoid robot NICO" (2026), figures 5 and 7.
const PUBLISHED: [[usize; 22]; 4] = [
    [0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 1, 0, 0, 0, 0, 3, 0, 3],
    [0, 0, 0, 1, 3, 0, 3, 2, 0, 3, 3, 0, 3, 3, 0, 3, 3, 0, 3, 2, 0, 0],
    [0, 1, 0, 3, 3, 0, 3, 3, 0, 3, 3, 0, 3, 3, 2, 3, 3, 0, 3, 2, 0, 0],
    [3, 0, 3, 0, 0, 3, 3, 3, 2, 3, 2, 3, 3, 3, 3, 3, 2, 3, 3, 0, 3, 0],
];
/// Two positions are the same within this, m.
const SAME_M: f64 = 1e-6;

/// What stands on the page.
pub fn page(experiment: &Experiment, summary: &Summary, rig: &Rig) -> page::Experiment {
    let attempts: usize = summary.methods.values().map(|of| of.attempts).sum();
    let positions = counted(experiment.positions_m.len(), "position");
    let made = format!("{} at {positions} by the", counted(attempts, "attempt"));
    let (who, seed) = (&experiment.twin, experiment.seed);
    let mut sentences = match who.strip_prefix(ROBOT) {
        Some(name) => vec![
            format!("{made} robot {name}. Judged by the person who stood beside it; what was refused counts as not lifted."),
            "Published: three attempts at each of 22 positions (Gavura and Farkaš 2026).".to_owned(),
        ],
        None => vec![
            format!("{made} twin {who}, simulated with the physics of contacts; seed {seed}. Judged by what really happened: lifted by more than 4 cm."),
            "Published: the real robot, three attempts at each of 22 positions (Gavura and Farkaš 2026). It is another robot than the twin.".to_owned(),
        ],
    };
    if experiment.lab.is_none() && experiment.methods.iter().any(|method| *method != Method::M5) {
        sentences.push(
            "M1 to M4 used what was learned here, from touches, and not what was published.".to_owned(),
        );
    }
    sentences.extend(not_lifted(experiment, summary));
    if summary.missing > 0 {
        sentences.push(format!("Still to be made: {}.", counted(summary.missing, "attempt")));
    }
    let corner = |k: usize| {
        let at = rig.touchscreen.corners()[k].coords;
        [at.x, at.y]
    };
    page::Experiment {
        title: format!("Grasps of the {}", experiment.object.to_lowercase()),
        sentences,
        screen_m: [corner(0), corner(1), corner(2), corner(3)],
        area_m: AREA_M,
        beyond_m: beyond_m().collect(),
        methods: experiment
            .methods
            .iter()
            .filter_map(|method| Some(of_method(*method, summary.methods.get(method.name())?)))
            .collect(),
        version: crate::ground::software(),
    }
}

/// Of all methods why things were not lifted, the most frequent reason first; `None`: all were lifted.
fn not_lifted(experiment: &Experiment, summary: &Summary) -> Option<String> {
    let of_method = |method: &Method| {
        let mut failures: Vec<_> = summary.methods.get(method.name())?.failures.iter().collect();
        failures.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let words: Vec<String> = failures
            .iter()
            .map(|(failure, count)| format!("{} {count}", failure.replace('-', " ")))
            .collect();
        (!words.is_empty()).then(|| format!("{} {}", method.name().to_uppercase(), words.join(", ")))
    };
    let all: Vec<String> = experiment.methods.iter().filter_map(of_method).collect();
    (!all.is_empty()).then(|| format!("Not lifted: {}.", all.join("; ")))
}

/// Places of the published nine by four grid that its right arm does not reach: x and y, m.
fn beyond_m() -> impl Iterator<Item = [f64; 2]> {
    let places = (2..=5).flat_map(|x| (-4..=4).map(move |y| [f64::from(x) / 10.0, f64::from(y) / 10.0]));
    places.filter(|at_m| !PLACES_M.iter().any(|place| is_same(place, at_m)))
}

fn is_same(a: &[f64; 2], b: &[f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_M)
}

fn of_method(method: Method, of: &MethodSummary) -> page::Method {
    let share = |part: usize, whole: usize| {
        if whole == 0 { "–".to_owned() } else { format!("{:.0} %", 100.0 * part as f64 / whole as f64) }
    };
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.1}"));
    let published = PUBLISHED.get(method as usize);
    let inside = |k: usize| PLACES_M[k].iter().zip(AREA_M).all(|(at, [low, high])| (low..=high).contains(at));
    let in_area: Vec<usize> = (0..PLACES_M.len()).filter(|k| inside(*k)).collect();
    let published_share = |places: &[usize]| {
        published.map_or("–".to_owned(), |counts| {
            share(places.iter().map(|k| counts[*k]).sum(), 3 * places.len())
        })
    };
    let everywhere: Vec<usize> = (0..PLACES_M.len()).collect();
    let hand = if of.hand_positions == 0 {
        "–".to_owned()
    } else {
        format!("{}/{}", of.hand_located, of.hand_positions)
    };
    let positions = of.positions.iter().map(|position| {
        let at_m = [position.x_m, position.y_m];
        let known = PLACES_M.iter().position(|place| is_same(place, &at_m));
        Position {
            at_m,
            successes: position.successes,
            attempts: position.attempts,
            published: known.and_then(|k| Some(published?[k])),
            hand_found: position.hand_located,
        }
    });
    page::Method {
        name: method.name().to_uppercase(),
        cells: vec![
            share(of.successes, of.attempts),
            published_share(&everywhere),
            share(of.inside, of.inside_attempts),
            published_share(&in_area),
            hand,
            of.refused.to_string(),
            format!("{} … {}", number(of.alignment_mm.median), number(of.alignment_mm.worst)),
            number(of.camera_error_mm.median),
            number(of.reach_error_mm.median),
            number(of.seconds_median),
        ],
        positions: positions.collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use plumbline_grasp::HandChoice;
    use plumbline_model::measured_data;

    use super::super::plan::FORMAT;
    use super::*;

    fn shown(twin: &str, failures: &[(&'static str, usize)]) -> page::Experiment {
        let experiment = Experiment {
            format: FORMAT,
            twin: twin.to_owned(),
            methods: vec![Method::M5],
            attempts: 3,
            positions_m: PLACES_M.to_vec(),
            hand: HandChoice::Auto,
            object: "Tomato".to_owned(),
            seed: 4,
            lab: None,
        };
        let of = MethodSummary {
            attempts: 66,
            failures: failures.iter().copied().collect(),
            ..Default::default()
        };
        let summary = Summary { methods: BTreeMap::from([("m5".to_owned(), of)]), missing: 0 };
        page(&experiment, &summary, &Rig::built_in("nico").expect("comes with the program"))
    }

    #[test]
    fn what_a_robot_did_is_not_said_to_be_simulated() {
        let robot = shown("robot nico", &[]).sentences.join(" ");
        assert!(robot.contains("by the robot nico") && robot.contains("person"), "{robot}");
        assert!(!robot.contains("twin") && !robot.contains("simulated"), "{robot}");
        let twin = shown("lab", &[]).sentences.join(" ");
        assert!(twin.contains("by the twin lab, simulated") && twin.contains("seed 4"), "{twin}");
    }

    #[test]
    fn why_things_were_not_lifted_is_said_with_the_most_frequent_reason_first() {
        let said = shown("lab", &[("place-wrong", 2), ("reach-wrong", 7)]).sentences.join(" ");
        assert!(said.contains("Not lifted: M5 reach wrong 7, place wrong 2."), "{said}");
        assert!(!shown("lab", &[]).sentences.join(" ").contains("Not lifted"));
    }

    #[test]
    fn every_place_of_the_grid_is_reached_or_beyond_reach() {
        assert_eq!(beyond_m().count() + PLACES_M.len(), 36);
        let cells = shown("lab", &[]).methods[0].cells.len();
        assert_eq!(cells, page::TABLE.len(), "a cell under every heading");
    }

    #[test]
    fn the_published_counts_are_those_of_the_published_table() {
        let folder = match measured_data::folder("nico-tables") {
            Ok(folder) => folder,
            Err(reason) => return measured_data::left_out(reason),
        };
        let text = std::fs::read_to_string(folder.join("grasp-outcomes-z5.csv")).expect("a table");
        let mut rows = 0;
        for line in text.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let method = Method::from_name(cells[0]).expect("a method");
            let number = |k: usize| cells[k].parse::<f64>().unwrap_or(0.0);
            let at_m = [number(1), number(2)];
            let place = PLACES_M.iter().position(|place| is_same(place, &at_m)).expect("a published place");
            let lifted = (4..7).map(number).sum::<f64>();
            assert_eq!(PUBLISHED[method as usize][place] as f64, lifted, "{line}");
            rows += 1;
        }
        assert_eq!(rows, 88);
    }
}

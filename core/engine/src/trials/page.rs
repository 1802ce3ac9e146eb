//! The page of an experiment, beside what was published of the robot.

use plumbline_grasp::{Method, PLACES_M};
use plumbline_model::robot::Rig;
use plumbline_report::experiment::{self as page, Position};

use super::plan::Experiment;
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
    let mut sentences = vec![
        format!(
            "{attempts} attempts at {} positions by the twin {}, simulated with the physics of contacts; seed {}. Judged by what really happened: lifted by more than 4 cm.",
            experiment.positions_m.len(),
            experiment.twin,
            experiment.seed
        ),
        "Published: the real robot, three attempts at each of 22 positions (Gavura and Farkaš 2026). It is another robot than the twin.".to_owned(),
    ];
    if summary.missing > 0 {
        sentences.push(format!("{} attempts are still to be made.", summary.missing));
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
        methods: experiment
            .methods
            .iter()
            .filter_map(|method| Some(of_method(*method, summary.methods.get(method.name())?)))
            .collect(),
        version: crate::ground::software(),
    }
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
        let known = PLACES_M
            .iter()
            .position(|place| (place[0] - at_m[0]).abs() < SAME_M && (place[1] - at_m[1]).abs() < SAME_M);
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
            number(of.seconds_median),
        ],
        positions: positions.collect(),
    }
}

//! What a joint does by what another one does, or by how far it came: nothing of the library is like that, and nothing is
//! repeated that would tell the noise.

mod common;

use common::{Plan, poses, present};
use plumbline_effects::{Assumed, Measurements};
use plumbline_gap::finding::Verdict;
use plumbline_gap::{Finding, Options, find};
use plumbline_model::Unattended;

/// The elbow in the list of joints, and the joint that turns the whole arm.
const ELBOW: usize = 3;
const SHOULDER: usize = 0;

/// Poses whose elbow is turned by what is said of each row (and of the row before), rad.
fn turned(by: impl Fn(&[f64], Option<&[f64]>) -> f64, seed: u64) -> Measurements {
    let plan = Plan { places: 80, repeats: 1, noise_m: 3e-4, ..Plan::default() };
    let mut measurements = poses(&plan, &[], seed);
    let zero = |offset_rad: f64, of: &Measurements| Assumed {
        effects: vec![present(of, "joint-zero", "r_elbow_y", &[offset_rad])],
        ..Assumed::nominal(of)
    };
    let plain = zero(0.0, &measurements);
    for i in 0..measurements.rows.len() {
        let before = i.checked_sub(1).map(|before| measurements.rows[before].angles_rad().to_vec());
        let row = &measurements.rows[i];
        let off = zero(by(row.angles_rad(), before.as_deref()), &measurements);
        let (with, without) = (measurements.predict(row, &off), measurements.predict(row, &plain));
        // In the frame of the robot; that of the instrument lies anywhere, and a turn of it changes no length.
        let moved: Vec<f64> =
            with.expect("an arm").iter().zip(without.expect("an arm")).map(|(a, b)| a - b).collect();
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.4, -1.1, 2.0));
        let moved = turn * nalgebra::Vector3::from_column_slice(&moved);
        measurements.rows[i].measured.iter_mut().zip(moved.iter()).for_each(|(at, by)| *at += by);
    }
    measurements
}

fn finding(measurements: &Measurements) -> Finding {
    let options = Options { show: false, advise: false, ..Options::default() };
    find(measurements, &options, &Unattended).expect("enough rows")
}

fn says(finding: &Finding, words: &str) -> bool {
    finding.unexplained.depends_on.iter().any(|on| on.on.contains(words) || on.of.contains(words))
}

#[test]
fn a_joint_that_another_one_pulls_at_is_something_unknown_and_the_other_one_is_told() {
    for seed in [1, 2] {
        let pulled = turned(|angles, _| 0.05 * ((angles[SHOULDER] + 0.03) / 0.35).powi(2), seed);
        let finding = finding(&pulled);
        assert_eq!(finding.verdict, Verdict::NotInLibrary, "{:?}", finding.effects);
        assert!(says(&finding, "shoulder"), "{:?}", finding.unexplained.depends_on);
    }
}

#[test]
fn a_joint_that_remembers_how_far_it_came_is_something_unknown() {
    for seed in [1, 2] {
        let remembers = turned(
            |now, before| {
                before.map_or(0.0, |before| 0.03 * ((now[ELBOW] - before[ELBOW]) / 0.2).clamp(-1.0, 1.0))
            },
            seed,
        );
        let finding = finding(&remembers);
        assert_eq!(finding.verdict, Verdict::NotInLibrary, "{:?}", finding.effects);
        assert!(says(&finding, "came"), "{:?}", finding.unexplained.depends_on);
    }
}

#[test]
fn where_nothing_of_that_is_there_a_zero_has_its_name() {
    for seed in [1, 2] {
        let finding = finding(&turned(|_, _| 0.03, seed));
        assert_eq!(finding.verdict, Verdict::Named, "{:?} {:?}", finding.effects, finding.unexplained);
        assert_eq!(
            (finding.effects[0].id.as_str(), finding.effects[0].site.as_str()),
            ("joint-zero", "r_elbow_y")
        );
    }
}

//! Masses that nobody weighed: what is found from loads is known no better than they are.

mod common;

use common::{Plan, normal, present, touches};
use plumbline_effects::{Assumed, Measurements, Situation};
use plumbline_gap::finding::NamedEffect;
use plumbline_gap::{Options, find};
use plumbline_model::Unattended;
use rand::SeedableRng;
use rand::rngs::StdRng;

/// Touches of an arm whose links weigh these shares more than described, with a bracket of the shoulder that
/// gives way by 0.04 rad/N m.
fn sagging(masses: [f64; 6], payloads: Vec<f64>, seed: u64) -> Measurements {
    let plan = Plan { places: 80, payloads, noise_m: 0.3e-3, ..Plan::default() };
    let mut made = touches(&plan, &[], seed);
    let described = made.apparatuses.clone();
    weigh(&mut made, masses);
    let hidden = present(&made, "joint-sag", "r_shoulder_y", &[0.04]);
    let truth = Assumed { effects: vec![hidden], ..Assumed::nominal(&made) };
    let mut random = StdRng::seed_from_u64(seed + 500);
    for i in 0..made.rows.len() {
        // The servo holds: what gives way is behind its encoder.
        made.rows[i].encoder_rad = made.rows[i].commanded_rad.clone();
        let exact = made.predict(&made.rows[i], &truth).expect("predictable");
        let noise = [0, 1].map(|_| plan.noise_m * normal(&mut random));
        // The finger meets the glass where it is: what it is lower by is not in the touch.
        made.rows[i].measured = vec![exact[0] + noise[0], exact[1] + noise[1], exact[2]];
    }
    made.apparatuses = described;
    made
}

fn weigh(made: &mut Measurements, masses: [f64; 6]) {
    for apparatus in &mut made.apparatuses {
        let parts = apparatus.arm.iter_mut().flat_map(|arm| &mut arm.parts);
        parts.zip(masses).for_each(|(part, more)| part.mass_kg *= 1.0 + more);
    }
}

fn sag(made: &Measurements) -> Option<NamedEffect> {
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(made, &options, &Unattended).expect("can be looked at");
    finding.effects.into_iter().find(|effect| effect.id == "joint-sag" && effect.site == "r_shoulder_y")
}

#[test]
fn a_compliance_found_from_loads_is_known_no_better_than_masses() {
    let made = sagging([0.2, 0.2, 0.15, 0.15, 0.2, 0.2], vec![0.0], 3);
    let found = sag(&made).expect("it is found");
    let of = &found.parameters[0];
    assert!(of.low < 0.04 && 0.04 < of.high, "{of:?}");
    // One weight: masses and compliance act alike, and masses are known to a fifth.
    assert!(of.high - of.low > 0.2 * of.value, "{of:?}");
}

#[test]
fn a_known_weight_makes_the_interval_smaller() {
    let width = |payloads: Vec<f64>| {
        let found = sag(&sagging([0.0; 6], payloads, 5)).expect("it is found");
        (found.parameters[0].high - found.parameters[0].low) / found.parameters[0].value
    };
    let (alone, with) = (width(vec![0.0, 0.02]), width(vec![0.0, 0.4]));
    assert!(with < 0.9 * alone, "{with} {alone}");
}

#[test]
fn a_link_that_is_heavier_is_named_where_servos_give_way_beside_a_known_weight() {
    let (payloads, sides) = (vec![0.0, 0.4], vec!["plus", "minus"]);
    let plan = Plan { places: 80, payloads, sides, noise_m: 0.3e-3, ..Plan::default() };
    let mut made = touches(&plan, &[], 9);
    let arm = made.apparatuses[0].arm.clone().expect("an arm");
    let (link, more) = (2, 0.6);
    let mut heavier = arm.clone();
    heavier.parts[link].mass_kg *= 1.0 + more;
    let mut random = StdRng::seed_from_u64(10);
    for row in &mut made.rows {
        let encoder_rad = row.angles_rad().to_vec();
        let up = nalgebra::Vector3::z();
        let at = Situation::new(&heavier, &encoder_rad, &row.direction, row.payload_kg, &up);
        let gives = at.torques_nm().iter().map(|nm| nm / 8.0);
        let commanded =
            encoder_rad.iter().zip(gives).map(|(q, gives)| q - gives + 2e-4 * normal(&mut random));
        (row.commanded_rad, row.encoder_rad) = (Some(commanded.collect()), Some(encoder_rad));
    }
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(&made, &options, &Unattended).expect("can be looked at");
    let found: Vec<String> = finding.effects.iter().map(|e| format!("{}@{}", e.id, e.site)).collect();
    assert_eq!(found, [format!("link-mass@{}", arm.parts[link].link)], "{}", finding.sentence);
    let mass = &finding.effects[0].parameters[0];
    let truth = more * arm.parts[link].mass_kg;
    assert!(mass.low < truth && truth < mass.high, "{mass:?} {truth}");
    assert!(finding.effects[0].not_addable.is_some() && finding.addable().is_empty());
    assert!(finding.sentence.contains("weigh it"), "{}", finding.sentence);
}

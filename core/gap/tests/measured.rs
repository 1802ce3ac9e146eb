//! Data of the real robot, where they are at hand: held-out errors.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

use std::time::Instant;

use plumbline_effects::Measurements;
use plumbline_gap::{Finding, Options, Verdict, find};
use plumbline_model::robot::Rig;
use plumbline_model::{Session, Unattended, measured_data};

/// Rows of a session; none where the data are not at hand.
fn session(name: &str) -> Option<Measurements> {
    let folder = match measured_data::folder(name) {
        Ok(folder) => folder,
        Err(not_at_hand) => {
            println!("{not_at_hand}");
            return None;
        }
    };
    let session = Session::read(&folder).expect("a session");
    let rig = Rig::built_in("nico").expect("comes along");
    Some(Measurements::of_sessions(&[(name.to_owned(), session)], &rig).expect("usable"))
}

fn found(measurements: &Measurements) -> Finding {
    let start = Instant::now();
    let options = Options { show: false, ..Options::default() };
    let verdict = find(measurements, &options, &Unattended).expect("can be looked at");
    println!("{} rows, verdict in {:.1} s", measurements.rows.len(), start.elapsed().as_secs_f64());
    let start = Instant::now();
    let finding = find(measurements, &Options::default(), &Unattended).expect("can be looked at");
    println!("with held-out rows in {:.1} s", start.elapsed().as_secs_f64());
    // Held-out rows could take names back; of these data they do not.
    assert_eq!(verdict.verdict, finding.verdict);
    print(&finding);
    finding
}

fn print(finding: &Finding) {
    println!("{:?}: {}", finding.verdict, finding.sentence);
    let (comparison, shown) = (&finding.comparison, &finding.shown);
    println!(
        "p {:.2e}, {:.2} sigmas, {} of {} rows kept, {:?}",
        comparison.p_value, comparison.size_sigmas, comparison.rows_kept, comparison.rows, finding.warnings
    );
    for coordinate in comparison.kinds.iter().flat_map(|kind| &kind.coordinates) {
        println!(
            "  {}: rms {:.5}, floor {:.5}, {:.2}",
            coordinate.name, coordinate.rms, coordinate.floor, coordinate.share
        );
    }
    for effect in &finding.effects {
        let class: Vec<String> =
            effect.class.iter().map(|member| format!("{}@{}", member.id, member.site)).collect();
        println!(
            "  {}@{} {:.3} {:?} class {class:?}",
            effect.id, effect.site, effect.probability, effect.values
        );
    }
    println!(
        "{}: {:.2} -> {:.2}, floor {:.2} over {} rows; worst tenth {:.1?}, inside {:.2}, closure {:?} {:?}",
        shown.blocks,
        1e3 * shown.before,
        1e3 * shown.after,
        1e3 * shown.floor,
        shown.rows,
        shown.worst_tenth.map(|error| 1e3 * error),
        shown.inside_95,
        shown.closure,
        shown.closure_range
    );
    let told: Vec<&str> = shown.telling.iter().map(|&c| shown.covariates[c].0.as_str()).collect();
    // Outliers included, as someone would who does not know of them.
    let length = |arrow: [f64; 3]| 1e3 * arrow[0].hypot(arrow[1]);
    let all = |of: fn(&plumbline_gap::finding::Residual) -> [f64; 3]| {
        comparison.residuals.iter().map(|row| length(of(row))).sum::<f64>()
            / comparison.residuals.len() as f64
    };
    println!(
        "all {} rows on the table: {:.2} -> {:.2} mm",
        comparison.rows,
        all(|row| row.before_m),
        all(|row| row.after_m)
    );
    println!("told by {told:?}; unexplained {:?}", finding.unexplained);
}

#[test]
fn touches_of_the_real_arm() {
    let Some(measurements) = session("nico-touch/touch-245") else { return };
    let finding = found(&measurements);
    // Skewed axes and wrong zeros are alike in these touches.
    assert_eq!(finding.verdict, Verdict::Class);
    assert!(finding.comparison.is_gap);
    assert!(finding.shown.before > 4e-3 && finding.shown.before < 7e-3, "{}", finding.shown.before);
    assert!(finding.shown.after <= 3.8e-3, "{}", finding.shown.after);
    // All encoders were read early, and that of the arm's lift by another share.
    let early: Vec<&str> = finding
        .effects
        .iter()
        .filter(|effect| effect.id == "early-log")
        .map(|effect| effect.site.as_str())
        .collect();
    assert!(early.contains(&"") && early.contains(&"r_arm_x"), "{early:?}");
    // Much is off in this arm; early logs stand out of it, zeros do not.
    assert!(finding.many.is_some(), "{}", finding.sentence);
    for effect in &finding.effects {
        assert_eq!(effect.id == "early-log", effect.probability > 0.5, "{effect:?}");
    }
}

#[test]
fn touches_of_the_real_arm_by_commands_alone() {
    let Some(mut measurements) = session("nico-touch/touch-245") else { return };
    measurements.rows.iter_mut().for_each(|row| row.encoder_rad = None);
    let finding = found(&measurements);
    // Zeros of up to 6° and a shoulder that bends explain it best, and are what much that is off looks like.
    assert_eq!(finding.verdict, Verdict::Class);
    assert!(finding.many.is_some_and(|probability| probability > 0.9), "{}", finding.sentence);
    assert!(finding.effects.iter().all(|effect| effect.probability < 0.5), "{:?}", finding.effects);
    assert!(finding.comparison.is_gap);
    // A least-squares placement in the plane alone leaves 6.7 mm; here heights hold the frame too.
    assert!((finding.shown.before - 6.7e-3).abs() < 1e-3, "{}", finding.shown.before);
    assert!(finding.shown.after < 0.75 * finding.shown.before);
}

/// The published pivot reaches 7.6 mm on all 36 places, fitted to the same; here each place is predicted without it,
/// and one that was set aside as an outlier is judged with the others.
#[test]
fn places_of_the_real_eyes() {
    let Some(measurements) = session("nico-vision/grid-z5") else { return };
    let finding = found(&measurements);
    // A right eye that is turned sideways, or whose image is shifted: four to one, which is on the edge of one name.
    assert!(matches!(finding.verdict, Verdict::Class | Verdict::Named), "{:?}", finding.verdict);
    assert!(finding.comparison.is_gap);
    assert!((finding.shown.before - 36.8e-3).abs() < 1.5e-3, "{}", finding.shown.before);
    let after_m: Vec<f64> =
        finding.comparison.residuals.iter().map(|row| row.after_m[0].hypot(row.after_m[1])).collect();
    let mean_mm = 1e3 * after_m.iter().sum::<f64>() / after_m.len() as f64;
    println!(
        "{:.2} mm on {} rows, {mean_mm:.2} mm on all {}",
        1e3 * finding.shown.after,
        finding.shown.rows,
        after_m.len()
    );
    for effect in &finding.effects {
        println!("{}@{}: {:.3?}", effect.id, effect.site, effect.values);
    }
    assert!(finding.shown.after <= 7.5e-3 && mean_mm <= 7.5, "{} {mean_mm}", finding.shown.after);
}

#[test]
fn each_joint_of_the_real_arm_that_turns_the_other_way_is_refused() {
    let Some(measurements) = session("nico-touch/touch-245") else { return };
    let joints = measurements.apparatuses[0].arm.as_ref().expect("an arm").len();
    for joint in 0..joints {
        let mut turned = measurements.clone();
        for row in &mut turned.rows {
            for angles in [&mut row.commanded_rad, &mut row.encoder_rad].into_iter().flatten() {
                angles[joint] *= -1.0;
            }
        }
        let error = find(&turned, &Options::default(), &Unattended).expect_err("nonsense");
        println!("{error}");
        assert!(error.to_string().contains("turns the other way"), "{error}");
    }
}

//! A UR10 measured by a laser tracker, two series with the target mounted anew: what is found on one has
//! to hold on the other.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

use std::time::Instant;

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::What;
use plumbline_effects::{Assumed, Effect, Measurements, Present};
use plumbline_gap::{Finding, GapError, Options, Turns, find};
use plumbline_model::robot::Rig;
use plumbline_model::{Session, Unattended, measured_data};

/// A series; `None` where the data are not at hand.
fn series(name: &str) -> Option<Measurements> {
    let folder = match measured_data::folder(&format!("robots/ur10/{name}")) {
        Ok(folder) => folder,
        Err(not_at_hand) => {
            println!("{not_at_hand}");
            return None;
        }
    };
    let session = Session::read(&folder).expect("a session");
    let rig = Rig::read_measured(&folder.join("../ur10.urdf")).expect("a description");
    let mut made = Measurements::of_sessions(&[(name.to_owned(), session)], &rig).expect("usable");
    // The target was mounted anew for each series.
    made.apparatuses[0].tip_is_unknown = true;
    Some(made)
}

/// The same without orientations.
fn places_only(mut of: Measurements) -> Measurements {
    for row in &mut of.rows {
        row.what = What::Pose;
        row.measured.truncate(3);
        row.orientation = None;
    }
    of
}

/// Effects as they were found.
fn effects(finding: &Finding, of: &Measurements) -> Vec<Present> {
    let arm = of.apparatuses[0].arm.as_ref();
    let found = finding.effects.iter().map(|effect| Present {
        effect: Effect::find(&effect.id, &effect.site, effect.shape, arm, None).expect("of the library"),
        values: effect.values.clone(),
    });
    found.collect()
}

/// Mean distance (mm) and mean turn (°) with these effects, the frame and the place of the target fitted
/// to all rows by least squares.
fn refitted(of: &Measurements, effects: Vec<Present>) -> [f64; 2] {
    let mut assumed = Assumed { effects, ..start(of) };
    let free = of.nuisances();
    let weight = |c: usize| if c < 3 { 1.0 / 1e-4 } else { 1.0 / 2e-4 };
    for _ in 0..8 {
        let mut normal = DMatrix::<f64>::identity(free.len(), free.len());
        let mut right = DVector::zeros(free.len());
        for row in &of.rows {
            let tangents = of.tangents(row, &assumed, &[]).expect("predictable");
            for c in 0..row.measured.len() {
                let line = DVector::from_iterator(
                    free.len(),
                    free.iter().map(|nuisance| weight(c) * of.nuisance_slope(row, &tangents, c, *nuisance)),
                );
                right.axpy(weight(c) * (row.measured[c] - tangents.predicted[c]), &line, 1.0);
                normal.ger(1.0, &line, &line, 1.0);
            }
        }
        let step = Cholesky::new(normal).expect("positive").solve(&right);
        of.move_nuisances(&mut assumed, &free, step.as_slice(), 0.5);
    }
    let count = of.rows.len() as f64;
    let mut sums = [0.0; 2];
    for row in &of.rows {
        let predicted = of.predict(row, &assumed).expect("predictable");
        let off: Vec<f64> = row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
        sums[0] += 1e3 * off[..3].iter().map(|v| v * v).sum::<f64>().sqrt() / count;
        sums[1] += off[3..].iter().map(|v| v * v).sum::<f64>().sqrt().to_degrees() / count;
    }
    sums
}

/// Frames where a search would place them: found without advice, shown nothing.
fn start(of: &Measurements) -> Assumed {
    let options = Options { show: false, advise: false, most_effects: 0, ..Options::default() };
    let finding = find(of, &options, &Unattended).expect("can be looked at");
    Assumed { placements: finding.placements, mounts: finding.mounts, effects: vec![] }
}

fn say(finding: &Finding) {
    println!("{:?}: {}", finding.verdict, finding.sentence);
    for coordinate in finding.comparison.kinds.iter().flat_map(|kind| &kind.coordinates) {
        println!("  {}: rms {:.6}, floor {:.6}", coordinate.name, coordinate.rms, coordinate.floor);
    }
    for effect in &finding.effects {
        println!(
            "  {}@{} {:.3}, {:.2} floors",
            effect.id, effect.site, effect.probability, effect.size_sigmas
        );
        for p in &effect.parameters {
            println!("    {} {:.6} ({:.6} to {:.6})", p.name, p.value, p.low, p.high);
        }
    }
    println!("unexplained {:?}", finding.unexplained);
}

fn both_ways(change: impl Fn(Measurements) -> Measurements) -> Option<Vec<[[f64; 2]; 2]>> {
    let (a, c) = (change(series("a")?), change(series("c")?));
    let whole = series("a").zip(series("c"))?;
    let mut all = vec![];
    for (learned, other, judged) in [(&a, &whole.1, "c"), (&c, &whole.0, "a")] {
        let begun = Instant::now();
        let options = Options { show: false, advise: false, ..Options::default() };
        let finding = find(learned, &options, &Unattended).expect("can be looked at");
        say(&finding);
        let nominal = refitted(other, vec![]);
        let with = refitted(other, effects(&finding, other));
        println!(
            "judged on {judged}: {:.3} mm, {:.4}° nominal, {:.3} mm, {:.4}° with what was found; {:.1} s",
            nominal[0],
            nominal[1],
            with[0],
            with[1],
            begun.elapsed().as_secs_f64()
        );
        all.push([nominal, with]);
    }
    Some(all)
}

#[test]
fn a_joint_that_turns_otherwise_is_refused_by_name() {
    let Some(all) = series("a").zip(series("c")).map(|(a, c)| [a, c]) else { return };
    for made in all {
        let joints: Vec<String> = made.apparatuses[0]
            .arm
            .iter()
            .flat_map(|arm| &arm.parts)
            .map(|part| part.joint.clone())
            .collect();
        for (j, joint) in joints.iter().enumerate() {
            for (factor, turns) in [(-1.0, Turns::TheOtherWay), (2.0, Turns::HalfAsFar)] {
                let mut wrong = made.clone();
                for row in &mut wrong.rows {
                    row.commanded_rad.iter_mut().for_each(|angles| angles[j] *= factor);
                }
                let options = Options { show: false, advise: false, ..Options::default() };
                let error = find(&wrong, &options, &Unattended).expect_err("a joint is wrong");
                let named = matches!(&error, GapError::OtherTurn { joint: named, turns: how, .. }
                    if named == joint && *how == turns);
                assert!(named, "{joint} times {factor}: {error}");
            }
        }
    }
}

#[test]
fn what_poses_tell_holds_on_a_target_that_was_mounted_anew() {
    let Some(all) = both_ways(|of| of) else { return };
    for [nominal, with] in all {
        assert!(with[0] <= 0.45, "{with:?}");
        assert!(with[1] <= nominal[1], "{with:?} {nominal:?}");
    }
}

#[test]
fn what_places_alone_tell_is_never_worse_than_nothing() {
    let Some(all) = both_ways(places_only) else { return };
    for [nominal, with] in all {
        assert!(with[0] <= nominal[0], "{with:?} {nominal:?}");
        assert!(with[1] <= 1.02 * nominal[1], "{with:?} {nominal:?}");
    }
}

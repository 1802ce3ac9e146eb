//! A UR10 measured by a laser tracker, two series with the target mounted anew: what is found on one has
//! to hold on the other.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

use std::f64::consts::TAU;
use std::time::Instant;

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::What;
use plumbline_effects::{Assumed, Effect, Measurements, Present};
use plumbline_gap::finding::FloorSource;
use plumbline_gap::{Finding, GapError, Options, Turns, Verdict, find};
use plumbline_model::robot::Rig;
use plumbline_model::{Session, Unattended, measured_data};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

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

/// Effects that were found and can be added.
fn effects(finding: &Finding, of: &Measurements) -> Vec<Present> {
    let arm = of.apparatuses[0].arm.as_ref();
    let addable = finding.addable().into_iter().map(|i| &finding.effects[i]);
    let found = addable.map(|effect| Present {
        effect: Effect::find(&effect.id, &effect.site, effect.shape, arm, None).expect("of the library"),
        values: effect.values.clone(),
    });
    found.collect()
}

/// Mean distance (mm) and mean turn (°) with these effects, the frame and the place of the target fitted
/// to all rows by least squares, places before turns.
fn refitted(of: &Measurements, effects: Vec<Present>) -> [f64; 2] {
    let mut assumed = Assumed { effects, ..start(of) };
    let free = of.nuisances();
    let weight = |c: usize| if c < 3 { 1.0 / 1e-4 } else { 1.0 / 1e-3 };
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
    Assumed { placements: finding.placements, mounts: finding.mounts, ..Assumed::default() }
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

/// An arm of seven joints, measured at random poses that are never repeated.
fn seven_joints(rows: usize, seed: u64) -> Measurements {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut urdf = "<robot name=\"seven\"><link name=\"l0\"/>".to_owned();
    for k in 0..7 {
        let axis = ["0 0 1", "0 1 0"][k % 2];
        let next = k + 1;
        urdf += &format!(
            "<joint name=\"a{next}\" type=\"revolute\"><parent link=\"l{k}\"/><child link=\"l{next}\"/>\
             <origin xyz=\"0 0.02 0.2\"/><axis xyz=\"{axis}\"/><limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/>\
             </joint><link name=\"l{next}\"/>"
        );
    }
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("seven.urdf", &(urdf + "</robot>"));
    let names: Vec<String> = (1..8).map(|k| format!("a{k}")).collect();
    write(
        "session.toml",
        &format!(
            "format = 1\nrig_file = \"seven.urdf\"\nstarted = 2026-01-01T00:00:00Z\n[chain]\ntip = \"l7\"\njoints = {names:?}\n"
        ),
    );
    let columns: Vec<String> = names.iter().map(|name| format!("cmd_{name}_rad")).collect();
    let mut text = format!("{},meas_x_m,meas_y_m,meas_z_m\n", columns.join(","));
    let mut random = StdRng::seed_from_u64(seed);
    for _ in 0..rows {
        let angles: Vec<String> = (0..7).map(|_| random.random_range(-1.2..1.2f64).to_string()).collect();
        text += &format!("{},0,0,0\n", angles.join(","));
    }
    write("poses.csv", &text);
    let session = Session::read(folder.path()).expect("a session");
    let rig = Rig::read_measured(&folder.path().join("seven.urdf")).expect("a description");
    let mut made = Measurements::of_sessions(&[("seven".to_owned(), session)], &rig).expect("usable");
    // Zeros and skews of some centimeters at the tip, half a millimeter of noise.
    let arm = made.apparatuses[0].arm.clone();
    let every = |id: &str| Effect::find(id, "", None, arm.as_ref(), None).expect("a family");
    let mut drawn = |effect: Effect, size: f64| {
        let values = effect.parameters().iter().map(|_| size * random.random_range(-1.0..1.0)).collect();
        Present { effect, values }
    };
    let effects = vec![drawn(every("joint-zero"), 0.02), drawn(every("axis-skew"), 0.01)];
    let truth = Assumed { effects, ..Assumed::nominal(&made) };
    for i in 0..made.rows.len() {
        let exact = made.predict(&made.rows[i], &truth).expect("predictable");
        made.rows[i].measured = exact.iter().map(|at| at + 5e-4 * random.random_range(-1.7..1.7)).collect();
    }
    made
}

#[test]
fn random_poses_without_repeats_are_never_declared_free_of_a_gap() {
    for seed in 1..4 {
        let made = seven_joints(60, seed);
        let options = Options { show: false, advise: false, ..Options::default() };
        let finding = find(&made, &options, &Unattended).expect("can be looked at");
        println!("{:?}: {}", finding.verdict, finding.sentence);
        assert_eq!(finding.comparison.floor_source, FloorSource::Fitted);
        assert_ne!(finding.verdict, Verdict::NoGap, "{}", finding.sentence);
    }
}

/// The same from a tracker that sways on its tripod, two turns and a half while the poses come, so far (m) to either side.
fn swaying(by_m: f64, seed: u64) -> Measurements {
    let mut made = seven_joints(100, seed);
    let count = made.rows.len() as f64;
    for (i, row) in made.rows.iter_mut().enumerate() {
        row.t_secs = Some(20.0 * i as f64);
        row.measured[1] += by_m * (2.5 * TAU * i as f64 / count).sin();
    }
    made
}

#[test]
fn a_tracker_that_sways_is_no_noise_though_no_pose_is_repeated() {
    let options = Options { show: false, advise: false, ..Options::default() };
    for seed in 1..4 {
        let [stands, sways] = [0.0, 3e-3].map(|by_m| {
            let finding = find(&swaying(by_m, seed), &options, &Unattended).expect("can be looked at");
            println!("{:?}: {}", finding.verdict, finding.sentence);
            finding
        });
        assert_eq!(stands.comparison.floor_source, FloorSource::Fitted);
        assert_ne!(stands.verdict, Verdict::NotInLibrary, "{}", stands.sentence);
        assert_eq!(sways.verdict, Verdict::NotInLibrary, "{}", sways.sentence);
        assert!(sways.sentence.contains("time"), "{}", sways.sentence);
    }
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
            for (factor, turns) in [(-1.0, Turns::TheOtherWay), (0.5, Turns::TwiceAsFar)] {
                let mut wrong = made.clone();
                for row in &mut wrong.rows {
                    row.commanded_rad.iter_mut().for_each(|angles| angles[j] *= factor);
                }
                let options = Options { show: false, advise: false, ..Options::default() };
                let Err(error) = find(&wrong, &options, &Unattended) else {
                    panic!("{joint} times {factor} was not noticed");
                };
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
        assert!(with[0] <= 0.49, "{with:?}");
        assert!(with[1] <= nominal[1], "{with:?} {nominal:?}");
    }
}

#[test]
fn what_places_alone_tell_does_not_turn_the_tip() {
    let Some(all) = both_ways(places_only) else { return };
    let [nominal, with] = all[0];
    assert!(with[0] <= 0.6 * nominal[0], "{with:?} {nominal:?}");
    assert!(with[1] <= nominal[1], "{with:?} {nominal:?}");
    // The other way little is told without orientations, and what is not told is not added.
    let [nominal, with] = all[1];
    assert!(with[0] <= nominal[0] && with[1] <= nominal[1], "{with:?} {nominal:?}");
}

#[test]
fn a_marker_that_stands_turned_is_taken_as_mounted_anew() {
    let Some(mut made) = series("a") else { return };
    // As the session has it: nobody said that the target was mounted anew.
    made.apparatuses[0].tip_is_unknown = false;
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(&made, &options, &Unattended).expect("can be looked at");
    say(&finding);
    assert!(finding.warnings.iter().any(|words| words.contains("mounted anew")), "{:?}", finding.warnings);
    assert!(!finding.mounts.is_empty());
    assert!(finding.effects.iter().all(|effect| effect.not_addable.is_none()), "{}", finding.sentence);
}

#[test]
#[ignore = "a measurement of time"]
fn time_of_many_poses_of_seven_joints() {
    let made = seven_joints(1500, 1);
    for show in [false, true] {
        let begun = Instant::now();
        let options = Options { show, advise: false, ..Options::default() };
        let finding = find(&made, &options, &Unattended).expect("can be looked at");
        println!("{:?}, held out: {show}, {:.1} s", finding.verdict, begun.elapsed().as_secs_f64());
        assert_ne!(finding.verdict, Verdict::NoGap, "{}", finding.sentence);
    }
}

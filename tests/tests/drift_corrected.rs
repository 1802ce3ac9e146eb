//! The warm-up of the twin's eyes is watched, explained by the gap search and corrected by name: in the laboratory and
//! in two worlds drawn by chance, with the head as it stood and turned, and whether the stated uncertainty holds.
//!
//! `cargo test --release -p plumbline-tests --test drift_corrected -- --nocapture` prints the table.
//! What watches, explains and corrects reads images, encoders and the eyes' clock; only the judge reads the truth.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use image::GrayImage;
use nalgebra::{Matrix2, Matrix3, Point3, Vector3};
use plumbline_drift::{Monitor, Sample, ToGo, Verdict, Watcher, WatcherSetup, log_of};
use plumbline_effects::{Measurements, RigModel, RobotModel, SeenUnder};
use plumbline_gap::{Finding, Options, find};
use plumbline_model::measured_data::left_out;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::session::Manifest;
use plumbline_model::{Session, Unattended};
use plumbline_twin::eyes::RenderError;
use plumbline_twin::{Lockstep, Scenario, Toy};

/// Seconds between looks: the window looks more often.
const EVERY_S: f64 = 10.0;

/// Looks from switching on for so many minutes; `None`: nothing can be drawn on this machine.
fn watched(twin: &mut Lockstep, model: &Arc<RobotModel>, minutes: f64) -> Option<Monitor> {
    let (mut watcher, mut monitor) = (Watcher::default(), Monitor::default());
    while twin.eyes_on_s() < 60.0 * minutes {
        let pair = match twin.look() {
            Ok(pair) => pair,
            Err(RenderError::NoAdapter) => {
                left_out("no Vulkan device on this machine");
                return None;
            }
            Err(error) => panic!("{error}"),
        };
        let gray = |image| -> GrayImage { image::imageops::grayscale(image) };
        let setup = WatcherSetup {
            model: model.clone(),
            posture: twin.encoders(),
            eyes_on_s: Some(twin.eyes_on_s()),
            references: Vec::new(),
        };
        let look = watcher.look(&setup, (&gray(&pair.left), &gray(&pair.right))).expect("enough to see");
        monitor.add(Sample { at_s: twin.eyes_on_s(), look });
        twin.wait(0.02);
        twin.advance_warm_up(EVERY_S - 0.02);
    }
    Some(monitor)
}

fn explained(rig: &Rig, twin: &Lockstep, monitor: &Monitor) -> (Session, Finding) {
    let table = log_of(rig, &twin.encoders(), monitor.samples()).expect("long enough");
    let manifest = Manifest::of_rig(rig.name.as_str(), jiff::Timestamp::UNIX_EPOCH);
    let session = Session { localizations: Some(table), ..Session::new(manifest) };
    let rows = Measurements::of_sessions(&[("watched".to_owned(), session.clone())], rig).expect("usable");
    let finding = find(&rows, &Options::default(), &Unattended).expect("can be looked at");
    (session, finding)
}

/// A quantile of the squared distance of two normal numbers: 95 %.
const INSIDE_95: f64 = 5.991;
/// When it is judged, minutes since switching on.
const JUDGED_MIN: [f64; 4] = [3.0, 6.0, 10.0, 20.0];
/// What is said of the time to go holds the truth to so much, s.
const TO_GO_WITHIN_S: f64 = 90.0;
/// With cold eyes, for which everything was calibrated, the correction moves no place by more than this, m.
const COLD_M: f64 = 2e-3;
/// Places are judged on the table, and so far above it: what is corrected in the ray holds there as well.
const ABOVE_M: [f64; 2] = [0.0, 0.1];
/// So far the head is turned to the side for the second half of the table, rad.
const TURNED_RAD: f64 = 0.26;

/// How far off the 9 by 4 places are, across the table, beside what they are off by with cold eyes.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    mean_m: f64,
    worst_m: f64,
    /// Mean of the row at the far end.
    far_m: f64,
    /// Places that lie in the stated 95 % around where they came out.
    inside: usize,
    /// Mean of the stated 95 % along the worst direction, m.
    stated_m: f64,
}

/// Where each of the 36 places comes out minus where it is, and the stated covariance.
type Errors = Vec<(Vector3<f64>, Matrix3<f64>)>;

/// Where places stand is what the twin hides.
fn errors(twin: &mut Lockstep, model: &RobotModel, above_m: f64) -> Errors {
    let (seen, posture) =
        (SeenUnder { t_secs: Some(twin.eyes_on_s()), ..SeenUnder::default() }, twin.encoders());
    let rig = model.rig().clone();
    let eyes = twin.truth_for_judging().eyes;
    let place = |k: usize| {
        let height_m = rig.table.height_m + above_m;
        let at = Point3::new(0.2 + 0.13 * (k / 9) as f64, -0.4 + 0.1 * (k % 9) as f64, height_m);
        let left = eyes.left.project(&(eyes.robot_from_left.isometry.inverse() * at).coords).ok()?;
        let right = eyes.right.project(&(eyes.robot_from_right.isometry.inverse() * at).coords).ok()?;
        let in_left = rig.eyes.cameras.triangulate(left, right)?;
        let put = model.place(&in_left, &Matrix3::zeros(), &posture, &seen)?;
        Some((put.point.coords.coords - at.coords, put.covariance_m2))
    };
    let all: Errors = (0..36).filter_map(place).collect();
    assert_eq!(all.len(), 36, "all places are seen");
    all
}

fn off(now: &Errors, cold: &Errors) -> Off {
    let mut off = Off::default();
    for (k, ((error, covariance_m2), (cold, _))) in now.iter().zip(cold).enumerate() {
        let drift = (error - cold).xy();
        off.mean_m += drift.norm() / 36.0;
        off.worst_m = off.worst_m.max(drift.norm());
        off.far_m += if k >= 27 { drift.norm() / 9.0 } else { 0.0 };
        let flat: Matrix2<f64> = covariance_m2.fixed_view::<2, 2>(0, 0).into();
        let distance = flat.try_inverse().map_or(f64::INFINITY, |inverse| drift.dot(&(inverse * drift)));
        off.inside += usize::from(distance <= INSIDE_95);
        // The larger of the two eigenvalues.
        let apart = (0.5 * (flat.m11 - flat.m22)).hypot(flat.m12);
        let largest_m2 = 0.5 * flat.trace() + apart;
        off.stated_m += (INSIDE_95 * largest_m2.max(0.0)).sqrt() / 36.0;
    }
    off
}

fn world(rig: &Arc<Rig>, scenario: &Scenario) -> Lockstep {
    let mut twin = Lockstep::new(rig.clone(), scenario, 5).expect("a world");
    for toy in Toy::ALL {
        twin.remove_toy(toy);
    }
    twin.place_toy(Toy::Tomato, 0.32, 0.12).expect("on the table");
    twin.place_toy(Toy::Banana, 0.42, -0.18).expect("on the table");
    twin.wait(1.0);
    twin.cool_eyes();
    twin
}

/// When places of the far row are within 2 mm of where they end, s since switching on.
fn warm_s(twin: &mut Lockstep, model: &RobotModel) -> f64 {
    let mut course = Vec::new();
    while twin.eyes_on_s() < 5400.0 {
        course.push((twin.eyes_on_s(), errors(twin, model, 0.0)));
        twin.advance_warm_up(10.0);
    }
    let end = errors(twin, model, 0.0);
    let away_m = |errors: &Errors| (27..36).map(|k| (errors[k].0 - end[k].0).norm()).sum::<f64>() / 9.0;
    course.iter().find(|(_, errors)| away_m(errors) <= 0.002).map_or(f64::INFINITY, |(at_s, _)| *at_s)
}

/// What was said of the time to go, after so many minutes each.
fn told_to_go(monitor: &Monitor) -> Vec<(f64, ToGo)> {
    let mut told = Vec::new();
    let mut so_far = Monitor::default();
    let mut next =
        [2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0, 19.0].into_iter().map(|min: f64| 60.0 * min).peekable();
    for sample in monitor.samples() {
        so_far.add(sample.clone());
        if next.peek().is_some_and(|at_s| sample.at_s >= *at_s) {
            next.next();
            if let Verdict::Warming { to_go: Some(to_go), .. } = so_far.verdict() {
                told.push((sample.at_s, to_go));
            }
        }
    }
    told
}

/// With what was found; as it was where nothing was.
fn corrected(rig: &Arc<Rig>, finding: &Finding, session: Session) -> RobotModel {
    let addable = finding.addable();
    if addable.is_empty() {
        return RobotModel::nominal(rig.clone());
    }
    let nominal = RigModel::nominal(rig);
    let at = jiff::Timestamp::UNIX_EPOCH;
    let added = plumbline_engine::rig_models::with(&nominal, rig, (finding, &[session]), &addable, true, at);
    RobotModel::new(rig.clone(), Arc::new(added.expect("can be added"))).expect("fits")
}

/// Watched for so many minutes, explained, corrected; judged with the head as it stood and turned.
fn judged(name: &str, scenario: &Scenario, watched_min: f64) -> Option<Vec<(f64, bool, Off, Off)>> {
    let rig = default_rig();
    let nominal = Arc::new(RobotModel::nominal(rig.clone()));
    let mut twin = world(&rig, scenario);
    let monitor = watched(&mut twin, &nominal, watched_min)?;
    let warm_s = warm_s(&mut world(&rig, scenario), &nominal);
    for (at_s, ToGo { least_s, about_s, most_s }) in told_to_go(&monitor) {
        println!(
            "{name}: after {:.0} min about {:.0} min to go, {:.0} to {:.0}; truly {:.1}",
            at_s / 60.0,
            about_s / 60.0,
            least_s / 60.0,
            most_s / 60.0,
            (warm_s - at_s).max(0.0) / 60.0
        );
        // Before that the bend hardly shows.
        let truly_s = (warm_s - at_s).max(0.0);
        let held = least_s - TO_GO_WITHIN_S <= truly_s && truly_s <= most_s + TO_GO_WITHIN_S;
        assert!(held || at_s < 300.0, "{name}: {truly_s} s to go after {at_s} s");
    }
    let (session, finding) = explained(&rig, &twin, &monitor);
    println!("{name}: {:?} in {:.1} s: {}", finding.verdict, finding.seconds, finding.sentence);
    for effect in &finding.effects {
        println!("  {} {:?} {:?}", effect.id, effect.shape, effect.values);
    }
    let corrected = corrected(&rig, &finding, session);
    if corrected.is_nominal() {
        println!("{name}: nothing is worth a correction");
    }
    let mut table = Vec::new();
    for is_turned in [false, true] {
        // The same robot, cold again.
        let mut twin = world(&rig, scenario);
        if is_turned {
            let aside = twin.encoders().with(&[rig.eyes.pan], &[TURNED_RAD]);
            twin.follow(&[aside], 0.5);
            twin.cool_eyes();
        }
        let cold = ABOVE_M.map(|above_m| errors(&mut twin, &nominal, above_m));
        let posture = if is_turned { "turned" } else { "fixed" };
        let by_correction = off(&errors(&mut twin, &corrected, 0.0), &cold[0]);
        println!(
            "{name:>8} {posture:>6} cold: the correction moves places by {:.2} mm on average, {:.2} mm at worst",
            by_correction.mean_m * 1e3,
            by_correction.worst_m * 1e3
        );
        assert!(by_correction.worst_m <= COLD_M, "{name}, {posture}: {by_correction:?}");
        for minutes in JUDGED_MIN {
            twin.advance_warm_up(60.0 * minutes - twin.eyes_on_s());
            for (above_m, cold) in ABOVE_M.into_iter().zip(&cold) {
                let [before, after] =
                    [&*nominal, &corrected].map(|model| off(&errors(&mut twin, model, above_m), cold));
                println!(
                    "{name:>8} {posture:>6} {minutes:>4} min, {:>3.0} mm up: mean {:>4.1} → {:.1} mm, worst {:>4.1} → \
                     {:.1} mm, far row {:>4.1} → {:.1} mm, {:>2} of 36 inside the stated 95 % ({:.1} mm)",
                    above_m * 1e3,
                    before.mean_m * 1e3,
                    after.mean_m * 1e3,
                    before.worst_m * 1e3,
                    after.worst_m * 1e3,
                    before.far_m * 1e3,
                    after.far_m * 1e3,
                    after.inside,
                    after.stated_m * 1e3
                );
                table.push((minutes, is_turned, before, after));
            }
        }
    }
    Some(table)
}

fn scenario(name: &str) -> Scenario {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/offline/tests/scenarios");
    let file = folder.join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&file).expect("a scenario of the repository");
    Scenario::from_toml(name, &text).expect("a scenario")
}

/// The share of places inside the stated 95 % over all rows of a table.
fn inside(table: &[(f64, bool, Off, Off)]) -> f64 {
    let inside: usize = table.iter().map(|(.., after)| after.inside).sum();
    inside as f64 / (36 * table.len()) as f64
}

fn holds(name: &str, table: &[(f64, bool, Off, Off)]) {
    for (minutes, is_turned, _, after) in table {
        let about = format!("{name}, {minutes} min, turned: {is_turned}: {after:?}");
        assert!(after.mean_m <= 6e-3 && after.worst_m <= 15e-3, "{about}");
    }
    let share = inside(table);
    println!("{name}: {:.1} % inside the stated 95 %", 100.0 * share);
    assert!(share >= 0.95, "{name}: the stated 95 % hold for {share}");
}

#[test]
fn in_the_laboratory_twenty_minutes_of_warming_up_are_explained_and_corrected() {
    let lab = Scenario::built_in("lab").expect("a scenario");
    let Some(table) = judged("lab", &lab, 20.0) else { return };
    holds("lab", &table);
    let raw_m = table.iter().map(|(_, _, before, _)| before.mean_m).fold(0.0, f64::max);
    assert!(raw_m > 0.03, "there was something to correct: {raw_m}");
}

#[test]
fn in_a_world_drawn_by_chance() {
    let Some(table) = judged("drawn-1", &scenario("drawn-1"), 20.0) else { return };
    holds("drawn-1", &table);
}

/// There the right eye nods and rolls against the left one: places in the middle stay, those at the corners go.
#[test]
fn in_another_world_drawn_by_chance_an_eye_that_rolls_is_named_and_corrected() {
    let Some(table) = judged("drawn-2", &scenario("drawn-2"), 20.0) else { return };
    holds("drawn-2", &table);
    let worst_m = |of: fn(&(f64, bool, Off, Off)) -> f64| table.iter().map(of).fold(0.0, f64::max);
    let [before_m, after_m] = [worst_m(|row| row.2.worst_m), worst_m(|row| row.3.worst_m)];
    assert!(before_m > 15e-3 && after_m < 0.5 * before_m, "{before_m} {after_m}");
}

#[test]
fn after_ten_minutes_only() {
    let lab = Scenario::built_in("lab").expect("a scenario");
    let Some(table) = judged("lab, 10", &lab, 10.0) else { return };
    let later = table.iter().filter(|(minutes, ..)| *minutes > 10.0);
    for (minutes, is_turned, before, after) in later {
        assert!(after.mean_m < 0.4 * before.mean_m, "{minutes} {is_turned}: {after:?}");
    }
    holds("lab, 10", &table);
}

/// Worlds for what watching is off by; others are drawn by other numbers.
#[test]
#[ignore = "takes four minutes: seven worlds"]
fn in_more_worlds_drawn_by_chance() {
    let mut inside_of = vec![];
    for number in 2001..=2007 {
        let name = format!("{}-{number}", if number % 2 == 0 { "drawn" } else { "wide" });
        let text = plumbline_twin::scenario::drawn::named(&name).expect("a robot drawn by chance");
        let drawn = Scenario::from_toml(&name, &text).expect("a scenario");
        let Some(table) = judged(&name, &drawn, 20.0) else { return };
        let worst_m = |of: fn(&(f64, bool, Off, Off)) -> f64| table.iter().map(of).fold(0.0, f64::max);
        let [before_m, after_m] = [worst_m(|row| row.2.mean_m), worst_m(|row| row.3.mean_m)];
        println!("{name}: {:.1} → {:.1} mm, {:.1} %", 1e3 * before_m, 1e3 * after_m, 100.0 * inside(&table));
        inside_of.push(inside(&table));
    }
    let mean = inside_of.iter().sum::<f64>() / inside_of.len() as f64;
    println!("{:.1} % inside the stated 95 % in {} worlds", 100.0 * mean, inside_of.len());
    assert!(mean >= 0.9, "{mean}: {inside_of:?}");
}

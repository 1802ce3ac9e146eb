//! Twenty minutes of warm-up of the twin's eyes are watched, explained by the gap search and corrected by name.
//! What watches, explains and corrects reads images, encoders and the eyes' clock; only the judge reads the truth.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use image::GrayImage;
use nalgebra::{Matrix3, Point3, Vector3};
use plumbline_drift::{Monitor, Sample, Watcher, WatcherSetup, log_of};
use plumbline_effects::{Measurements, RigModel, RobotModel, SeenUnder};
use plumbline_gap::{Finding, Options, find};
use plumbline_model::measured_data::left_out;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::session::{Manifest, RigReference};
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
    let session = Session {
        manifest: Manifest {
            rig: RigReference::Named(rig.name.clone()),
            started: jiff::Timestamp::UNIX_EPOCH,
            operator: String::new(),
            notes: String::new(),
            touchscreen: None,
            chain: None,
            extra: toml::Table::new(),
        },
        touches: None,
        localizations: Some(table),
        poses: None,
        stereo: Default::default(),
        log: None,
    };
    let rows = Measurements::of_sessions(&[("watched".to_owned(), session.clone())], rig).expect("usable");
    let finding = find(&rows, &Options::default(), &Unattended).expect("can be looked at");
    (session, finding)
}

/// Mean and largest error (m) in the plane of the table over 9 by 4 places beside what cold eyes are off by;
/// where they stand is what the twin hides. `None`: of what drifts alone.
fn judged(twin: &mut Lockstep, model: &RobotModel, cold_m: &[Option<Vector3<f64>>]) -> [f64; 2] {
    let errors = errors(twin, model);
    let sizes: Vec<f64> =
        errors.iter().zip(cold_m).filter_map(|(now, cold)| Some(((*now)? - (*cold)?).xy().norm())).collect();
    assert_eq!(sizes.len(), 36, "all places are seen");
    [sizes.iter().sum::<f64>() / 36.0, sizes.iter().copied().fold(0.0, f64::max)]
}

fn errors(twin: &mut Lockstep, model: &RobotModel) -> Vec<Option<Vector3<f64>>> {
    let (seen, posture) = (SeenUnder { t_secs: Some(twin.eyes_on_s()), background_m: None }, twin.encoders());
    let rig = model.rig().clone();
    let eyes = twin.truth_for_judging().eyes;
    let place = |k: usize| {
        let at = Point3::new(0.2 + 0.13 * (k / 9) as f64, -0.4 + 0.1 * (k % 9) as f64, rig.table.height_m);
        let left = eyes.left.project(&(eyes.robot_from_left.isometry.inverse() * at).coords).ok()?;
        let right = eyes.right.project(&(eyes.robot_from_right.isometry.inverse() * at).coords).ok()?;
        let in_left = rig.eyes.cameras.triangulate(left, right)?;
        let put = model.place(&in_left, &Matrix3::zeros(), &posture, &seen)?;
        Some(put.point.coords.coords - at.coords)
    };
    (0..36).map(place).collect()
}

#[test]
fn twenty_minutes_of_warming_up_are_watched_explained_and_corrected() {
    let rig = default_rig();
    let scenario = Scenario::built_in("lab").expect("a scenario");
    let world = || {
        let mut twin = Lockstep::new(rig.clone(), &scenario, 5).expect("a world");
        for toy in Toy::ALL {
            twin.remove_toy(toy);
        }
        twin.place_toy(Toy::Tomato, 0.32, 0.12).expect("on the table");
        twin.place_toy(Toy::Banana, 0.42, -0.18).expect("on the table");
        twin.wait(1.0);
        twin.cool_eyes();
        twin
    };
    let nominal = Arc::new(RobotModel::nominal(rig.clone()));
    let mut twin = world();
    let Some(monitor) = watched(&mut twin, &nominal, 20.0) else { return };
    let (session, finding) = explained(&rig, &twin, &monitor);
    println!("{:?} in {:.1} s: {}", finding.verdict, finding.seconds, finding.sentence);
    for effect in &finding.effects {
        println!("  {} {:?} {:?}", effect.id, effect.shape, effect.values);
    }
    let added = plumbline_engine::rig_models::with(
        &RigModel::nominal(&rig),
        &rig,
        (&finding, &[session]),
        &finding.addable(),
        true,
        jiff::Timestamp::UNIX_EPOCH,
    )
    .expect("can be added");
    let corrected = RobotModel::new(rig.clone(), Arc::new(added)).expect("fits");
    // The same robot, cold again.
    let mut twin = world();
    let cold_m = errors(&mut twin, &nominal);
    let mut last = [0.0; 2];
    for minutes in [0.0, 3.0, 6.0, 10.0, 20.0] {
        twin.advance_warm_up(60.0 * minutes - twin.eyes_on_s());
        let [before, after] = [&*nominal, &corrected].map(|model| judged(&mut twin, model, &cold_m));
        println!(
            "{minutes:>4} min: mean {:.1} → {:.1} mm, worst {:.1} → {:.1} mm",
            before[0] * 1e3,
            after[0] * 1e3,
            before[1] * 1e3,
            after[1] * 1e3
        );
        assert!(after[0] <= 6e-3 && after[1] <= 15e-3, "{minutes} min: {after:?}");
        last = before;
    }
    assert!(last[0] > 0.02, "there was something to correct: {last:?}");
}

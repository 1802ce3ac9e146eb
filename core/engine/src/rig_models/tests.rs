//! The model in use on disk, and what a finding adds to it.

use plumbline_effects::arm::Arm;
use plumbline_effects::{Assumed, Effect, Measurements, Present, Surface, What};
use plumbline_fit::ArmTouches;
use plumbline_gap::finding::{ClassMember, Comparison, FORMAT, FoundParameter, Unexplained, Verdict};
use plumbline_model::Unattended;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::session::{Chain, Manifest, TouchTable};

use super::made_up::model_with;
use super::*;

fn nico() -> Rig {
    Rig::built_in("nico").expect("comes with the program")
}

fn session(rig: &Rig) -> Session {
    let joints = rig.chain("right_index_tip").expect("a tip").names().to_vec();
    let manifest = Manifest {
        touchscreen: Some(rig.touchscreen.clone()),
        chain: Some(Chain { tip: "right_index_tip".to_owned(), joints: joints.clone() }),
        ..Manifest::of_rig("nico", Timestamp::UNIX_EPOCH)
    };
    Session { touches: Some(TouchTable::from_rows(joints, &[])), ..Session::new(manifest) }
}

fn named(id: &str, site: &str, value: f64) -> NamedEffect {
    NamedEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: format!("{site}: {id}"),
        probability: 0.9,
        class_probability: 0.95,
        parameters: vec![FoundParameter {
            name: "offset_rad".to_owned(),
            value,
            low: value - 0.001,
            high: value + 0.001,
            text: None,
        }],
        shape: None,
        reference_s: 0.0,
        values: vec![value],
        covariance: vec![1e-6],
        size_sigmas: 3.0,
        size_m: 4e-3,
        class: vec![ClassMember {
            id: id.to_owned(),
            site: site.to_owned(),
            title: String::new(),
            probability: 1.0,
        }],
        beside: vec![],
        split_by: None,
        runner_up: None,
        not_addable: None,
    }
}

fn finding(effects: Vec<NamedEffect>) -> Finding {
    Finding {
        format: FORMAT,
        rig: "nico".to_owned(),
        sessions: vec!["morning".to_owned()],
        version: "0.1.0".to_owned(),
        seed: 1,
        verdict: Verdict::Named,
        sentence: "The elbow's zero is off.".to_owned(),
        comparison: Comparison {
            rows: 80,
            rows_kept: 80,
            cells: 80,
            kinds: vec![],
            floor_from_repeats: true,
            floor_source: plumbline_gap::finding::FloorSource::Repeats,
            p_value: 1e-9,
            size_sigmas: 3.0,
            is_gap: true,
            residuals: vec![],
        },
        effects,
        candidates: vec![],
        shown: Shown {
            blocks: "5 folds".to_owned(),
            rows: 80,
            unit: ShownUnit::Meter,
            before: 6.7e-3,
            after: 3.6e-3,
            floor: 3e-3,
            closure: Some(0.84),
            closure_range: None,
            worst_tenth: [12e-3, 6e-3],
            inside_95: 0.95,
            unseen: None,
            part: None,
            covariates: vec![],
            telling: vec![],
        },
        unexplained: Unexplained { p_value: 0.2, probability: 0.02, depends_on: vec![], share: 0.1 },
        next: None,
        placements: vec![nalgebra::Isometry3::translation(0.004, -0.002, 0.001)],
        mounts: vec![],
        partial: false,
        many: None,
        undetermined: vec![],
        left_out: vec![],
        warnings: vec![],
        seconds: 1.0,
    }
}

#[test]
fn accepting_and_taking_back_live_on_disk() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("a folder for the test"));
    let world = folder.path().join("twin");
    assert!(load(&world, &rig).expect("nothing there").is_nominal());
    let sessions = [session(&rig)];
    let found = finding(vec![named("joint-zero", "r_elbow_y", 0.03), named("joint-sag", "r_arm_x", 0.01)]);
    let one = accept(&world, &rig, (&found, &sessions), &[0], true).expect("accepted");
    assert_eq!(one.effects().len(), 1);
    let both = accept(&world, &rig, (&found, &sessions), &[1], false).expect("accepted");
    assert_eq!(load(&world, &rig).expect("there").effects(), both.effects());
    assert_eq!(both.effects().len(), 2);
    // The robot moved by the placement is the screen moved the other way.
    let screen = both.screen(&rig.touchscreen).expect("placed");
    let middle = screen.point_at(screen.middle());
    let nominal = rig.touchscreen.point_at(rig.touchscreen.middle());
    let moved = middle.coords - nominal.coords - nalgebra::Vector3::new(-0.004, 0.002, -0.001);
    assert!(moved.norm() < 1e-12);
    let gaps: Vec<[f64; 2]> = history(&both).map(|(_, gap)| [gap.before, gap.after]).collect();
    assert_eq!(gaps, [[6.7e-3, 3.6e-3]; 2]);
    let back = undo(&world, &rig).expect("a step");
    assert_eq!(back.contents.effects, one.contents.effects);
    assert_eq!(history(&back).count(), 1);
    assert!(undo(&world, &rig).expect("a step").is_nominal());
    assert!(undo(&world, &rig).expect_err("none left").to_string().contains("no step left"));
}

#[test]
fn what_cannot_be_accepted_is_said_and_changes_nothing() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("a folder for the test"));
    let sessions = [session(&rig)];
    let mut found = finding(vec![named("joint-zero", "r_elbow_y", 0.03)]);
    let refused = |found: &Finding, sessions: &[Session], effects: &[usize]| {
        accept(folder.path(), &rig, (found, sessions), effects, true).expect_err("refused").to_string()
    };
    assert!(refused(&found, &sessions, &[1]).contains("no such effect"));
    assert!(refused(&found, &sessions, &[]).contains("at least one"));
    assert!(refused(&found, &[], &[0]).contains("not of these sessions"));
    found.effects[0].not_addable = Some("its fit sits at a bound".to_owned());
    assert!(refused(&found, &sessions, &[0]).contains("sits at a bound"));
    assert!(!file(folder.path()).exists());
}

#[test]
fn the_model_of_another_rig_is_refused() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("a folder for the test"));
    save(folder.path(), &model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.03])]), &rig).expect("written");
    let other = Rig { name: "icub".to_owned(), ..rig };
    let said = load(folder.path(), &other).expect_err("another rig").to_string();
    assert!(said.contains("belongs to the robot \"nico\", not to \"icub\""), "{said}");
}

#[test]
fn all_that_was_accepted_is_put_together() {
    use plumbline_model::{StereoCalibration, StereoCameras};

    use crate::eyes::store::Store;

    let (rig, folder) = (nico(), tempfile::tempdir().expect("a folder for the test"));
    let plain = in_use(folder.path(), &rig).expect("nothing was accepted");
    assert!(plain.is_nominal());
    assert_eq!(**plain.rig(), rig);

    let mut cameras: StereoCameras = rig.eyes.cameras;
    cameras.right_from_left.isometry.translation.vector.x *= 1.02;
    let store = Store::of_world(folder.path());
    store.accept(&StereoCalibration::bare(cameras), Timestamp::now()).expect("kept");
    let motion = nalgebra::Isometry3::translation(0.01, 0.0, 0.002);
    let corners = rig.touchscreen.corners();
    let pixels = [[0.0, 0.0], [1919.0, 0.0], [1919.0, 1079.0], [0.0, 1079.0]];
    let touches: Vec<_> = pixels
        .into_iter()
        .map(|[u_px, v_px]| {
            let pixel = plumbline_model::Pixel::new(u_px, v_px);
            (pixel, plumbline_model::Point::from(motion * rig.touchscreen.point_at(pixel).coords))
        })
        .collect();
    let placement = plumbline_model::touchscreen::place_screen(&rig.touchscreen, &touches)
        .expect("four corners")
        .of_rig(&rig.name);
    screen_in(folder.path())
        .put(|error| panic!("{error}"), |file| placement.write(file).map_err(|error| panic!("{error}")))
        .unwrap_or_else(|()| unreachable!("it would have panicked"));
    let effects = model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.03])]);
    save(folder.path(), &effects, &rig).expect("written");

    let all = in_use(folder.path(), &rig).expect("all of it can be used");
    assert_eq!(all.title(), "with 1 effect");
    assert_eq!(all.rig().eyes.head_from_left, rig.eyes.head_from_left);
    assert!((all.rig().eyes.cameras.baseline_m() - cameras.baseline_m()).abs() < 1e-9);
    for (moved, nominal) in all.rig().touchscreen.corners().iter().zip(corners) {
        assert!((moved.coords - nominal.coords - motion.translation.vector).norm() < 1e-9);
    }
    std::fs::write(mount_in(folder.path()).file(), "format = 1\n").expect("written");
    let said = in_use(folder.path(), &rig).expect_err("no mount").to_string();
    assert!(said.contains("mount.toml") && said.ends_with('.'), "{said}");
}

#[test]
fn what_was_not_accepted_of_the_eyes_is_unmeasured_and_whatever_is_accepted_makes_another_model() {
    use nalgebra::Matrix6;
    use plumbline_effects::robot_model::{Mounted, Unmeasured};

    let rig = nico();
    let mounted = Mounted { covariance: Matrix6::identity() * 1e-6, rest_sigma_rad: [0.001; 2] };
    let cameras = Some(&rig.eyes.cameras);
    // A calibration that came out as described, and a mount, are measured all the same.
    let steps = [
        (Accepted::default(), Unmeasured::ALL),
        (Accepted { cameras, ..Accepted::default() }, Unmeasured { lenses: false, ..Unmeasured::ALL }),
        (
            Accepted { cameras, mounted: Some(mounted), ..Accepted::default() },
            Unmeasured { neck: true, ..Unmeasured::default() },
        ),
    ];
    let models = steps.map(|(accepted, unmeasured)| {
        let model = accepted.robot_model(&rig).expect("it fits");
        assert_eq!(model.unmeasured(), unmeasured);
        assert!(accepted.is_in(&model, &rig));
        model
    });
    for (accepted, _) in steps {
        let of_it = models.iter().filter(|model| accepted.is_in(model, &rig)).count();
        assert_eq!(of_it, 1, "{accepted:?}");
    }
}

/// Touches by an arm with small errors, and its session as [`ArmTouches`] wants them.
fn touches_with_errors(rig: &Rig) -> Measurements {
    let arm = Arm::of_rig(rig, "right_index_tip").expect("an arm");
    let solver = Solver::of_rig(rig, "right_index_tip").expect("a tip");
    let hidden = [
        ("joint-zero", "r_elbow_y", 0.03),
        ("joint-zero", "r_shoulder_y", 0.02),
        ("joint-sag", "r_arm_x", 0.02),
    ];
    let effects = hidden.map(|(id, site, value)| Present {
        effect: Effect::find(id, site, None, Some(&arm), None).expect("known"),
        values: vec![value],
    });
    let truth = Assumed {
        effects: effects.to_vec(),
        placements: vec![nalgebra::Isometry3::identity()],
        ..Assumed::default()
    };
    let (screen, home) = (&rig.touchscreen, rig.home());
    let mut rows = vec![];
    for i in 0..24_u32 {
        let pixel =
            plumbline_model::Pixel::new(500.0 + 220.0 * f64::from(i % 6), 150.0 + 240.0 * f64::from(i / 6));
        let target = Target::Position(screen.point_at(pixel));
        let Ok(answer) = solver.solve_from(&target, &home, &Options::default()) else { continue };
        if answer.is_reached() {
            let directions = vec![if i.is_multiple_of(2) { 1.0 } else { -1.0 }; arm.len()];
            let mut row = plumbline_fit::row(What::Touch, answer.best().joints.to_vec(), directions);
            (row.row, row.cell) = (rows.len(), rows.len());
            rows.push(row);
        }
    }
    let mut touches = plumbline_fit::measurements(rig, arm, Some(Surface::of(screen)), rows);
    touches.apparatuses[0].tip = Some("right_index_tip".to_owned());
    touches.apparatuses[0].title = "morning".to_owned();
    for k in 0..touches.rows.len() {
        touches.rows[k].measured = touches.predict(&touches.rows[k], &truth).expect("predicted");
    }
    touches
}

#[test]
fn the_arm_takes_small_shares_of_all_effects_beside_the_names_and_one_step_takes_them_back() {
    let rig = nico();
    let (measurements, sessions) = (touches_with_errors(&rig), [session(&rig)]);
    assert!(measurements.rows.len() >= 20, "{}", measurements.rows.len());
    let found = finding(vec![named("joint-zero", "r_elbow_y", 0.03)]);
    let touches = ArmTouches::of(&sessions, &measurements).expect("touches of one session");
    let before = RigModel::nominal(&rig);
    let model = whole(&before, &rig, &touches, &found, &[0], Timestamp::now(), &Unattended)
        .expect("it fits")
        .expect("it errs less");
    let has_name: Vec<String> =
        model.effects().iter().filter(|e| e.probability.is_some()).map(ModelEffect::name).collect();
    assert_eq!(has_name, ["joint-zero@r_elbow_y"]);
    assert!(model.effects().len() > 40 && model.contents.together.len() == 1, "{}", model.effects().len());
    let (_, gap) = history(&model).next().expect("its gap");
    assert!(gap.after < 0.5 * gap.before, "{gap:?}");
    // A family of joints is named joint by joint; what encoders see in another way is not lost among shares.
    let family = finding(vec![named("joint-zero", "", 0.03)]);
    let model_of = |found: &Finding| {
        whole(&before, &rig, &touches, found, &[0], Timestamp::now(), &Unattended).expect("it fits")
    };
    let of_family = model_of(&family).expect("it errs less");
    let of_joints = |e: &&ModelEffect| e.id == "joint-zero" && e.probability.is_some();
    assert!(of_family.effects().iter().filter(of_joints).count() >= 5, "each joint of the arm");
    assert!(model_of(&finding(vec![named("gone", "r_elbow_y", 0.1)])).is_none());
    // It is a model like any other: written, read, taken back in one step.
    let folder = tempfile::tempdir().expect("a folder for the test");
    save(folder.path(), &model, &rig).expect("written");
    assert_eq!(load(folder.path(), &rig).expect("read").effects().len(), model.effects().len());
    assert!(undo(folder.path(), &rig).expect("one step").is_nominal());
}

#[test]
fn an_arm_is_sized_from_enough_touches_of_one_session_only() {
    let rig = nico();
    let (mut measurements, sessions) = (touches_with_errors(&rig), [session(&rig), session(&rig)]);
    assert!(ArmTouches::of(&sessions, &measurements).is_none(), "of two sessions");
    assert!(ArmTouches::of(&sessions[..1], &measurements).is_some());
    let mut other = measurements.clone();
    other.rows[0].what = What::Pose;
    assert!(ArmTouches::of(&sessions[..1], &other).is_none(), "not touches alone");
    measurements.rows.truncate(11);
    assert!(ArmTouches::of(&sessions[..1], &measurements).is_none(), "too few");
}

#[test]
fn what_grows_counts_from_the_calibration_in_use_whatever_the_finding_says() {
    let mut rig = nico();
    let at = Timestamp::UNIX_EPOCH;
    // Found beside eyes that were calibrated after ten minutes, or kept by a program that did not say it.
    for found_s in [600.0, 0.0] {
        let growing = NamedEffect {
            shape: Some(300.0),
            reference_s: found_s,
            values: vec![0.006],
            ..named("eye-yaw", "right", 0.006)
        };
        let found = finding(vec![growing, named("joint-zero", "r_elbow_y", 0.03)]);
        for (cameras_s, counts_from_s) in [(Some(1500.0), 1500.0), (None, 0.0)] {
            rig.eyes.calibrated_at.cameras_s = cameras_s;
            let sessions = [session(&rig)];
            let model = with(&RigModel::nominal(&rig), &rig, (&found, &sessions), &[0, 1], true, at);
            let model = model.expect("they fit");
            let references: Vec<f64> = model.effects().iter().map(|effect| effect.reference_s).collect();
            assert_eq!(references, [counts_from_s, 0.0], "found at {found_s} s, calibrated at {cameras_s:?}");
        }
    }
}

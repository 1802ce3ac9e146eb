//! Places by what was accepted in a lab.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use nalgebra::Vector3;
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_engine::eyes::store::Store;
use plumbline_engine::rig_models;
use plumbline_model::formats::native;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::{Corners, Eye, Pixel, Point, Robot, StereoCalibration, Unattended};
use plumbline_offline::{LocateArgs, LocateEyes, LocateReport, LocateRobot, PointInRobot, Stood, locate};
use plumbline_vision::mount::{HeadView, MountCalibration, MountOptions, Target, calibrate_mount};

use super::common::{eyes, wall_pair, write_pairs};

/// So much more, rad.
pub const NOD_RAD: f64 = 0.03;

/// A folder with a pair of the wall, points in it, and nothing accepted in the lab beside them.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().expect("temporary folder"));
        write_pairs(desk.0.path(), &[wall_pair()]);
        std::fs::write(desk.path("points.csv"), "u_px,v_px\n165,125\n140,110\n-5,3\n").expect("written");
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn locate(&self, eyes: LocateEyes) -> Result<LocateReport, String> {
        let [left, right] = ["left", "right"].map(|eye| self.path(eye).join("wall.png"));
        let args = LocateArgs { eyes, left, right, points: self.path("points.csv") };
        locate(&args, &Unattended).map_err(|error| error.to_string())
    }

    fn in_lab(&self, stood: Stood) -> Result<LocateReport, String> {
        self.locate(LocateEyes::OfLab { lab: self.path("lab"), stood })
    }
}

/// A mount of the eyes some millimeters beside the described one, from points that the head looked at.
fn mount(rig: &Rig) -> MountCalibration {
    let (mut head_from_left, cameras) = (rig.eyes.head_from_left.isometry, eyes());
    head_from_left.translation.vector += Vector3::new(0.004, -0.003, 0.002);
    let grid = (0..15).map(|k| (0.25 + 0.1 * f64::from(k % 3), 0.1 * f64::from(k / 3) - 0.2));
    let points: Vec<Point<Robot>> = grid.map(|(x, y)| Point::new(x, y, rig.table.height_m)).collect();
    let views = (0..6).map(|i| {
        let head_rad = [0.1 * f64::from(i) - 0.25, -0.35 - 0.05 * f64::from(i % 4)];
        let posture = rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &head_rad);
        let head = rig.description.forward(&posture).of(rig.eyes.link).isometry;
        let left_from_robot = (head * head_from_left).inverse();
        let pixels = |eye: Eye| -> Corners {
            let seen = |(k, point): (usize, &Point<Robot>)| {
                let in_left = left_from_robot * point.coords;
                let in_eye = match eye {
                    Eye::Left => in_left,
                    Eye::Right => cameras.right_from_left.isometry * in_left,
                };
                let pixel = cameras.camera(eye).project(&in_eye.coords).ok()?;
                // No corner is found exactly.
                let off_px = 0.02 * ((7 * k + 3 * i as usize) % 11) as f64 - 0.1;
                Some(Pixel::new(pixel.u_px + off_px, pixel.v_px - off_px))
            };
            points.iter().enumerate().map(seen).collect()
        };
        let [left, right] = Eye::BOTH.map(|eye| Some(pixels(eye)));
        HeadView { name: format!("view {i}"), posture, left, right }
    });
    let views: Vec<HeadView> = views.collect();
    let target = Target::KnownPoints(points.clone());
    calibrate_mount(rig, &cameras, &views, &target, &MountOptions::default(), &Unattended).expect("solved")
}

/// The head nods by more than its encoder says.
pub fn nodding(rig: &Rig) -> RigModel {
    let mut model = RigModel::nominal(rig);
    model.contents.effects = vec![ModelEffect {
        id: "head-joint".to_owned(),
        site: rig.description.joint(rig.eyes.tilt).name.clone(),
        title: String::new(),
        tip: None,
        shape: None,
        reference_s: 0.0,
        values: vec![NOD_RAD],
        // Less well known than the zero of the neck's turn is beforehand.
        covariance: vec![2e-3],
        probability: None,
        parameters: vec![],
    }];
    model
}

fn place(report: &LocateReport) -> PointInRobot {
    report.points[0].robot.expect("found")
}

fn at_m(report: &LocateReport) -> Vector3<f64> {
    let place = place(report);
    Vector3::new(place.robot_x_m, place.robot_y_m, place.robot_z_m)
}

/// Puts the eyes in use as they are, and their mount.
fn accept_eyes(world: &Path, rig: &Rig) {
    let calibration = StereoCalibration::bare(eyes());
    Store::of_world(world).accept(&calibration, Timestamp::UNIX_EPOCH).expect("kept");
    mount(rig).write(&world.join("mount.toml")).expect("written");
}

#[test]
fn what_was_accepted_in_a_lab_is_used() {
    let (desk, rig) = (Desk::new(), default_rig());
    let world = desk.path("lab/twin");
    accept_eyes(&world, &rig);
    let described = desk.in_lab(Stood::default()).expect("located");
    assert_eq!((described.model.as_deref(), described.effects.len()), (Some("as described"), 0));
    // With nothing named it is where eye and mount have it.
    let known = rig_models::in_use(&world, &rig).expect("it can be used");
    let [x_m, y_m, z_m] = [described.points[0].x_m, described.points[0].y_m, described.points[0].z_m];
    let in_left = Point::new(x_m.expect("found"), y_m.expect("found"), z_m.expect("found"));
    let should = known.rig().robot_from_left(&rig.home()) * in_left;
    assert!((at_m(&described) - should.coords.coords).norm() < 1e-9, "{described:?}");
    assert!(place(&described).robot_sigma_m > described.points[0].sigma_m.expect("found"), "its mount's");
    let home = rig.home();
    assert_eq!(described.head_y_rad, Some(home[rig.eyes.tilt]), "it is said how the head stood");

    let effects = nodding(&rig);
    rig_models::save(&world, &effects, &rig).expect("written");
    let with = desk.in_lab(Stood::default()).expect("located");
    assert_eq!((with.model.as_deref(), with.effects.len()), (Some("with 1 effect"), 1));
    assert_eq!(with.points[0].x_m, described.points[0].x_m, "the same is seen");
    let stood = Stood { head_rad: [None, Some(home[rig.eyes.tilt] + NOD_RAD)], ..Stood::default() };
    rig_models::save(&world, &RigModel::nominal(&rig), &rig).expect("written");
    let nods = desk.in_lab(stood).expect("located");
    assert!((at_m(&with) - at_m(&nods)).norm() < 1e-6 && (at_m(&with) - at_m(&described)).norm() > 5e-3);
    assert!(place(&with).robot_sigma_m > place(&nods).robot_sigma_m, "the effect's own is in it");

    // The same files by their names give the same.
    rig_models::save(&world, &effects, &rig).expect("written");
    native::write(&StereoCalibration::bare(eyes()), &desk.path("eyes.yaml")).expect("written");
    let robot = LocateRobot {
        rig: "nico".to_owned(),
        rig_model: rig_models::file(&world),
        mount: Some(world.join("mount.toml")),
        stood: Stood::default(),
    };
    let cameras = vec![desk.path("eyes.yaml")];
    let by_files = desk.locate(LocateEyes::Calibrated { cameras, robot: Some(robot) }).expect("located");
    assert_eq!(by_files, with);
    let json = serde_json::to_value(&with).expect("serializable");
    super::keys(&json, &["points", "model", "effects", "head_z_rad", "head_y_rad"]);
    let keys = ["robot_x_m", "robot_y_m", "robot_z_m", "robot_sigma_m", "x_m", "sigma_m", "match_u_px"];
    super::keys(&json["points"][0], &keys);
    assert!(with.points[2].robot.is_none() && with.points[2].reason.is_some(), "it was not found");
}

#[test]
fn a_folder_in_which_not_enough_was_accepted_is_no_lab() {
    let (desk, rig) = (Desk::new(), default_rig());
    let refused = |said: &str| {
        let why = desk.in_lab(Stood::default()).expect_err("no lab");
        assert!(why.contains("plumbline commission") && why.contains(said), "{why}");
    };
    refused("no folder twin");
    let world = desk.path("lab/twin");
    std::fs::create_dir_all(&world).expect("made");
    refused("no calibration of the eyes");
    let calibration = StereoCalibration::bare(eyes());
    Store::of_world(&world).accept(&calibration, Timestamp::UNIX_EPOCH).expect("kept");
    refused("no mount of the eyes");
    std::fs::write(world.join("mount.toml"), "hello").expect("written");
    let why = desk.in_lab(Stood::default()).expect_err("no mount");
    assert!(why.contains("mount.toml"), "{why}");
    mount(&rig).write(&world.join("mount.toml")).expect("written");
    desk.in_lab(Stood::default()).expect("a lab");

    for angle in [-30.0, f64::NAN] {
        let stood = Stood { head_rad: [None, Some(angle)], ..Stood::default() };
        let why = desk.in_lab(stood).expect_err("no head stands so");
        assert!(why.contains("head_y") && why.contains("radians"), "{why}");
    }
}

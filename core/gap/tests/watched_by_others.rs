//! Logs of one place that other physics made than the library's: two times, both eyes, another mount and other
//! lenses than described, and a detector whose boxes go in steps of pixels.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use nalgebra::{Rotation3, Vector3};
use plumbline_effects::Measurements;
use plumbline_gap::finding::{Finding, Verdict};
use plumbline_gap::{Options, find};
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::{Camera, CameraModel, Pixel, Point, Raw, Session, Unattended};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

const MANIFEST: &str =
    "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\noperator = \"\"\nnotes = \"\"\n";

fn normal(random: &mut StdRng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// A robot and its eyes, drawn at random.
struct World {
    /// Where the thing stands, robot frame, m.
    thing_m: [f64; 3],
    /// The mount is turned and shifted by so much, own axes, rad and m.
    mount: [Vector3<f64>; 2],
    /// Focal lengths are so many times those that are described.
    focal: f64,
    /// How far each eye turns in the end, own axes, rad: with the first and with the second time.
    turns_rad: [[Vector3<f64>; 2]; 2],
    times_s: [f64; 2],
    /// A focal length grows by this share with the second time.
    grows: f64,
    noise_px: f64,
    step_px: f64,
    rows: u32,
    from_s: f64,
}

impl World {
    /// `turns`: whether its eyes warm up.
    fn drawn(seed: u64, turns: bool) -> Self {
        let mut random = StdRng::seed_from_u64(seed);
        let scale = f64::from(u8::from(turns));
        let mut about = |size: f64| Vector3::from_fn(|_, _| size * (2.0 * random.random::<f64>() - 1.0));
        let mount = [about(0.02), about(0.006)];
        // Mostly sideways, in opposite ways: what the eyes turn against each other moves places far.
        let turn = |yaw: f64, other: Vector3<f64>| scale * (Vector3::new(0.0, yaw, 0.0) + other);
        let turns_rad = [
            [turn(0.0015, about(0.0006)), turn(-0.0028, about(0.0006))],
            [turn(0.002, about(0.0006)), turn(-0.0026, about(0.0006))],
        ];
        let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
        let size = random.random_range(0.8..1.6) * sign;
        Self {
            thing_m: [random.random_range(0.35..0.55), random.random_range(-0.3..0.3), 0.05],
            mount,
            focal: random.random_range(0.99..1.01),
            turns_rad: turns_rad.map(|eyes| eyes.map(|turn| turn * size)),
            times_s: [random.random_range(60.0..200.0), random.random_range(300.0..1200.0)],
            grows: scale * random.random_range(-0.002..0.002),
            noise_px: random.random_range(0.05..0.13),
            step_px: [0.1, 0.2, 0.3][random.random_range(0..3)],
            rows: random.random_range(12..=20),
            from_s: random.random_range(5.0..90.0),
        }
    }

    /// Where stereo by the description puts the thing.
    fn estimate(&self, rig: &Rig, t_s: f64, random: &mut StdRng) -> [f64; 3] {
        let grown = self.times_s.map(|time_s| 1.0 - (-t_s / time_s).exp());
        let described = rig.robot_from_left(&rig.home());
        let [x, y, z] = self.thing_m;
        let in_left = (described.inverse() * Point::new(x, y, z)).coords.coords;
        let in_left = Rotation3::new(self.mount[0]) * in_left + self.mount[1];
        let cameras = &rig.eyes.cameras;
        let in_right = cameras.right_from_left * plumbline_model::Point::new(in_left.x, in_left.y, in_left.z);
        let mut seen = |camera: &Camera, at: Vector3<f64>, eye: usize| -> Pixel<Raw> {
            let turn = self.turns_rad[0][eye] * grown[0] + self.turns_rad[1][eye] * grown[1];
            let camera = with_focal(camera, self.focal * (1.0 + self.grows * grown[1]));
            let at = camera.project(&(Rotation3::new(turn) * at)).expect("in view");
            let [u_px, v_px] = [at.u_px, at.v_px].map(|px| {
                let noisy = px + self.noise_px * normal(random);
                (noisy / self.step_px).round() * self.step_px
            });
            Pixel::new(u_px, v_px)
        };
        let left = seen(&cameras.left, in_left, 0);
        let right = seen(&cameras.right, in_right.coords.coords, 1);
        (described * cameras.triangulate(left, right).expect("in front")).coords.coords.into()
    }

    fn log(&self, rig: &Rig, seed: u64) -> Measurements {
        let mut random = StdRng::seed_from_u64(seed);
        let mut text = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,t_secs\n".to_owned();
        for minute in 0..self.rows {
            let t_s = self.from_s + 60.0 * f64::from(minute) + random.random_range(-3.0..3.0);
            let [ex, ey, ez] = self.estimate(rig, t_s, &mut random);
            let [tx, ty, tz] = self.thing_m;
            text += &format!("{tx:.3},{ty:.3},{tz:.3},{ex:.4},{ey:.4},{ez:.4},{t_s:.0}\n");
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("session.toml"), MANIFEST).expect("writable");
        std::fs::write(folder.path().join("localizations.csv"), text).expect("writable");
        let session = Session::read(folder.path()).expect("well formed");
        Measurements::of_sessions(&[("a log".to_owned(), session)], rig).expect("usable")
    }

    /// Standard deviation of an estimate (m, 3D) and how far it goes in the end, m.
    fn sizes_m(&self, rig: &Rig) -> [f64; 2] {
        let mut random = StdRng::seed_from_u64(99);
        let mut many = |t_s: f64| -> Vec<Vector3<f64>> {
            (0..300).map(|_| Vector3::from(self.estimate(rig, t_s, &mut random))).collect()
        };
        let mean = |all: &[Vector3<f64>]| all.iter().sum::<Vector3<f64>>() / all.len() as f64;
        let (cold, warm) = (many(self.from_s), many(self.from_s + 60.0 * f64::from(self.rows - 1)));
        let middle = mean(&cold);
        let spread = cold.iter().map(|at| (at - middle).norm_squared()).sum::<f64>() / cold.len() as f64;
        [spread.sqrt(), (mean(&warm) - middle).norm()]
    }
}

fn with_focal(camera: &Camera, times: f64) -> Camera {
    let mut camera = *camera;
    if let CameraModel::Fisheye(lens) = &mut camera.model {
        (lens.fx_px, lens.fy_px) = (lens.fx_px * times, lens.fy_px * times);
    }
    camera
}

fn found(world: &World, rig: &Rig, seed: u64) -> Finding {
    let log = world.log(rig, seed);
    let finding = find(&log, &Options::default(), &Unattended).expect("can be looked at");
    let [noise_m, goes_m] = world.sizes_m(rig);
    let ids: Vec<String> =
        finding.effects.iter().map(|effect| format!("{} {:?}", effect.id, effect.shape)).collect();
    println!(
        "{seed}: {:?}, noise {:.1} mm, goes {:.1} mm in {} rows, step {} px; {:.1} → {:.1} mm, floor {:.1}; p {:.1e}; {ids:?}",
        finding.verdict,
        noise_m * 1e3,
        goes_m * 1e3,
        world.rows,
        world.step_px,
        finding.shown.before * 1e3,
        finding.shown.after * 1e3,
        finding.shown.floor * 1e3,
        finding.comparison.p_value,
    );
    finding
}

fn is_of_eyes(finding: &Finding) -> bool {
    matches!(finding.verdict, Verdict::Named | Verdict::Class)
        && finding.effects.iter().any(|effect| effect.shape.is_some())
}

#[test]
fn eyes_that_warm_up_by_other_physics_are_named() {
    let rig = default_rig();
    let named =
        (0..96).filter(|seed| is_of_eyes(&found(&World::drawn(1500 + seed, true), &rig, *seed))).count();
    println!("{named} of 96 named");
    // Of two dozen, chance alone makes two more or less.
    assert!(named >= 80, "{named} of 96");
}

#[test]
fn eyes_that_stay_are_not_blamed_for_the_steps_of_a_detector() {
    let rig = default_rig();
    let blamed = (0..60)
        .filter(|seed| found(&World::drawn(1700 + seed, false), &rig, *seed).verdict != Verdict::NoGap);
    assert_eq!(blamed.count(), 0);
}

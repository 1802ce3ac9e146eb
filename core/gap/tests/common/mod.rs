//! Sessions made with the forward model: the screen touched where the true arm, with effects in
//! it, would touch it, plus noise.
#![allow(dead_code, reason = "each test file uses its own part")]

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_effects::measurements::Observation;
use plumbline_effects::{Assumed, Effect, EyesDeviation, Measurements, Present};
use plumbline_model::Session;
use plumbline_model::robot::Rig;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

pub const JOINTS: [&str; 6] =
    ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
const BASE: [f64; 6] = [-0.03, 0.31, 0.44, 1.55, 1.07, 0.73];
const SPREAD: [f64; 6] = [0.35, 0.0, 0.12, 0.25, 0.3, 0.15];

/// A plan of touches or poses.
#[derive(Clone, Debug)]
pub struct Plan {
    pub places: usize,
    pub repeats: usize,
    /// Weights, one after the other over the places, kg.
    pub payloads: Vec<f64>,
    /// Sides of approach, one after the other over the places.
    pub sides: Vec<&'static str>,
    /// Heights of the screen, m.
    pub heights: Vec<f64>,
    /// Noise of u and v (or x, y, z), m.
    pub noise_m: f64,
    /// All places once, then all of them again; else repeats follow each other.
    pub by_passes: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            places: 60,
            repeats: 3,
            payloads: vec![0.0],
            sides: vec![],
            heights: vec![0.0],
            noise_m: 1e-3,
            by_passes: false,
        }
    }
}

pub fn rig() -> Rig {
    Rig::built_in("nico").expect("comes along")
}

pub fn normal(random: &mut StdRng) -> f64 {
    let (a, b): (f64, f64) = (random.random_range(f64::MIN_POSITIVE..1.0), random.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// A row of any table as text: what comes before the measured columns is the same for all.
struct Row {
    angles: [f64; 6],
    group: usize,
    side: &'static str,
    payload: f64,
    height: f64,
    set: usize,
    t: usize,
}

fn rows(plan: &Plan, random: &mut StdRng) -> Vec<Row> {
    let mut rows = vec![];
    for place in 0..plan.places {
        let angles: [f64; 6] =
            std::array::from_fn(|j| BASE[j] + SPREAD[j] * (2.0 * random.random::<f64>() - 1.0));
        for pass in 0..plan.repeats {
            let order = if plan.by_passes { pass * plan.places + place } else { rows.len() };
            rows.push(Row {
                angles,
                group: place,
                side: if plan.sides.is_empty() { "" } else { plan.sides[place % plan.sides.len()] },
                payload: plan.payloads[place / 2 % plan.payloads.len()],
                height: plan.heights[place / 3 % plan.heights.len()],
                set: place * 8 / plan.places,
                t: order * 8,
            });
        }
    }
    rows.sort_by_key(|row| row.t);
    rows
}

const MANIFEST: &str = r#"
format = 1
rig = "nico"
started = 2026-01-01T00:00:00Z
operator = ""
notes = ""
[touchscreen]
width_px = 1920
height_px = 1080
width_m = 0.475
height_m = 0.267
origin_m = [0.545, 0.2375, 0.056]
u_axis = [0.0, -1.0, 0.0]
v_axis = [-1.0, 0.0, 0.0]
[chain]
tip = "right_index_tip"
joints = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"]
"#;

fn read(table: &str, text: &str) -> Measurements {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("session.toml"), MANIFEST).expect("writable");
    std::fs::write(folder.path().join(table), text).expect("writable");
    let session = Session::read(folder.path()).expect("well formed");
    Measurements::of_sessions(&[("made up".to_owned(), session)], &rig()).expect("usable")
}

fn header(extra: &str) -> String {
    let commands: Vec<String> = JOINTS.iter().map(|joint| format!("cmd_{joint}_rad")).collect();
    format!("group,approach,set,payload_kg,t_secs,{extra},{}\n", commands.join(","))
}

fn line(row: &Row, extra: &str) -> String {
    let angles: Vec<String> = row.angles.iter().map(f64::to_string).collect();
    let Row { group, side, set, payload, t, .. } = row;
    format!("g{group},{side},s{set},{payload},{t},{extra},{}\n", angles.join(","))
}

/// Touches of an arm with effects in it, on a screen that lies a little elsewhere.
pub fn touches(plan: &Plan, hidden: &[Present], seed: u64) -> Measurements {
    let mut random = StdRng::seed_from_u64(seed);
    let mut text = header("screen_height_m,touch_u_px,touch_v_px");
    for row in rows(plan, &mut random) {
        text += &line(&row, &format!("{},960,540", row.height));
    }
    let mut measurements = read("touches.csv", &text);
    let truth = Assumed {
        effects: hidden.to_vec(),
        placements: vec![Isometry3::from_parts(
            Translation3::new(0.006, -0.004, 0.003),
            UnitQuaternion::from_scaled_axis(Vector3::new(0.008, -0.005, 0.01)),
        )],
        ..Assumed::default()
    };
    let mut done: Vec<Observation> = vec![];
    for i in 0..measurements.rows.len() {
        let mut row = measurements.rows[i].clone();
        match done.iter().find(|known| known.cell == row.cell) {
            Some(known) => row.commanded_rad.clone_from(&known.commanded_rad),
            None => lower(&measurements, &mut row, &truth, 3e-4 * normal(&mut random)),
        }
        let exact = measurements.predict(&row, &truth).expect("an arm can always be placed");
        row.measured[0] = exact[0] + plan.noise_m * normal(&mut random);
        row.measured[1] = exact[1] + plan.noise_m * normal(&mut random);
        done.push(row);
    }
    measurements.rows = done;
    measurements
}

/// Bends the shoulder until the true finger is this high over the glass.
fn lower(measurements: &Measurements, row: &mut Observation, truth: &Assumed, height_m: f64) {
    let height = |row: &Observation| measurements.predict(row, truth).expect("predictable")[2] - height_m;
    for _ in 0..40 {
        let here = height(row);
        let mut ahead = row.clone();
        ahead.commanded_rad.as_mut().expect("commanded")[1] += 1e-5;
        let slope = (height(&ahead) - here) / 1e-5;
        let step = (-here / slope).clamp(-0.1, 0.1);
        row.commanded_rad.as_mut().expect("commanded")[1] += step;
        if step.abs() < 1e-10 {
            return;
        }
    }
    panic!("the glass is out of reach");
}

/// Poses of an arm with effects in it, in a frame that lies anywhere.
pub fn poses(plan: &Plan, hidden: &[Present], seed: u64) -> Measurements {
    let mut random = StdRng::seed_from_u64(seed);
    let mut text = header("meas_x_m,meas_y_m,meas_z_m");
    for row in rows(plan, &mut random) {
        text += &line(&row, "0,0,0");
    }
    let mut measurements = read("poses.csv", &text);
    let truth = Assumed {
        effects: hidden.to_vec(),
        placements: vec![Isometry3::from_parts(
            Translation3::new(1.2, -0.7, 0.9),
            UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -1.1, 2.0)),
        )],
        ..Assumed::default()
    };
    for i in 0..measurements.rows.len() {
        let exact = measurements.predict(&measurements.rows[i], &truth).expect("predictable");
        for (to, from) in measurements.rows[i].measured.iter_mut().zip(exact) {
            *to = from + plan.noise_m * normal(&mut random);
        }
    }
    measurements
}

/// A grid of places whose estimates are in another unit than meters.
pub fn places_estimated_in(factor: f64) -> Measurements {
    // Files like that are refused when they are read: these rows come from elsewhere.
    let mut measurements = places(1, &[], 0.0, 1);
    let eyes = measurements.apparatuses[0].eyes.clone().expect("a robot with eyes");
    let nominal = EyesDeviation::none(eyes.neck.len());
    for row in &mut measurements.rows {
        let robot_from_left = eyes.robot_from_left(&row.neck_rad, &nominal);
        let estimate = robot_from_left * eyes.place(&row.measured).expect("an estimate");
        row.measured = eyes.natural(&(robot_from_left.inverse() * (estimate * factor))).to_vec();
    }
    measurements
}

/// A grid of places that the eyes estimate, 9 by 4 or more.
pub fn places(repeats: usize, hidden: &[Present], noise_rad: f64, seed: u64) -> Measurements {
    let mut random = StdRng::seed_from_u64(seed);
    let mut text =
        "group,set,true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,head_head_z_rad,head_head_y_rad\n"
            .to_owned();
    for i in 0..36 {
        let (x, y) = (0.2 + 0.1 * f64::from(i / 9), -0.4 + 0.1 * f64::from(i % 9));
        for _ in 0..repeats {
            text += &format!("p{i},x{},{x},{y},0.05,{x},{y},0.05,0,-0.523599\n", i / 9);
        }
    }
    let mut measurements = read("localizations.csv", &text);
    let truth = Assumed { effects: hidden.to_vec(), ..Assumed::nominal(&measurements) };
    for i in 0..measurements.rows.len() {
        let exact = measurements.predict(&measurements.rows[i], &truth).expect("in view");
        for (to, from) in measurements.rows[i].measured.iter_mut().zip(exact) {
            *to = from + noise_rad * normal(&mut random);
        }
    }
    measurements
}

/// An effect of the library with values.
pub fn present(measurements: &Measurements, id: &str, site: &str, values: &[f64]) -> Present {
    let apparatus = &measurements.apparatuses[0];
    let effect = Effect::find(id, site, None, apparatus.arm.as_ref(), apparatus.eyes.as_ref())
        .unwrap_or_else(|| panic!("{id}@{site} is in the library"));
    Present { effect, values: values.to_vec() }
}

/// The elbow's zero is off.
pub fn elbow_zero(offset_rad: f64) -> Present {
    let some = touches(&Plan { places: 1, repeats: 1, ..Plan::default() }, &[], 1);
    present(&some, "joint-zero", "r_elbow_y", &[offset_rad])
}

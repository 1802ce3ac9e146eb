//! What the tests share: a made-up screen, smooth touches on it, and the measured ones.
#![allow(dead_code)] // Every test file uses a part of it.

use plumbline_correction::{Touch, TouchData};
use plumbline_model::robot::Rig;
use plumbline_model::session::{Chain as ChainNames, Manifest, TouchRow, TouchTable, Touchscreen};
use plumbline_model::{Direction, Pixel, Point, Robot, Session, measured_data};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

pub const JOINTS: [&str; 6] =
    ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];

pub fn screen() -> Touchscreen {
    let direction = |x, y| Direction::new(nalgebra::Vector3::new(x, y, 0.0)).expect("not zero");
    Touchscreen {
        width_px: 1920,
        height_px: 1080,
        width_m: 0.475,
        height_m: 0.267,
        origin: Point::new(0.545, 0.2375, 0.056),
        u_axis: direction(0.0, -1.0),
        v_axis: direction(-1.0, 0.0),
    }
}

/// A smooth map like that of a bent arm.
pub fn smooth(pixel: [f64; 2]) -> [f64; 3] {
    let (a, b) = (pixel[0] / 1920.0 - 0.5, pixel[1] / 1080.0 - 0.5);
    [0.38 - 0.27 * b + 0.012 * a * a, -0.01 - 0.47 * a + 0.02 * a * b, 0.064 - 0.015 * b + 0.03 * a * a]
}

/// Places on the screen, seeded.
pub fn places(count: usize, seed: u64) -> Vec<[f64; 2]> {
    let mut random = StdRng::seed_from_u64(seed);
    (0..count).map(|_| [random.random_range(150.0..1750.0), random.random_range(320.0..1040.0)]).collect()
}

/// Touches of the smooth map, with noise in each coordinate.
pub fn touches(count: usize, noise_m: f64, seed: u64) -> Vec<Touch> {
    let mut random = StdRng::seed_from_u64(seed + 1000);
    let touch = |(row, place): (usize, [f64; 2])| {
        let sent = smooth(place).map(|m| m + noise_m * (random.random::<f64>() - 0.5) * 12_f64.sqrt());
        Touch {
            pixel: Pixel::new(place[0], place[1]),
            sent: Point::new(sent[0], sent[1], sent[2]),
            set: None,
            group: None,
            row,
        }
    };
    places(count, seed).into_iter().enumerate().map(touch).collect()
}

pub fn data(count: usize, noise_m: f64, seed: u64) -> TouchData {
    TouchData::new(touches(count, noise_m, seed), screen(), vec![]).expect("touches to learn from")
}

/// A session of rows.
pub fn session(rows: &[TouchRow]) -> Session {
    let joints: Vec<String> = JOINTS.map(str::to_owned).to_vec();
    let manifest = Manifest {
        touchscreen: Some(screen()),
        chain: Some(ChainNames { tip: "right_index_tip".to_owned(), joints: joints.clone() }),
        ..Manifest::of_rig("nico", jiff::Timestamp::UNIX_EPOCH)
    };
    Session { touches: Some(TouchTable::from_rows(joints, rows)), ..Session::new(manifest) }
}

/// A row with its target and without encoder angles.
pub fn row(place: [f64; 2]) -> TouchRow {
    let sent = smooth(place);
    TouchRow {
        commanded_rad: vec![Some(0.1); 6],
        touch: Some(Pixel::new(place[0], place[1])),
        target: Some(Point::<Robot>::new(sent[0], sent[1], sent[2])),
        ..TouchRow::default()
    }
}

pub fn rig() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program")
}

/// The measured touches, if they are at hand.
pub fn touch_245() -> Option<TouchData> {
    let folder = match measured_data::folder("nico-touch") {
        Ok(folder) => folder,
        Err(reason) => {
            eprintln!("{reason}");
            return None;
        }
    };
    let session = Session::read(&folder.join("touch-245")).expect("a session");
    let tip = session.manifest.chain.as_ref().expect("it has touches").tip.clone();
    let chain = rig().chain(&tip).expect("a tip of the rig");
    Some(TouchData::of_session(&session, &chain).expect("touches to learn from"))
}

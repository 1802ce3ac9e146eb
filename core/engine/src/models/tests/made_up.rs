//! A made-up session of touches, for tests of this package and of the command line's.

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Chain, Manifest, Screen, TouchRow, TouchTable, Touchscreen};
use plumbline_model::{Pixel, Point, Robot, Session};

/// The rig that comes with the program.
pub fn nico() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program is tested")
}

/// What must be sent for a pixel of the made-up lab: up to 20 mm beside its place, smoothly.
pub fn needed(screen: &Touchscreen, pixel: Pixel<Screen>) -> Point<Robot> {
    let (u, v) = (pixel.u_px / 1920.0 - 0.5, pixel.v_px / 1080.0 - 0.5);
    let shift = Vector3::new(0.012 + 0.03 * u * v, -0.008 + 0.02 * u * u, 0.004 - 0.01 * v * v);
    Point::from(screen.point_at(pixel).coords + shift)
}

/// A session of 9 × 7 touches, in rows of 9 that were touched one after the other.
pub fn made_up_session(rig: &Rig) -> Session {
    let screen = &rig.touchscreen;
    let arm = &rig.arms[0];
    let joints: Vec<String> =
        arm.joints.iter().map(|joint| rig.description.joint(*joint).name.clone()).collect();
    let touch = |i: u32, j: u32| {
        // Not quite a grid, and 0.2 mm of noise: what is the same everywhere can be learned by heart.
        let jitter = f64::from((i * 37 + j * 91) % 17) - 8.0;
        let pixel = Pixel::new(240.0 + 180.0 * f64::from(i) + jitter, 120.0 + 140.0 * f64::from(j) - jitter);
        let noise = 0.0002 * (f64::from((i * 53 + j * 29) % 11) / 5.0 - 1.0);
        let sent = needed(screen, pixel).coords;
        TouchRow {
            commanded_rad: vec![Some(0.1); joints.len()],
            touch: Some(pixel),
            set: Some(format!("row {j}")),
            target: Some(Point::new(sent.x + noise, sent.y - noise, sent.z)),
            ..TouchRow::default()
        }
    };
    let rows: Vec<TouchRow> = (0..7).flat_map(|j| (0..9).map(move |i| touch(i, j))).collect();
    let manifest = Manifest {
        touchscreen: Some(screen.clone()),
        chain: Some(Chain { tip: "right_index_tip".to_owned(), joints: joints.clone() }),
        ..Manifest::of_rig(rig.name.as_str(), "2026-05-01T10:00:00Z".parse().expect("a time"))
    };
    Session { touches: Some(TouchTable::from_rows(joints, &rows)), ..Session::new(manifest) }
}

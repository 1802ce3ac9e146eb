//! Every bad input is answered with a sentence, and the renderer goes on.

use std::sync::Arc;

use plumbline_model::{CameraModel, Pinhole};
use plumbline_twin::eyes::{AdapterChoice, EyeOptions, EyeRenderer, Sensor, sample};
use plumbline_twin::scene::{Mesh, Scenery, Shape, Snapshot};

use super::{cube, renderer};

#[test]
fn what_cannot_be_drawn_is_said() {
    let absent = EyeOptions { adapter: AdapterChoice::Absent };
    let error = EyeRenderer::new(absent).err().expect("there is no device");
    assert!(error.to_string().contains("install"), "{error}");
    let Some(mut renderer) = renderer() else { return };
    let (scenery, snapshot) = sample::lab();
    let mut fails = |scenery: &Scenery, snapshot: &Snapshot, sensor: &Sensor| {
        renderer.render(scenery, snapshot, sensor, 1).expect_err("bad input").to_string()
    };
    let sensor = Sensor::default();
    let mut bad = snapshot.clone();
    bad.robot_from_body[0].translation.x = f64::NAN;
    assert!(fails(&scenery, &bad, &sensor).contains("body 0"));
    let mut bad = snapshot.clone();
    bad.eyes.robot_from_right.isometry.translation.z = f64::INFINITY;
    assert!(fails(&scenery, &bad, &sensor).contains("right eye"));
    let mut bad = snapshot.clone();
    bad.robot_from_body.clear();
    assert!(fails(&scenery, &bad, &sensor).contains("bodies"));
    let mut bad = snapshot.clone();
    bad.eyes.left.model = CameraModel::Pinhole(Pinhole {
        fx_px: 500.0,
        fy_px: 500.0,
        cx_px: 320.0,
        cy_px: 240.0,
        k1: 0.0,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        k3: 0.0,
    });
    assert!(fails(&scenery, &bad, &sensor).contains("fisheye"));
    let mut bad = scenery.clone();
    bad.items[3].shape = Shape::Capsule { radius_m: -1.0, half_length_m: 0.1 };
    assert!(fails(&bad, &snapshot, &sensor).contains("item 3"));
    let mut bad = scenery.clone();
    let hole = Mesh { triangles: vec![[0, 1, 99]], ..cube(0.1) };
    bad.items[4].shape = Shape::Mesh { mesh: Arc::new(hole) };
    assert!(fails(&bad, &snapshot, &sensor).contains("item 4"));
    let mut bad = scenery.clone();
    bad.items = (0..40).flat_map(|_| scenery.items.clone()).collect();
    assert!(fails(&bad, &snapshot, &sensor).contains("768"));
    let blind = Sensor { exposure: f32::NAN, ..sensor };
    assert!(fails(&scenery, &snapshot, &blind).contains("exposure"));
    // After all that it still draws.
    renderer.render(&scenery, &snapshot, &sensor, 1).expect("an image");
}

//! Laws of the renderer: geometry, occlusion, light, noise, errors.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod bad_input;
mod stream;

use std::sync::Arc;

use image::RgbImage;
use nalgebra::{Isometry3, Vector3};
use plumbline_model::Eye;

use plumbline_twin::eyes::*;

use plumbline_twin::scene::{BodyIndex, Item, Light, Material, Mesh, Pattern, Scenery, Shape, Snapshot};

/// A renderer, or a word on why the test is left out.
fn renderer() -> Option<EyeRenderer> {
    match EyeRenderer::new(EyeOptions::default()) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter) => {
            plumbline_model::measured_data::left_out("no Vulkan device on this machine");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn plain(albedo: f32) -> Material {
    Material { albedo: [albedo; 3], gloss: 0.0, pattern: Pattern::Plain }
}

/// An item at a place given in the left eye's frame.
fn before_left(snapshot: &Snapshot, object: u16, at: Vector3<f64>, shape: Shape, albedo: f32) -> Item {
    Item {
        object,
        body: BodyIndex(0),
        body_from_shape: snapshot.eyes.robot_from_left.isometry * Isometry3::translation(at.x, at.y, at.z),
        shape,
        material: plain(albedo),
    }
}

fn empty() -> (Scenery, Snapshot) {
    let snapshot =
        Snapshot { time_s: 0.0, robot_from_body: vec![Isometry3::identity()], eyes: sample::eyes(0.5) };
    (Scenery::default(), snapshot)
}

fn ball(radius_m: f64) -> Shape {
    Shape::Ellipsoid { radii_m: Vector3::repeat(radius_m) }
}

/// Only light from everywhere, so that shading does not move the middle of a ball.
fn even_light() -> Light {
    Light { lamp: 0.0, ambient: 1.0, ..Light::default() }
}

/// Mean place of an object's pixels.
fn middle(objects: &ObjectImage, object: u16) -> Option<[f64; 2]> {
    let mut sum = [0.0; 3];
    for (u, v, pixel) in objects.enumerate_pixels() {
        if pixel[0] == object {
            sum = [sum[0] + f64::from(u), sum[1] + f64::from(v), sum[2] + 1.0];
        }
    }
    (sum[2] > 0.0).then(|| [sum[0] / sum[2], sum[1] / sum[2]])
}

/// Mean and standard deviation of green in a patch.
fn patch(image: &RgbImage, u: u32, v: u32, side: u32) -> (f64, f64) {
    let values: Vec<f64> = (v..v + side)
        .flat_map(|v| (u..u + side).map(move |u| (u, v)))
        .map(|(u, v)| f64::from(image.get_pixel(u, v)[1]))
        .collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    (mean, variance.sqrt())
}

/// The shader inverts the lens, the model projects and unprojects in double precision: whether the
/// middle of a pixel is on a ball or beside it must agree for every pixel that is not within a few
/// thousandths of a pixel of the ball's outline.
#[test]
fn rays_of_the_shader_are_those_of_the_lens_model() {
    const RADIUS_RAD: f64 = 0.08;
    const TOLERANCE_PX: f64 = 0.005;
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, snapshot) = empty();
    let eyes = &snapshot.eyes;
    let right_from_left = eyes.robot_from_right.isometry.inverse() * eyes.robot_from_left.isometry;
    let (mut wrong, mut close) = (0, 0);
    for ring in 0..6 {
        for step in 0..4 {
            // From the axis out to 75°, all around, near and far.
            let theta = 0.05 + 0.25 * f64::from(ring);
            let azimuth = 0.3 + f64::from(step) * 1.571 + f64::from(ring);
            let range = 0.2 + 0.3 * f64::from(step);
            let (sin, cos) = theta.sin_cos();
            let at = range * Vector3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
            let radius = RADIUS_RAD * range;
            scenery.items = vec![before_left(&snapshot, 1, at, ball(radius), 0.9)];
            let seen = renderer.render_labeled(&scenery, &snapshot, &Sensor::ideal(), 0).expect("an image");
            let in_right = right_from_left.transform_point(&at.into()).coords;
            for (objects, camera, at) in
                [(&seen.left_objects, &eyes.left, at), (&seen.right_objects, &eyes.right, in_right)]
            {
                let outline_rad = (radius / at.norm()).asin();
                for (u, v, object) in objects.enumerate_pixels() {
                    let pixel = plumbline_model::Pixel::new(f64::from(u), f64::from(v));
                    let Some(ray) = camera.unproject(pixel).ok().filter(|ray| ray.z > 0.03) else { continue };
                    let beyond_px = (ray.angle(&at) - outline_rad) * camera.model.focal_px().0;
                    close += usize::from(beyond_px.abs() < 0.05);
                    let differs = (object[0] == 1) != (beyond_px < 0.0);
                    wrong += usize::from(differs && beyond_px.abs() > TOLERANCE_PX);
                }
            }
        }
    }
    eprintln!(
        "{close} pixels within 0.05 px of an outline, {wrong} on the wrong side by over {TOLERANCE_PX} px"
    );
    assert!(close > 150, "only {close} pixels put the law to the test");
    assert_eq!(wrong, 0, "pixels are on the wrong side of an outline");
}

#[test]
fn nearer_objects_hide_those_behind() {
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, snapshot) = empty();
    let forward = Vector3::z();
    let capsule = Shape::Capsule { radius_m: 0.02, half_length_m: 0.05 };
    let wall = Shape::Box { half_m: Vector3::new(0.3, 0.3, 0.01) };
    scenery.items = vec![
        before_left(&snapshot, 9, forward * 0.8, wall, 0.5),
        before_left(&snapshot, 5, forward * 0.5, ball(0.08), 0.5),
        before_left(&snapshot, 7, forward * 0.3, capsule, 0.5),
    ];
    let seen = renderer.render_labeled(&scenery, &snapshot, &Sensor::default(), 3).expect("an image");
    let left = &seen.left_objects;
    let axis = snapshot.eyes.left.model.principal_point();
    let at = |u: f64, v: f64| left.get_pixel(u.round() as u32, v.round() as u32)[0];
    // On the axis the nearest; beside it, at known angles, what sticks out behind.
    assert_eq!(at(axis.u_px, axis.v_px), 7);
    let beside = snapshot.eyes.left.project(&Vector3::new(0.06, 0.0, 0.5)).expect("in view");
    assert_eq!(at(beside.u_px, beside.v_px), 5);
    let further = snapshot.eyes.left.project(&Vector3::new(0.25, 0.1, 0.8)).expect("in view");
    assert_eq!(at(further.u_px, further.v_px), 9);
    assert_eq!(at(5.0, 5.0), 0);
    // The order of items does not matter.
    scenery.items.reverse();
    scenery.revision += 1;
    let again = renderer.render_labeled(&scenery, &snapshot, &Sensor::default(), 3).expect("an image");
    assert_eq!(again.left_objects, seen.left_objects);
}

#[test]
fn outlines_of_objects_are_where_geometry_says() {
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, snapshot) = empty();
    let at = Vector3::new(-0.1, 0.12, 0.4);
    let shapes = [
        ball(0.05),
        Shape::Box { half_m: Vector3::repeat(0.04) },
        Shape::Cylinder { radius_m: 0.03, half_length_m: 0.05 },
        Shape::Capsule { radius_m: 0.03, half_length_m: 0.05 },
        Shape::Mesh { mesh: Arc::new(cube(0.04)) },
    ];
    for shape in shapes {
        scenery.items = vec![before_left(&snapshot, 3, at, shape.clone(), 0.6)];
        scenery.revision += 1;
        let seen = renderer.render_labeled(&scenery, &snapshot, &Sensor::ideal(), 0).expect("an image");
        let mut wrong = 0;
        for (u, v, object) in seen.left_objects.enumerate_pixels() {
            let pixel = plumbline_model::Pixel::new(f64::from(u), f64::from(v));
            let Ok(ray) = snapshot.eyes.left.unproject(pixel) else { continue };
            if ray.z > 0.0 && (object[0] == 3) != meets(&shape, &-at, &ray) {
                wrong += 1;
            }
        }
        // A pixel on the outline may go either way.
        let outline = 2.0 * std::f64::consts::PI * 25.0;
        assert!(f64::from(wrong) < 0.3 * outline, "{shape:?}: {wrong} pixels differ");
    }
}

/// Whether a ray meets a shape, by walking along it: slow, and nothing like the shader.
fn meets(shape: &Shape, origin: &Vector3<f64>, ray: &Vector3<f64>) -> bool {
    (0..1200).any(|i| {
        let p = origin + ray * (0.3 + 0.00025 * f64::from(i));
        match shape {
            Shape::Box { half_m } => (0..3).all(|k| p[k].abs() <= half_m[k]),
            Shape::Ellipsoid { radii_m } => p.component_div(radii_m).norm() <= 1.0,
            Shape::Capsule { radius_m, half_length_m } => {
                let z = p.z.clamp(-half_length_m, *half_length_m);
                (p - Vector3::z() * z).norm() <= *radius_m
            }
            Shape::Cylinder { radius_m, half_length_m } => {
                p.xy().norm() <= *radius_m && p.z.abs() <= *half_length_m
            }
            Shape::Mesh { .. } => p.amax() <= 0.04,
            Shape::Board { .. } => false,
        }
    })
}

fn cube(half: f32) -> Mesh {
    let vertices: Vec<_> = (0..8)
        .map(|i| {
            let side = |bit: i32| if i & bit != 0 { half } else { -half };
            nalgebra::Point3::new(side(1), side(2), side(4))
        })
        .collect();
    let normals = vertices.iter().map(|v: &nalgebra::Point3<f32>| v.coords.normalize()).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { vertices, normals, triangles }
}

#[test]
fn the_same_seed_gives_the_same_images() {
    let Some(mut renderer) = renderer() else { return };
    let (scenery, snapshot) = sample::lab();
    let mut draw = |seed| renderer.render(&scenery, &snapshot, &Sensor::default(), seed).expect("an image");
    let (first, again, other) = (draw(7), draw(7), draw(8));
    assert!(first == again, "the same seed gave another image");
    assert!(first != other, "another seed gave the same image");
    let mut fresh = crate::renderer().expect("there was one");
    assert!(first == fresh.render(&scenery, &snapshot, &Sensor::default(), 7).expect("an image"));
    // Both eyes have noise of their own.
    assert!(first.left != first.right);
}

#[test]
fn noise_is_as_large_as_the_sensor_says() {
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, snapshot) = empty();
    scenery.light = even_light();
    let wall = Shape::Box { half_m: Vector3::new(0.5, 0.5, 0.01) };
    scenery.items = vec![before_left(&snapshot, 1, Vector3::z() * 0.3, wall, 0.5)];
    let sensor =
        Sensor { full_well_electrons: 2000.0, read_noise_electrons: 10.0, falloff: 0.0, ..Sensor::default() };
    let image = renderer.render(&scenery, &snapshot, &sensor, 5).expect("an image").left;
    let (mean, sd) = patch(&image, 300, 220, 40);
    // The brightness curve's slope takes linear light to gray levels.
    let linear = ((mean / 255.0 + 0.055) / 1.055).powf(2.4);
    let slope = 255.0 * 1.055 / 2.4 * linear.powf(1.0 / 2.4 - 1.0);
    let expected = slope * (linear * 2000.0 + 100.0_f64).sqrt() / 2000.0;
    assert!((sd / expected - 1.0).abs() < 0.12, "noise of {sd} gray levels instead of {expected}");
    let quiet = renderer.render(&scenery, &snapshot, &Sensor::ideal(), 5).expect("an image").left;
    assert!(patch(&quiet, 300, 220, 40).1 < 1.0);
}

#[test]
fn things_throw_shadows_and_glass_mirrors() {
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, mut snapshot) = empty();
    snapshot.eyes = sample::eyes(0.6);
    let item = |object, at: [f64; 3], shape, material| Item {
        object,
        body: BodyIndex(0),
        body_from_shape: Isometry3::translation(at[0], at[1], at[2]),
        shape,
        material,
    };
    let floor = Shape::Box { half_m: Vector3::new(1.0, 1.0, 0.01) };
    scenery.light = Light { toward: -Vector3::z(), lamp: 0.8, ambient: 0.2 };
    scenery.items =
        vec![item(1, [0.4, 0.0, 0.0], floor, plain(0.5)), item(2, [0.4, 0.0, 0.06], ball(0.02), plain(0.5))];
    let brightness = |renderer: &mut EyeRenderer, scenery: &Scenery, at: [f64; 3]| {
        let image = renderer.render(scenery, &snapshot, &Sensor::ideal(), 0).expect("an image").left;
        let left = snapshot.eyes.robot_from_left.isometry.inverse() * nalgebra::Point3::from(at);
        let pixel = snapshot.eyes.left.project(&left.coords).expect("in view");
        patch(&image, pixel.u_px as u32 - 1, pixel.v_px as u32 - 1, 3).0
    };
    let shaded = brightness(&mut renderer, &scenery, [0.4, 0.0, 0.01]);
    let lit = brightness(&mut renderer, &scenery, [0.4, 0.25, 0.01]);
    assert!(lit > shaded * 1.5, "{lit} in the light, {shaded} in the shadow");
    scenery.items.truncate(1);
    let free = brightness(&mut renderer, &scenery, [0.4, 0.0, 0.01]);
    assert!((free - lit).abs() < 0.1 * lit, "{free} without the ball, {lit} beside it");

    // A black mirror under a bright sky shows the dark ball above it.
    let mirror = Shape::Box { half_m: Vector3::new(0.3, 0.3, 0.01) };
    let glass = Material { albedo: [0.0; 3], gloss: 0.5, pattern: Pattern::Plain };
    scenery.light = Light { lamp: 0.0, ambient: 0.6, ..Light::default() };
    scenery.items = vec![item(1, [0.4, 0.0, -0.01], mirror, glass)];
    let without = brightness(&mut renderer, &scenery, [0.34, 0.0, 0.0]);
    // Where the eye looks along the mirrored ray toward the ball.
    let eye = snapshot.eyes.robot_from_left.translation_m();
    let image_of_eye = Vector3::new(eye.x, eye.y, -eye.z);
    let toward = (Vector3::new(0.34, 0.0, 0.0) - image_of_eye).normalize();
    let place = Vector3::new(0.34, 0.0, 0.0) + toward * 0.12;
    scenery.items.push(item(2, place.into(), ball(0.03), plain(0.0)));
    let with = brightness(&mut renderer, &scenery, [0.34, 0.0, 0.0]);
    assert!(with < without * 0.5, "{with} with a ball to mirror, {without} without");
}

#[test]
fn nothing_to_see_is_a_dark_image() {
    let Some(mut renderer) = renderer() else { return };
    let (scenery, snapshot) = empty();
    let seen = renderer.render_labeled(&scenery, &snapshot, &Sensor::default(), 1).expect("an image");
    assert_eq!(seen.pair.left.dimensions(), (640, 480));
    assert_eq!(seen.pair.left.get_pixel(2, 2).0, [0, 0, 0]);
    assert!(patch(&seen.pair.left, 300, 240, 20).0 < 130.0);
    assert!(seen.left_objects.iter().all(|&object| object == 0));
}

#[test]
fn the_image_circle_ends_where_the_sensor_says() {
    let Some(mut renderer) = renderer() else { return };
    let (mut scenery, snapshot) = empty();
    let room = Shape::Box { half_m: Vector3::repeat(2.0) };
    scenery.items = vec![before_left(&snapshot, 1, Vector3::zeros(), room, 0.8)];
    let sensor = Sensor { shell: None, ..Sensor::default() };
    let seen = renderer.render_labeled(&scenery, &snapshot, &sensor, 1).expect("an image");
    for (eye, objects) in Eye::BOTH.into_iter().zip([&seen.left_objects, &seen.right_objects]) {
        let camera = match eye {
            Eye::Left => &snapshot.eyes.left,
            Eye::Right => &snapshot.eyes.right,
        };
        for (u, v, object) in objects.enumerate_pixels() {
            let pixel = plumbline_model::Pixel::new(f64::from(u), f64::from(v));
            let angle = camera.unproject(pixel).map_or(9.0, |ray| ray.z.acos());
            let off = (angle - std::f64::consts::FRAC_PI_2).abs();
            if off > 0.01 {
                let inside = angle < std::f64::consts::FRAC_PI_2;
                assert_eq!(object[0] == 1, inside, "{eye} pixel {u}, {v} at {angle} rad");
            }
        }
    }
    // The face covers the nose's side of each eye: the right of the left one, the left of the right one.
    let with = renderer.render_labeled(&scenery, &snapshot, &Sensor::default(), 1).expect("an image");
    let (left, right) = (middle(&with.left_objects, 1), middle(&with.right_objects, 1));
    let (left, right) = (left.expect("seen"), right.expect("seen"));
    assert!(left[0] < 318.0 && right[0] > 325.0, "{left:?} {right:?}");
}

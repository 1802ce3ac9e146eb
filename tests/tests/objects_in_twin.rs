//! Places of toys on the twin's table, judged by the twin's truth: boxes are those of the renderer's
//! object images with edges wrong by a pixel by chance, as a detector's are; the eyes are known.
#![allow(clippy::print_stderr)]

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::robot::Rig;
use plumbline_model::{ClassIndex, ClassNames, Detection, PixelBox, Pose, StereoCalibration, StereoCameras};
use plumbline_tests::eye_renderer;
use plumbline_twin::eyes::{ObjectImage, Sensor};
use plumbline_twin::physics::World;
use plumbline_twin::scene::{Scenery, Shape, Snapshot, TrueEyes};
use plumbline_twin::scenery::object::of_toy;
use plumbline_twin::{Scenario, Toy, Twin, TwinSettings};
use plumbline_vision::detect_places::{Place, PlaceFinder, PlaceOptions, RangeFrom, Seen};
use plumbline_vision::synthetic::Noise;

/// Smaller things are nobody's boxes, px.
const LEAST_SIDE_PX: f32 = 6.0;
/// Table seen in a few head poses (turn, tilt from the usual one, rad).
const HEADS_RAD: [[f64; 2]; 4] = [[0.0, 0.0], [0.3, 0.05], [-0.3, -0.05], [0.1, -0.15]];

/// What is visible while all toys are out.
fn scenery(rig: &Arc<Rig>, scenario: &Scenario) -> Arc<Scenery> {
    let settings = TwinSettings { rig: rig.clone(), scenario: scenario.clone(), seed: 1, pace: 1.0 };
    Twin::start(settings).expect("it starts").scene().newest().0
}

fn calibration(eyes: &TrueEyes) -> StereoCalibration {
    let right_from_left = eyes.robot_from_right.isometry.inverse() * eyes.robot_from_left.isometry;
    StereoCalibration::bare(StereoCameras {
        left: eyes.left,
        right: eyes.right,
        right_from_left: Pose::new(right_from_left),
    })
}

/// Middle of the box around a toy, along the axes of the left eye.
fn middle(scenery: &Scenery, snapshot: &Snapshot, toy: Toy) -> Point3<f64> {
    let left_from_robot = snapshot.eyes.robot_from_left.isometry.inverse();
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for item in scenery.items.iter().filter(|item| item.object == of_toy(toy)) {
        let left_from_shape: Isometry3<f64> =
            left_from_robot * snapshot.robot_from_body[item.body.0] * item.body_from_shape;
        for corner in corners(&item.shape) {
            let corner = (left_from_shape * corner).coords;
            (low, high) = (low.inf(&corner), high.sup(&corner));
        }
    }
    Point3::from(0.5 * (low + high))
}

/// Points whose box is that of the shape, nearly.
fn corners(shape: &Shape) -> Vec<Point3<f64>> {
    let ball = |radii: Vector3<f64>| {
        let directions = (0..400).map(|i| {
            // Evenly over the sphere.
            let z = 1.0 - (f64::from(i) + 0.5) / 200.0;
            let angle = f64::from(i) * 2.399_963;
            Vector3::new(angle.cos(), angle.sin(), 0.0) * (1.0 - z * z).sqrt() + Vector3::z() * z
        });
        directions.map(|d| Point3::from(d.component_mul(&radii))).collect()
    };
    match shape {
        Shape::Mesh { mesh } => mesh.vertices.iter().map(|v| v.cast::<f64>()).collect(),
        Shape::Ellipsoid { radii_m } => ball(*radii_m),
        Shape::Capsule { radius_m, half_length_m } => {
            ball(Vector3::new(*radius_m, *radius_m, radius_m + half_length_m))
        }
        Shape::Cylinder { radius_m, half_length_m } => {
            ball(Vector3::new(*radius_m, *radius_m, *half_length_m))
        }
        Shape::Box { half_m } => ball(*half_m),
        Shape::Board { .. } => Vec::new(),
    }
}

fn detections(objects: &ObjectImage, noise: &mut Noise) -> Vec<(Toy, Detection)> {
    let names = ClassNames::published();
    let mut found = Vec::new();
    for toy in Toy::ALL {
        let mut area: Option<PixelBox> = None;
        for (x, y, _) in objects.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] == of_toy(toy)) {
            let (x, y) = (x as f32, y as f32);
            let own = PixelBox::new(x, y, x + 1.0, y + 1.0);
            area = Some(area.map_or(own, |a| {
                let (x1, y1) = (a.x1_px.max(own.x1_px), a.y1_px.max(own.y1_px));
                PixelBox::new(a.x0_px.min(x), a.y0_px.min(y), x1, y1)
            }));
        }
        let large = area.filter(|a| a.width_px() >= LEAST_SIDE_PX && a.height_px() >= LEAST_SIDE_PX);
        let Some(area) = large else { continue };
        let mut edge = |value: f32| value + noise.normal() as f32;
        let shaken = PixelBox::new(edge(area.x0_px), edge(area.y0_px), edge(area.x1_px), edge(area.y1_px));
        let name = names.iter().find(|(_, name)| name.eq_ignore_ascii_case(toy.name()));
        let class: ClassIndex = name.expect("a published class").0;
        found.push((toy, Detection { class, confidence: 0.9, area: shaken }));
    }
    found
}

struct Judged {
    error_m: f64,
    nees: f64,
    by_own_pixels: bool,
}

fn judge(place: &Place, truth: &Point3<f64>) -> Judged {
    let error = place.middle.point.coords - truth;
    let information = place.middle.covariance_m2.try_inverse().expect("a covariance");
    Judged {
        error_m: error.norm(),
        nees: (error.transpose() * information * error).x,
        by_own_pixels: place.from == RangeFrom::OwnPixelsAndBoxes,
    }
}

/// Places for the toys, a hand's breadth apart.
fn spread(noise: &mut Noise) -> Vec<(Toy, [f64; 2])> {
    let mut places: Vec<(Toy, [f64; 2])> = Vec::new();
    for toy in Toy::ALL {
        for _ in 0..100 {
            let at = [noise.between(0.26, 0.55), noise.between(-0.3, 0.3)];
            if places.iter().all(|(_, other)| (at[0] - other[0]).hypot(at[1] - other[1]) > 0.11) {
                places.push((toy, at));
                break;
            }
        }
    }
    places
}

#[test]
fn toys_on_the_table_are_where_they_are_said_to_be() {
    let Some(mut renderer) = eye_renderer() else { return };
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let scenario = Scenario::built_in("perfect").expect("valid");
    let scenery = scenery(&rig, &scenario);
    let mut world = World::new(rig.clone(), &scenario, 1).expect("a world");
    let mut noise = Noise::new(6);
    let (mut judged, mut both, mut wrong) = (Vec::new(), 0, 0);
    for scene in 0..12usize {
        for (toy, [x_m, y_m]) in spread(&mut noise) {
            world.place_toy(toy, x_m, y_m).expect("on the table");
        }
        let [turn_rad, tilt_rad] = HEADS_RAD[scene % HEADS_RAD.len()];
        let home = rig.home();
        let head = [rig.eyes.pan, rig.eyes.tilt];
        world.stand(&home.with(&head, &[home[head[0]] + turn_rad, home[head[1]] + tilt_rad]));
        world.run(0.3);
        let snapshot = world.snapshot();
        let drawn =
            renderer.render_labeled(&scenery, &snapshot, &Sensor::default(), scene as u64).expect("an image");
        let (left, right) =
            (detections(&drawn.left_objects, &mut noise), detections(&drawn.right_objects, &mut noise));
        both += left.iter().filter(|(toy, _)| right.iter().any(|(other, _)| other == toy)).count();
        let only = |boxes: &[(Toy, Detection)]| boxes.iter().map(|(_, d)| *d).collect::<Vec<_>>();
        let calibration = calibration(&snapshot.eyes);
        let mut finder =
            PlaceFinder::new(Some(&calibration), PlaceOptions::for_classes(&ClassNames::published()));
        let mut found = Vec::new();
        finder.find((&drawn.pair.left, &only(&left)), (&drawn.pair.right, &only(&right)), &mut found);
        for object in &found {
            let (Seen::Both { left: l, right: r, .. }, Ok(place)) = (object.seen, &object.place) else {
                continue;
            };
            if left[l].0 == right[r].0 {
                let truth = middle(&scenery, &snapshot, left[l].0);
                let one = judge(place, &truth);
                eprintln!(
                    "{:8} {:.2} m away: {:5.1} mm off, sigma {:4.1} mm, NEES {:5.2}{}",
                    left[l].0.name(),
                    truth.coords.norm(),
                    1e3 * one.error_m,
                    1e3 * place.middle.sigma_m(),
                    one.nees,
                    if one.by_own_pixels { "" } else { ", boxes alone" }
                );
                judged.push(one);
            } else {
                wrong += 1;
            }
        }
    }
    let n = judged.len();
    let mut errors: Vec<f64> = judged.iter().map(|j| j.error_m).collect();
    errors.sort_by(f64::total_cmp);
    let within = judged.iter().filter(|j| j.nees < 7.815).count();
    let own = judged.iter().filter(|j| j.by_own_pixels).count();
    eprintln!(
        "{n} of {both} toys seen by both eyes placed, {wrong} wrong pairs, {own} by own pixels; median {:.1} mm, 95 % {:.1} mm; {within} within the 95 % region, mean NEES {:.2} (3)",
        1e3 * errors[n / 2],
        1e3 * errors[n * 95 / 100],
        judged.iter().map(|j| j.nees).sum::<f64>() / n as f64
    );
    assert!(both >= 30, "only {both} toys are seen by both eyes");
    assert!(n * 100 >= both * 95 && wrong == 0, "{n} of {both} placed, {wrong} wrong pairs");
    assert!(errors[n / 2] < 0.015, "median error {} m", errors[n / 2]);
    assert!(within * 100 >= n * 80, "only {within} of {n} within the stated 95 % region");
}

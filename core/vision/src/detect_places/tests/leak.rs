//! A thing before a far background, such as a hand with spread fingers: most pixels of its box show
//! the background.

use nalgebra::{Isometry3, Point3};
use plumbline_model::{Eye, PixelBox, StereoCalibration};

use super::{ball, ball_box, blotches, detection, images, scene, small_eyes};
use crate::detect_places::{PlaceOptions, places};
use crate::synthetic::Plane;

/// A palm of 30 mm in the middle of a box of 70 mm, and three fingers.
fn is_hand(x: f64, y: f64) -> bool {
    let within = |value: f64, low: f64, high: f64| value > low && value < high;
    let is_palm = x.abs() < 0.015 && y.abs() < 0.015;
    let is_finger = within(x, 0.003, 0.013) && within(y, -0.035, 0.0);
    let is_thumb = within(x, -0.035, 0.0) && y.abs() < 0.005;
    let is_little_finger = within(x, 0.0, 0.035) && within(y, 0.005, 0.013);
    let is_wrist = within(x, -0.012, -0.002) && within(y, 0.0, 0.035);
    is_palm || is_finger || is_thumb || is_little_finger || is_wrist
}

#[test]
fn a_far_background_does_not_leak_into_a_hand() {
    let cameras = small_eyes();
    let middle = Point3::new(0.03, -0.02, 0.35);
    let mut scene = scene(Vec::new(), 2.0, 9);
    scene.planes.truncate(1);
    let skin = blotches(0.008, 5);
    let texture =
        Box::new(
            move |x: f64, y: f64| {
                if is_hand(x, y) { skin(x, y).map(|brightness| 90.0 + 0.4 * brightness) } else { None }
            },
        );
    scene.planes.push(Plane::new(Isometry3::translation(middle.x, middle.y, middle.z), texture));
    let [left_box, right_box] = Eye::BOTH.map(|eye| {
        let shift_m =
            if eye == Eye::Right { cameras.right_from_left.isometry } else { Isometry3::identity() };
        let corner = |x: f64, y: f64| {
            let point = shift_m * (middle + nalgebra::Vector3::new(x, y, 0.0));
            cameras.camera(eye).project(&point.coords).expect("visible")
        };
        let (a, b) = (corner(-0.035, -0.035), corner(0.035, 0.035));
        let area = [a.u_px, a.v_px, b.u_px, b.v_px].map(|edge| edge as f32 + 0.5);
        [detection(6, PixelBox::new(area[0], area[1], area[2], area[3]))]
    });
    let [left, right] = images(&scene, 4);
    let calibration = StereoCalibration::bare(cameras);
    let found = places(&calibration, (&left, &left_box), (&right, &right_box), &PlaceOptions::default());
    let place = found[0].place.as_ref().expect("placed");
    let surface_error_m = place.surface.point.range_m() - middle.coords.norm();
    eprintln!(
        "surface {:.1} mm off, {:?} {:?} {:?}",
        1e3 * surface_error_m,
        place.leak,
        place.from,
        place.disagreement
    );
    let leak = place.leak.expect("most of the box shows the wall");
    assert!(surface_error_m.abs() < 0.015, "surface is {surface_error_m} m off");
    assert!(leak.median_off_m > 0.1, "all pixels of the box would have been {} m off", leak.median_off_m);
    assert!(leak.behind_m > 0.8 && leak.share > 0.5, "{leak:?}");
    // No pixel that voted shows the wall.
    let shows_hand = |area: PixelBox| {
        let ray = cameras.left.unproject(area.middle()).expect("on the image");
        let at = ray * (middle.z / ray.z) - middle.coords;
        [-0.006, 0.0, 0.006].iter().any(|d| is_hand(at.x + d, at.y) || is_hand(at.x, at.y + d))
    };
    let (hand, all) = (place.votes.cells().filter(|cell| shows_hand(*cell)).count(), place.votes.count());
    eprintln!("{hand} of {all} voters show the hand");
    assert!(hand * 10 >= all * 9, "only {hand} of {all} voters show the hand");
}

#[test]
fn a_ball_before_a_near_wall_gives_no_warning() {
    let cameras = small_eyes();
    let center = Point3::new(0.0, -0.05, 0.4);
    let [left_box, right_box] = Eye::BOTH.map(|eye| [detection(7, ball_box(&cameras, eye, &center, 0.03))]);
    let [left, right] = images(&scene(vec![ball(center, 0.03, 0)], 0.45, 3), 8);
    let calibration = StereoCalibration::bare(cameras);
    let found = places(&calibration, (&left, &left_box), (&right, &right_box), &PlaceOptions::default());
    let place = found[0].place.as_ref().expect("placed");
    assert_eq!(place.leak, None);
    assert!(place.votes.count() > 50, "{} pixels voted", place.votes.count());
}

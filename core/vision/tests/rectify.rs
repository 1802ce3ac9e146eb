//! From raw fisheye images of made-up scenes to rectified views, disparities and places.

use std::sync::OnceLock;

use image::GrayImage;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use plumbline_model::aim::{AimedPair, DEFAULT_SIZE_PX};
use plumbline_model::frame::{LeftCamera, LeftRectified};
use plumbline_model::{Camera, CameraModel, Eye, Pinhole, Pixel, Point, Pose, StereoCameras, Workspace};
use plumbline_vision::depth::{PointMap, Probe, ProbeFailure, probe};
use plumbline_vision::disparity::{DisparityMap, Matcher, Settings};
use plumbline_vision::rectify::{Rectifier, RectifyError};
use plumbline_vision::synthetic::{Plane, Scene, granite_texture, nico_like_eyes};

/// The table of the workspace, covered with granite.
fn table(left_from_robot: Isometry3<f64>, grain_m: f64) -> Scene {
    let robot_from_table =
        Isometry3::from_parts(Translation3::new(0.0, 0.0, table_height_m()), UnitQuaternion::identity());
    let plane = Plane::new(left_from_robot * robot_from_table, granite_texture(grain_m, 7));
    Scene { planes: vec![plane], ..Scene::default() }
}

fn table_height_m() -> f64 {
    Workspace::default().table_height_m
}

fn left_from_robot() -> Isometry3<f64> {
    Workspace::default().robot_from_left.inverse().isometry
}

fn aimed() -> AimedPair {
    AimedPair::at_workspace(&nico_like_eyes(), &Workspace::default(), DEFAULT_SIZE_PX).expect("aimable")
}

/// The table as the eyes see it, with some noise; rendered once.
fn granite() -> &'static (GrayImage, GrayImage) {
    static PAIR: OnceLock<(GrayImage, GrayImage)> = OnceLock::new();
    PAIR.get_or_init(|| table(left_from_robot(), 0.008).render_pair(&nico_like_eyes(), 2.0, 11))
}

/// [`granite`], rectified and matched.
fn matched(settings: Settings) -> (AimedPair, DisparityMap) {
    let pair = aimed();
    let (left, right) = granite();
    let rectifier = Rectifier::new(&pair).expect("maps");
    let views = rectifier.rectify_gray(left, right).expect("right size");
    let map = Matcher::new(settings)
        .expect("settings")
        .compute(&views.left, &views.right, Some(rectifier.masks()))
        .expect("views of one size");
    (pair, map)
}

fn settings() -> [Settings; 2] {
    let max_disparity_px = aimed().disparity_at(0.17) as u32;
    [Settings::live(max_disparity_px), Settings::full(max_disparity_px)]
}

/// Places on the table, in the robot's frame, of all pixels whose disparity was measured, with
/// the number of pixels that show the patch.
fn measured_on_patch(pair: &AimedPair, map: &DisparityMap) -> (Vec<nalgebra::Point3<f64>>, usize) {
    let workspace = Workspace::default();
    let points = PointMap::new(map, pair).expect("same pair");
    let (mut on_patch, mut shown) = (Vec::new(), 0);
    for y in 0..map.height_px() {
        for x in 0..map.width_px() {
            let Some(seen) = on_table(pair, Pixel::new(f64::from(x), f64::from(y))) else { continue };
            let inside = |value: f64, range: [f64; 2]| value > range[0] && value < range[1];
            if !(inside(seen.x, workspace.x_range_m) && inside(seen.y, workspace.y_range_m)) {
                continue;
            }
            shown += 1;
            if let (Some(_), Some(point)) = (map.measured(x, y), points.point(x, y)) {
                on_patch.push((workspace.robot_from_left * point).coords);
            }
        }
    }
    (on_patch, shown)
}

/// Where the left view's ray at a pixel meets the table, in the robot's frame.
fn on_table(pair: &AimedPair, pixel: Pixel<plumbline_model::Rectified>) -> Option<nalgebra::Point3<f64>> {
    let robot_from_left = Workspace::default().robot_from_left;
    let eye = (robot_from_left * Point::new(0.0, 0.0, 0.0)).coords;
    let along = (robot_from_left * pair.point(pixel, 1.0)?).coords - eye;
    let t = (table_height_m() - eye.z) / along.z;
    (t > 0.0).then(|| eye + along * t)
}

#[test]
fn the_table_is_measured_where_it_is() {
    for settings in settings() {
        let (pair, map) = matched(settings);
        let (points, shown) = measured_on_patch(&pair, &map);
        let part = points.len() as f64 / shown as f64;
        let mut errors: Vec<f64> = points.iter().map(|p| p.z - table_height_m()).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize];
        eprintln!(
            "{:?}: {part:.3} of the patch measured, height off by {:.2} mm, 5 % to 95 % {:.1} to {:.1} mm",
            settings.quality,
            1e3 * at(0.5),
            1e3 * at(0.05),
            1e3 * at(0.95)
        );
        assert!(part > 0.85, "only {part} of the patch was measured");
        assert!(at(0.5).abs() < 5e-4, "the table is {} m off", at(0.5));
        assert!(at(0.95) - at(0.05) < 8e-3, "the heights scatter from {} to {} m", at(0.05), at(0.95));
    }
}

#[test]
fn views_are_what_pinhole_eyes_at_the_same_places_would_see() {
    let pair = aimed();
    let rectifier = Rectifier::new(&pair).expect("maps");
    let scene = |left_from_robot| table(left_from_robot, 0.1);
    let (left, right) = scene(left_from_robot()).render_pair(&pair.cameras, 0.0, 1);
    let views = rectifier.rectify_gray(&left, &right).expect("right size");

    let pinhole = Camera {
        model: CameraModel::Pinhole(Pinhole {
            cx_px: pair.cx_px,
            cy_px: pair.cy_px,
            ..Pinhole::ideal(pair.f_px, 0.0, 0.0)
        }),
        width_px: pair.width_px,
        height_px: pair.height_px,
    };
    let aside = nalgebra::Vector3::new(-pair.baseline_m, 0.0, 0.0);
    let virtual_eyes = StereoCameras {
        left: pinhole,
        right: pinhole,
        right_from_left: Pose::from_rotation_vector(nalgebra::Vector3::zeros(), aside),
    };
    let rectified_from_robot = pair.left_rectified_from_left.isometry * left_from_robot();
    let (left, right) = scene(rectified_from_robot).render_pair(&virtual_eyes, 0.0, 1);
    for (eye, expected) in [(Eye::Left, left), (Eye::Right, right)] {
        let mask = rectifier.masks().of(eye);
        let difference = |shift: u32| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (x, y, seen) in mask.enumerate_pixels().filter(|(x, ..)| x + shift < mask.width()) {
                if seen.0[0] > 0 {
                    let shown = views.of(eye).get_pixel(x + shift, y).0[0];
                    sum += f64::from(shown.abs_diff(expected.get_pixel(x, y).0[0]));
                    count += 1.0;
                }
            }
            assert!(count > 0.9 * f64::from(pair.width_px * pair.height_px));
            sum / count
        };
        let (mean, shifted) = (difference(0), difference(1));
        assert!(mean < 2.0, "the {eye} view differs by {mean} gray levels on average");
        assert!(shifted > 1.5 * mean, "one pixel off would not be noticed: {shifted}, {mean}");
    }
}

#[test]
fn color_and_gray_views_agree() {
    let pair = aimed();
    let rectifier = Rectifier::new(&pair).expect("maps");
    let (left, right) = granite();
    let rgb = |image: &GrayImage| image::DynamicImage::ImageLuma8(image.clone()).into_rgb8();
    let gray_views = rectifier.rectify_gray(left, right).expect("right size");
    let rgb_views = rectifier.rectify_rgb(&rgb(left), &rgb(right)).expect("right size");
    for eye in Eye::BOTH {
        for (gray, rgb) in gray_views.of(eye).pixels().zip(rgb_views.of(eye).pixels()) {
            assert_eq!([gray.0[0]; 3], rgb.0);
        }
    }
}

/// A view so far down that its lower part is beyond what the sensor sees.
fn too_far_down() -> AimedPair {
    AimedPair::turned_down(&nico_like_eyes(), 1.2, 1.8, (320, 240)).expect("aimable")
}

#[test]
fn what_the_sensor_does_not_see_is_masked_and_never_matched() {
    let pair = too_far_down();
    let rectifier = Rectifier::new(&pair).expect("maps");
    for eye in Eye::BOTH {
        let mask = rectifier.masks().of(eye);
        for (x, y, seen) in mask.enumerate_pixels() {
            let raw = pair.raw_from_rectified(eye, Pixel::new(f64::from(x), f64::from(y)));
            let on_sensor = raw.is_ok_and(|raw| raw.is_inside((640, 480)));
            assert_eq!(seen.0[0] > 0, on_sensor, "{eye} ({x}, {y})");
        }
        assert!(mask.contains(&0) && mask.iter().any(|seen| *seen > 0));
    }
    let (left, right) = granite();
    let views = rectifier.rectify_gray(left, right).expect("right size");
    let mut matcher = Matcher::new(Settings::live(60)).expect("settings");
    let map = matcher.compute(&views.left, &views.right, Some(rectifier.masks())).expect("map");
    for (x, y, seen) in rectifier.masks().left.enumerate_pixels() {
        if seen.0[0] == 0 {
            assert_eq!(map.get(x, y), None, "({x}, {y})");
            let pixel = Pixel::new(f64::from(x), f64::from(y));
            assert!(matches!(probe(&map, &pair, pixel), Err(ProbeFailure::Unseen)));
        }
    }
}

#[test]
fn images_of_another_size_are_refused_with_both_sizes() {
    let rectifier = Rectifier::new(&aimed()).expect("maps");
    let (good, bad) = (GrayImage::new(640, 480), GrayImage::new(1280, 720));
    let error = rectifier.rectify_gray(&good, &bad).expect_err("wrong size");
    assert!(matches!(error, RectifyError::Size { eye: Eye::Right, width_px: 1280, .. }));
    let message = error.to_string();
    assert!(message.contains("1280x720") && message.contains("640x480"), "{message}");
}

#[test]
fn a_view_behind_the_lens_is_refused() {
    let pair = AimedPair::turned_down(&nico_like_eyes(), 3.0, 0.6, (320, 240)).expect("aimable");
    assert!(matches!(Rectifier::new(&pair), Err(RectifyError::NothingVisible { .. })));
}

#[test]
fn points_are_those_of_the_aimed_pair() {
    let pair = aimed();
    let (width, height) = pair.size_px();
    let disparities =
        (0..width * height).map(|i| if i % 7 == 0 { f32::INFINITY } else { 5.0 + (i % 50) as f32 });
    let map = DisparityMap::from_measured(width, height, disparities.collect()).expect("fits");
    let points = PointMap::new(&map, &pair).expect("same pair");
    for y in (0..height).step_by(13) {
        for x in 0..width {
            let expected =
                map.get(x, y).and_then(|d| pair.point(Pixel::new(f64::from(x), f64::from(y)), f64::from(d)));
            match (points.point(x, y), expected) {
                (Some(point), Some(expected)) => {
                    assert!(
                        point.distance_m(&expected) < 1e-6 * expected.range_m(),
                        "{point:?} {expected:?}"
                    );
                    let depth_m = (pair.left_rectified_from_left * expected).coords.z;
                    let stored = points.depth_m(x, y).map(f64::from);
                    assert!(stored.is_some_and(|stored| (stored - depth_m).abs() < 1e-6 * depth_m));
                }
                (None, None) => {}
                (point, expected) => panic!("({x}, {y}): {point:?}, expected {expected:?}"),
            }
        }
    }
    assert!(points.point(width, 0).is_none() && points.point(0, height).is_none());
}

#[test]
fn a_probe_knows_how_far_off_it_may_be() {
    let (pair, map) = matched(settings()[0]);
    let eye = Point::<LeftCamera>::new(0.0, 0.0, 0.0);
    let (mut within_one, mut within_two, mut all) = (0, 0, 0);
    for y in (20..220).step_by(4) {
        for x in (20..476).step_by(4) {
            let pixel = Pixel::new(f64::from(x), f64::from(y));
            let Some(truth) = on_table(&pair, pixel).map(|p| Point::from(left_from_robot() * p)) else {
                continue;
            };
            let Ok(Probe { range_m, sigma_m, .. }) = probe(&map, &pair, pixel) else { continue };
            let off_m = (range_m - eye.distance_m(&truth)).abs();
            all += 1;
            within_one += i32::from(off_m < sigma_m);
            within_two += i32::from(off_m < 2.0 * sigma_m);
        }
    }
    let part = |count: i32| f64::from(count) / f64::from(all);
    eprintln!("{all} probes: {:.3} within one sigma, {:.3} within two", part(within_one), part(within_two));
    assert!(all > 3000, "only {all} probes");
    assert!(part(within_one) > 0.6 && part(within_two) > 0.9, "too sure of itself");
}

#[test]
fn a_probe_is_the_point_of_its_disparity() {
    let (pair, map) = matched(settings()[0]);
    let found = probe(&map, &pair, Pixel::new(250.0, 120.0)).expect("the middle of the table");
    let expected = pair.point(Pixel::new(250.0, 120.0), found.disparity_px).expect("in front");
    assert!(found.point.distance_m(&expected) < 1e-12);
    assert!((found.range_m - expected.range_m()).abs() < 1e-12);
    // First order: what one sigma of disparity does to the range.
    let further = pair.point(Pixel::new(250.0, 120.0), found.disparity_px - found.disparity_sigma_px);
    let change_m = further.expect("in front").range_m() - found.range_m;
    assert!((change_m - found.sigma_m).abs() < 0.05 * found.sigma_m, "{change_m} {}", found.sigma_m);
}

#[test]
fn a_probe_says_why_it_has_nothing() {
    let (pair, map) = matched(settings()[0]);
    let at = |u_px, v_px| probe(&map, &pair, Pixel::new(u_px, v_px));
    assert!(matches!(at(-5.0, 10.0), Err(ProbeFailure::Outside { .. })));
    assert!(matches!(at(f64::NAN, 10.0), Err(ProbeFailure::Outside { .. })));
    // The left edge of the near table lies outside the right view.
    assert!(matches!(at(2.0, 230.0), Err(ProbeFailure::Unmatched)), "{:?}", at(2.0, 230.0));
    let other = AimedPair::parallel(&nico_like_eyes(), (320, 240)).expect("aimable");
    assert!(matches!(probe(&map, &other, Pixel::new(10.0, 10.0)), Err(ProbeFailure::Size(_))));
    assert!(PointMap::new(&map, &other).is_err());
}

#[test]
fn rectified_rows_of_both_eyes_show_the_same_points() {
    let pair = aimed();
    for (x, y, z) in [(0.0, 0.0, 0.4), (-0.3, 0.05, 0.35), (0.25, -0.1, 0.6)] {
        let in_left = pair.left_rectified_from_left.inverse() * Point::<LeftRectified>::new(x, y, z);
        let raw_left = pair.cameras.left.project(&in_left.coords.coords).expect("visible");
        let in_right = pair.cameras.right_from_left * in_left;
        let raw_right = pair.cameras.right.project(&in_right.coords.coords).expect("visible");
        let left = pair.rectified_from_raw(Eye::Left, raw_left).expect("in the view");
        let right = pair.rectified_from_raw(Eye::Right, raw_right).expect("in the view");
        assert!((left.v_px - right.v_px).abs() < 1e-6);
        assert!((left.u_px - right.u_px - pair.disparity_at(z)).abs() < 1e-6);
    }
}

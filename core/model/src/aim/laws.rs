//! Laws of the aimed pair, on eyes with the published numbers of NICO and on a pinhole pair.

use nalgebra::Vector3;

use super::{AimError, AimedPair, DEFAULT_SIZE_PX, DISPARITY_STEP_PX};
use crate::camera::{Camera, CameraModel, Fisheye, Pinhole, ProjectError};
use crate::frame::{Point, Pose};
use crate::pixel::{Eye, Pixel, Rectified};
use crate::stereo::StereoCameras;
use crate::workspace::Workspace;

fn nico() -> StereoCameras {
    let eye = |fx_px, fy_px, cx_px, cy_px, skew_px, k| Camera {
        model: CameraModel::Fisheye(Fisheye { fx_px, fy_px, cx_px, cy_px, skew_px, k }),
        width_px: 640,
        height_px: 480,
    };
    let rotation_rad = Vector3::new(0.2004, -0.5079, 0.3261) * 1f64.to_radians();
    StereoCameras {
        left: eye(
            150.68417,
            150.71215,
            321.33567,
            238.08166,
            -0.07459,
            [-0.0083834, -0.0079917, 0.0017380, -0.00025998],
        ),
        right: eye(
            150.99253,
            150.92082,
            322.62101,
            235.26168,
            -0.04620,
            [-0.0109939, -0.0066349, 0.0020807, -0.00023410],
        ),
        right_from_left: Pose::from_rotation_vector(
            rotation_rad,
            Vector3::new(-0.0699274, -0.0003356, -0.0009737),
        ),
    }
}

fn pinholes() -> StereoCameras {
    let camera = Camera {
        model: CameraModel::Pinhole(Pinhole {
            k1: -0.36,
            k2: 0.17,
            p1: 0.001,
            ..Pinhole::ideal(524.0, 316.0, 247.0)
        }),
        width_px: 640,
        height_px: 480,
    };
    let right_from_left =
        Pose::from_rotation_vector(Vector3::new(0.01, -0.02, 0.03), Vector3::new(-0.12, 0.002, -0.001));
    StereoCameras { left: camera, right: camera, right_from_left }
}

fn pairs() -> [AimedPair; 4] {
    let workspace = Workspace::default();
    [
        AimedPair::at_workspace(&nico(), &workspace, DEFAULT_SIZE_PX).expect("aimable"),
        AimedPair::at_workspace(&nico(), &workspace, (800, 300)).expect("aimable"),
        AimedPair::parallel(&nico(), (640, 480)).expect("aimable"),
        AimedPair::parallel(&pinholes(), (640, 480)).expect("aimable"),
    ]
}

/// Pixels all over the view, with disparities from far to near (golden-ratio sequence).
fn samples(pair: &AimedPair) -> Vec<(Pixel<Rectified>, f64)> {
    let fraction = |i: f64, step: f64| (i * step).fract();
    (0..400)
        .map(|i| {
            let i = f64::from(i);
            let pixel = Pixel::new(
                fraction(i, 0.618_034) * f64::from(pair.width_px - 1),
                fraction(i, 0.754_878) * f64::from(pair.height_px - 1),
            );
            (pixel, 0.5 + 90.0 * fraction(i, 0.569_840))
        })
        .collect()
}

#[test]
fn both_views_show_a_point_on_the_same_row() {
    for pair in pairs() {
        for (pixel, disparity_px) in samples(&pair) {
            let point = pair.point(pixel, disparity_px).expect("positive disparity");
            let (left, right) = pair.project(point).expect("in front");
            assert!((left.v_px - right.v_px).abs() < 1e-9, "{left:?} {right:?}");
            // The same through the right eye's own rotation and center, not through the baseline.
            let point_in_right = pair.cameras.right_from_left * point;
            let direct = pair
                .pixel_of(&(pair.right_rectified_from_right * point_in_right).coords.coords)
                .expect("in front");
            assert!(direct.distance_px(&right) < 1e-9, "{direct:?} {right:?}");
        }
    }
}

#[test]
fn point_undoes_project() {
    for pair in pairs() {
        for (pixel, disparity_px) in samples(&pair) {
            let point = pair.point(pixel, disparity_px).expect("positive disparity");
            let (left, right) = pair.project(point).expect("in front");
            assert!(left.distance_px(&pixel) < 1e-9);
            assert!((left.u_px - right.u_px - disparity_px).abs() < 1e-9);
        }
    }
}

#[test]
fn raw_and_rectified_undo_each_other() {
    for pair in pairs() {
        for (pixel, _) in samples(&pair) {
            for eye in Eye::BOTH {
                // The pinhole's lens folds in the far corners of what it is asked for here.
                let Ok(raw) = pair.raw_from_rectified(eye, pixel) else { continue };
                let back = pair.rectified_from_raw(eye, raw).expect("just came from there");
                assert!(back.distance_px(&pixel) < 1e-6, "{pixel:?} came back as {back:?}");
            }
        }
    }
}

#[test]
fn raw_pixels_of_a_point_are_the_real_projections() {
    let pair = pairs()[0];
    for (pixel, disparity_px) in samples(&pair) {
        let point = pair.point(pixel, disparity_px).expect("positive disparity");
        let (left, right) = pair.project(point).expect("in front");
        let real = pair.cameras.left.project(&point.coords.coords).expect("visible");
        assert!(pair.raw_from_rectified(Eye::Left, left).expect("visible").distance_px(&real) < 1e-8);
        let point_in_right = pair.cameras.right_from_left * point;
        let real = pair.cameras.right.project(&point_in_right.coords.coords).expect("visible");
        assert!(pair.raw_from_rectified(Eye::Right, right).expect("visible").distance_px(&real) < 1e-8);
    }
}

#[test]
fn the_patch_fills_the_view_of_both_eyes() {
    let workspace = Workspace::default();
    for size_px in [DEFAULT_SIZE_PX, (800, 300), (1280, 400)] {
        let pair = AimedPair::at_workspace(&nico(), &workspace, size_px).expect("aimable");
        let mut columns = [f64::INFINITY, f64::NEG_INFINITY];
        let mut rows = [f64::INFINITY, f64::NEG_INFINITY];
        for height_m in [0.0, workspace.headroom_m] {
            for corner in workspace.corners_in_left(height_m) {
                let (left, right) = pair.project(corner).expect("in front");
                for pixel in [left, right] {
                    rows = [rows[0].min(pixel.v_px), rows[1].max(pixel.v_px)];
                    if height_m == 0.0 {
                        assert!(pixel.is_inside(size_px), "{corner:?} falls on {pixel:?} of {size_px:?}");
                        columns = [columns[0].min(pixel.u_px), columns[1].max(pixel.u_px)];
                    }
                }
            }
        }
        assert!(rows[0] >= 0.0 && rows[1] <= f64::from(size_px.1 - 1), "rows {rows:?}");
        let filled = [
            (columns[1] - columns[0]) / f64::from(size_px.0 - 1),
            (rows[1] - rows[0]) / f64::from(size_px.1 - 1),
        ];
        assert!(filled[0].max(filled[1]) > 0.97, "the patch fills only {filled:?}");
    }
}

#[test]
fn depth_steps_are_those_the_lens_allows() {
    let pair = AimedPair::suited(&nico(), &Workspace::default()).expect("aimable");
    assert!(pair.f_px > 150.0, "f = {}", pair.f_px);
    assert!(pair.depth_step_m(0.6) <= 2.2e-3, "{} m", pair.depth_step_m(0.6));
    // The step is what one unit of disparity really moves a point by.
    let d = pair.disparity_at(0.6);
    let depth = |d: f64| pair.f_px * pair.baseline_m / d;
    assert!((depth(d) - 0.6).abs() < 1e-12);
    let moved = depth(d - 0.5 * DISPARITY_STEP_PX) - depth(d + 0.5 * DISPARITY_STEP_PX);
    assert!((moved - pair.depth_step_m(0.6)).abs() < 1e-6);
}

#[test]
fn a_view_coarser_than_the_lens_is_refused_and_the_size_it_names_works() {
    let workspace = Workspace::default();
    let Err(AimError::Coarse { f_px, lens_px, needed_width_px, needed_height_px, .. }) =
        AimedPair::at_workspace(&nico(), &workspace, (320, 240))
    else {
        panic!("320x240 cannot hold the table at the lens's own detail");
    };
    assert!(f_px < lens_px);
    let pair =
        AimedPair::at_workspace(&nico(), &workspace, (needed_width_px, needed_height_px)).expect("aimable");
    assert!(pair.f_px >= lens_px && pair.f_px < 1.02 * lens_px);
}

#[test]
fn views_that_no_memory_holds_are_refused() {
    let mut eyes = nico();
    for camera in [&mut eyes.left, &mut eyes.right] {
        if let crate::camera::CameraModel::Fisheye(lens) = &mut camera.model {
            (lens.fx_px, lens.fy_px) = (1000.0 * lens.fx_px, 1000.0 * lens.fy_px);
        }
    }
    let workspace = Workspace::default();
    let Err(AimError::Coarse { needed_width_px, needed_height_px, .. }) =
        AimedPair::suited(&eyes, &workspace)
    else {
        panic!("a lens a thousand times finer does not fit into a usual view");
    };
    let too_large = AimedPair::at_workspace(&eyes, &workspace, (needed_width_px, needed_height_px));
    let said = too_large.expect_err("billions of pixels").to_string();
    assert!(said.contains("32 million pixels") && said.contains("calibrate again"), "{said}");
    for camera in [&mut eyes.left, &mut eyes.right] {
        if let crate::camera::CameraModel::Fisheye(lens) = &mut camera.model {
            (lens.fx_px, lens.fy_px) = (1e308, 1e308);
        }
    }
    // The size that would be needed has no number: it must not wrap to a small one.
    assert!(matches!(
        AimedPair::suited(&eyes, &workspace),
        Err(AimError::Coarse { needed_width_px: u32::MAX, needed_height_px: u32::MAX, .. })
    ));
    assert!(matches!(
        AimedPair::at_workspace(&eyes, &workspace, (u32::MAX, u32::MAX)),
        Err(AimError::TooLarge { .. })
    ));
}

#[test]
fn turning_down_moves_the_view_down_and_nothing_else() {
    let level = AimedPair::turned_down(&nico(), 0.0, 1.2, (640, 480)).expect("aimable");
    for down_rad in [-0.4, 0.0, 0.3, 0.8] {
        let pair = AimedPair::turned_down(&nico(), down_rad, 1.2, (640, 480)).expect("aimable");
        assert!((pair.down_rad() - down_rad).abs() < 1e-12);
        // What the turned view shows in its middle, the level one shows lower by that angle.
        let middle = pair.point(Pixel::new(319.5, 239.5), 20.0).expect("positive disparity");
        let (left, right) = level.project(middle).expect("in front");
        let lower_rad = ((left.v_px - level.cy_px) / level.f_px).atan();
        assert!((lower_rad - down_rad).abs() < 1e-9, "{lower_rad} {down_rad}");
        assert!((left.v_px - right.v_px).abs() < 1e-9);
        let across_rad = 2.0 * (319.5 / pair.f_px).atan();
        assert!((across_rad - 1.2).abs() < 1e-12);
    }
    for (down_rad, across_rad) in [(0.0, 3.0), (0.0, f64::NAN), (f64::NAN, 1.0), (4.0, 1.0)] {
        let result = AimedPair::turned_down(&nico(), down_rad, across_rad, (640, 480));
        assert!(matches!(result, Err(AimError::TooWide { .. })), "{result:?}");
    }
}

#[test]
fn pairs_that_see_no_depth_are_refused() {
    let mut together = nico();
    together.right_from_left = Pose::identity();
    assert!(matches!(AimedPair::parallel(&together, (640, 480)), Err(AimError::NoBaseline { .. })));

    let mut swapped = nico();
    swapped.right_from_left = Pose::new(nico().right_from_left.isometry.inverse());
    assert!(matches!(AimedPair::parallel(&swapped, (640, 480)), Err(AimError::NotSideBySide { .. })));

    let mut unknown = nico();
    unknown.right_from_left = Pose::from_rotation_vector(Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(AimedPair::parallel(&unknown, (640, 480)), Err(AimError::NoBaseline { .. })));
}

#[test]
fn a_workspace_around_the_eyes_is_refused() {
    let workspace = Workspace { x_range_m: [-3.0, 3.0], ..Workspace::default() };
    let result = AimedPair::at_workspace(&nico(), &workspace, DEFAULT_SIZE_PX);
    assert!(matches!(result, Err(AimError::TooWide { .. })), "{result:?}");
}

#[test]
fn no_disparity_is_no_point() {
    let pair = pairs()[0];
    let pixel = Pixel::new(100.0, 100.0);
    for disparity_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(pair.point(pixel, disparity_px).is_none());
    }
    let behind = pair.left_rectified_from_left.inverse() * Point::new(0.0, 0.0, -1.0);
    assert!(matches!(pair.project(behind), Err(ProjectError::Behind { .. })));
}

#[test]
fn turning_by_hand_gives_the_angle_and_the_field_of_view_asked_for() {
    let cameras = nico();
    for (down_rad, across_rad) in [(0.0, 1.0), (0.6, 1.6), (-0.3, 2.4)] {
        let pair = AimedPair::turned_down(&cameras, down_rad, across_rad, (401, 201)).expect("possible");
        assert!((pair.down_rad() - down_rad).abs() < 1e-12);
        let edge =
            |u_px| pair.point(Pixel::new(u_px, 100.0), 1.0).and_then(|p| p.direction()).expect("a direction");
        assert!((edge(0.0).angle_rad(&edge(400.0)) - across_rad).abs() < 1e-9);
    }
    let aimed = AimedPair::at_workspace(&cameras, &Workspace::default(), DEFAULT_SIZE_PX).expect("possible");
    assert!(aimed.down_rad() > 0.0, "the table is below");
    assert!(AimedPair::turned_down(&cameras, 0.0, 3.0, (401, 201)).is_err());
}

//! What the picture shows, what a click hits, and what happens to data that is not valid.

use egui::{Color32, Vec2, pos2, vec2};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::render::{Quality, Rendered, Renderer, Sampling};
use super::*;
use crate::theme::{DARK, LIGHT};

const SIZE: [usize; 2] = [160, 120];
const FINE: Sampling = Sampling { size_px: SIZE, factor: 2 };
const RED: Color32 = Color32::from_rgb(220, 20, 20);
const BLUE: Color32 = Color32::from_rgb(20, 20, 220);

/// Looks along x at the origin from 1 m.
fn camera() -> SceneCamera {
    SceneCamera {
        target_m: Point3::origin(),
        heading_rad: 0.0,
        pitch_rad: 0.0,
        distance_m: 1.0,
        fov_y_rad: 0.6,
    }
}

fn ball(x_m: f64, radius_m: f64, tint: Tint) -> Solid {
    let shape = Shape::Ellipsoid { radii_m: [radius_m; 3] };
    Solid::new(shape, Translation3::new(x_m, 0.0, 0.0).into(), tint)
}

fn render(scene: &Scene) -> Rendered {
    Renderer::default().render(scene, &camera(), FINE, 120.0, &DARK)
}

fn scene(solids: Vec<Solid>) -> Scene {
    Scene { solids, ..Scene::default() }
}

fn pixel(picture: &Rendered, x: usize, y: usize) -> [i32; 3] {
    let [r, g, b, _] = picture.pixels[y * picture.size_px[0] + x].to_array().map(i32::from);
    [r, g, b]
}

fn middle(picture: &Rendered) -> [i32; 3] {
    pixel(picture, SIZE[0] / 2, SIZE[1] / 2)
}

#[test]
fn the_nearer_body_hides_the_farther_one_in_any_order() {
    let near = ball(-0.3, 0.05, Tint::Object(RED));
    let far = ball(0.3, 0.2, Tint::Object(BLUE));
    for solids in [vec![near.clone(), far.clone()], vec![far, near]] {
        let picture = render(&scene(solids));
        let [r, _, b] = middle(&picture);
        assert!(r > 2 * b, "red in front: {r} {b}");
        let [r, _, b] = pixel(&picture, SIZE[0] / 2 + 25, SIZE[1] / 2);
        assert!(b > 2 * r, "blue around it: {r} {b}");
    }
}

#[test]
fn a_ghost_tints_what_is_behind_it_and_is_hidden_by_what_is_in_front() {
    let body = ball(0.0, 0.1, Tint::Object(BLUE));
    let alone = middle(&render(&scene(vec![body.clone()])));
    let behind = middle(&render(&scene(vec![body.clone(), ball(0.3, 0.1, Tint::Ghost)])));
    assert_eq!(alone, behind);
    let in_front = middle(&render(&scene(vec![ball(-0.3, 0.1, Tint::Ghost), body.clone()])));
    let pure = middle(&render(&scene(vec![ball(-0.3, 0.1, Tint::Predicted)])));
    assert!(in_front[0] > alone[0] + 30, "{alone:?} became {in_front:?}");
    assert!(in_front[2] > pure[2] + 20, "the blue shines through: {in_front:?} of {pure:?}");
    // Two ghosts at the same place are one ghost: nothing adds up.
    let ghost = ball(-0.3, 0.1, Tint::Ghost);
    assert_eq!(middle(&render(&scene(vec![ghost.clone(), ghost, body]))), in_front);
}

#[test]
fn a_ghost_of_the_present_pose_does_not_cover_it() {
    let alone = middle(&render(&scene(vec![ball(0.0, 0.1, Tint::Measured)])));
    let both = middle(&render(&scene(vec![ball(0.0, 0.1, Tint::Measured), ball(0.0, 0.1, Tint::Ghost)])));
    assert_eq!(alone, both);
}

#[test]
fn edges_are_smooth() {
    let picture = render(&scene(vec![ball(0.0, 0.15, Tint::Object(Color32::WHITE))]));
    let row: Vec<i32> = (0..SIZE[0]).map(|x| pixel(&picture, x, SIZE[1] / 3)[0]).collect();
    let background = row[0];
    let partial = row.iter().filter(|v| **v > background + 15 && **v < 100).count();
    assert!(partial >= 1, "a pixel at the rim is between body and background: {row:?}");
}

#[test]
fn lines_and_dots_are_hidden_by_bodies_in_front() {
    let mut scene = scene(vec![ball(-0.2, 0.05, Tint::Object(BLUE))]);
    let line = |x: f64| {
        Line::new(vec![Point3::new(x, 0.2, 0.0), Point3::new(x, -0.2, 0.0)], Tint::Object(RED)).width(3.0)
    };
    scene.lines = vec![line(0.2)];
    let picture = render(&scene);
    assert!(middle(&picture)[0] < 60, "behind the ball: {:?}", middle(&picture));
    let beside = pixel(&picture, SIZE[0] / 2 - 25, SIZE[1] / 2);
    assert!(beside[0] > 150, "beside it: {beside:?}");
    scene.lines = vec![line(-0.5)];
    scene.dots = vec![Dot { at_m: Point3::new(-0.5, 0.1, 0.1), radius: 5.0, tint: Tint::Object(RED) }];
    let picture = render(&scene);
    assert!(middle(&picture)[0] > 150, "in front of the ball");
    let (at, _) = camera().view(vec2(160.0, 120.0)).project(&Point3::new(-0.5, 0.1, 0.1)).expect("in view");
    assert!(pixel(&picture, at.x as usize, at.y as usize)[0] > 150, "the dot at {at:?}");
}

#[test]
fn what_has_no_valid_place_is_left_out_and_counted() {
    let nan = Isometry3::new(Vector3::new(f64::NAN, 0.0, 0.0), Vector3::zeros());
    let bad_shapes = [
        Shape::Box { size_m: [0.1, f64::NAN, 0.1] },
        Shape::Box { size_m: [0.1, 0.0, 0.1] },
        Shape::Ellipsoid { radii_m: [f64::NAN, 0.1, 0.1] },
        Shape::Capsule { radius_m: -0.1, length_m: 0.1 },
        Shape::Capsule { radius_m: 0.1, length_m: f64::INFINITY },
        Shape::Cylinder { radius_m: 0.1, length_m: f64::NAN },
    ];
    let mut scene = scene(vec![Solid::new(Shape::Ellipsoid { radii_m: [0.1; 3] }, nan, Tint::Measured)]);
    scene.solids.extend(bad_shapes.map(|shape| Solid::new(shape, Isometry3::identity(), Tint::Measured)));
    scene.lines = vec![
        Line::trail(vec![Point3::new(0.0, f64::NAN, 0.0), Point3::origin()], Tint::Measured),
        Line::new(vec![Point3::origin()], Tint::Measured),
    ];
    scene.dots = vec![Dot { at_m: Point3::new(f64::INFINITY, 0.0, 0.0), radius: 3.0, tint: Tint::Measured }];
    assert_eq!(scene.left_out(), 10);
    let picture = render(&scene);
    assert!(picture.pixels.iter().all(|p| *p == DARK.backdrop), "nothing is drawn");
    scene.solids.push(ball(0.0, 0.1, Tint::Object(RED)));
    assert!(middle(&render(&scene))[0] > 100, "what is valid still is");
    let ray = camera().view(vec2(160.0, 120.0)).ray(pos2(80.0, 60.0));
    assert!(pick::pick(&scene, ray).point_m.is_some());
}

#[test]
fn a_grid_that_cannot_be_drawn_is_not() {
    for grid in [
        Grid { step_m: 0.0, ..Grid::table(0.0) },
        Grid { step_m: 1e-9, ..Grid::table(0.0) },
        Grid { x_m: [f64::NAN, 1.0], ..Grid::table(0.0) },
        Grid { y_m: [0.5, -0.5], ..Grid::table(0.0) },
    ] {
        let scene = Scene { grid: Some(grid), ..scene(vec![ball(0.0, 0.05, Tint::Measured)]) };
        assert!(render(&scene).triangles < 2000, "{grid:?}");
    }
}

#[test]
fn the_camera_may_stand_inside_a_body() {
    let wall = Solid::new(Shape::Box { size_m: [4.0, 4.0, 0.02] }, Isometry3::identity(), Tint::Table);
    for z in [-0.011, 0.0, 0.005, 0.02] {
        let camera = SceneCamera { target_m: Point3::new(0.5, 0.0, z), ..camera() };
        Renderer::default().render(&scene(vec![wall.clone()]), &camera, FINE, 120.0, &LIGHT);
    }
    // Just above the plane: it fills the lower half of the picture up to the horizon.
    let above = SceneCamera { target_m: Point3::new(0.5, 0.0, 0.1), ..camera() };
    let picture = Renderer::default().render(&scene(vec![wall]), &above, FINE, 120.0, &DARK);
    assert_ne!(picture.pixels[(SIZE[1] - 2) * SIZE[0] + 80], DARK.backdrop);
    assert_eq!(picture.pixels[2 * SIZE[0] + 80], DARK.backdrop);
}

#[test]
fn a_shadow_falls_straight_down_and_only_on_the_ground() {
    let table = table_slab([-0.5, 0.5], [-0.5, 0.5], 0.0);
    let mut scene = scene(vec![table]);
    scene.grid = Some(Grid { z_m: 0.0, x_m: [-0.5, 0.5], y_m: [-0.5, 0.5], step_m: 0.37 });
    let camera = SceneCamera { pitch_rad: 0.6, distance_m: 1.5, ..camera() };
    let at = |scene: &Scene, point: Point3<f64>| {
        let picture = Renderer::default().render(scene, &camera, FINE, 120.0, &LIGHT);
        let (at, _) = camera.view(vec2(160.0, 120.0)).project(&point).expect("in view");
        pixel(&picture, at.x as usize, at.y as usize)[0]
    };
    let (below, beside) = (Point3::new(0.1, 0.1, 0.0), Point3::new(0.1, -0.25, 0.0));
    let lit = at(&scene, below);
    let shape = Shape::Ellipsoid { radii_m: [0.06; 3] };
    scene.solids.push(Solid::new(shape, Translation3::new(0.1, 0.1, 0.3).into(), Tint::Neutral));
    let shaded = at(&scene, below);
    assert!(shaded < lit - 15, "{shaded} of {lit}");
    assert!((at(&scene, beside) - lit).abs() < 12, "the rest stays lit");
}

#[test]
fn a_click_names_the_nearest_body_and_its_surface() {
    let solids = vec![
        ball(0.3, 0.2, Tint::Measured).pick(PickId(1)),
        ball(-0.2, 0.05, Tint::Measured).pick(PickId(2)),
        ball(-0.5, 0.05, Tint::Ghost),
    ];
    let view = camera().view(Vec2::new(160.0, 120.0));
    let scene = scene(solids);
    let hit = pick::pick(&scene, view.ray(pos2(80.0, 60.0)));
    assert_eq!(hit.pick, Some(PickId(2)), "the ghost without an id lets it through");
    let point = hit.point_m.expect("a surface");
    assert!((point - Point3::new(-0.25, 0.0, 0.0)).norm() < 2e-3, "{point}");
    assert_eq!(pick::pick(&scene, view.ray(pos2(80.0, 82.0))).pick, Some(PickId(1)));
    let void = pick::pick(&scene, view.ray(pos2(2.0, 2.0)));
    assert_eq!((void.pick, void.point_m), (None, None));
}

#[test]
fn a_click_beside_bodies_lands_on_the_plane_of_the_grid() {
    let scene = Scene { grid: Some(Grid::table(0.054)), ..scene(vec![ball(0.3, 0.02, Tint::Measured)]) };
    let view = SceneCamera::preset(ViewPreset::Top).view(vec2(700.0, 500.0));
    let point = Point3::new(0.45, -0.2, 0.054);
    let (place, _) = view.project(&point).expect("in view");
    let hit = pick::pick(&scene, view.ray(place)).point_m.expect("the table");
    assert!((hit - point).norm() < 1e-5, "{hit}");
}

#[test]
fn large_views_are_drawn_coarser_while_something_moves() {
    let of = |view_px, quality| {
        let Sampling { size_px, factor } = Sampling::of(view_px, quality);
        (size_px, factor)
    };
    assert_eq!(of([700, 500], Quality::Draft), ([700, 500], 2));
    assert_eq!(of([1400, 900], Quality::Draft), ([1400, 900], 1));
    assert_eq!(of([1400, 900], Quality::Fine), ([1400, 900], 2));
    assert_eq!(of([2801, 1800], Quality::Draft), ([1401, 900], 1));
    assert_eq!(of([2801, 1800], Quality::Fine), ([2801, 1800], 1));
    assert_eq!(of([0, 0], Quality::Draft), ([1, 1], 2));
}

/// A robot-like scene. Printed rather than asserted tightly: the bound is a tenfold of what an
/// idle core needs, to find a lost optimization.
#[test]
fn render_time() {
    let scene = crate::gallery::robot_scene(true);
    for view_px in [[700, 500], [1400, 900]] {
        let mut renderer = Renderer::default();
        let sampling = Sampling::of(view_px, Quality::Draft);
        let mut times = Vec::new();
        let mut triangles = 0;
        for i in 0..40 {
            let camera = SceneCamera { heading_rad: 2.4 + 0.01 * f64::from(i), ..SceneCamera::default() };
            let start = Instant::now();
            triangles = renderer.render(&scene, &camera, sampling, view_px[1] as f32, &DARK).triangles;
            times.push(start.elapsed().as_secs_f64());
        }
        times.sort_by(f64::total_cmp);
        let (best, median) = (times[0] * 1e3, times[20] * 1e3);
        let [width, height] = view_px;
        eprintln!("{width}x{height}, {triangles} triangles: median {median:.2} ms, best {best:.2} ms");
        assert!(triangles > 3000, "{triangles} triangles");
        assert!(best < 80.0, "{best} ms");
    }
}

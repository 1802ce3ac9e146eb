//! Laws on images rendered with the hand's own shape, and what a wrong input is answered with.

use std::sync::Arc;

use image::{Rgb, RgbImage};
use nalgebra::{Isometry3, UnitQuaternion};
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::{Eye, Point};

use super::*;

const TIP: &str = "right_palm_center";

/// A robot with its hand over the table.
struct Desk {
    rig: Arc<Rig>,
    hand: HandShape,
    eyes: EyesAt,
    posture: Posture,
    robot_from_tip: Pose<Robot, Tip>,
}

fn desk(x_m: f64, y_m: f64) -> Desk {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let hand = HandShape::of_rig(&rig, TIP).expect("a hand");
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let open = rig.pose("open-hand").expect("a pose").applied_to(&rig.home());
    let target = Target::PositionYaw { point: Point::new(x_m, y_m, 0.13), yaw_rad: 0.3 };
    let answer = solver.solve_from(&target, &open, &Options::upright()).expect("finite");
    let posture = open.with(solver.joints(), answer.best().joints.as_ref());
    let robot_from_tip = rig.chain(TIP).expect("a tip").robot_from_tip_in(&posture);
    let eyes = EyesAt { cameras: rig.eyes.cameras, robot_from_left: rig.robot_from_left(&rig.home()) };
    Desk { rig, hand, eyes, posture, robot_from_tip }
}

impl Desk {
    fn predicted(&self, off_m: Vector3<f64>, sigma_m: f64) -> Predicted<'_> {
        let shifted = Isometry3::translation(off_m.x, off_m.y, off_m.z) * self.robot_from_tip.isometry;
        Predicted {
            posture: &self.posture,
            robot_from_tip: Pose::new(shifted),
            covariance_m2: Matrix3::identity() * sigma_m * sigma_m,
        }
    }

    /// Both eyes' images with the hand where it is.
    fn shown(&self) -> [RgbImage; 2] {
        let view = self.hand.view(&self.eyes, &self.predicted(Vector3::zeros(), 0.003));
        let [left, right] = background();
        [painted(left, view.left.as_ref()), painted(right, view.right.as_ref())]
    }
}

/// Speckles, so that every place has edges.
fn background() -> [RgbImage; 2] {
    [0.0f64, 17.0].map(|phase| {
        RgbImage::from_fn(640, 480, |u, v| {
            let (u, v) = (f64::from(u) + phase, f64::from(v));
            let speckle = (0.9 * u).sin() * (0.7 * v + 0.2 * u).sin() + (0.31 * v - 0.13 * u).sin();
            Rgb([150.0, 145.0, 140.0].map(|gray| (gray + 35.0 * speckle) as u8))
        })
    })
}

fn painted(mut image: RgbImage, mask: Option<&Mask>) -> RgbImage {
    let mask = mask.expect("in view");
    for (i, part) in mask.coverage.iter().enumerate() {
        let (u, v) = (mask.u0_px + i as u32 % mask.width_px, mask.v0_px + i as u32 / mask.width_px);
        let behind = image.get_pixel(u, v).0;
        let gray = 28.0 + 6.0 * ((u * 7 + v * 13) % 5) as f32;
        image.put_pixel(u, v, Rgb(behind.map(|value| (part * gray + (1.0 - part) * f32::from(value)) as u8)));
    }
    image
}

fn pair(images: &[RgbImage; 2]) -> Pair<'_> {
    Pair { left: &images[0], right: &images[1] }
}

fn look(desk: &Desk, with_before: bool, off_m: Vector3<f64>, sigma_m: f64) -> Result<HandSeen, HandNotSeen> {
    let (before, now) = (background(), desk.shown());
    let before = with_before.then(|| pair(&before));
    let predicted = desk.predicted(off_m, sigma_m);
    look_for_hand(before, pair(&now), &desk.eyes, &desk.hand, &predicted, &HandOptions::default())
}

#[test]
fn on_its_own_rendering_the_hand_is_where_it_was_predicted() {
    for (x_m, y_m) in [(0.25, -0.1), (0.35, -0.2), (0.3, 0.1)] {
        let seen = look(&desk(x_m, y_m), true, Vector3::zeros(), 0.003).expect("seen");
        assert!(seen.offset_m.norm() < 5e-4, "{x_m} {y_m}: {}", seen.offset_m);
        assert!(seen.turn_rad.norm() < 0.02, "{}", seen.turn_rad);
        let outline = seen.fit.iter().flatten().map(|fit| fit.outline.len()).sum::<usize>();
        assert!(outline > 100, "{outline} points");
    }
}

#[test]
fn a_shift_is_recovered() {
    for (off_mm, sigma_m) in
        [([4.0, -3.0, 2.0], 0.005), ([-20.0, 15.0, 5.0], 0.02), ([10.0, 25.0, -15.0], 0.02)]
    {
        let off_m = Vector3::from(off_mm) * 1e-3;
        // Without a pair before, the background's own edges count.
        for (with_before, tolerance_m) in [(true, 2.5e-3), (false, 6e-3)] {
            let seen = look(&desk(0.3, -0.1), with_before, off_m, sigma_m).expect("seen");
            let miss = seen.offset_m + off_m;
            assert!(miss.norm() < tolerance_m, "{off_mm:?}, {with_before}: {:.2} mm", miss.norm() * 1e3);
            for k in 0..3 {
                let sigmas = miss[k] / seen.covariance_m2[(k, k)].sqrt();
                assert!(sigmas.abs() < 3.5, "{off_mm:?}, {with_before}: {sigmas:.1} sigma along {k}");
            }
        }
    }
}

#[test]
fn depth_is_known_least_and_less_than_beforehand_is_unknown() {
    let desk = desk(0.35, -0.1);
    let seen = look(&desk, true, Vector3::zeros(), 0.02).expect("seen");
    let from_eye = desk.robot_from_tip.translation_m() - desk.eyes.robot_from_left.translation_m();
    let along = from_eye.normalize();
    let across = along.cross(&Vector3::z()).normalize();
    let sigma = |axis: &Vector3<f64>| axis.dot(&(seen.covariance_m2 * axis)).sqrt();
    assert!(sigma(&along) > 1.5 * sigma(&across), "{} {}", sigma(&along), sigma(&across));
    assert!(sigma(&along) < 0.02 && seen.sigma_m() >= sigma(&along));
}

#[test]
fn a_turn_is_not_taken_for_a_shift() {
    let mut turned = desk(0.3, -0.1);
    let now = turned.shown();
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.03, -0.04, 0.05));
    turned.robot_from_tip.isometry.rotation = turn * turned.robot_from_tip.isometry.rotation;
    let predicted = turned.predicted(Vector3::zeros(), 0.01);
    let before = background();
    let seen = look_for_hand(
        Some(pair(&before)),
        pair(&now),
        &turned.eyes,
        &turned.hand,
        &predicted,
        &HandOptions::default(),
    )
    .expect("seen");
    assert!(seen.offset_m.norm() < 3e-3, "{}", seen.offset_m);
    assert!((seen.turn_rad + turn.scaled_axis()).norm() < 0.04, "{}", seen.turn_rad);
}

#[test]
fn a_hand_that_is_not_there_is_not_found() {
    let desk = desk(0.3, -0.1);
    let (before, now) = (background(), background());
    let predicted = desk.predicted(Vector3::zeros(), 0.003);
    let options = HandOptions::default();
    let find = |before: Option<Pair<'_>>, now: &[RgbImage; 2], predicted: &Predicted<'_>| {
        look_for_hand(before, pair(now), &desk.eyes, &desk.hand, predicted, &options)
    };
    let nothing = find(Some(pair(&before)), &now, &predicted).expect_err("no hand");
    assert!(matches!(nothing, HandNotSeen::NothingChanged { share } if share < 0.01), "{nothing:?}");
    assert!(nothing.to_string().contains("nothing changed"), "{nothing}");
    // A bright sheet in front of most of it.
    let sheet = desk.shown().map(|mut image| {
        (200..460).for_each(|u| (150..420).for_each(|v| image.put_pixel(u, v, Rgb([235, 230, 225]))));
        image
    });
    let hidden = find(Some(pair(&before)), &sheet, &predicted).expect_err("hidden");
    assert!(matches!(hidden, HandNotSeen::Hidden { .. } | HandNotSeen::DoesNotFit { .. }), "{hidden:?}");
    let mut behind = desk.predicted(Vector3::zeros(), 0.003);
    behind.robot_from_tip.isometry.translation.vector = Vector3::new(-0.5, 0.0, 0.3);
    assert_eq!(find(None, &now, &behind).expect_err("behind"), HandNotSeen::OutsideView);
    let mut sure = desk.predicted(Vector3::zeros(), 0.003);
    sure.covariance_m2 = Matrix3::zeros();
    assert_eq!(find(None, &now, &sure).expect_err("no prior"), HandNotSeen::NoPrior);
    let small = [RgbImage::new(64, 48), RgbImage::new(64, 48)];
    assert_eq!(find(None, &small, &predicted).expect_err("small"), HandNotSeen::OtherSize);
}

#[test]
fn masks_lie_where_the_hand_projects() {
    let desk = desk(0.3, -0.1);
    let view = desk.hand.view(&desk.eyes, &desk.predicted(Vector3::zeros(), 0.003));
    for (eye, mask) in [(Eye::Left, &view.left), (Eye::Right, &view.right)] {
        let mask = mask.as_ref().expect("in view");
        assert!((300.0..6000.0).contains(&mask.area_px()), "{} px", mask.area_px());
        let in_camera =
            desk.eyes.camera_from_robot(eye) * nalgebra::Point3::from(desk.robot_from_tip.translation_m());
        let tip = desk.eyes.cameras.camera(eye).project(&in_camera.coords).expect("in view");
        let (u, v) = (tip.u_px - f64::from(mask.u0_px), tip.v_px - f64::from(mask.v0_px));
        let near = |at: f64, size: u32| at > -20.0 && at < f64::from(size) + 20.0;
        assert!(near(u, mask.width_px) && near(v, mask.height_px), "{u} {v}");
    }
}

#[test]
fn unknown_tips_are_told_with_those_that_are_known() {
    let rig = desk(0.3, -0.1).rig;
    let error = HandShape::of_rig(&rig, "tail").expect_err("none").to_string();
    assert!(error.contains("tail") && error.contains(TIP), "{error}");
}

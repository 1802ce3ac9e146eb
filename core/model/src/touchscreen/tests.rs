// What was measured is printed.
#![allow(clippy::print_stdout)]

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::*;
use crate::robot::Rig;

fn nominal() -> Touchscreen {
    Rig::built_in("nico").expect("comes with the program").touchscreen
}

/// A screen that lies somehow, with axes that miss the right angle as far as a session may.
fn skewed() -> Touchscreen {
    let turned = nominal().moved(&Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, -0.3, 0.8)));
    let bent = turned.v_axis.vector() + 0.015 * turned.u_axis.vector();
    Touchscreen { v_axis: Direction::new(bent).expect("not zero"), ..turned }
}

/// Seeded numbers of a normal distribution (SplitMix64, sum of twelve).
struct Noise(u64);

impl Noise {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    fn vector(&mut self, sd: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sd * self.normal())
    }
}

#[test]
fn pixels_come_back() {
    for screen in [nominal(), nominal().raised(0.06), skewed()] {
        for (u_px, v_px) in [(0.0, 0.0), (-0.5, 1079.5), (960.25, 3.0), (1919.0, 1079.0), (-300.0, 5000.0)] {
            let point = screen.point_at(Pixel::new(u_px, v_px));
            assert!(screen.height_above_m(point).abs() < 1e-12);
            // A point over the glass has the pixel below it.
            let above = Point::from(point.coords + screen.normal().vector() * 0.1);
            for point in [point, above] {
                let back = screen.pixel_at(point);
                assert!((back.u_px - u_px).abs() < 1e-8 && (back.v_px - v_px).abs() < 1e-8, "{back:?}");
            }
            assert!((screen.height_above_m(above) - 0.1).abs() < 1e-12);
        }
    }
}

#[test]
fn pixels_lie_where_the_conventions_say() {
    let screen = nominal();
    let [u_m, v_m] = screen.pitch_m();
    assert!((u_m - 0.475 / 1920.0).abs() < 1e-15 && (v_m - 0.267 / 1080.0).abs() < 1e-15);
    // The outer corner is half a pixel before the center of the first one: u grows to the robot's
    // right (−y), v toward the robot (−x).
    let first = screen.point_at(Pixel::new(0.0, 0.0)).coords;
    let corner = screen.origin.coords;
    assert!((first.y - (corner.y - 0.5 * u_m)).abs() < 1e-15);
    assert!((first.x - (corner.x - 0.5 * v_m)).abs() < 1e-15);
    assert!(screen.normal().vector().z > 0.999, "the glass looks up");
    let corners = screen.corners();
    assert!(corners[0].distance_m(&screen.origin) < 1e-15);
    assert!((corners[0].distance_m(&corners[1]) - screen.width_m).abs() < 1e-12);
    assert!((corners[1].distance_m(&corners[2]) - screen.height_m).abs() < 1e-12);
    assert!(screen.point_at(screen.middle()).distance_m(&corners[0]) > 0.2);
}

#[test]
fn the_image_ends_at_its_outer_pixels() {
    let screen = nominal();
    for (u_px, v_px, on) in [
        (-0.5, -0.5, true),
        (1919.5, 1079.5, true),
        (-0.6, 10.0, false),
        (1919.6, 10.0, false),
        (10.0, 1079.6, false),
        (f64::NAN, 10.0, false),
    ] {
        assert_eq!(screen.contains(Pixel::new(u_px, v_px)), on, "({u_px}, {v_px})");
    }
}

/// Touches of a screen that truly lies `motion` away from its nominal place.
fn touches(
    motion: &Isometry3<f64>,
    pixels: &[(f64, f64)],
    sd_m: f64,
    noise: &mut Noise,
) -> Vec<(Pixel<Screen>, Point<Robot>)> {
    let truth = nominal().moved(motion);
    let touch = |&(u_px, v_px): &(f64, f64)| {
        let pixel = Pixel::new(u_px, v_px);
        (pixel, Point::from(truth.point_at(pixel).coords + noise.vector(sd_m)))
    };
    pixels.iter().map(touch).collect()
}

const CORNERS: [(f64, f64); 4] = [(100.0, 300.0), (1800.0, 300.0), (1800.0, 1000.0), (100.0, 1000.0)];

fn still() -> Isometry3<f64> {
    Isometry3::identity()
}

#[test]
fn the_truth_lies_within_the_stated_uncertainty() {
    let mut noise = Noise(7);
    for (times, sd_m) in [(1, 1.5e-3), (3, 0.7e-3), (3, 3e-3)] {
        let pixels: Vec<(f64, f64)> = CORNERS.iter().copied().cycle().take(4 * times).collect();
        let mut within = 0;
        let mut squares = vec![];
        for _ in 0..100 {
            let turn = UnitQuaternion::from_scaled_axis(noise.vector(0.05));
            let motion = Isometry3::from_parts(Translation3::from(noise.vector(0.02)), turn);
            let placed =
                place_screen(&nominal(), &touches(&motion, &pixels, sd_m, &mut noise)).expect("a screen");
            let truth = nominal().moved(&motion);
            let middle =
                truth.point_at(truth.middle()).coords - nominal().point_at(nominal().middle()).coords;
            let shift = middle - Vector3::from(placed.moved_m);
            // The error of the turn, in the robot frame.
            let found = UnitQuaternion::from_scaled_axis(Vector3::from(placed.turned_rad));
            let turn = (turn * found.inverse()).scaled_axis();
            let z = (0..6)
                .map(|i| if i < 3 { shift[i] / placed.sd_m[i] } else { turn[i - 3] / placed.sd_rad[i - 3] });
            let z: Vec<f64> = z.collect();
            within += usize::from(z.iter().all(|z| z.abs() < 3.0));
            squares.extend(z.iter().map(|z| z * z));
        }
        let mean_square = squares.iter().sum::<f64>() / squares.len() as f64;
        println!(
            "{} touches of {sd_m} m: {within} of 100 within 3 sd, z rms {:.2}",
            4 * times,
            mean_square.sqrt()
        );
        assert!(within >= 95, "{within} of 100");
        // Neither too sure nor too timid: with 4 touches the usual noise is a lower bound.
        assert!((0.5..1.5).contains(&mean_square.sqrt()), "{mean_square}");
    }
}

#[test]
fn exact_touches_place_exactly() {
    let motion = Isometry3::new(Vector3::new(0.01, -0.02, 0.004), Vector3::new(0.01, -0.02, 0.3));
    let placed =
        place_screen(&nominal(), &touches(&motion, &CORNERS[..3], 0.0, &mut Noise(1))).expect("a screen");
    assert!(placed.rms_m < 1e-12);
    for (found, truth) in placed.screen.corners().iter().zip(nominal().moved(&motion).corners()) {
        assert!(found.distance_m(&truth) < 1e-12);
    }
    assert_eq!(placed.touches, 3);
    assert!(placed.remarks[0].contains("too few to judge"), "{:?}", placed.remarks);
    assert_eq!(placed.remarks.len(), 1, "nothing else to say");
    assert!(placed.sd_m.iter().all(|sd_m| (0.5e-3..3e-3).contains(sd_m)), "{:?}", placed.sd_m);
}

#[test]
fn a_slip_is_named() {
    let pixels: Vec<(f64, f64)> = CORNERS.iter().copied().cycle().take(12).collect();
    let mut some = touches(&still(), &pixels, 0.5e-3, &mut Noise(3));
    some[4].1.coords.x += 0.025;
    let placed = place_screen(&nominal(), &some).expect("a screen");
    assert!(placed.remarks.iter().any(|remark| remark.starts_with("touch 5 lies")), "{:?}", placed.remarks);
}

fn refusal(touches: &[(Pixel<Screen>, Point<Robot>)]) -> String {
    place_screen(&nominal(), touches).expect_err("refused").to_string()
}

#[test]
fn touches_that_cannot_place_a_screen_say_why() {
    let good = touches(&still(), &CORNERS, 0.0, &mut Noise(1));
    assert!(refusal(&good[..2]).contains("at least three"));
    assert!(refusal(&[]).contains("at least three"));
    let line: Vec<(f64, f64)> = (0..5).map(|i| (200.0 + 300.0 * f64::from(i), 600.0)).collect();
    assert!(refusal(&touches(&still(), &line, 0.0, &mut Noise(1))).contains("on a line"));
    assert!(refusal(&[good[0]; 4]).contains("on a line"), "one place four times");
    let mut lost = good.clone();
    lost[2].1 = Point::new(f64::NAN, 0.0, 0.0);
    assert!(refusal(&lost).contains("touch 3"));
    let mut beside = good.clone();
    beside[1].0 = Pixel::new(2500.0, 20.0);
    assert!(refusal(&beside).contains("beside the screen of 1920×1080"));
}

#[test]
fn corners_in_another_order_are_noticed() {
    let good = touches(&still(), &CORNERS, 0.0, &mut Noise(1));
    let ordered = |order: [usize; 4]| -> Vec<_> { (0..4).map(|i| (good[i].0, good[order[i]].1)).collect() };
    assert!(refusal(&ordered([1, 0, 3, 2])).contains("mirrored"));
    assert!(refusal(&ordered([2, 3, 0, 1])).contains("turned by 180°"));
    // Two corners exchanged fit to no screen at all.
    let message = refusal(&ordered([1, 0, 2, 3]));
    assert!(message.contains("mm rms") || message.contains("mirrored"), "{message}");
    // A screen of another size.
    let small = Touchscreen { width_m: 0.3, height_m: 0.15, ..nominal() };
    let message = place_screen(&small, &good).expect_err("refused").to_string();
    assert!(message.contains("size"), "{message}");
}

#[test]
fn a_screen_without_size_is_refused() {
    let flat = Touchscreen { width_m: 0.0, ..nominal() };
    assert!(!flat.is_usable());
    let good = touches(&still(), &CORNERS, 0.0, &mut Noise(1));
    assert!(place_screen(&flat, &good).expect_err("refused").to_string().contains("size"));
}

#[test]
fn readers_refuse_a_screen_without_size() {
    let rig = include_str!("../../../../assets/robots/nico/rig.toml");
    let urdf = include_str!("../../../../assets/robots/nico/nico.urdf");
    let sizes = [
        ("width_px = 1920", "width_px = 0"),
        ("width_m = 0.475", "width_m = 0.0"),
        ("height_m = 0.267", "height_m = -0.1"),
    ];
    for (good, bad) in sizes {
        assert!(rig.contains(good));
        let error =
            Rig::parse("rig.toml", &rig.replace(good, bad), |_| Ok(urdf.to_owned())).expect_err("refused");
        assert!(error.to_string().contains("touchscreen"), "{error}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.toml");
    let manifest = "format = 1\nrig = \"nico\"\nstarted = 2026-11-21T10:04:00Z\n[touchscreen]\nwidth_px = 1920\nheight_px = 1080\nwidth_m = 0.475\nheight_m = 0.267\norigin_m = [0.53, 0.2375, 0.056]\nu_axis = [0.0, -1.0, 0.0]\nv_axis = [-1.0, 0.0, 0.0]\n";
    for (good, bad) in sizes {
        std::fs::write(&file, manifest.replace(good, bad)).expect("written");
        let error = crate::session::Manifest::read(&file).expect_err("refused").to_string();
        assert!(error.contains("touchscreen."), "{error}");
    }
}

#[test]
fn placements_are_kept_for_their_rig() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("screen.toml");
    let some = touches(&Isometry3::translation(0.01, 0.0, 0.0), &CORNERS, 1e-3, &mut Noise(5));
    let placed = place_screen(&nominal(), &some).expect("a screen");
    assert!(matches!(placed.write(&file), Err(PlacementError::NoRig)));
    assert!(!file.exists());
    let placed = placed.of_rig("nico");
    placed.write(&file).expect("written");
    let back = ScreenPlacement::read(&file, "nico").expect("read");
    assert_eq!((back.moved_m, back.at, &back.remarks), (placed.moved_m, placed.at, &placed.remarks));
    for (a, b) in back.screen.corners().iter().zip(placed.screen.corners()) {
        assert!(a.distance_m(&b) < 1e-12);
    }
    let message = ScreenPlacement::read(&file, "other").expect_err("refused").to_string();
    assert!(message.contains("\"nico\"") && message.contains("\"other\""), "{message}");

    let rig = Rig::built_in("nico").expect("comes with the program");
    let placed_rig = placed.applied_to(&rig).expect("its rig");
    assert_eq!(placed_rig.touchscreen, placed.screen);
    assert!(placed.applied_to(&Rig { name: "other".to_owned(), ..rig }).is_err());
}

#[test]
fn broken_placements_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("screen.toml");
    let some = touches(&still(), &CORNERS, 1e-3, &mut Noise(5));
    place_screen(&nominal(), &some).expect("a screen").of_rig("nico").write(&file).expect("written");
    let good = std::fs::read_to_string(&file).expect("text");
    let breaks = [
        ("format = 1", "format = 2", "format 2"),
        ("width_px = 1920", "width_px = 0", "size"),
        ("touches = 4", "touches = 5", "4 residuals of 5"),
        ("rms_m = ", "rms_m = nan #", "NaN"),
        ("[screen]", "[scream]", "scream"),
    ];
    for (part, broken, words) in breaks {
        assert!(good.contains(part), "{part}");
        std::fs::write(&file, good.replace(part, broken)).expect("written");
        let message = ScreenPlacement::read(&file, "nico").expect_err("refused").to_string();
        assert!(
            message.contains(words) && message.contains("screen.toml"),
            "\"{words}\" is not in: {message}"
        );
    }
    assert!(ScreenPlacement::read(&folder.path().join("none.toml"), "nico").is_err());
}

#[test]
fn the_real_screen_is_placed_as_well_as_a_rigid_motion_can() {
    let folder = match crate::measured_data::folder("nico-touch/touch-245") {
        Ok(folder) => folder,
        Err(skipped) => return println!("{skipped}"),
    };
    let session = crate::session::Session::read(&folder).expect("a session");
    let rig = Rig::built_in("nico").expect("comes with the program");
    let chain = rig.chain("right_index_tip").expect("a tip of the rig");
    let table = session.touches.expect("touches");
    let fingertip = |row: &crate::session::TouchRow| {
        let angles_rad: Option<Vec<f64>> = row.commanded_rad.iter().copied().collect();
        let tip = chain.robot_from_tip(&angles_rad?).translation_m();
        Some((row.touch?, Point::new(tip.x, tip.y, tip.z)))
    };
    let some: Vec<_> = table.rows().filter_map(|row| fingertip(&row)).collect();
    let screen = session.manifest.touchscreen.expect("a touchscreen");
    let placed = place_screen(&screen, &some).expect("a screen");
    let [u_m, v_m] = placed.screen.pitch_m();
    let miss_m = |(pixel, tip): &(Pixel<Screen>, Point<Robot>)| {
        let predicted = placed.screen.pixel_at(*tip);
        ((predicted.u_px - pixel.u_px) * u_m).hypot((predicted.v_px - pixel.v_px) * v_m)
    };
    let mean_m = some.iter().map(miss_m).sum::<f64>() / some.len() as f64;
    println!(
        "{} touches: mean 2D {:.2} mm, 3D rms {:.2} mm, moved {:?} m, turned {:?} rad",
        some.len(),
        mean_m * 1e3,
        placed.rms_m * 1e3,
        placed.moved_m,
        placed.turned_rad
    );
    let says = |words: &str| placed.remarks.iter().any(|remark| remark.contains(words));
    assert!(says("the arm itself errs") && says("lean"), "{:?}", placed.remarks);
    // What a rigid placement is known to leave on these touches: 6.7 mm.
    assert!((6.0e-3..7.4e-3).contains(&mean_m), "{mean_m}");
}

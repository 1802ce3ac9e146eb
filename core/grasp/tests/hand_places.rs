//! The hand over the 22 places of the published grasps, found on twins: judged against what is
//! really so.
//!
//! Measured over all places, three predictions each (truth plus 3 mm per axis, turned by 0.03 rad per
//! axis), with a pair before, on both scenarios, on an empty table, with a toy under the hand, with
//! others beside, and high before the room: 66 of 66 within 8 mm each; horizontal error median 1.3 to
//! 1.7 mm, 95 % 3.7 to 4.8 mm (predicted: 3.5 and 7); 66 to 77 % of coordinates within one stated
//! sigma, none beyond 3.0; 15 ms of a processor core, 34 at most low over the table, 62 high.
//! From nominal kinematics (16 to 19 mm off on "lab", prior 20 mm): 22 of 22, horizontal median 1.7 to
//! 2.0 mm, 95 % 3.0 to 3.8 mm; high before the room 20 of 22 and 8 mm. 22 ms, 50 at most low, 83 high.
//! Without a pair before some are lost: 59 to 66 of 66, and worse beside toys.
//!
//! The published way (boxes of the shipped detector in both eyes, "lab"): low over the table 22 of 22
//! within 20 mm, 17 within 8 mm by the middles of the boxes, 21 by their own pixels; high before the
//! room 17 within 20 mm, 13 and 6 within 8 mm.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use plumbline_grasp::hand::{EyesAt, HandOptions, HandShape, Pair, Predicted, look_for_hand};
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Detection, Point, Pose, StereoCalibration, StereoCameras};
use plumbline_twin::truth::Truth;
use plumbline_twin::{Lockstep, Scenario, Toy, eyes::RenderedPair};
use plumbline_vision::detect::{DetectSettings, DetectorOptions, shipped_detector};
use plumbline_vision::detect_places::{PlaceFinder, PlaceOptions};

/// x and y of the published targets, m.
const PLACES_M: [[f64; 2]; 22] = [
    [0.2, -0.4],
    [0.2, -0.3],
    [0.2, -0.2],
    [0.2, -0.1],
    [0.2, 0.0],
    [0.2, 0.1],
    [0.2, 0.2],
    [0.2, 0.3],
    [0.3, -0.4],
    [0.3, -0.3],
    [0.3, -0.2],
    [0.3, -0.1],
    [0.3, 0.0],
    [0.3, 0.1],
    [0.3, 0.2],
    [0.3, 0.3],
    [0.4, -0.3],
    [0.4, -0.2],
    [0.4, -0.1],
    [0.4, 0.0],
    [0.4, 0.1],
    [0.4, 0.2],
];
const TIP: &str = "right_palm_center";

/// Numbers from a seed, evenly between −1 and 1, and normal.
struct Dice(u64);

impl Dice {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| 0.5 * self.even()).sum()
    }

    fn vector(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sigma * self.normal())
    }
}

/// A hand over a place, as the twin has it.
struct Shown {
    place_m: [f64; 2],
    before: RenderedPair,
    now: RenderedPair,
    commanded: Posture,
    truth: Truth,
}

impl Shown {
    fn true_tip(&self, rig: &Rig) -> Isometry3<f64> {
        let tip = rig.description.find_link(TIP).expect("a tip");
        self.truth.robot_from_link[tip.0].expect("placed")
    }

    fn true_eyes(&self) -> EyesAt {
        let eyes = &self.truth.eyes;
        let cameras = StereoCameras {
            left: eyes.left,
            right: eyes.right,
            right_from_left: eyes.robot_from_right.inverse() * eyes.robot_from_left,
        };
        EyesAt { cameras, robot_from_left: eyes.robot_from_left }
    }
}

/// A pose over a place: the heading in which the palm looks down best.
fn over(rig: &Rig, solver: &Solver, place_m: [f64; 2], height_m: f64) -> Posture {
    let open = rig.pose("open-hand").expect("a pose").applied_to(&rig.home());
    let chain = rig.chain(TIP).expect("a tip");
    let upright = |posture: &Posture| (chain.robot_from_tip_in(posture).isometry * Vector3::z()).z;
    let point = Point::new(place_m[0], place_m[1], rig.table.height_m + height_m);
    let reach = |target: Target, options: &Options| {
        let answer = solver.solve_from(&target, &open, options).expect("finite");
        answer.is_reached().then(|| open.with(solver.joints(), answer.best().joints.as_ref()))
    };
    let headings = (-8..8).map(|i| f64::from(i) * 0.2);
    headings
        .filter_map(|yaw_rad| reach(Target::PositionYaw { point, yaw_rad }, &Options::upright()))
        .max_by(|a, b| upright(a).total_cmp(&upright(b)))
        .or_else(|| reach(Target::Position(point), &Options::default()))
        .expect("in reach")
}

fn show(scenario: &str, toys: &[(Toy, [f64; 2])], heights_m: [f64; 2]) -> (Arc<Rig>, Vec<Shown>) {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let scenario = Scenario::built_in(scenario).expect("valid");
    let mut twin = Lockstep::new(rig.clone(), &scenario, 1).expect("a twin");
    Toy::ALL.into_iter().for_each(|toy| twin.remove_toy(toy));
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let mut shown = vec![];
    for (i, place_m) in PLACES_M.into_iter().enumerate() {
        for (toy, beside_m) in toys {
            let [x, y] = [place_m[0] + beside_m[0], place_m[1] + beside_m[1]];
            twin.place_toy(*toy, x, y.clamp(-0.42, 0.42)).expect("on the table");
        }
        twin.follow(&[rig.home()], 1.2);
        twin.wait(1.0);
        let before = twin.look().expect("an image");
        let height_m = heights_m[i % 2];
        let goal = over(&rig, &solver, place_m, height_m);
        twin.follow(&[over(&rig, &solver, place_m, height_m + 0.06), goal], 1.0);
        let now = twin.look().expect("an image");
        let (commanded, truth) = (twin.commanded().clone(), twin.truth_for_judging());
        shown.push(Shown { place_m, before, now, commanded, truth });
    }
    (rig, shown)
}

/// Time that this thread has had on a processor, s: others of a busy machine do not count.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).map_or(f64::NAN, |ns| ns * 1e-9)
}

/// What a series of looks comes to.
#[derive(Default)]
struct Score {
    looks: usize,
    failures: Vec<String>,
    horizontal_m: Vec<f64>,
    errors_m: Vec<Vector3<f64>>,
    sigmas: Vec<f64>,
    prior_m: Vec<f64>,
    times_s: Vec<f64>,
}

impl Score {
    fn print(&mut self, title: &str) {
        let quantile = |values: &mut Vec<f64>, q: f64| {
            values.sort_by(f64::total_cmp);
            values.get(((values.len() as f64 - 1.0) * q).round() as usize).copied().unwrap_or(f64::NAN) * 1e3
        };
        let located = self.errors_m.iter().filter(|error| error.norm() <= 0.008).count();
        let within = |k: f64| {
            self.sigmas.iter().filter(|s| s.abs() <= k).count() as f64 / self.sigmas.len().max(1) as f64
        };
        let worst = self.sigmas.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let (one, two) = (within(1.0), within(2.0));
        let mean: Vector3<f64> =
            self.errors_m.iter().sum::<Vector3<f64>>() / self.errors_m.len().max(1) as f64 * 1e3;
        let mut norms: Vec<f64> = self.errors_m.iter().map(nalgebra::Matrix::norm).collect();
        println!(
            "{title}: located {located}/{} | horizontal median {:.2} p95 {:.2} mm | whole median {:.2} p95 {:.2} mm (predicted {:.2}) | bias {:.2} {:.2} {:.2} mm | within 1 sigma {:.0} %, 2 sigma {:.0} %, worst {worst:.1} | {:.1} ms of a processor median, {:.1} most",
            self.looks,
            quantile(&mut self.horizontal_m, 0.5),
            quantile(&mut self.horizontal_m, 0.95),
            quantile(&mut norms, 0.5),
            quantile(&mut norms, 0.95),
            quantile(&mut self.prior_m, 0.5),
            mean.x,
            mean.y,
            mean.z,
            one * 100.0,
            two * 100.0,
            quantile(&mut self.times_s, 0.5),
            quantile(&mut self.times_s, 1.0),
        );
        for failure in &self.failures {
            println!("    {failure}");
        }
    }
}

impl Score {
    /// What is promised where the prediction is good to 3 mm and there is a pair before.
    fn check(&self) {
        let located = self.errors_m.iter().filter(|error| error.norm() <= 0.008).count();
        assert_eq!(located, self.looks, "{:?}", self.failures);
        let mut horizontal_m = self.horizontal_m.clone();
        horizontal_m.sort_by(f64::total_cmp);
        let (median_m, p95_m) =
            (horizontal_m[horizontal_m.len() / 2], horizontal_m[horizontal_m.len() * 95 / 100]);
        assert!(median_m <= 0.002 && p95_m <= 0.0055, "median {median_m} m, 95 % {p95_m} m");
        let within = self.sigmas.iter().filter(|sigma| sigma.abs() <= 1.0).count();
        let share = within as f64 / self.sigmas.len() as f64;
        assert!((0.6..0.85).contains(&share), "{share} within one sigma");
        assert!(self.sigmas.iter().all(|sigma| sigma.abs() < 4.0), "a sigma of more than 4");
    }
}

struct Trial {
    /// Standard deviation of the error put on the truth; `None`: nominal kinematics.
    truth_and_m: Option<f64>,
    prior_m: f64,
    with_before: bool,
    repeats: u64,
}

fn judge(rig: &Rig, shown: &[Shown], trial: &Trial, verbose: bool) -> Score {
    let hand = HandShape::of_rig(rig, TIP).expect("a hand");
    let chain = rig.chain(TIP).expect("a tip");
    let mut score = Score::default();
    for (i, look) in shown.iter().enumerate() {
        for repeat in 0..trial.repeats {
            let mut dice = Dice(1 + i as u64 * 1000 + repeat);
            (0..5).for_each(|_| {
                dice.even();
            });
            let truth = look.true_tip(rig);
            let predicted = match trial.truth_and_m {
                Some(sigma) => Isometry3::from_parts(
                    Translation3::from(truth.translation.vector + dice.vector(sigma)),
                    UnitQuaternion::from_scaled_axis(dice.vector(0.03)) * truth.rotation,
                ),
                None => chain.robot_from_tip_in(&look.commanded).isometry,
            };
            let eyes = look.true_eyes();
            let predicted_hand = Predicted {
                posture: &look.commanded,
                robot_from_tip: Pose::new(predicted),
                covariance_m2: Matrix3::identity() * trial.prior_m.powi(2),
            };
            let pair = |pair: &'static str| match pair {
                "before" => &look.before,
                _ => &look.now,
            };
            let (before, now) = (pair("before"), pair("now"));
            let before = trial.with_before.then_some(Pair { left: &before.left, right: &before.right });
            let started_s = processor_s();
            let found = look_for_hand(
                before,
                Pair { left: &now.left, right: &now.right },
                &eyes,
                &hand,
                &predicted_hand,
                &HandOptions::default(),
            );
            score.times_s.push(processor_s() - started_s);
            score.looks += 1;
            score.prior_m.push((truth.translation.vector - predicted.translation.vector).norm());
            match found {
                Err(why) => score.failures.push(format!("{:?}: {why}", look.place_m)),
                Ok(seen) => {
                    let error = predicted.translation.vector + seen.offset_m - truth.translation.vector;
                    if verbose {
                        println!(
                            "  {:?}: predicted off by {:.1} mm, found off by {:.1} {:.1} {:.1} mm, sigma {:.1} {:.1} {:.1} mm, turn {:.3} {:.3} {:.3}, fit {:?}",
                            look.place_m,
                            (truth.translation.vector - predicted.translation.vector).norm() * 1e3,
                            error.x * 1e3,
                            error.y * 1e3,
                            error.z * 1e3,
                            seen.covariance_m2[(0, 0)].sqrt() * 1e3,
                            seen.covariance_m2[(1, 1)].sqrt() * 1e3,
                            seen.covariance_m2[(2, 2)].sqrt() * 1e3,
                            seen.turn_rad.x,
                            seen.turn_rad.y,
                            seen.turn_rad.z,
                            seen.fit
                                .iter()
                                .map(|fit| fit.as_ref().map(|fit| (
                                    fit.outline.len(),
                                    (fit.spread_px * 100.0).round() / 100.0,
                                    (fit.hidden * 100.0).round(),
                                    fit.changed.map(|c| (c * 100.0).round())
                                )))
                                .collect::<Vec<_>>(),
                        );
                    }
                    score.horizontal_m.push(error.xy().norm());
                    for k in 0..3 {
                        score.sigmas.push(error[k] / seen.covariance_m2[(k, k)].sqrt());
                    }
                    score.errors_m.push(error);
                }
            }
        }
    }
    score
}

#[test]
#[ignore = "minutes: cargo test --release -p plumbline-grasp --test hand_places -- --ignored --nocapture"]
fn places() {
    let only = std::env::var("HAND_ONLY").unwrap_or_default();
    for scenario in ["perfect", "lab"] {
        for (title, toys, heights_m) in [
            ("empty table", vec![], [0.07, 0.07]),
            ("high, the room behind", vec![], [0.18, 0.24]),
            ("tomato under the hand", vec![(Toy::Tomato, [0.0, 0.0])], [0.06, 0.08]),
            (
                "tomato under the hand, others beside",
                vec![
                    (Toy::Tomato, [0.0, 0.0]),
                    (Toy::Orange, [0.03, 0.11]),
                    (Toy::Banana, [0.10, -0.02]),
                    (Toy::Mushroom, [0.02, -0.10]),
                ],
                [0.06, 0.08],
            ),
        ] {
            if !format!("{scenario}, {title}").contains(&only) {
                continue;
            }
            let (rig, shown) = show(scenario, &toys, heights_m);
            if std::env::var_os("HAND_PICTURES").is_some() {
                for look in &shown {
                    let name = format!(
                        "/tmp/h4pics/{scenario}_{}_{:.1}_{:.1}",
                        toys.len(),
                        look.place_m[0],
                        look.place_m[1]
                    );
                    look.now.left.save(format!("{name}_now.png")).expect("saved");
                    look.before.left.save(format!("{name}_before.png")).expect("saved");
                }
            }
            let ours = Trial { truth_and_m: Some(0.003), prior_m: 0.003, with_before: true, repeats: 3 };
            let mut score = judge(&rig, &shown, &ours, std::env::var_os("HAND_VERBOSE").is_some());
            score.print(&format!("{scenario}, {title}, 3 mm"));
            score.check();
            let blind = Trial { with_before: false, ..ours };
            judge(&rig, &shown, &blind, false).print(&format!("{scenario}, {title}, 3 mm, no pair before"));
            let nominal = Trial { truth_and_m: None, prior_m: 0.02, with_before: true, repeats: 1 };
            judge(&rig, &shown, &nominal, std::env::var_os("HAND_VERBOSE").is_some())
                .print(&format!("{scenario}, {title}, nominal kinematics"));
        }
    }
}

/// The published way at the same places: the box of a hand in both eyes, and stereo.
///
/// Two kinds of stereo: the middles of both boxes, triangulated; and the box's own pixels matched.
/// Judged against the middle of the palm, which the boxes are drawn around.
#[test]
#[ignore = "needs the detector: cargo test --release -p plumbline-grasp --test hand_places -- --ignored --nocapture published"]
fn published_way() {
    let (Some(shipped), rig) = (shipped_detector(), Arc::new(Rig::built_in("nico").expect("valid"))) else {
        println!("skipped: there is no detector here");
        return;
    };
    let options = DetectorOptions { threads: Some(1), ..DetectorOptions::default() };
    let mut detector = match shipped.open(&options) {
        Ok(detector) => detector,
        Err(why) => {
            println!("skipped: {why}");
            return;
        }
    };
    let palm = rig.description.find_link("right_palm").expect("a palm");
    let box_middle = rig.description.links()[palm.0].visuals[0].link_from_shape.translation.vector;
    let names = detector.info().names.clone();
    let is_hand = |class| names.get(class).is_some_and(|name| name.ends_with("Hand"));
    for (title, heights_m) in [("7 cm", [0.07, 0.07]), ("18 and 24 cm", [0.18, 0.24])] {
        let (_, shown) = show("lab", &[], heights_m);
        let mut errors = [vec![], vec![]];
        for look in &shown {
            let eyes = look.true_eyes();
            let palm_m =
                look.truth.robot_from_link[palm.0].expect("placed") * nalgebra::Point3::from(box_middle);
            let mut boxes = [&look.now.left, &look.now.right].map(|image| {
                let mut found = vec![];
                detector.detect(image, &DetectSettings::default(), &mut found).expect("an answer");
                found.retain(|found: &Detection| is_hand(found.class));
                // The most confident comes first.
                found.truncate(1);
                found
            });
            let calibration = StereoCalibration::bare(eyes.cameras);
            let mut places = vec![];
            // Both boxes are the hand, whichever it is called.
            if let ([left], [right]) = (&boxes[0][..], &boxes[1][..]) {
                let class = left.class;
                let right = Detection { class, ..*right };
                boxes[1] = vec![right];
            }
            let mut finder = PlaceFinder::new(Some(&calibration), PlaceOptions::for_classes(&names));
            finder.find((&look.now.left, &boxes[0]), (&look.now.right, &boxes[1]), &mut places);
            let matched =
                places.first().and_then(|place| place.place.as_ref().ok()).map(|place| place.middle.point);
            let middles = boxes[0].first().zip(boxes[1].first());
            let triangulated = middles
                .and_then(|(left, right)| eyes.cameras.triangulate(left.area.middle(), right.area.middle()));
            let error = |point: Option<Point<_>>| {
                point.map(|point| ((eyes.robot_from_left * point).coords - palm_m).norm())
            };
            for (errors, found) in errors.iter_mut().zip([error(triangulated), error(matched)]) {
                errors.push(found.unwrap_or(f64::INFINITY));
            }
        }
        for (way, mut errors) in ["middles of boxes", "own pixels"].into_iter().zip(errors) {
            errors.sort_by(f64::total_cmp);
            assert!(errors[errors.len() / 2] < 0.03, "{way}: not even half of the places");
            let within = |limit_m: f64| errors.iter().filter(|error| **error <= limit_m).count();
            println!(
                "published, {way}, {title} over the table: within 8 mm {}, 20 mm {}, 50 mm {} of {}; no place {}; median {:.1} mm",
                within(0.008),
                within(0.02),
                within(0.05),
                errors.len(),
                errors.iter().filter(|error| !error.is_finite()).count(),
                errors[errors.len() / 2] * 1e3
            );
        }
    }
}

/// Enlarged pieces of the images with the hand's outline: true in green, found in red.
#[test]
#[ignore = "writes pictures into the folder that HAND_PICTURES names"]
fn pictures() {
    let Some(folder) = std::env::var_os("HAND_PICTURES") else { return };
    let (rig, shown) = show("perfect", &[], [0.07, 0.07]);
    let hand = HandShape::of_rig(&rig, TIP).expect("a hand");
    for look in &shown {
        let eyes = look.true_eyes();
        let truth = Pose::new(look.true_tip(&rig));
        let predicted = |sigma_m: f64| Predicted {
            posture: &look.commanded,
            robot_from_tip: truth,
            covariance_m2: Matrix3::identity() * sigma_m * sigma_m,
        };
        let pair = |pair: &'_ RenderedPair| (pair.left.clone(), pair.right.clone());
        let (now, before) = (pair(&look.now), pair(&look.before));
        let find = |sigma_m| {
            look_for_hand(
                Some(Pair { left: &before.0, right: &before.1 }),
                Pair { left: &now.0, right: &now.1 },
                &eyes,
                &hand,
                &predicted(sigma_m),
                &HandOptions { sigma_turn_rad: 0.06, ..HandOptions::default() },
            )
        };
        let fixed = hand.view(&eyes, &predicted(0.001));
        let found = find(0.02);
        for (eye, image, mask) in [(0, &now.0, &fixed.left), (1, &now.1, &fixed.right)] {
            let mask = mask.as_ref().expect("in view");
            const ZOOM: u32 = 10;
            let (u0, v0) = (mask.u0_px.saturating_sub(8), mask.v0_px.saturating_sub(8));
            let (w, h) = (mask.width_px + 16, mask.height_px + 16);
            let mut big = image::RgbImage::from_fn(w * ZOOM, h * ZOOM, |x, y| {
                let pixel = image.get_pixel((u0 + x / ZOOM).min(639), (v0 + y / ZOOM).min(479)).0;
                image::Rgb(pixel.map(|v| (255.0 * (f32::from(v) / 255.0).powf(0.6)) as u8))
            });
            for y in 0..mask.height_px {
                for x in 0..mask.width_px {
                    let part = mask.coverage[(y * mask.width_px + x) as usize];
                    if part > 0.0 && part < 1.0 {
                        for k in 0..4 {
                            big.put_pixel(
                                (x + mask.u0_px - u0) * ZOOM + 3 + k,
                                (y + mask.v0_px - v0) * ZOOM + 5,
                                image::Rgb([0, 255, 0]),
                            );
                        }
                    }
                }
            }
            if let Ok(seen) = &found {
                for point in seen.fit[eye].iter().flat_map(|fit| &fit.outline) {
                    for k in -2..3 {
                        let x = (point.pixel_px.x - f64::from(u0) + 0.5) * f64::from(ZOOM) + f64::from(k);
                        let y = (point.pixel_px.y - f64::from(v0) + 0.5) * f64::from(ZOOM);
                        if x >= 0.0 && y >= 0.0 && x < f64::from(w * ZOOM) && y < f64::from(h * ZOOM) {
                            let g = (255.0 * (1.0 - point.weight)) as u8;
                            big.put_pixel(x as u32, y as u32, image::Rgb([255, g, g]));
                        }
                    }
                }
            }
            let name = format!("big_{:.1}_{:.1}_{eye}.png", look.place_m[0], look.place_m[1]);
            big.save(std::path::Path::new(&folder).join(name)).expect("saved");
        }
    }
}

//! Grasps of one thing of several: the right one is taken, the others stay as they are.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use image::{RgbImage, imageops};
use nalgebra::{Isometry3, Vector3};
use plumbline_grasp::see::Seen;
use plumbline_grasp::{Method, Sight, Step};
use plumbline_twin::{Lockstep, Scenario, Toy};

use super::super::attempt::Meddler;
use super::bad_inputs::assert_honest;
use super::{bench_of, task};

const EASY_M: [f64; 2] = [0.3, -0.1];
/// Another thing stands so far from the one that is grasped, m.
const APART_M: f64 = 0.12;
/// What was moved by less, m, and leans by less, rad, was not knocked over.
const TOUCHED_M: f64 = 0.01;
const LEANS_RAD: f64 = 0.2;

fn perfect() -> Scenario {
    Scenario::built_in("perfect").expect("valid")
}

/// Another tomato beside the one that there is: its image is put elsewhere into both eyes, before and
/// after the lift.
struct Second {
    boxes_px: [[f32; 4]; 2],
    shift_px: i64,
    patches: Option<[RgbImage; 2]>,
}

impl Meddler for Second {
    fn sees(&mut self, step: Step, sight: &mut Sight) {
        if !matches!(step, Step::Look | Step::Check) {
            return;
        }
        let around = self.boxes_px.map(|[x0, y0, x1, y1]| {
            let least = |px: f32| (px - 4.0).max(0.0) as u32;
            (least(x0), least(y0), (x1 - x0 + 8.0) as u32, (y1 - y0 + 8.0) as u32)
        });
        let eyes = [&mut sight.left, &mut sight.right];
        let patches = self.patches.get_or_insert_with(|| {
            let cut = |eye: &RgbImage, (x, y, w, h): (u32, u32, u32, u32)| {
                imageops::crop_imm(eye, x, y, w, h).to_image()
            };
            [cut(eyes[0], around[0]), cut(eyes[1], around[1])]
        });
        for ((eye, patch), (x, y, ..)) in eyes.into_iter().zip(patches.iter()).zip(around) {
            let mut image = (**eye).clone();
            imageops::replace(&mut image, patch, i64::from(x) + self.shift_px, i64::from(y));
            *eye = Arc::new(image);
        }
    }
}

#[test]
fn a_second_tomato_beside_it_is_not_taken_for_the_one_that_was_lifted() {
    let mut bench = bench_of(perfect());
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    let (alone, _) = bench.attempt(&task).expect("done");
    let chosen = &alone.seen[alone.chosen.expect("it was seen")];
    let boxes_px = chosen.boxes_px.map(|area| area.expect("both eyes saw it"));
    let width_px = boxes_px[0][2] - boxes_px[0][0];
    let tomatoes =
        |seen: &[Seen]| seen.iter().filter(|thing| thing.class == "Tomato" && thing.place.is_ok()).count();
    // The other one stands nearer to the robot's middle, then farther from it than the one that there is.
    for (widths, near_m) in [(-1.6, Some(EASY_M)), (1.6, Some(EASY_M)), (1.6, None)] {
        let mut second = Second { boxes_px, shift_px: (widths * width_px) as i64, patches: None };
        let mut pointed = task.clone();
        pointed.order.near_m = near_m;
        let (record, judged) = bench.attempt_disturbed(&pointed, &mut second).expect("done");
        assert_eq!(tomatoes(&record.seen), 2, "{widths} {near_m:?}: {:?}", record.seen);
        assert!(judged.lifted, "{widths} {near_m:?}: {:?}", record.outcome);
        assert_honest("two", &record, &judged);
    }
}

/// Puts a duck beside the tomato: as high, and easily knocked over.
struct Neighbor {
    at_m: [f64; 2],
}

impl Meddler for Neighbor {
    fn before(&mut self, twin: &mut Lockstep) {
        twin.place_toy(Toy::Duck, self.at_m[0], self.at_m[1]).expect("on the table");
        twin.wait(1.0);
    }
}

/// Where a toy really is.
fn stands(twin: &mut Lockstep, toy: Toy) -> Isometry3<f64> {
    let toys = twin.truth_for_judging().toys;
    let place = toys.into_iter().find_map(|(other, place)| place.filter(|_| other == toy));
    place.expect("on the table")
}

#[test]
fn what_stands_twelve_centimeters_beside_it_is_not_knocked_over() {
    let mut bench = bench_of(perfect());
    let task = task(Method::M5, Toy::Tomato, EASY_M);
    for side in 0..8 {
        let (sine, cosine) = (f64::from(side) * std::f64::consts::FRAC_PI_4).sin_cos();
        let at_m = [EASY_M[0] + APART_M * cosine, EASY_M[1] + APART_M * sine];
        let mut world = bench.world(&task).expect("a world");
        Neighbor { at_m }.before(world.twin());
        let before = stands(world.twin(), Toy::Duck);
        let (record, judged) = bench.attempt_in(&mut world, &task, &mut ()).expect("nothing is kept");
        let after = stands(world.twin(), Toy::Duck);
        bench.put_away(world);
        assert_honest(&format!("{at_m:.2?}"), &record, &judged);
        let moved_m = (after.translation.vector - before.translation.vector).norm();
        let up = |place: &Isometry3<f64>| place.rotation * Vector3::z();
        let leans_rad = up(&before).angle(&up(&after));
        println!(
            "{at_m:.2?}: heading {:.0?}°, moved by {:.1} mm, leans by {leans_rad:.2} rad, tries {}",
            record.heading_rad.map(f64::to_degrees),
            moved_m * 1e3,
            record.earlier.len() + 1
        );
        assert!(moved_m < TOUCHED_M && leans_rad < LEANS_RAD, "{at_m:?}: {moved_m} m, {leans_rad} rad");
        assert!(judged.lifted && record.is_success(), "{at_m:?}: {:?}", record.outcome);
    }
}

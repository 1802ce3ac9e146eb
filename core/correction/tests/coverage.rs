//! Whether the intervals that models state hold touches of the real robot that they had not seen.
//! Without the data each test says so and passes.

mod common;

use std::collections::BTreeSet;

use plumbline_correction::{CorrectionModel, Method, Touch, TouchData, TrainOptions, train};
use plumbline_model::{Pixel, Point, Unattended, measured_data};

/// Of numbers inside and outside of the border: how many, and how many are within 1.96 standard
/// deviations.
#[derive(Default)]
struct Coverage {
    inside: [u32; 2],
    outside: [u32; 2],
}

impl Coverage {
    fn count(&mut self, model: &CorrectionModel, touch: &Touch, axes: usize) {
        let answer = model.correct(touch.pixel);
        let side = if answer.inside { &mut self.inside } else { &mut self.outside };
        for axis in 0..axes {
            side[0] += 1;
            let error_m = touch.sent.coords[axis] - answer.target.coords[axis];

            side[1] += u32::from(error_m.abs() <= 1.96 * answer.sd_m[axis]);
        }
    }

    fn print(&self, what: &str) {
        let share = |[all, held]: [u32; 2]| {
            format!("{held} of {all} ({:.1} %)", 100.0 * f64::from(held) / f64::from(all.max(1)))
        };
        eprintln!(
            "{what}: 95 % intervals hold {} inside, {} outside",
            share(self.inside),
            share(self.outside)
        );
    }

    fn assert_honest(&self) {
        let share = |[all, held]: [u32; 2]| f64::from(held) / f64::from(all.max(1));
        assert!((0.90..=0.98).contains(&share(self.inside)), "{} inside", share(self.inside));
        assert!(self.outside[0] == 0 || share(self.outside) >= 0.90, "{} outside", share(self.outside));
    }
}

fn trained(data: &TouchData, method: Method) -> CorrectionModel {
    train(data, method, &TrainOptions::default(), &Unattended, &mut |_| ()).expect("it trains")
}

/// Every set once is the new data of a model that was trained, and its intervals learned, on the
/// other sets alone.
#[test]
fn intervals_hold_touches_of_other_sets() {
    let Some(data) = common::touch_245() else { return };
    let sets: BTreeSet<_> = data.touches.iter().map(|touch| touch.set.clone()).collect();
    for method in Method::ALL {
        let mut coverage = Coverage::default();
        for set in &sets {
            let (held_out, rest): (Vec<_>, Vec<_>) =
                data.touches.iter().cloned().partition(|touch| touch.set == *set);
            let rest = TouchData::new(rest, data.screen.clone(), vec![]).expect("most touches remain");
            let model = trained(&rest, method);
            held_out.iter().for_each(|touch| coverage.count(&model, touch, 3));
        }
        coverage.print(&format!("touch-245 by sets, {}", method.name()));
        coverage.assert_honest();
    }
}

/// The judge: touches of another run, never used for choosing anything. It has no heights.
#[test]
fn intervals_hold_touches_of_another_run() {
    let Some(data) = common::touch_245() else { return };
    let Some(judge) = another_run() else { return };
    for method in Method::ALL {
        let model = trained(&data, method);
        let mut coverage = Coverage::default();
        judge.iter().for_each(|touch| coverage.count(&model, touch, 2));
        coverage.print(&format!("reach-test-m2-250, {}", method.name()));
        coverage.assert_honest();
    }
}

fn another_run() -> Option<Vec<Touch>> {
    let file = measured_data::folder("nico-touch").ok()?.join("reach-test-m2-250.csv");
    let text = std::fs::read_to_string(file).ok()?;
    let touch = |(row, line): (usize, &str)| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        Touch {
            pixel: Pixel::new(cells[4], cells[5]),
            sent: Point::new(cells[2], cells[3], 0.0),
            set: None,
            group: None,
            row,
        }
    };
    Some(text.lines().skip(1).enumerate().map(touch).collect())
}

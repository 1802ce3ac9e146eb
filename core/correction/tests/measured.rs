//! On touches of the real robot. Without the data each test says so and passes.

mod common;

use std::time::Instant;

use common::touch_245;
use plumbline_correction::bench::fit_times;
use plumbline_correction::{
    Activation, BlockBy, CorrectionModel, Errors, HeightGrid, Method, Recipe, TouchData, TrainOptions,
    compare, cross_validate, distance_2d_m, spread_of_repeats, train,
};
use plumbline_model::session::Screen;
use plumbline_model::{Pixel, Unattended, measured_data};

fn trained(data: &TouchData, method: Method, options: &TrainOptions) -> CorrectionModel {
    train(data, method, options, &Unattended, &mut |_| ()).expect("it trains")
}

fn mm(errors: &Errors) -> String {
    let Errors { mean_2d_m, rms_2d_m, rms_z_m, .. } = errors;
    format!("2D mean {:.2} rms {:.2} mm, z rms {:.2} mm", 1e3 * mean_2d_m, 1e3 * rms_2d_m, 1e3 * rms_z_m)
}

#[test]
fn held_out_errors_order_the_methods() {
    let Some(data) = touch_245() else { return };
    assert_eq!(spread_of_repeats(&data), None);
    let options = TrainOptions::default();
    for method in Method::ALL {
        let model = trained(&data, method, &options);
        let provenance = model.provenance();
        let held_out = provenance.cross_validation.as_ref().expect("trained here");
        assert_eq!(held_out.blocks.len(), 12);
        eprintln!("{} trained  {}", method.name(), mm(&provenance.training.expect("trained here")));
        let [low, high] = held_out.mean_2d_interval_m.map(|m| 1e3 * m);
        eprintln!("{} held out {}, mean {low:.2} to {high:.2}", method.name(), mm(&held_out.errors));
    }
    let comparison = compare(&data, &Method::ALL, &options, &Unattended).expect("it compares");
    let (_, [low, _]) = comparison.difference_m(Method::M1, Method::M3).expect("both");
    assert!(low > 1e-3, "M3 is better than M1 by {low} m at least");
    let m3 = comparison.of(Method::M3).expect("compared").errors;
    assert!(m3.mean_2d_m < 4.6e-3 && m3.rms_z_m < 0.7e-3, "{m3:?}");
}

/// Whether what was chosen about training still is what whole areas held out ask for.
#[test]
fn gently_bending_units_go_on_best_into_areas_that_are_held_out() {
    let Some(data) = touch_245() else { return };
    let mean_m = |activation: Activation| {
        let of = |folds: usize| {
            let options =
                TrainOptions { activation, block_by: BlockBy::Area, folds, ..TrainOptions::default() };
            cross_validate(&data, Method::M3, &options, &Unattended).expect("it trains").errors
        };
        let of_folds = [8, 12, 20].map(of);
        for errors in &of_folds {
            eprintln!("{activation:?}, areas held out: {}", mm(errors));
        }
        of_folds.iter().map(|errors| errors.mean_2d_m).sum::<f64>() / 3.0
    };
    let (tanh, relu) = (mean_m(Activation::Tanh), mean_m(Activation::Relu));
    assert!(tanh < relu + 0.1e-3 && tanh < 4.9e-3, "{tanh} {relu}");
}

#[test]
fn the_sessions_own_grid_gives_the_heights() {
    let Some(data) = touch_245() else { return };
    let heights = HeightGrid::of_touches(&data);
    assert_eq!((heights.x_m.len(), heights.y_m.len()), (4, 9));
    assert!((heights.at(0.392, -0.106) - 0.066).abs() < 1e-9);
}

/// Touched pixel and the (x, y) that had been sent.
fn reach_test() -> Option<Vec<(Pixel<Screen>, [f64; 2])>> {
    let file = measured_data::folder("nico-touch").ok()?.join("reach-test-m2-250.csv");
    let text = std::fs::read_to_string(file).expect("it lies beside the touches");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.trim().parse().expect("a number")).collect();
        (Pixel::new(numbers[4], numbers[5]), [numbers[2], numbers[3]])
    };
    Some(text.lines().skip(1).filter(|line| !line.is_empty()).map(row).collect())
}

#[test]
fn the_kept_aside_touches_are_predicted() {
    let (Some(data), Some(judge)) = (touch_245(), reach_test()) else { return };
    assert_eq!(judge.len(), 250);
    // The goal of M3 is 4.45 mm; what is held here is the published network's 4.60 mm.
    let goals_m = [(Method::M1, f64::INFINITY), (Method::M2, 4.7e-3), (Method::M3, 4.60e-3)];
    for recipe in [Recipe::Published, Recipe::Evidence] {
        for (method, goal_m) in goals_m {
            let options = TrainOptions { recipe, ..TrainOptions::default() };
            let model = trained(&data, method, &options);
            let residuals: Vec<[f64; 3]> = judge
                .iter()
                .map(|(pixel, sent)| {
                    let target = model.correct(*pixel).target.coords;
                    [target.x - sent[0], target.y - sent[1], 0.0]
                })
                .collect();
            let mean_m = residuals.iter().map(distance_2d_m).sum::<f64>() / residuals.len() as f64;
            eprintln!(
                "{} {recipe:?}: 2D mean {:.3} mm (at most {:.2})",
                method.name(),
                1e3 * mean_m,
                1e3 * goal_m
            );
            assert!(recipe == Recipe::Published || mean_m <= goal_m, "{mean_m} m");
        }
    }
}

#[test]
fn training_is_fast() {
    let Some(data) = touch_245() else { return };
    let start = Instant::now();
    trained(&data, Method::M3, &TrainOptions::default());
    eprintln!("first training with cross-validation: {:.3} s", start.elapsed().as_secs_f64());
    let times = fit_times(&data).expect("it trains");
    eprintln!("{times:?}");
    // A machine that is busy with other things must not fail this.
    assert!(times.whole_training_s < 5.0);
}

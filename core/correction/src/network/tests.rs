use nalgebra::DMatrix;
use plumbline_model::{Cancelled, JobContext, Pixel, Unattended};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::evidence::normal;
use super::objective::{Objective, Precision};
use super::*;

/// A smooth map like that of a bent arm, without noise.
fn smooth(u: f64, v: f64) -> Vec<f64> {
    let (a, b) = (u / 1920.0 - 0.5, v / 1080.0 - 0.5);
    vec![0.38 - 0.27 * b + 0.01 * a * a, -0.01 - 0.47 * a + 0.02 * a * b, 0.064 - 0.015 * b + 0.03 * a * a]
}

fn samples(count: usize, noise_m: f64, seed: u64) -> Samples {
    let mut random = StdRng::seed_from_u64(seed);
    let inputs: Vec<Vec<f64>> = (0..count)
        .map(|_| vec![random.random_range(100.0..1800.0), random.random_range(300.0..1050.0)])
        .collect();
    let outputs = inputs.iter().map(|input| smooth(input[0], input[1]));
    let outputs =
        outputs.map(|row| row.iter().map(|m| m + noise_m * normal(&mut random)).collect()).collect();
    Samples { inputs, outputs }
}

const OPTIONS: EvidenceOptions =
    EvidenceOptions { units: 64, activation: Activation::Tanh, iterations: 4, draw_sd: 0.2 };

fn fit(samples: &Samples, options: &EvidenceOptions, seed: u64) -> Network {
    fit_evidence(samples, None, options, seed, &Unattended, &mut |_| ()).expect("it trains")
}

#[test]
fn the_gradient_agrees_with_differences() {
    for activation in [Activation::Tanh, Activation::Relu] {
        let mut random = StdRng::seed_from_u64(3);
        let inputs = DMatrix::from_fn(40, 3, |_, column| if column == 2 { 1.0 } else { normal(&mut random) });
        let outputs = DMatrix::from_fn(40, 3, |row, column| {
            (inputs[(row, 0)] * (1.0 + column as f64)).sin() + 0.1 * normal(&mut random)
        });
        let anchor = DMatrix::from_fn(3, 7, |_, _| normal(&mut random));
        let row_weights: Vec<f64> = (0..40).map(|_| random.random_range(0.3..2.0)).collect();
        let mut objective = Objective::new(activation, &inputs, &outputs, &row_weights, anchor.clone(), 2.0);
        objective.precision = Precision { noise: vec![3.0, 5.0, 7.0], weights: vec![0.5, 1.0, 2.0] };
        let hidden = anchor.map(|weight| 1.1 * weight + 0.05);
        let gradient = objective.evaluate(&hidden).expect("solvable").gradient;
        for index in 0..hidden.len() {
            let step = 1e-6;
            let value = |sign: f64| {
                let mut moved = hidden.clone();
                moved[index] += sign * step;
                objective.evaluate(&moved).expect("solvable").value
            };
            let difference = (value(1.0) - value(-1.0)) / (2.0 * step);
            let error = (difference - gradient[index]).abs();
            assert!(error < 1e-5 * (1.0 + difference.abs()), "{activation:?} {index}: {difference} {error}");
        }
    }
}

#[test]
fn a_smooth_map_without_noise_is_recovered() {
    let (learn, judge) = (samples(245, 0.0, 1), samples(400, 0.0, 2));
    for activation in [Activation::Relu, Activation::Tanh] {
        let network = fit(&learn, &EvidenceOptions { activation, ..OPTIONS }, 1);
        assert!(judge.rms_2d_m(&network) < 4e-4, "{activation:?}: {} m", judge.rms_2d_m(&network));
    }
}

#[test]
fn noise_is_averaged_out_and_not_learned() {
    let (learn, judge) = (samples(245, 4e-3, 1), samples(400, 0.0, 2));
    let network = fit(&learn, &OPTIONS, 1);
    // 4 mm per axis are 5.7 mm in the plane; a plane fitted to 245 touches would be off by 0.6 mm.
    assert!(judge.rms_2d_m(&network) < 1.6e-3, "{} m", judge.rms_2d_m(&network));
    assert!(learn.rms_2d_m(&network) > 4.8e-3, "{} m", learn.rms_2d_m(&network));
}

#[test]
fn a_plane_is_carried_exactly_also_far_outside() {
    let mut learn = samples(60, 0.0, 1);
    let plane = |row: &Vec<f64>| vec![0.5 - 2e-4 * row[1], 0.2 - 2.4e-4 * row[0], 0.06 + 1e-5 * row[1]];
    learn.outputs = learn.inputs.iter().map(plane).collect();
    let network = fit(&learn, &OPTIONS, 1);
    let far = network.at(Pixel::new(-2000.0, 4000.0));
    let truth = plane(&vec![-2000.0, 4000.0]);
    for axis in 0..3 {
        assert!((far[axis] - truth[axis]).abs() < 1e-4, "{far:?} {truth:?}");
    }
}

#[test]
fn the_order_of_rows_does_not_matter() {
    let learn = samples(120, 4e-3, 1);
    let mut turned = learn.clone();
    turned.inputs.reverse();
    turned.outputs.reverse();
    let (a, b) = (fit(&learn, &OPTIONS, 5), fit(&turned, &OPTIONS, 5));
    for input in &learn.inputs {
        let pixel = Pixel::new(input[0], input[1]);
        for (a, b) in a.at(pixel).iter().zip(b.at(pixel)) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}

#[test]
fn a_wild_row_moves_little() {
    let learn = samples(120, 2e-3, 1);
    let mut wild = learn.clone();
    wild.outputs[7][0] += 0.1;
    let (calm, moved) = (fit(&learn, &OPTIONS, 5), fit(&wild, &OPTIONS, 5));
    let judge = samples(300, 0.0, 9);
    let (before, after) = (judge.rms_2d_m(&calm), judge.rms_2d_m(&moved));
    assert!(after < before + 5e-4, "{before} {after}");
}

#[test]
fn the_published_recipe_learns() {
    let learn = samples(245, 2e-3, 1);
    let mut losses = vec![];
    let network = fit_published(&learn, Some(&learn), &Adam::published(64), 1, &Unattended, &mut |step| {
        losses.push(step)
    })
    .expect("it trains");
    assert_eq!(losses.len(), 200);
    assert!(losses[199].train_rms_m < 0.2 * losses[0].train_rms_m);
    assert_eq!(losses[199].held_out_rms_m, Some(losses[199].train_rms_m));
    assert!(samples(300, 0.0, 2).rms_2d_m(&network) < 6e-3);
    let again = fit_published(&learn, None, &Adam::published(64), 1, &Unattended, &mut |_| ());
    assert_eq!(again, Ok(network));
}

#[test]
fn scaling_round_trips_and_can_be_exchanged() {
    let learn = samples(50, 1e-3, 1);
    let scaling = Scaling::per_channel(&learn.outputs);
    for row in &learn.outputs {
        for (a, b) in scaling.undo(&scaling.apply(row)).iter().zip(row) {
            assert!((a - b).abs() < 1e-15);
        }
    }
    let network = fit(&learn, &OPTIONS, 1);
    let other = network.scaled_as(&Scaling::scalar(&learn.inputs), &Scaling::scalar(&learn.outputs));
    assert_ne!(network.input, other.input);
    for input in &learn.inputs {
        let pixel = Pixel::new(input[0], input[1]);
        for (a, b) in network.at(pixel).iter().zip(other.at(pixel)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}

#[test]
fn wild_numbers_are_an_error_not_a_network() {
    let mut learn = samples(60, 1e-3, 1);
    learn.outputs[3][1] = f64::NAN;
    let ours = fit_evidence(&learn, None, &OPTIONS, 1, &Unattended, &mut |_| ());
    assert!(matches!(ours, Err(FitError::Diverged { .. })), "{ours:?}");
    let published = fit_published(&learn, None, &Adam::published(16), 1, &Unattended, &mut |_| ());
    assert_eq!(published, Err(FitError::Diverged { iteration: 1 }));
}

#[test]
fn training_can_be_cancelled() {
    struct Stop;
    impl JobContext for Stop {
        fn checkpoint(&self) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
        fn report(&self, _: f64, _: &str) {}
    }
    let learn = samples(60, 1e-3, 1);
    assert_eq!(
        fit_evidence(&learn, None, &OPTIONS, 1, &Stop, &mut |_| ()),
        Err(FitError::Cancelled(Cancelled))
    );
}

#[test]
fn faults_are_named() {
    let sound = fit(&samples(60, 1e-3, 1), &OPTIONS, 1);
    assert_eq!(sound.fault(), None);
    assert_eq!(sound.shape(), "2–64–3");
    let mut short = sound.clone();
    short.weights[1].pop();
    assert!(short.fault().expect("short").contains("[64, 63, 64]"));
    let mut flat = sound.clone();
    flat.input.sd[0] = 0.0;
    assert!(flat.fault().expect("flat").contains("normalization"));
    let mut wild = sound;
    wild.bias[0] = f64::NAN;
    assert!(wild.fault().expect("wild").contains("finite"));
}

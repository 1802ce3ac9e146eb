//! Training a model, with cross-validation by blocks, and comparing methods on the same touches.

use std::sync::mpsc;

use plumbline_model::{Cancelled, JobContext};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::blocks::{BlockBy, Blocks};
use crate::border::{Border, BorderError, Spread, SpreadError};
use crate::data::TouchData;
use crate::errors::{Errors, distance_2d_m, interval_95};
use crate::heights::HeightGrid;
use crate::method::Method;
use crate::model::{CorrectionModel, CrossValidation, Parts, Provenance, Trust};
use crate::network::{
    Adam, Ensemble, EvidenceOptions, FitError, Network, Samples, Step, fit_evidence, fit_published,
};
use crate::options::{Recipe, TrainOptions};
use crate::placement::M1;

/// Fewest touches that a network is trained on: less than that a plane explains better.
pub const FEWEST_FOR_A_NETWORK: usize = 20;
/// Fewest touches that have to be left when a block is held out: a placement and heights need them.
const FEWEST_TO_JUDGE: usize = crate::data::FEWEST_TOUCHES - 1;
/// Standard deviation of the draw of the hidden layer.
/// Small: over the touches the units bend gently, as the arm's error does.
const DRAW_SD: f64 = 0.2;
/// An arm that misses by more than this (rms) is not the one that was touched with, m.
const LARGEST_RMS_M: f64 = 0.15;
/// Loss points that may wait for their receiver.
const WAITING: usize = 256;

/// A point of a loss curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LossPoint {
    /// What is trained.
    pub method: Method,
    /// With `held_out_rms_m`: number of the block that is held out. Without: number of the network
    /// of the final model, which is trained on all touches.
    pub member: usize,
    /// Counted from 1 (an epoch, or a step of the hidden layer).
    pub iteration: usize,
    /// 2D rms of the touches that are learned from, m.
    pub train_rms_m: f64,
    /// 2D rms of the touches that are held out, m.
    pub held_out_rms_m: Option<f64>,
}

/// Why there is no model.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// Cancelled on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Not enough touches for a network.
    #[error(
        "{found} touches are too few to train {}: at least {needed} are needed; touch more places, or use M1", .method.name()
    )]
    TooFew {
        /// What was to be trained.
        method: Method,
        /// Touches that there are.
        found: usize,
        /// Touches that are needed.
        needed: usize,
    },
    /// A group of repeats is nearly all there is.
    #[error(
        "{largest} of the {found} touches repeat one command (column group), and without them {rest} are left to judge {} with, where at least {needed} are needed: touch more places, or correct the column group in touches.csv", .method.name()
    )]
    MostlyRepeats {
        /// What was to be trained.
        method: Method,
        /// Touches that there are.
        found: usize,
        /// Touches that would be held out together.
        largest: usize,
        /// Touches that would be left.
        rest: usize,
        /// Touches that are needed.
        needed: usize,
    },
    /// The weights grew beyond all bounds.
    #[error(
        "training {} diverged in iteration {iteration}: look for wild values among the touches, or choose another seed or recipe", .method.name()
    )]
    Diverged {
        /// What was trained.
        method: Method,
        /// Where.
        iteration: usize,
    },
    /// What was learned does not even answer for what it was learned from.
    #[error(
        "{} misses the touches that it was trained on by {:.0} mm, where an arm is off by some millimeters: pixels and points sent do not belong together; look for a wrong unit, screen or robot in the session", .method.name(), 1e3 * .rms_m
    )]
    Nonsense {
        /// What was trained.
        method: Method,
        /// √(mean squared error in space), m.
        rms_m: f64,
    },
    /// The border cannot be drawn.
    #[error(transparent)]
    Border(#[from] BorderError),
    /// The spread cannot be told.
    #[error(transparent)]
    Spread(#[from] SpreadError),
    /// The thread of the training did not start.
    #[error("no thread could be started for training ({0}): close other programs and try again")]
    Thread(std::io::Error),
}

/// Trains a model on all touches, cross-validates it by blocks, and draws its border.
///
/// Every point of the loss curves goes to `on_loss`: first those of networks that a block was held
/// out from, with its error, then those of the final networks. The result does not depend on the
/// number of threads.
///
/// # Errors
/// When cancelled, with too few touches, and when training diverges.
pub fn train(
    data: &TouchData,
    method: Method,
    options: &TrainOptions,
    job: &dyn JobContext,
    on_loss: &mut dyn FnMut(LossPoint),
) -> Result<CorrectionModel, TrainError> {
    check(data, method)?;
    let blocks = judging_blocks(data, method, options.block_by, options)?;
    let areas = judging_blocks(data, method, BlockBy::Area, options)?;
    let border = Border::around(&data.pixels())?;
    let (residuals_m, of_areas_m, parts) = listening(on_loss, |emit| {
        job.report(0.1, "cross-validating");
        let residuals_m = held_out_residuals(data, method, options, &blocks, job, emit)?;
        // How errors grow away from data is learned from areas that were held out.
        job.report(0.4, "measuring how errors grow away from the touches");
        let of_areas_m = match blocks.by {
            BlockBy::Area => residuals_m.clone(),
            BlockBy::SetsElseArea => held_out_residuals(data, method, options, &areas, job, &|_| ())?,
        };
        job.report(0.8, "training on all touches");
        let parts = fit(data, None, method, options, job, &|member, step| {
            emit(LossPoint { member, ..loss_point(method, step) });
        })?;
        Ok((residuals_m, of_areas_m, parts))
    })?;
    job.checkpoint()?;
    fits(&parts.residuals_m(data), method)?;
    let errors = of_areas_m.iter().map(|residual| residual.map(|m| -m)).collect::<Vec<_>>();
    let spread = Spread::fit_blocked(&data.pixels(), &errors, &areas.of_touch, &border)?;
    let trust = Trust::new(border, spread, data, &residuals_m);
    let provenance = Provenance {
        session: options.session.clone(),
        software: options.software.clone(),
        made: jiff::Timestamp::now(),
        touches: data.touches.iter().map(Into::into).collect(),
        left_out: data.left_out.clone(),
        options: Some(options.clone()),
        without: Errors::of(&data.sent_as_they_are_m()),
        training: Errors::of(&parts.residuals_m(data)),
        cross_validation: cross_validation(residuals_m, blocks, options.seed),
        remarks: vec![],
    };
    Ok(CorrectionModel { parts, trust: Some(trust), provenance })
}

/// Refuses what misses its own touches by more than any arm does.
fn fits(residuals_m: &[[f64; 3]], method: Method) -> Result<(), TrainError> {
    let sum: f64 = residuals_m.iter().flatten().map(|m| m * m).sum();
    let rms_m = (sum / residuals_m.len().max(1) as f64).sqrt();
    if rms_m <= LARGEST_RMS_M { Ok(()) } else { Err(TrainError::Nonsense { method, rms_m }) }
}

/// Errors of a method on touches whose block was held out from training.
///
/// # Errors
/// As [`train`].
pub fn cross_validate(
    data: &TouchData,
    method: Method,
    options: &TrainOptions,
    job: &dyn JobContext,
) -> Result<CrossValidation, TrainError> {
    check(data, method)?;
    let blocks = judging_blocks(data, method, options.block_by, options)?;
    let residuals_m = held_out_residuals(data, method, options, &blocks, job, &|_| ())?;
    cross_validation(residuals_m, blocks, options.seed).ok_or(TrainError::TooFew {
        method,
        found: 0,
        needed: crate::data::FEWEST_TOUCHES,
    })
}

/// Methods judged on the same held-out touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Rows of the session's table, in the order of all residuals.
    pub rows: Vec<usize>,
    /// One per method, in the order asked for.
    pub methods: Vec<Compared>,
}

/// One method of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// Which.
    pub method: Method,
    /// On touches that were held out; the blocks are the same for all methods.
    pub held_out: CrossValidation,
}

impl Comparison {
    /// What one method held out gave.
    pub fn of(&self, method: Method) -> Option<&CrossValidation> {
        self.methods.iter().find(|compared| compared.method == method).map(|compared| &compared.held_out)
    }

    /// By how much the mean 2D error of `a` is larger than that of `b`, and the 95 % interval of
    /// that, from drawing the same blocks for both, m.
    pub fn difference_m(&self, a: Method, b: Method) -> Option<(f64, [f64; 2])> {
        let (a, b) = (self.of(a)?, self.of(b)?);
        let pairs = a.residuals_m.iter().zip(&b.residuals_m);
        let values: Vec<f64> = pairs.map(|(a, b)| distance_2d_m(a) - distance_2d_m(b)).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        Some((mean, interval_95(&values, &a.blocks, 0)))
    }
}

/// Judges methods on the same held-out touches.
///
/// # Errors
/// As [`train`], for the first method that fails.
pub fn compare(
    data: &TouchData,
    methods: &[Method],
    options: &TrainOptions,
    job: &dyn JobContext,
) -> Result<Comparison, TrainError> {
    let mut compared = vec![];
    for (index, method) in methods.iter().enumerate() {
        job.report(
            index as f64 / methods.len() as f64,
            &format!("holding out touches from {}", method.name()),
        );
        let held_out = cross_validate(data, *method, options, job)?;
        compared.push(Compared { method: *method, held_out });
    }
    Ok(Comparison { rows: data.touches.iter().map(|touch| touch.row).collect(), methods: compared })
}

fn check(data: &TouchData, method: Method) -> Result<(), TrainError> {
    if method == Method::M1 || data.len() >= FEWEST_FOR_A_NETWORK {
        return Ok(());
    }
    Err(TrainError::TooFew { method, found: data.len(), needed: FEWEST_FOR_A_NETWORK })
}

/// Blocks of which each leaves enough touches to learn from when it is held out.
fn judging_blocks(
    data: &TouchData,
    method: Method,
    by: BlockBy,
    options: &TrainOptions,
) -> Result<Blocks, TrainError> {
    let blocks = Blocks::of(data, by, options.folds);
    let (found, needed) = (data.len(), FEWEST_TO_JUDGE);
    let sizes = (0..blocks.len()).map(|block| blocks.split(block).1.len());
    let largest = sizes.max().unwrap_or(0);
    let rest = found - largest;
    if rest >= needed {
        Ok(blocks)
    } else {
        Err(TrainError::MostlyRepeats { method, found, largest, rest, needed })
    }
}

fn cross_validation(residuals_m: Vec<[f64; 3]>, blocks: Blocks, seed: u64) -> Option<CrossValidation> {
    let errors = Errors::of(&residuals_m)?;
    let distances: Vec<f64> = residuals_m.iter().map(distance_2d_m).collect();
    let mean_2d_interval_m = interval_95(&distances, &blocks, seed);
    Some(CrossValidation { blocks, errors, mean_2d_interval_m, residuals_m })
}

/// Predicted − sent of every touch by a model that was trained without its block, m. The first
/// network of each block tells its loss.
fn held_out_residuals(
    data: &TouchData,
    method: Method,
    options: &TrainOptions,
    blocks: &Blocks,
    job: &dyn JobContext,
    emit: &(dyn Fn(LossPoint) + Sync),
) -> Result<Vec<[f64; 3]>, TrainError> {
    let of_blocks = (0..blocks.len()).into_par_iter().map(|block| {
        job.checkpoint()?;
        let (rest, held_out) = blocks.split(block);
        let test = data.subset(&held_out);
        let parts = fit(&data.subset(&rest), Some(&test), method, options, job, &|member, step| {
            if member == 0 {
                emit(LossPoint { member: block, ..loss_point(method, step) });
            }
        })?;
        Ok((held_out, parts.residuals_m(&test)))
    });
    let of_blocks: Vec<(Vec<usize>, Vec<[f64; 3]>)> = of_blocks.collect::<Result<_, TrainError>>()?;
    let mut residuals_m = vec![[0.0; 3]; data.len()];
    for (touches, residuals) in of_blocks {
        for (touch, residual) in touches.into_iter().zip(residuals) {
            residuals_m[touch] = residual;
        }
    }
    Ok(residuals_m)
}

fn loss_point(method: Method, step: Step) -> LossPoint {
    let Step { iteration, train_rms_m, held_out_rms_m } = step;
    LossPoint { method, member: 0, iteration, train_rms_m, held_out_rms_m }
}

/// One fit, without cross-validation: what is timed as "one fit".
pub(crate) fn fit(
    data: &TouchData,
    held_out: Option<&TouchData>,
    method: Method,
    options: &TrainOptions,
    job: &dyn JobContext,
    emit: &(dyn Fn(usize, Step) + Sync),
) -> Result<Parts, TrainError> {
    let outputs = match method {
        Method::M1 => return Ok(Parts::M1(M1::of_touches(data, options.placement))),
        Method::M2 => 2,
        Method::M3 => 3,
    };
    let samples = samples(data, outputs);
    let held_out = held_out.map(|held_out| self::samples(held_out, outputs));
    let units = if method == Method::M2 { 16 } else { 64 };
    let members = if options.recipe == Recipe::Published { 1 } else { options.members.max(1) };
    let networks = (0..members).into_par_iter().map(|member| {
        let seed = options.seed.wrapping_add((member as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut after = |step| emit(member, step);
        fit_network(&samples, held_out.as_ref(), units, options, seed, job, &mut after)
    });
    let members: Result<Vec<Network>, FitError> = networks.collect();
    let network = Ensemble {
        members: members.map_err(|error| match error {
            FitError::Cancelled(cancelled) => TrainError::Cancelled(cancelled),
            FitError::Diverged { iteration } => TrainError::Diverged { method, iteration },
        })?,
    };
    Ok(match method {
        Method::M3 => Parts::M3 { network },
        _ => Parts::M2 { network, heights: HeightGrid::of_touches(data) },
    })
}

fn fit_network(
    samples: &Samples,
    held_out: Option<&Samples>,
    units: usize,
    options: &TrainOptions,
    seed: u64,
    job: &dyn JobContext,
    after: &mut dyn FnMut(Step),
) -> Result<Network, FitError> {
    match options.recipe {
        Recipe::Published => fit_published(samples, held_out, &Adam::published(units), seed, job, after),
        Recipe::Evidence => {
            let options = EvidenceOptions {
                units,
                activation: options.activation,
                iterations: options.iterations,
                draw_sd: DRAW_SD,
            };
            fit_evidence(samples, held_out, &options, seed, job, after)
        }
    }
}

pub(crate) fn samples(data: &TouchData, outputs: usize) -> Samples {
    let touches = data.touches.iter();
    Samples {
        inputs: touches.clone().map(|touch| vec![touch.pixel.u_px, touch.pixel.v_px]).collect(),
        outputs: touches.map(|touch| touch.sent.coords.iter().take(outputs).copied().collect()).collect(),
    }
}

/// Runs `work` on a thread of its own and hands what it emits to `on_loss` on this one.
fn listening<T: Send>(
    on_loss: &mut dyn FnMut(LossPoint),
    work: impl FnOnce(&(dyn Fn(LossPoint) + Sync)) -> Result<T, TrainError> + Send,
) -> Result<T, TrainError> {
    let (sender, points) = mpsc::sync_channel(WAITING);
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("training".to_owned());
        let working = thread.spawn_scoped(scope, move || {
            // The receiver lives until the last sender is gone: sending cannot fail.
            work(&|point| sender.send(point).unwrap_or_default())
        });
        let working = working.map_err(TrainError::Thread)?;
        points.iter().for_each(on_loss);
        working.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

//! How long training takes, for the program's benchmark command.

use std::time::Instant;

use plumbline_model::Unattended;

use crate::data::TouchData;
use crate::method::Method;
use crate::options::{Recipe, TrainOptions};
use crate::train::{TrainError, fit, train};

/// Median seconds of training an M3 on this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitTimes {
    /// One fit with the default options, all its networks.
    pub ours_s: f64,
    /// One fit in the published way (Adam, 1e-3, batches of 16, 200 epochs), by this program. What
    /// the same takes in Python the benchmark command measures beside it.
    pub published_s: f64,
    /// A training with the default options, cross-validation, border and spread included.
    pub whole_training_s: f64,
}

/// Measures how long training an M3 takes.
///
/// # Errors
/// As [`train`].
pub fn fit_times(data: &TouchData) -> Result<FitTimes, TrainError> {
    let ours = TrainOptions::default();
    let published = TrainOptions { recipe: Recipe::Published, ..TrainOptions::default() };
    let one =
        |options: &TrainOptions| fit(data, None, Method::M3, options, &Unattended, &|_, _| ()).map(|_| ());
    Ok(FitTimes {
        ours_s: median_s(9, || one(&ours))?,
        published_s: median_s(3, || one(&published))?,
        whole_training_s: median_s(3, || {
            train(data, Method::M3, &ours, &Unattended, &mut |_| ()).map(|_| ())
        })?,
    })
}

fn median_s(runs: usize, mut work: impl FnMut() -> Result<(), TrainError>) -> Result<f64, TrainError> {
    // The first run also pays for starting threads and for cold caches.
    work()?;
    let mut seconds = vec![];
    for _ in 0..runs {
        let start = Instant::now();
        work()?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok(seconds[runs / 2])
}

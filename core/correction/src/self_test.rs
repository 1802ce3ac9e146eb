//! What a model answered when it was written. One that answers otherwise when it is read has been
//! changed or damaged since, however finite its numbers are.

use std::path::Path;

use plumbline_model::session::Screen;
use plumbline_model::{Pixel, plausible};
use serde::{Deserialize, Serialize};

use crate::file_error::FileError;
use crate::model::CorrectionModel;

/// An answer that was kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Answer {
    /// Touch pixel (u, v), px.
    pixel: [f64; 2],
    /// The point to send, robot frame, m.
    target_m: [f64; 3],
    /// Standard deviation per axis, m; absent where nothing is known of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sd_m: Option<[f64; 3]>,
    /// Whether the pixel is inside of the border.
    inside: bool,
}

/// Pixels that are asked about, per side of a grid over the touches and around them.
const PER_SIDE: usize = 12;
/// How far the grid reaches beyond the touches, as a part of their extent.
const AROUND: f64 = 0.3;
/// Processors round differently, by far less than this, m.
pub(crate) const EXACT_M: f64 = 1e-6;
/// The same where weights are kept with seven digits, m.
pub(crate) const ROUNDED_M: f64 = 1e-4;
/// Errors that a file states may be rounded by this, m.
const STATED_M: f64 = 1e-5;

impl CorrectionModel {
    /// Answers at some of its own touches, between and around them.
    pub(crate) fn answers(&self) -> Vec<Answer> {
        self.probes().into_iter().map(|pixel| self.answer(pixel)).filter(Answer::is_finite).collect()
    }

    fn answer(&self, pixel: [f64; 2]) -> Answer {
        let answer = self.correct(Pixel::<Screen>::new(pixel[0], pixel[1]));
        let sd_m = answer.sd_m.iter().all(|sd_m| sd_m.is_finite()).then_some(answer.sd_m);
        Answer { pixel, target_m: answer.target.coords.into(), sd_m, inside: answer.inside }
    }

    fn probes(&self) -> Vec<[f64; 2]> {
        let range = |axis: usize| {
            let values = self.provenance.touches.iter().map(|touch| touch.pixel[axis]);
            let (low, high) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            if low < high { (low, high) } else { [(0.0, 1920.0), (0.0, 1080.0)][axis] }
        };
        let along = |axis: usize, i: usize| {
            let (low, high) = range(axis);
            let part = i as f64 / (PER_SIDE - 1) as f64;
            low + (high - low) * ((1.0 + 2.0 * AROUND) * part - AROUND)
        };
        let grid = (0..PER_SIDE * PER_SIDE).map(|k| [along(0, k % PER_SIDE), along(1, k / PER_SIDE)]);
        let step = self.provenance.touches.len().div_ceil(PER_SIDE).max(1);
        let own = self.provenance.touches.iter().step_by(step).map(|touch| touch.pixel);
        grid.chain(own).collect()
    }

    /// Refuses a model that does not answer as it did, nor as its file says that it fits its touches,
    /// nor with a place that an arm could be sent to.
    pub(crate) fn check_answers(
        &self,
        file: &Path,
        kept: &[Answer],
        tolerance_m: f64,
    ) -> Result<(), FileError> {
        let refuse = |off_m: f64| FileError::OtherAnswers { file: file.to_path_buf(), off_m };
        for expected in kept {
            let off_m = expected.off_m(&self.answer(expected.pixel));
            // Not so for NaN either.
            if !(off_m <= tolerance_m) {
                return Err(refuse(off_m));
            }
        }
        if let Some(off_m) = self.misses_its_touches_m() {
            return Err(refuse(off_m));
        }
        for probe in self.probes() {
            let target_m = self.answer(probe).target_m;
            plausible::TARGET_M.check_all(&target_m).map_err(|what| FileError::damaged(file, what))?;
        }
        Ok(())
    }

    /// By how much the errors on its own touches differ from those that it states; `None` where they
    /// agree, or none are stated.
    fn misses_its_touches_m(&self) -> Option<f64> {
        let stated = self.provenance.training.as_ref()?;
        let touches = &self.provenance.touches;
        if touches.is_empty() || touches.len() != stated.count {
            return None;
        }
        let residuals: Vec<[f64; 3]> = touches
            .iter()
            .map(|touch| {
                let at_m = self.answer(touch.pixel).target_m;
                std::array::from_fn(|axis| at_m[axis] - touch.sent_m[axis])
            })
            .collect();
        let found = crate::errors::Errors::of(&residuals)?;
        let off_m = (found.rms_2d_m - stated.rms_2d_m).abs().max((found.rms_z_m - stated.rms_z_m).abs());
        (!(off_m <= STATED_M)).then_some(off_m)
    }
}

impl Answer {
    fn is_finite(&self) -> bool {
        self.target_m.iter().all(|m| m.is_finite())
    }

    /// Largest difference in space or of a standard deviation, m.
    fn off_m(&self, now: &Self) -> f64 {
        if self.inside != now.inside {
            return f64::INFINITY;
        }
        let between = |a: &[f64; 3], b: &[f64; 3]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, |most: f64, off| if off.is_nan() { f64::NAN } else { most.max(off) })
        };
        let sd_m = match (&self.sd_m, &now.sd_m) {
            (Some(then), Some(now)) => between(then, now),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        let target_m = between(&self.target_m, &now.target_m);
        if target_m.is_nan() { f64::NAN } else { target_m.max(sd_m) }
    }
}

//! From tangents to directions, classes and bits.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use plumbline_model::decompose;
use rayon::prelude::*;

use super::tangent::{ContactTangent, STEP};
use super::{ALIKE_COSINE, EffectVisibility, Noise, PlannedContact, SEEN_SIGMAS};
use crate::arm::Arm;
use crate::library::{Effect, Surface};

/// What touches tell about parameters and the screen's place, as normal matrices in units of the
/// noise. Of two plans together it is the sum.
#[derive(Clone, Debug)]
pub(super) struct Information {
    /// Parameters (of usual size) against each other.
    effects: DMatrix<f64>,
    /// Parameters against the screen's place.
    mixed: DMatrix<f64>,
    /// The screen's place.
    gauge: DMatrix<f64>,
    /// What encoders tell about single parameters.
    encoders: DVector<f64>,
    /// First parameter of each effect, and the end of the last.
    starts: Vec<usize>,
}

impl AddAssign<&Self> for Information {
    fn add_assign(&mut self, other: &Self) {
        self.effects += &other.effects;
        self.mixed += &other.mixed;
        self.gauge += &other.gauge;
        self.encoders += &other.encoders;
    }
}

impl Information {
    pub fn of(
        arm: &Arm,
        surface: &Surface,
        effects: &[Effect],
        contacts: &[PlannedContact],
        noise: &Noise,
    ) -> Self {
        let mut starts = vec![0];
        for effect in effects {
            starts.push(starts[starts.len() - 1] + effect.parameters().len());
        }
        let count = starts[starts.len() - 1];
        let tangents: Vec<ContactTangent> = contacts
            .par_iter()
            .map(|contact| {
                ContactTangent::of(arm, surface, effects, contact, noise.encoder_rad.is_some(), STEP)
            })
            .collect();
        let weigh = Matrix3::from_diagonal(&Vector3::new(
            1.0 / noise.in_plane_m,
            1.0 / noise.in_plane_m,
            1.0 / noise.height_m,
        ));
        let mut rows = DMatrix::zeros(3 * contacts.len(), count);
        let mut gauge = DMatrix::zeros(3 * contacts.len(), 6);
        let mut encoders = DVector::zeros(count);
        for (i, tangent) in tangents.iter().enumerate() {
            rows.rows_mut(3 * i, 3).copy_from(&(weigh * &tangent.effects));
            gauge.rows_mut(3 * i, 3).copy_from(&(weigh * tangent.gauge));
            if let Some(encoder_rad) = noise.encoder_rad {
                for (sum, seen_rad) in encoders.iter_mut().zip(&tangent.encoder_rad) {
                    *sum += (seen_rad / encoder_rad).powi(2);
                }
            }
        }
        Self {
            effects: rows.tr_mul(&rows),
            mixed: rows.tr_mul(&gauge),
            gauge: gauge.tr_mul(&gauge),
            encoders,
            starts,
        }
    }

    /// Frees the screen's place and takes the rest apart.
    pub fn spectrum(&self) -> Spectrum {
        let solved = decompose::pseudo_inverse(self.gauge.clone(), 1e-9 * self.gauge.amax());
        let solved = solved.unwrap_or_else(|| DMatrix::zeros(self.gauge.ncols(), self.gauge.nrows()));
        let touches = &self.effects - &self.mixed * solved * self.mixed.transpose();
        let touches = 0.5 * (&touches + touches.transpose());
        // What cannot be taken apart tells nothing.
        let eigenvalues = decompose::symmetric_eigenvalues(touches.clone());
        let mut singular: Vec<f64> =
            eigenvalues.iter().flat_map(|values| values.iter()).map(|value| value.max(0.0).sqrt()).collect();
        singular.sort_by(|a, b| b.total_cmp(a));
        let with_encoders = &touches + DMatrix::from_diagonal(&self.encoders);
        Spectrum { singular, all: with_encoders, starts: self.starts.clone() }
    }
}

/// What is left to be seen when the screen's place is free.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    /// Of the touches, largest first: how far a mixture of usual size stands out of the noise.
    pub singular: Vec<f64>,
    /// Normal matrix of touches and encoders.
    all: DMatrix<f64>,
    starts: Vec<usize>,
}

impl Spectrum {
    pub fn directions(&self) -> usize {
        self.singular.iter().filter(|value| **value >= SEEN_SIGMAS).count()
    }

    pub fn condition(&self) -> f64 {
        match self.directions() {
            0 => 1.0,
            count => self.singular[0] / self.singular[count - 1],
        }
    }

    pub fn bits(&self) -> f64 {
        self.singular.iter().map(|value| 0.5 * value.mul_add(*value, 1.0).log2()).sum()
    }

    /// Sum of squares of what the parameters of an effect do, averaged over them.
    fn sigmas(&self, effect: usize) -> f64 {
        let range = self.starts[effect]..self.starts[effect + 1];
        let count = range.len() as f64;
        (range.map(|i| self.all[(i, i)].max(0.0)).sum::<f64>() / count).sqrt()
    }

    pub fn visibility(&self, effects: &[Effect]) -> Vec<EffectVisibility> {
        let posterior = (DMatrix::identity(self.all.nrows(), self.all.ncols()) + &self.all)
            .cholesky()
            .map(|cholesky| cholesky.inverse());
        let doubt = |effect: usize| {
            let range = self.starts[effect]..self.starts[effect + 1];
            let count = range.len() as f64;
            let of = |covariance: &DMatrix<f64>| range.map(|i| covariance[(i, i)]).sum::<f64>() / count;
            posterior.as_ref().map_or(1.0, of).clamp(0.0, 1.0).sqrt()
        };
        let mut seen: Vec<EffectVisibility> = effects
            .iter()
            .enumerate()
            .map(|(i, effect)| EffectVisibility {
                id: effect.id().to_owned(),
                site: effect.site.clone(),
                title: effect.title.clone(),
                sigmas: self.sigmas(i),
                doubt_left: doubt(i),
            })
            .collect();
        seen.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
        seen
    }

    /// Classes of effects that do the same. Each gathers around the one that is seen best, so
    /// that no chain of small differences joins what is different.
    pub fn alike(&self, effects: &[Effect]) -> Vec<Vec<(String, String)>> {
        let mut left: Vec<usize> = (0..effects.len()).filter(|i| self.sigmas(*i) >= SEEN_SIGMAS).collect();
        left.sort_by(|a, b| self.sigmas(*b).total_cmp(&self.sigmas(*a)));
        let whitened: Vec<Option<DMatrix<f64>>> = (0..effects.len()).map(|i| self.whitener(i)).collect();
        let mut classes = vec![];
        while !left.is_empty() {
            let leader = left.remove(0);
            let (same, others): (Vec<usize>, Vec<usize>) =
                left.iter().partition(|other| self.cosine(&whitened, leader, **other) > ALIKE_COSINE);
            left = others;
            if !same.is_empty() {
                let name = |i: &usize| (effects[*i].id().to_owned(), effects[*i].site.clone());
                classes.push(std::iter::once(&leader).chain(&same).map(name).collect());
            }
        }
        classes
    }

    /// Cosine of the largest angle between what the smaller effect can do and the nearest that the
    /// larger one can: 1 if one can be taken for the other whatever its values.
    fn cosine(&self, whitened: &[Option<DMatrix<f64>>], a: usize, b: usize) -> f64 {
        let (Some(white_a), Some(white_b)) = (&whitened[a], &whitened[b]) else { return 0.0 };
        let (start, end) = (self.starts[a], self.starts[b]);
        let (rows, columns) = (self.starts[a + 1] - start, self.starts[b + 1] - end);
        let cosines = white_a.tr_mul(&self.all.view((start, end), (rows, columns))) * white_b;
        decompose::singular_values(cosines).map_or(0.0, |values| values.min())
    }

    /// Columns that make the parameters of an effect independent and of unit size; directions
    /// that cannot be seen are left out.
    fn whitener(&self, effect: usize) -> Option<DMatrix<f64>> {
        let (start, end) = (self.starts[effect], self.starts[effect + 1]);
        let block = self.all.view((start, start), (end - start, end - start)).into_owned();
        let eigen = decompose::symmetric_eigen(block)?;
        let columns: Vec<DVector<f64>> = eigen
            .eigenvalues
            .iter()
            .enumerate()
            .filter(|(_, value)| **value >= 1.0)
            .map(|(i, value)| eigen.eigenvectors.column(i) / value.sqrt())
            .collect();
        (!columns.is_empty()).then(|| DMatrix::from_columns(&columns))
    }
}

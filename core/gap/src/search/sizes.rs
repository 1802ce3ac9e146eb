//! How far the sizes of what was named may be off by what is not known of it: its shape, and what else is there.

use nalgebra::{DMatrix, DVector};

use super::field::log_sum;
use super::naming::{Evidence, Named, parameters};
use crate::finding::FoundParameter;

/// Shapes of one effect that are so many times less probable do not tell how far its values are off.
const LEAST_SHAPE: f64 = 0.1;
/// Sets that are less probable do not tell how far values are off.
const LEAST_COMPANY: f64 = 0.005;

impl Evidence<'_> {
    /// Covariance (usual sizes) of what grows by what is not known of its law: how far it will go is known the less,
    /// the less of its course was seen.
    pub(super) fn by_shapes(&self, block: usize, own: &[f64]) -> DMatrix<f64> {
        let mut spread = DMatrix::zeros(own.len(), own.len());
        let is_late = |block: usize| self.library.effects[block].shape.is_some_and(|shape| shape < 0.0);
        if !is_late(block) {
            return spread;
        }
        let name = self.look.blocks[block].name;
        let mut total = 0.0;
        for model in &self.explored.models {
            let same = |other: &usize| self.look.blocks[*other].name == name;
            let set = self.of_library(model);
            let Some(place) = set.iter().position(same) else { continue };
            let Some((other, _)) = self.values(&set).into_iter().nth(place) else { continue };
            let apart = DVector::from_iterator(own.len(), other.iter().zip(own).map(|(a, b)| a - b));
            spread += &apart * apart.transpose() * model.probability;
            total += model.probability;
        }
        if total > 0.0 { spread / total } else { spread }
    }

    /// Covariance (usual sizes) of values of a block by what else is there: sets that are as probable have other
    /// companions, and with them other values (Bayesian model averaging: Hoeting, Madigan, Raftery and Volinsky
    /// 1999).
    pub(super) fn by_companions(&self, set: &[usize], block: usize, own: &[f64]) -> DMatrix<f64> {
        let mut spread = DMatrix::zeros(own.len(), own.len());
        let mut total = 0.0;
        let likely = self.explored.models.iter().filter(|model| model.probability > LEAST_COMPANY);
        for model in likely.filter(|model| model.set.contains(&block)) {
            total += model.probability;
            if model.set == set {
                continue;
            }
            let at = model.set.iter().position(|&other| other == block);
            let Some((other, _)) = at.and_then(|at| self.values(&model.set).into_iter().nth(at)) else {
                continue;
            };
            let apart = DVector::from_iterator(own.len(), other.iter().zip(own).map(|(a, b)| a - b));
            spread += &apart * apart.transpose() * model.probability;
        }
        if total > 0.0 { spread / total } else { spread }
    }

    /// Widens the intervals of what was named by its other shapes that are nearly as probable: how far a wave goes
    /// once per turn or twice, or what grows with another time constant.
    pub(super) fn widen_by_shapes(&self, named: &mut Named) {
        let set = named.blocks.clone();
        for (place, effect) in named.effects.iter_mut().enumerate() {
            let block = set[place];
            let name = self.look.blocks[block].name;
            let (fields, packed) = (&self.look.fields, &self.look.packed);
            let base: Vec<usize> = set.iter().copied().filter(|&other| other != block).collect();
            let given: Vec<_> = fields.iter().map(|field| field.given(&base, packed)).collect();
            let score = |other: usize| {
                let adds = given.iter().map(|given| given.log_evidence + given.adds(&packed[other]));
                log_sum(adds) / self.temperature
            };
            let own = score(block);
            let shapes = self.look.allowed.iter().copied();
            let others = shapes.filter(|&other| other != block && other < self.look.effects);
            for other in others.filter(|&other| self.look.blocks[other].name == name) {
                if score(other) < own + LEAST_SHAPE.ln() {
                    continue;
                }
                let with: Vec<usize> =
                    set.iter().map(|&one| if one == block { other } else { one }).collect();
                let Some((values, covariance)) = self.values(&with).into_iter().nth(place) else { continue };
                let shape = &self.library.effects[other];
                let typical: Vec<f64> = shape.parameters().iter().map(|one| one.typical).collect();
                let values: Vec<f64> = values.iter().zip(&typical).map(|(value, one)| value * one).collect();
                let covariance = DMatrix::from_fn(values.len(), values.len(), |r, c| {
                    covariance[(r, c)] * typical[r] * typical[c]
                });
                widen(&mut effect.parameters, &parameters(shape, &values, &covariance));
            }
        }
    }
}

/// To what another shape says of the same parameters. What is constant and what grows have others.
fn widen(own: &mut [FoundParameter], others: &[FoundParameter]) {
    for one in own {
        if let Some(other) = others.iter().find(|other| other.name == one.name) {
            (one.low, one.high) = (one.low.min(other.low), one.high.max(other.high));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, [low, value, high]: [f64; 3]) -> FoundParameter {
        FoundParameter { name: name.to_owned(), value, low, high, text: None }
    }

    #[test]
    fn an_angle_is_not_widened_by_a_time() {
        let turned = ["rot_x_rad", "rot_y_rad"].map(|name| parameter(name, [-0.01, 0.0, 0.01]));
        let grown = [
            parameter("rot_x_rad", [-0.02, 0.0, 0.005]),
            parameter("time_constant_s", [170.0, 240.0, 339.0]),
        ];
        let mut own = turned.to_vec();
        widen(&mut own, &grown);
        assert_eq!((own[0].low, own[0].high), (-0.02, 0.01));
        assert_eq!(own[1], turned[1]);
    }
}

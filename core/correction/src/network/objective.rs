//! What our training minimizes over the hidden layer, the output layer being solved for.
//!
//! The features of the hidden units and the outputs are first freed of what a plane through the
//! inputs explains (variable projection): the network only carries what bends. With precision β
//! of the noise and α of the output weights, per output, the value is
//! `½ Σ (β |Φ w − t|² + α |w|²) + ½ |V − V₀|² / s²` at the best w.

use nalgebra::{DMatrix, DVector, Dyn, linalg::Cholesky};

use super::Activation;

/// The problem for one draw of the hidden layer and one set of row weights.
pub(super) struct Objective<'a> {
    pub activation: Activation,
    /// Scaled inputs and a column of ones, n × 3.
    pub inputs: &'a DMatrix<f64>,
    /// Roots of the rows' weights, n.
    pub root_weights: DVector<f64>,
    /// Orthonormal basis of the weighted inputs, n × 3.
    pub plane: DMatrix<f64>,
    /// Triangular factor that belongs to it, 3 × 3.
    pub plane_factor: DMatrix<f64>,
    /// Weighted, scaled outputs, n × k.
    pub outputs: DMatrix<f64>,
    /// The same without what the plane explains.
    pub bend: DMatrix<f64>,
    /// Per output.
    pub precision: Precision,
    /// The draw that the hidden layer is held to, 3 × H.
    pub anchor: DMatrix<f64>,
    /// 1 / s².
    pub anchor_precision: f64,
}

/// How exact outputs are, and how small their weights have to be.
#[derive(Clone, Debug)]
pub(super) struct Precision {
    /// β, per output.
    pub noise: Vec<f64>,
    /// α, per output.
    pub weights: Vec<f64>,
}

/// Value and gradient for one hidden layer, and the output layer that belongs to it.
pub(super) struct Evaluation {
    pub value: f64,
    /// By the hidden layer, 3 × H.
    pub gradient: DMatrix<f64>,
    /// Values of the hidden units, n × H, not weighted.
    pub features: DMatrix<f64>,
    /// Output weights, H × k.
    pub weights: DMatrix<f64>,
}

impl<'a> Objective<'a> {
    /// The problem with given row weights; precisions are still to be estimated.
    pub fn new(
        activation: Activation,
        inputs: &'a DMatrix<f64>,
        outputs: &DMatrix<f64>,
        row_weights: &[f64],
        anchor: DMatrix<f64>,
        anchor_precision: f64,
    ) -> Self {
        let root_weights = DVector::from_iterator(inputs.nrows(), row_weights.iter().map(|w| w.sqrt()));
        let factors = weighted(inputs, &root_weights).qr();
        let (plane, plane_factor) = (factors.q(), factors.r());
        let outputs = weighted(outputs, &root_weights);
        let bend = without(&plane, outputs.clone());
        let count = outputs.ncols();
        let precision = Precision { noise: vec![1.0; count], weights: vec![1.0; count] };
        Self {
            activation,
            inputs,
            root_weights,
            plane,
            plane_factor,
            outputs,
            bend,
            precision,
            anchor,
            anchor_precision,
        }
    }

    /// Sums of the hidden units and their values, n × H.
    pub fn features(&self, hidden: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let sums = self.inputs * hidden;
        let values = sums.map(|sum| self.activation.of(sum));
        (sums, values)
    }

    /// Weighted features without what the plane explains, n × H.
    pub fn bent(&self, features: &DMatrix<f64>) -> DMatrix<f64> {
        without(&self.plane, weighted(features, &self.root_weights))
    }

    /// Value and gradient; `None` when they are not finite or the output layer has no solution.
    pub fn evaluate(&self, hidden: &DMatrix<f64>) -> Option<Evaluation> {
        let (sums, features) = self.features(hidden);
        let bent = self.bent(&features);
        let transposed = bent.transpose();
        let gram = &transposed * &bent;
        let weights = self.output_layer(&gram, &(&transposed * &self.bend))?;
        let mut residual = &bent * &weights - &self.bend;
        let mut value = 0.0;
        for (output, mut column) in residual.column_iter_mut().enumerate() {
            let (noise, shrink) = (self.precision.noise[output], self.precision.weights[output]);
            value += 0.5 * (noise * column.norm_squared() + shrink * weights.column(output).norm_squared());
            column *= noise;
        }
        let offset = hidden - &self.anchor;
        value += 0.5 * self.anchor_precision * offset.norm_squared();
        // The residual is free of the plane already, so projecting the features needs no term.
        let mut by_sum = residual * weights.transpose();
        for (unit, mut column) in by_sum.column_iter_mut().enumerate() {
            for (row, slope) in column.iter_mut().enumerate() {
                let of_unit = self.activation.slope(sums[(row, unit)], features[(row, unit)]);
                *slope *= self.root_weights[row] * of_unit;
            }
        }
        let gradient = self.inputs.transpose() * by_sum + offset * self.anchor_precision;
        let finite = value.is_finite() && gradient.iter().all(|slope| slope.is_finite());
        finite.then_some(Evaluation { value, gradient, features, weights })
    }

    fn output_layer(&self, gram: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut weights = DMatrix::zeros(gram.nrows(), right.ncols());
        for output in 0..right.ncols() {
            let ridge = self.precision.weights[output] / self.precision.noise[output];
            let mut damped = gram.clone();
            for unit in 0..gram.nrows() {
                damped[(unit, unit)] += ridge;
            }
            let factor: Cholesky<f64, Dyn> = Cholesky::new(damped)?;
            weights.set_column(output, &factor.solve(&right.column(output)));
        }
        Some(weights)
    }

    /// Weights of u, v and 1 that go with these features and output weights, 3 × k.
    pub fn plane_weights(&self, features: &DMatrix<f64>, weights: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let rest = &self.outputs - weighted(&(features * weights), &self.root_weights);
        self.plane_factor.solve_upper_triangular(&(self.plane.transpose() * rest))
    }
}

fn weighted(matrix: &DMatrix<f64>, root_weights: &DVector<f64>) -> DMatrix<f64> {
    let mut product = matrix.clone();
    for mut column in product.column_iter_mut() {
        column.component_mul_assign(root_weights);
    }
    product
}

/// What is left of each column without its part in the span of the orthonormal `plane`.
fn without(plane: &DMatrix<f64>, mut columns: DMatrix<f64>) -> DMatrix<f64> {
    let part = plane.transpose() * &columns;
    columns.gemm(-1.0, plane, &part, 1.0);
    columns
}

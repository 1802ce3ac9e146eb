//! Levenberg–Marquardt on the reduced (Schur) system. The loop belongs to the caller: progress,
//! cancellation and plots need nothing more than [`Optimizer::step`].

use nalgebra::{DMatrix, DVector, Vector6};

use super::problem::{NormalEquations, Problem, State};

/// Why the optimizer stopped, with the value that met the threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Termination {
    /// The cost no longer falls.
    Converged {
        /// Last relative improvement of the cost.
        relative_improvement: f64,
        /// Threshold it had to fall below.
        threshold: f64,
    },
    /// No step lowers the cost, however short.
    NoStep {
        /// Damping at which it gave up.
        damping: f64,
    },
    /// Ran out of iterations.
    TooManyIterations {
        /// How many were made.
        iterations: usize,
    },
}

/// Iterates on one problem.
pub(super) struct Optimizer<'a> {
    problem: &'a Problem,
    pub state: State,
    pub cost: f64,
    damping: f64,
}

const RELATIVE_IMPROVEMENT: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;

impl<'a> Optimizer<'a> {
    pub fn new(problem: &'a Problem, state: State) -> Self {
        let cost = problem.cost(&state);
        Self { problem, state, cost, damping: 1e-4 }
    }

    /// One improving step, or the reason why there is none.
    pub fn step(&mut self) -> Option<Termination> {
        let equations = self.problem.normal_equations(&self.state);
        while self.damping < MOST_DAMPING {
            let moved = solve_reduced(&equations, self.damping)
                .map(|(shared, views)| self.problem.moved(&self.state, &shared, &views));
            if let Some(state) = moved {
                let cost = self.problem.cost(&state);
                if cost.is_finite() && cost <= self.cost {
                    let relative_improvement = (self.cost - cost) / self.cost.max(f64::MIN_POSITIVE);
                    self.state = state;
                    self.cost = cost;
                    self.damping = (self.damping * 0.1).max(1e-12);
                    let converged =
                        Termination::Converged { relative_improvement, threshold: RELATIVE_IMPROVEMENT };
                    return (relative_improvement < RELATIVE_IMPROVEMENT).then_some(converged);
                }
            }
            self.damping *= 10.0;
        }
        Some(Termination::NoStep { damping: self.damping })
    }

    /// Steps until it stops or `most` iterations are done.
    pub fn run(&mut self, most: usize) -> Termination {
        for _ in 0..most {
            if let Some(reason) = self.step() {
                return reason;
            }
        }
        Termination::TooManyIterations { iterations: most }
    }
}

/// Step of shared and view parameters; `None` if the damped system is singular.
fn solve_reduced(equations: &NormalEquations, damping: f64) -> Option<(DVector<f64>, Vec<Vector6<f64>>)> {
    let (reduced, right, inverses) = reduce(equations, damping)?;
    let shared = reduced.cholesky()?.solve(&right);
    let views = equations
        .views
        .iter()
        .zip(&inverses)
        .map(|(view, inverse)| inverse * (view.gradient - &view.coupling * &shared))
        .collect();
    Some((shared, views))
}

type Reduced = (DMatrix<f64>, DVector<f64>, Vec<nalgebra::Matrix6<f64>>);

/// Eliminates the views.
fn reduce(equations: &NormalEquations, damping: f64) -> Option<Reduced> {
    let mut reduced = equations.shared.clone();
    for i in 0..reduced.nrows() {
        reduced[(i, i)] *= 1.0 + damping;
    }
    let mut right = equations.gradient.clone();
    let mut inverses = Vec::with_capacity(equations.views.len());
    for view in &equations.views {
        let mut hessian = view.hessian;
        for i in 0..6 {
            hessian[(i, i)] *= 1.0 + damping;
        }
        let inverse = hessian.cholesky()?.inverse();
        let eliminated = view.coupling.transpose() * inverse;
        reduced -= &eliminated * &view.coupling;
        right -= &eliminated * view.gradient;
        inverses.push(inverse);
    }
    Some((reduced, right, inverses))
}

/// Covariance of the shared parameters for unit measurement variance; `None` if some combination
/// of them cannot be seen in the data.
pub(super) fn shared_covariance(problem: &Problem, state: &State) -> Option<DMatrix<f64>> {
    let (reduced, ..) = reduce(&problem.normal_equations(state), 0.0)?;
    // Scale to unit diagonal first: focal lengths and distortion differ by many orders.
    let scale =
        DVector::from_iterator(reduced.nrows(), reduced.diagonal().iter().map(|d| 1.0 / d.max(0.0).sqrt()));
    if !scale.iter().all(|s| s.is_finite()) {
        return None;
    }
    let d = DMatrix::from_diagonal(&scale);
    let inverse = (&d * reduced * &d).cholesky()?.inverse();
    Some(&d * inverse * &d)
}

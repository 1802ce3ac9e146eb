//! Limited-memory BFGS with backtracking (Nocedal & Wright, Numerical Optimization, ch. 7).

use std::collections::VecDeque;

use nalgebra::DMatrix;

/// Pairs that are remembered.
const MEMORY: usize = 8;
/// Part of the predicted decrease that a step has to reach.
const ARMIJO: f64 = 1e-4;
/// Halvings of a step before the minimum counts as reached.
const HALVINGS: usize = 12;
/// Relative decrease below which the minimum counts as reached.
const DECREASE: f64 = 1e-9;

/// A point with its value and gradient, and whatever else its evaluation gave.
pub(super) struct At<E> {
    pub place: DMatrix<f64>,
    pub value: f64,
    pub gradient: DMatrix<f64>,
    pub evaluation: E,
}

/// Minimizes from `start`; calls `after` following each step, whose error ends the work.
pub(super) fn minimize<E, Stop>(
    start: At<E>,
    iterations: usize,
    evaluate: impl Fn(DMatrix<f64>) -> Option<At<E>>,
    mut after: impl FnMut(usize, &At<E>) -> Result<(), Stop>,
) -> Result<At<E>, Stop> {
    let mut at = start;
    let mut pairs: VecDeque<Pair> = VecDeque::new();
    for iteration in 1..=iterations {
        let direction = descent(&at.gradient, &pairs);
        let slope = direction.dot(&at.gradient);
        if slope >= 0.0 {
            break;
        }
        // Without memory the length of the gradient says nothing about the length of the step.
        let first = if pairs.is_empty() { (0.5 / direction.norm()).min(1.0) } else { 1.0 };
        let steps = (0..HALVINGS).map(|halvings| first * 0.5_f64.powi(halvings as i32));
        let next = steps
            .filter_map(|length| {
                let next = evaluate(&at.place + &direction * length)?;
                (next.value <= at.value + ARMIJO * length * slope).then_some(next)
            })
            .next();
        let Some(next) = next else { break };
        let small = at.value - next.value < DECREASE * at.value.abs();
        pairs.extend(Pair::between(&at, &next));
        if pairs.len() > MEMORY {
            pairs.pop_front();
        }
        at = next;
        after(iteration, &at)?;
        if small {
            break;
        }
    }
    Ok(at)
}

/// A step and the change of the gradient along it.
struct Pair {
    step: DMatrix<f64>,
    change: DMatrix<f64>,
    product: f64,
}

impl Pair {
    /// `None` where the curvature along the step is not positive.
    fn between<E>(from: &At<E>, to: &At<E>) -> Option<Self> {
        let step = &to.place - &from.place;
        let change = &to.gradient - &from.gradient;
        let product = step.dot(&change);
        (product > 1e-12 * step.norm() * change.norm()).then_some(Self { step, change, product })
    }
}

fn descent(gradient: &DMatrix<f64>, pairs: &VecDeque<Pair>) -> DMatrix<f64> {
    let mut direction = -gradient;
    let mut factors = vec![];
    for pair in pairs.iter().rev() {
        let factor = pair.step.dot(&direction) / pair.product;
        direction -= &pair.change * factor;
        factors.push(factor);
    }
    if let Some(newest) = pairs.back() {
        direction *= newest.product / newest.change.norm_squared();
    }
    for (pair, factor) in pairs.iter().zip(factors.into_iter().rev()) {
        let back = pair.change.dot(&direction) / pair.product;
        direction += &pair.step * (factor - back);
    }
    direction
}

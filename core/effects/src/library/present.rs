//! An effect that is there.

use super::Effect;

/// An effect with the values of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Present {
    /// The effect at its site.
    pub effect: Effect,
    /// One value per parameter of [`Effect::parameters`].
    pub values: Vec<f64>,
}

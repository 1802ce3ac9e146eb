//! Random numbers of one image pair.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// Throws dice; the same pair of a set throws the same numbers.
pub(super) struct Dice(StdRng);

impl Dice {
    /// Of one pair of a set.
    pub fn of_pair(seed: u64, index: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&index.to_le_bytes());
        Self(StdRng::from_seed(key))
    }

    /// Evenly between two numbers.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// The same, single precision.
    pub fn within_f32(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.random::<f32>()
    }

    /// Normal, zero mean.
    pub fn normal(&mut self, sigma: f64) -> f64 {
        let (a, b) = (1.0 - self.0.random::<f64>(), self.0.random::<f64>());
        sigma * (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }

    /// Yes with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// A whole number, both ends included.
    pub fn count(&mut self, least: usize, most: usize) -> usize {
        self.0.random_range(least..=most)
    }

    /// Any seed.
    pub fn seed(&mut self) -> u64 {
        self.0.random()
    }

    /// One of several; `items` must not be empty.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.0.random_range(0..items.len())]
    }

    /// A point in a box, meters.
    pub fn place(&mut self, low: [f64; 3], high: [f64; 3]) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.within(low[i], high[i]))
    }

    /// Any orientation, all alike.
    pub fn orientation(&mut self) -> UnitQuaternion<f64> {
        let mut number = || self.normal(1.0);
        let q = Quaternion::new(number(), number(), number(), number());
        UnitQuaternion::new_normalize(q)
    }

    /// A turn about the vertical.
    pub fn heading(&mut self) -> UnitQuaternion<f64> {
        let angle = self.within(-std::f64::consts::PI, std::f64::consts::PI);
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    /// Any color, bright or dark.
    pub fn color(&mut self) -> [f32; 3] {
        let bright = self.within_f32(0.02, 0.9);
        let mut part = || bright * self.within_f32(0.05, 1.0);
        [part(), part(), part()]
    }

    /// A gray with a breath of color.
    pub fn gray(&mut self, low: f32, high: f32) -> [f32; 3] {
        let bright = self.within_f32(low, high);
        let mut part = || bright * self.within_f32(0.93, 1.07);
        [part(), part(), part()]
    }
}

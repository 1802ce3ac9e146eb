//! What a generator takes servos, masses, contact, noise and plans to be. Two generators with other
//! choices keep a search from learning one of them.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};
use strum::{EnumString, IntoStaticStr};

/// Which generator.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, EnumString, IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Generator {
    /// Masses as described, servos that are fed the load forward, a hard contact, normal noise.
    #[default]
    Lean,
    /// Masses wrong by up to a third, integral or proportional servos, a soft contact that rubs, noise
    /// with tails, commands that jitter, more small errors, other plans.
    Worn,
}

/// A mass is another one when it is off by this share.
const OTHER_MASS: f64 = 0.05;

/// How servos hold their goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Servo {
    /// The load is known and fed forward.
    Fed,
    /// What is left is summed up, so many times per second.
    Integral {
        /// Gain of the sum over the gain of the difference, 1/s.
        per_s: f64,
    },
    /// They give way like springs.
    Proportional,
}

/// Plans of touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plans {
    /// Plain: columns and rows of places; drawn anywhere where `scattered`.
    pub grid: [usize; 2],
    /// Whether places are drawn over the whole area.
    pub scattered: bool,
    /// Repeats of every pose, plain and rich.
    pub repeats: [usize; 2],
    /// Rich: number of places.
    pub places: usize,
    /// Rich: heights of the screen, m.
    pub heights_m: &'static [f64],
    /// Weights that hang in the palm, plain and rich, kg.
    pub payloads_kg: [&'static [f64]; 2],
    /// Whether the touches of a session are in an order drawn by chance; else every pass goes through
    /// all poses in the same order.
    pub shuffled: bool,
}

/// All choices of a generator in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// Which.
    pub generator: Generator,
    /// True mass of each link over that of the description.
    pub mass_factors: [f64; 6],
    /// Stiffness of the servos, N m/rad.
    pub servo_nm_per_rad: f64,
    /// How they hold.
    pub servo: Servo,
    /// Friction of a moving servo, N m …
    pub friction_nm: f64,
    /// … between these shares of it from touch to touch.
    pub friction_shares: [f64; 2],
    /// Contact of the glass, in MuJoCo's words.
    pub glass: &'static str,
    /// Pad of a finger that is as pointed as the model has it, m.
    pub point_m: f64,
    /// A touch is felt from this force on, N.
    pub threshold_n: f64,
    /// Spread of the panel and the pad, along u and v, m.
    pub panel_m: [f64; 2],
    /// Whether that spread has tails (Student's t of four degrees of freedom).
    pub has_tails: bool,
    /// Spread of a joint about what its encoder says, rad.
    pub joint_rad: f64,
    /// Spread of what is commanded from touch to touch, rad; it is logged.
    pub jitter_rad: f64,
    /// Dirt is at most so large, in sigmas.
    pub dirt_sigmas: f64,
    /// Fewest and most pieces of dirt.
    pub dirt: [usize; 2],
    /// Plans of touches.
    pub plans: Plans,
}

impl Physics {
    /// Of a generator, in a case of this seed.
    pub fn of(generator: Generator, seed: u64) -> Self {
        match generator {
            Generator::Lean => Self::lean(),
            Generator::Worn => Self::worn(&mut StdRng::seed_from_u64(seed ^ 0x5EED_0F00)),
        }
    }

    /// [`Generator::Lean`].
    pub fn lean() -> Self {
        Self {
            generator: Generator::Lean,
            mass_factors: [1.0; 6],
            servo_nm_per_rad: 30.0,
            servo: Servo::Fed,
            friction_nm: 0.09,
            friction_shares: [0.3, 1.0],
            glass: r#"condim="3" friction="0.3 0.002 0.0001" solref="0.006 1" solimp="0.95 0.99 0.0003""#,
            point_m: 2e-4,
            threshold_n: 0.05,
            panel_m: [0.9e-3; 2],
            has_tails: false,
            joint_rad: 0.5e-3,
            jitter_rad: 0.0,
            dirt_sigmas: 0.2,
            dirt: [5, 8],
            plans: Plans {
                grid: [8, 5],
                scattered: false,
                repeats: [4, 3],
                places: 24,
                heights_m: &[0.0, 0.04, 0.08],
                payloads_kg: [&[0.0], &[0.0, 0.25]],
                shuffled: true,
            },
        }
    }

    /// [`Generator::Worn`].
    fn worn(random: &mut StdRng) -> Self {
        let servo = if random.random_bool(0.7) {
            Servo::Integral { per_s: random.random_range(0.5..3.0) }
        } else {
            Servo::Proportional
        };
        Self {
            generator: Generator::Worn,
            mass_factors: std::array::from_fn(|_| random.random_range(0.8..4.0 / 3.0)),
            servo_nm_per_rad: random.random_range(30.0..70.0),
            servo,
            friction_nm: 0.12,
            friction_shares: [0.1, 0.8],
            glass: r#"condim="3" friction="0.7 0.005 0.0001" solref="0.015 1" solimp="0.9 0.97 0.0008""#,
            point_m: 6e-4,
            threshold_n: 0.15,
            panel_m: [0.6e-3, 1.1e-3],
            has_tails: true,
            joint_rad: 0.8e-3,
            jitter_rad: 2e-3,
            dirt_sigmas: 0.25,
            dirt: [8, 13],
            plans: Plans {
                grid: [9, 4],
                scattered: true,
                repeats: [3, 3],
                places: 20,
                heights_m: &[0.0, 0.06],
                payloads_kg: [&[0.0], &[0.0, 0.4]],
                shuffled: false,
            },
        }
    }

    /// True names of what servos and masses do in every case, whatever else is hidden: a proportional servo
    /// gives way, friction holds all of them back, and links weigh other than described. `id@site`.
    pub fn usual_names(&self, joints: &[String], links: &[String]) -> Vec<String> {
        let mut names: Vec<String> = joints.iter().map(|joint| format!("stiction@{joint}")).collect();
        let masses = links.iter().zip(self.mass_factors).enumerate();
        names.extend(masses.filter(|(_, (_, factor))| (factor - 1.0).abs() >= OTHER_MASS).map(
            |(l, (link, _))| {
                let kind = if l + 1 == links.len() { "payload-mass" } else { "link-mass" };
                format!("{kind}@{link}")
            },
        ));
        if !matches!(self.servo, Servo::Integral { .. }) {
            names.push("servo-droop@".to_owned());
            names.extend(joints.iter().map(|joint| format!("servo-droop@{joint}")));
        }
        names
    }

    /// Gain of the sum of a servo, 1/s; zero of one that has none.
    pub fn integral_per_s(&self) -> f64 {
        if let Servo::Integral { per_s } = self.servo { per_s } else { 0.0 }
    }

    /// Noise of the panel along each axis, in units of its spread: a standard normal number, or one with
    /// tails of the same spread.
    pub fn noise(&self, random: &mut StdRng) -> f64 {
        let normal = normal(random);
        if !self.has_tails {
            return normal;
        }
        let square: f64 = (0..4).map(|_| self::normal(random).powi(2)).sum();
        // Student's t of four degrees has the variance two.
        normal / (square / 4.0).max(1e-3).sqrt() / std::f64::consts::SQRT_2
    }
}

/// A standard normal number (Box and Muller 1958).
pub fn normal(random: &mut StdRng) -> f64 {
    let (a, b): (f64, f64) = (random.random::<f64>().max(1e-300), random.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_with_tails_spreads_as_said_and_reaches_further() {
        let mut random = StdRng::seed_from_u64(2);
        let worn = Physics::of(Generator::Worn, 2);
        let drawn: Vec<f64> = (0..40_000).map(|_| worn.noise(&mut random)).collect();
        let variance = drawn.iter().map(|d| d * d).sum::<f64>() / drawn.len() as f64;
        assert!((variance - 1.0).abs() < 0.15, "{variance}");
        let far = drawn.iter().filter(|d| d.abs() > 4.0).count();
        assert!(far > 50, "{far} beyond four standard deviations");
    }

    #[test]
    fn a_generator_with_other_choices_differs_from_case_to_case() {
        let [a, b] = [1, 2].map(|seed| Physics::of(Generator::Worn, seed));
        assert_ne!(a.mass_factors, b.mass_factors);
        assert_eq!(Physics::of(Generator::Lean, 1), Physics::of(Generator::Lean, 2));
    }
}

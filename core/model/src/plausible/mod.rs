//! Which numbers can be: the plausible range of every quantity that is read from a file, in one
//! place, with the reason for it. Every reader asks here, so that meters which are millimeters and
//! radians which are degrees are refused with words instead of being computed with.
//!
//! Ranges are generous: what a robot on a table, of whatever make, can be and be measured with lies
//! inside. What is wrong by a factor of a hundred or a thousand lies outside.

mod quantities;

use std::fmt;

pub use quantities::*;

/// A quantity with the range in which it can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// What it is, for people, as in "joint angle".
    pub name: &'static str,
    /// Its unit, as in "m"; empty for a plain number.
    pub unit: &'static str,
    /// Smallest value that can be.
    pub least: f64,
    /// Largest value that can be.
    pub most: f64,
    /// Why not beyond, for people.
    pub reason: &'static str,
    /// Units that are confused with it.
    pub confused: &'static [Confused],
}

/// A unit that is confused with the right one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confused {
    /// Its name, as in "millimeters".
    pub name: &'static str,
    /// How many of it make one of the right unit.
    pub factor: f64,
    /// What the right unit is called, as in "meters".
    pub right: &'static str,
}

/// A number that cannot be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Implausible {
    /// What it is said to be.
    pub quantity: Quantity,
    /// The number.
    pub value: f64,
}

impl Quantity {
    /// Whether a value can be; not so for one that is not finite.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.least && value <= self.most
    }

    /// Refuses a value that cannot be.
    ///
    /// # Errors
    /// With the value, its range and the likely cause.
    pub fn check(&self, value: f64) -> Result<(), Implausible> {
        if self.contains(value) { Ok(()) } else { Err(Implausible { quantity: *self, value }) }
    }

    /// Refuses the first of several values that cannot be.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_all<'a>(&self, values: impl IntoIterator<Item = &'a f64>) -> Result<(), Implausible> {
        values.into_iter().try_for_each(|value| self.check(*value))
    }

    /// The same with another range, where a rig, a screen or an image knows better.
    pub fn within(self, least: f64, most: f64, reason: &'static str) -> Self {
        Self { least, most, reason, ..self }
    }
}

impl Implausible {
    /// Units that the number may be in: those that make it plausible.
    pub fn seems(&self) -> impl Iterator<Item = Confused> + '_ {
        let usual = |value: f64| self.quantity.contains(value);
        self.quantity.confused.iter().copied().filter(move |unit| usual(self.value / unit.factor))
    }
}

impl fmt::Display for Implausible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Quantity { name, unit, least, most, reason, .. } = self.quantity;
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let value = Shown(self.value);
        write!(
            f,
            "{value}{unit} cannot be {name}, which is {} to {}{unit} ({reason})",
            Shown(least),
            Shown(most)
        )?;
        let seems: Vec<Confused> = self.seems().collect();
        match seems.first() {
            Some(Confused { right, .. }) => {
                let names: Vec<&str> = seems.iter().map(|unit| unit.name).collect();
                write!(f, "; it looks like {}, where {right} belong", names.join(" or "))
            }
            None => Ok(()),
        }
    }
}

impl std::error::Error for Implausible {}

/// A number as short as it can be told: at most four decimals, powers of ten where it is long.
#[derive(Clone, Copy, Debug)]
struct Shown(f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-4..1e7).contains(&size) {
            return write!(f, "{:.3e}", self.0);
        }
        let text = format!("{:.4}", self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_cannot_be_says_its_range_and_what_it_seems() {
        let wrong = TARGET_M.check(446.0).expect_err("millimeters");
        assert_eq!(
            wrong.to_string(),
            "446 m cannot be a coordinate of a point sent to the arm, which is -5 to 5 m (no arm on a table \
             reaches farther); it looks like millimeters or centimeters, where meters belong"
        );
        let wrong = JOINT_ANGLE_RAD.check(90.0).expect_err("degrees");
        assert!(wrong.to_string().ends_with("it looks like degrees, where radians belong"), "{wrong}");
        let wrong = JOINT_ANGLE_RAD.check(1e9).expect_err("nonsense");
        assert!(wrong.to_string().starts_with("1.000e9 rad cannot be"), "{wrong}");
        assert_eq!(wrong.seems().count(), 0);
        assert!(
            PAYLOAD_KG
                .check(-5.0)
                .expect_err("negative")
                .to_string()
                .starts_with("-5 kg cannot be a payload")
        );
        let grams = PAYLOAD_KG.check(250.0).expect_err("grams");
        assert_eq!(grams.seems().map(|unit| unit.name).collect::<Vec<_>>(), ["grams"]);
    }

    #[test]
    fn what_is_no_number_cannot_be() {
        for wild in [f64::NAN, f64::INFINITY, -1e308] {
            assert!(TEMPERATURE_C.check(wild).is_err());
        }
        assert!(TEMPERATURE_C.check_all(&[20.0, 70.0]).is_ok());
        assert_eq!(TEMPERATURE_C.check_all(&[20.0, 700.0]).map_err(|wrong| wrong.value), Err(700.0));
    }
}

//! How well values of effects that were fitted together are known together.
//!
//! Each alone is known badly where data can hardly tell them apart; what they do together is known well. An
//! arm of eighty effects that touches place to a millimeter would be unknown by a centimeter if each effect
//! counted alone.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::contents::{Contents, ModelEffect};

/// Effects that were fitted together, and the covariance of all their values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Together {
    /// The tip whose arm they were found on; `None` for effects on the eyes alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// `id@site` of the effects.
    effects: Vec<String>,
    /// Values of each.
    counts: Vec<usize>,
    /// Covariance of all values in turn, units of the parameters: the lower triangle, row by row.
    covariance: Vec<f64>,
}

impl Together {
    /// Of effects in the order of `covariance`, which is that of all their values in turn. `None` when it is
    /// of another size.
    pub fn new(effects: &[ModelEffect], covariance: &DMatrix<f64>) -> Option<Self> {
        let counts: Vec<usize> = effects.iter().map(|effect| effect.values.len()).collect();
        let n: usize = counts.iter().sum();
        if covariance.shape() != (n, n) {
            return None;
        }
        Some(Self {
            tip: effects.first()?.tip.clone(),
            effects: effects.iter().map(ModelEffect::name).collect(),
            counts,
            covariance: (0..n).flat_map(|r| (0..=r).map(move |c| short(covariance[(r, c)]))).collect(),
        })
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let n: usize = self.counts.iter().sum();
        if self.counts.len() != self.effects.len() || self.covariance.len() != n * (n + 1) / 2 {
            return Err(format!(
                "{} effects that were fitted together have a covariance of {} numbers: a number was changed or \
                 damaged; search the gap and write the file again",
                self.effects.len(),
                self.covariance.len()
            ));
        }
        match self.covariance.iter().find(|number| !number.is_finite()) {
            Some(number) => {
                Err(format!("the covariance of effects that were fitted together holds {number}"))
            }
            None => Ok(()),
        }
    }

    /// Where the values of an effect begin, and how many they are; `None` when it is not among them.
    fn values_of(&self, effect: &ModelEffect) -> Option<(usize, usize)> {
        let name = effect.name();
        let at = self.effects.iter().position(|other| *other == name).filter(|_| self.tip == effect.tip)?;
        Some((self.counts[..at].iter().sum(), self.counts[at]))
            .filter(|(_, count)| *count == effect.values.len())
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        let (row, column) = (row.max(column), row.min(column));
        self.covariance[row * (row + 1) / 2 + column]
    }
}

/// Seven digits say enough, and a file of thousands of numbers stays small.
fn short(number: f64) -> f64 {
    format!("{number:.6e}").parse().unwrap_or(number)
}

impl Contents {
    /// Covariance of all values of these effects (numbers among [`Self::effects`]) in turn; zero for those
    /// whose covariance nobody knows.
    pub(super) fn covariance_of(&self, effects: &[usize]) -> DMatrix<f64> {
        let starts: Vec<usize> = effects
            .iter()
            .scan(0, |next, i| {
                let start = *next;
                *next += self.effects[*i].values.len();
                Some(start)
            })
            .collect();
        let n = effects.iter().map(|i| self.effects[*i].values.len()).sum();
        let mut covariance = DMatrix::zeros(n, n);
        for (start, i) in starts.iter().zip(effects) {
            if let Some(own) = self.effects[*i].covariance_of_values() {
                covariance.view_mut((*start, *start), own.shape()).copy_from(&own);
            }
        }
        for together in &self.together {
            let of = |(start, i): (&usize, &usize)| {
                let effect = self.effects.get(*i).filter(|effect| self.is_once(effect))?;
                together.values_of(effect).map(|(from, count)| (*start, from, count))
            };
            let known: Vec<_> = starts.iter().zip(effects).filter_map(of).collect();
            for (row, row_from, rows) in &known {
                for (column, column_from, columns) in &known {
                    for (r, c) in (0..*rows).flat_map(|r| (0..*columns).map(move |c| (r, c))) {
                        covariance[(row + r, column + c)] = together.at(row_from + r, column_from + c);
                    }
                }
            }
        }
        covariance
    }

    /// Of an effect that was added twice nobody knows which part was fitted with others.
    fn is_once(&self, effect: &ModelEffect) -> bool {
        let same = |other: &&ModelEffect| {
            (&other.id, &other.site, &other.tip) == (&effect.id, &effect.site, &effect.tip)
        };
        self.effects.iter().filter(same).count() == 1
    }
}

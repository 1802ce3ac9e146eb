//! Which cases a test is made of.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use crate::design::Design;
use crate::physics::Generator;
use crate::recipe::{Family, Recipe};
use crate::secret::Kind;

/// Sizes of single effects, in sigmas.
pub const SIZES: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 10.0];
/// A robot that is a little off everywhere is so in so many ways, fewest and most …
pub(crate) const CROWD: [usize; 2] = [12, 20];
/// … each of a size between these, sigmas.
pub(crate) const CROWD_SIGMAS: [f64; 2] = [0.5, 2.5];

/// Cases of robots that are a little off everywhere, beside so many others.
pub(crate) fn crowds(cases: usize) -> usize {
    cases.div_ceil(10)
}

/// A size of one of a crowd, sigmas: small ones are more frequent.
pub(crate) fn crowd_sigmas(random: &mut StdRng) -> f64 {
    let [least, most] = CROWD_SIGMAS;
    least * (most / least).powf(random.random_range(0.0..1.0))
}

/// Cases of every family: of a hundred, 12 without anything hidden (half of them with dirt), 52
/// singles of all kinds and sizes, 14 pairs, 8 triples, 14 with what the library does not have;
/// half of each on the plain plan, half on the rich one. Dirt is in every other case. After them a tenth as many of robots
/// that are a little off everywhere.
pub fn recipes(generator: Generator, cases: usize, seed: u64) -> Vec<Recipe> {
    let mut random = StdRng::seed_from_u64(seed);
    let kinds: Vec<Kind> = Kind::NAMED.iter().copied().filter(|kind| kind.is_hidden_by(generator)).collect();
    let mut named: Vec<Kind> = vec![];
    let mut nameless: Vec<Kind> = vec![];
    let crowds = crowds(cases);
    (0..cases + crowds)
        .map(|number| {
            let share = (number as f64 + 0.5) / cases as f64;
            let family = match share {
                _ if number >= cases => Family::Crowd,
                s if s < 0.12 => Family::Null,
                s if s < 0.64 => Family::Single,
                s if s < 0.78 => Family::Pair,
                s if s < 0.86 => Family::Triple,
                _ => Family::OffLibrary,
            };
            let design = if number % 2 == 0 { Design::Plain } else { Design::Rich };
            let size_sigmas = match family {
                Family::Null | Family::Crowd => 0.0,
                Family::Single => SIZES[(number / 2) % SIZES.len()],
                Family::OffLibrary => [2.0, 3.0, 5.0][random.random_range(0..3)],
                _ => [1.5, 2.0, 3.0][random.random_range(0..3)],
            };
            // Every kind in its turn, in an order drawn by chance.
            let kind = match family {
                Family::Single => Some(next(&mut named, &kinds, design, &mut random)),
                Family::OffLibrary => Some(next(&mut nameless, Kind::NAMELESS, design, &mut random)),
                _ => None,
            };
            Recipe {
                number,
                generator,
                family,
                design,
                dirt: family != Family::Crowd && (number / 2) % 2 == 1,
                size_sigmas,
                kind,
                seed: random.random(),
            }
        })
        .collect()
}

fn next(waiting: &mut Vec<Kind>, all: &[Kind], design: Design, random: &mut StdRng) -> Kind {
    loop {
        if waiting.is_empty() {
            waiting.extend(all);
        }
        let fitting: Vec<usize> = (0..waiting.len())
            .filter(|&i| design == Design::Rich || waiting[i].shows_from_one_side())
            .collect();
        match fitting.len() {
            // Only kinds are left that this plan cannot show: they wait for another case.
            0 => waiting.extend(all),
            n => return waiting.swap_remove(fitting[random.random_range(0..n)]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mix_has_every_family_plan_and_kind() {
        let recipes = recipes(Generator::Lean, 200, 3);
        let count = |family| recipes.iter().filter(|recipe| recipe.family == family).count();
        assert_eq!((count(Family::Null), count(Family::Crowd)), (24, 20));
        assert!(count(Family::Single) > 90 && count(Family::Pair) > 20 && count(Family::Triple) > 10);
        let named = Kind::NAMED.iter().filter(|kind| kind.is_hidden_by(Generator::Lean));
        for kind in named.chain(Kind::NAMELESS) {
            assert!(recipes.iter().any(|recipe| recipe.kind == Some(*kind)), "{kind:?}");
        }
        let plain_backlash =
            recipes.iter().any(|r| r.kind == Some(Kind::Backlash) && r.design == Design::Plain);
        assert!(!plain_backlash, "one side cannot show it");
    }
}

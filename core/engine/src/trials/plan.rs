//! What an experiment is, and the attempts it has.

use plumbline_grasp::{HandChoice, Method};
use serde::{Deserialize, Serialize};

/// Version of the files.
pub const FORMAT: u32 = 1;
/// An experiment has no more attempts: it would take a robot half a year.
const MOST_ATTEMPTS: usize = 20_000;
/// Names of twins and things are no longer, letters.
const LONGEST_NAME: usize = 200;
/// Things lie no farther from the robot than this, m.
const FARTHEST_M: f64 = 10.0;
/// A person puts a thing this near to where it belongs, m per axis (standard deviation).
const PLACING_M: f64 = 0.002;

/// What stands before the name of a real robot where the name of a scenario would stand.
pub(super) const ROBOT: &str = "robot ";

/// What the experiment is; the same in every shard of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Version of the format.
    pub format: u32,
    /// Name of the twin's scenario; of the real robot its name.
    pub twin: String,
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// Attempts per position and method.
    pub attempts: usize,
    /// x and y, robot frame, m.
    pub positions_m: Vec<[f64; 2]>,
    /// With which hand; experiments of before there was a choice were made with the right one.
    #[serde(default = "right")]
    pub hand: HandChoice,
    /// Class of the object.
    pub object: String,
    /// Of all that is drawn by chance.
    pub seed: u64,
    /// A number that differs between labs that know different things or are of different twins, whatever
    /// these are called; `None`: not told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lab: Option<String>,
}

fn right() -> HandChoice {
    HandChoice::Right
}

/// One attempt of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Trial {
    /// Its number, from 0.
    pub number: usize,
    /// Place in the list of positions.
    pub position: usize,
    /// Of those at this position, from 0.
    pub attempt: usize,
    /// How.
    pub method: Method,
}

impl Experiment {
    /// What of it cannot be; `None`: it can be carried out.
    pub fn is_wrong(&self) -> Option<String> {
        let parts = [self.positions_m.len(), self.methods.len(), self.attempts];
        let all = parts.iter().try_fold(1usize, |all, part| all.checked_mul(*part));
        if all.is_none_or(|all| all > MOST_ATTEMPTS) {
            return Some(format!("more than {MOST_ATTEMPTS} attempts"));
        }
        if [&self.twin, &self.object].iter().any(|name| name.chars().count() > LONGEST_NAME) {
            return Some(format!("a name of more than {LONGEST_NAME} letters"));
        }
        let far = self.positions_m.iter().find(|at_m| at_m.iter().any(|m| !(m.abs() <= FARTHEST_M)));
        far.map(|[x_m, y_m]| format!("a position at {x_m}, {y_m} m"))
    }

    /// Whether it was made on a twin.
    pub fn is_of_twin(&self) -> bool {
        !self.twin.starts_with(ROBOT)
    }

    /// Who made it: "the twin lab", "the robot nico".
    pub fn who(&self) -> String {
        match self.twin.strip_prefix(ROBOT) {
            Some(name) => format!("the robot {name}"),
            None => format!("the twin {}", self.twin),
        }
    }

    /// Whether attempts of both can be put together; what does not tell its lab is taken for one of the same.
    pub fn is_same(&self, other: &Self) -> bool {
        let told = |lab: &Option<String>, or: &Option<String>| lab.clone().or_else(|| or.clone());
        let lab = told(&self.lab, &other.lab);
        Self { lab: lab.clone(), ..self.clone() } == Self { lab, ..other.clone() }
            && (self.lab.is_none() || other.lab.is_none() || self.lab == other.lab)
    }

    /// All attempts, in their order: every method at a position before the next attempt there.
    pub fn trials(&self) -> impl Iterator<Item = Trial> + '_ {
        let of_position = move |position: usize| {
            (0..self.attempts).flat_map(move |attempt| {
                self.methods.iter().enumerate().map(move |(k, method)| Trial {
                    number: (position * self.attempts + attempt) * self.methods.len() + k,
                    position,
                    attempt,
                    method: *method,
                })
            })
        };
        (0..self.positions_m.len()).flat_map(of_position)
    }

    /// Where the thing is put for an attempt (x and y, robot frame, m), off its position as by a person's
    /// hand, and a seed of the attempt's own. Both depend on the experiment's seed and the number alone, so
    /// that parts of an experiment can be made anywhere; all methods get the same.
    pub fn placed(&self, trial: &Trial) -> ([f64; 2], u64) {
        let number = (trial.position * self.attempts + trial.attempt) as u64;
        let mut dice = Dice(self.seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let [x_m, y_m] = self.positions_m[trial.position];
        let at_m = [x_m + PLACING_M * dice.normal(), y_m + PLACING_M * dice.normal()];
        (at_m, dice.next())
    }
}

/// Numbers from a seed (SplitMix64), the same on every machine.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Of mean 0 and standard deviation 1: twelve even numbers added up, so never beyond 6.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| (self.next() >> 11) as f64 / (1u64 << 53) as f64).sum::<f64>() - 6.0
    }
}

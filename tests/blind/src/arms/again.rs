//! The same arm measured again, the way somebody would who was told which experiment to do next.

use plumbline_model::Session;
use rand::Rng;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use strum::EnumString;

use super::cases::{self, Made};
use super::run::{Cell, PACE_S, SWING_RAD, Setup, Visit, visits};
use super::secret::{Kind, Secret};
use crate::case::Case;
use crate::error::BlindError;
use crate::hide::Wish;

/// Between two sessions, s.
const BREAK_S: f64 = 120.0;
/// Cold and warm, s after power-on.
const COLD_S: f64 = 60.0;
const WARM_S: f64 = 2400.0;
/// The weight of the experiment, kg.
const WEIGHT_KG: f64 = 0.25;

/// What is asked for, as the search names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString)]
#[strum(serialize_all = "kebab-case")]
pub enum Ask {
    /// Poses from one side and from the other.
    OtherSide,
    /// With and without a weight.
    Weight,
    /// Poses, and as many in other postures. The tracker sees the marker anywhere, so it need not stand at the same place.
    OtherPosture,
    /// Cold, and again warm.
    ColdAndWarm,
    /// Each three times.
    Repeats,
    /// New ones.
    MorePlaces,
    /// Encoders read once more when the joints have arrived.
    LogLater,
}

impl Ask {
    /// Rows that each place gives.
    fn rows_each(self) -> usize {
        match self {
            Self::Repeats => 3,
            Self::MorePlaces => 1,
            _ => 2,
        }
    }
}

/// An arm of a case, which can be measured again.
pub struct Arm {
    setup: Setup,
    secrets: Vec<Secret>,
    random: StdRng,
    sessions: usize,
    clock_s: f64,
}

impl Arm {
    /// A case as [`super::make`] makes it, and its arm.
    ///
    /// # Errors
    /// When nothing can be hidden.
    pub fn make(wish: &Wish<Kind>) -> Result<(Case, Self), BlindError> {
        let Made { case, setup, secrets, random } = cases::made(wish)?;
        let clock_s = setup.end_s;
        Ok((case, Self { setup, secrets, random, sessions: 1, clock_s }))
    }

    /// Another session, of so many rows, in the frame of the first: the tracker was not moved, horns stay where they
    /// slipped, and the arm is as warm as it is by then. Which poses, nobody said.
    ///
    /// # Errors
    /// When the session cannot be put together.
    pub fn again(&mut self, ask: Ask, rows: usize) -> Result<Session, BlindError> {
        let places = rows.div_ceil(ask.rows_each()).max(1);
        self.sessions += 1;
        let mut bases = self.setup.cells.clone();
        bases.shuffle(&mut self.random);
        let cells: Vec<Cell> =
            bases.iter().cycle().take(places).flat_map(|base| self.cells(ask, base)).collect();
        let visits = self.visits(ask, cells.len());
        let label = format!("session {} ", self.sessions);
        let mut setup = Setup { cells, visits, label, is_repeated: true, ..self.setup.clone() };
        setup.cells.iter_mut().for_each(|cell| cell.set = format!("again {}", self.sessions - 1));
        let met = setup.measure(&self.secrets, &setup.visits, Some(&mut self.random));
        cases::session(&setup, &met)
    }

    /// What lies beside the tables of each of its sessions: name and text.
    pub fn files(&self) -> Vec<(String, String)> {
        cases::files(&self.setup)
    }

    /// How many joints it has.
    pub fn joints(&self) -> usize {
        self.setup.robot.len()
    }

    /// Names of joints that slide.
    pub fn slides(&self) -> Vec<String> {
        self.setup.robot.slides()
    }

    /// The conditions that are compared, at one pose.
    fn cells(&mut self, ask: Ask, base: &Cell) -> Vec<Cell> {
        let base = Cell { payload_kg: 0.0, ..base.clone() };
        let mut elsewhere = || Cell {
            goals_rad: self
                .setup
                .robot
                .parts
                .iter()
                .map(|part| part.stroke() * self.random.random_range(-SWING_RAD..SWING_RAD))
                .collect(),
            ..base.clone()
        };
        match ask {
            Ask::OtherSide => [1.0, -1.0].map(|side| Cell { side: Some(side), ..base.clone() }).into(),
            Ask::Weight => vec![Cell { payload_kg: WEIGHT_KG, ..base.clone() }, base],
            Ask::OtherPosture => vec![elsewhere(), base],
            Ask::MorePlaces => vec![elsewhere()],
            Ask::LogLater => vec![Cell { later: true, ..base.clone() }, base],
            Ask::ColdAndWarm | Ask::Repeats => vec![base],
        }
    }

    /// When each pose is visited.
    fn visits(&mut self, ask: Ask, cells: usize) -> Vec<Visit> {
        let mut all = if ask == Ask::ColdAndWarm {
            // Somebody switched it off, and let it cool.
            let mut cold = visits(cells, 1, COLD_S, &mut self.random);
            cold.extend(visits(cells, 1, WARM_S, &mut self.random));
            cold
        } else {
            let repeats = if ask == Ask::Repeats { 3 } else { 1 };
            visits(cells, repeats, self.clock_s + BREAK_S, &mut self.random)
        };
        let first_s = self.setup.end_s;
        let from_s = self.clock_s.max(first_s) + BREAK_S;
        for (k, visit) in all.iter_mut().enumerate() {
            visit.over = (from_s + PACE_S * k as f64) / first_s;
        }
        self.clock_s = all.last().map_or(self.clock_s, |visit| visit.t_secs);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Plan;
    use crate::recipe::Family;

    fn arm(kind: Kind) -> (Case, Arm) {
        let mut wish = Wish::of(Family::Single, Plan::Plain, 2.0, Some(kind));
        wish.seed = 5;
        Arm::make(&wish).expect("an arm")
    }

    #[test]
    fn an_experiment_has_the_rows_and_the_conditions_that_were_asked_for() {
        for (ask, rows) in
            [(Ask::Weight, 20), (Ask::OtherSide, 20), (Ask::Repeats, 30), (Ask::MorePlaces, 20)]
        {
            let (_, mut arm) = arm(Kind::JointScale);
            let session = arm.again(ask, rows).expect("a session");
            let poses = session.poses.expect("poses");
            let all: Vec<_> = poses.rows().collect();
            assert_eq!(all.len(), rows, "{ask:?}");
            let weights = all.iter().filter(|row| row.payload_kg == Some(WEIGHT_KG)).count();
            assert_eq!(weights, if ask == Ask::Weight { 10 } else { 0 }, "{ask:?}");
            let sides = all.iter().filter(|row| row.approach.as_deref() == Some("minus")).count();
            assert_eq!(sides, if ask == Ask::OtherSide { 10 } else { 0 }, "{ask:?}");
        }
    }

    #[test]
    fn a_horn_that_slipped_has_slipped_in_every_later_session_cold_or_warm() {
        let (_, mut arm) = arm(Kind::SlippedHorn);
        for ask in [Ask::ColdAndWarm, Ask::MorePlaces, Ask::ColdAndWarm] {
            let visits = arm.visits(ask, 10);
            assert!(visits.iter().all(|visit| visit.over > 1.0), "{ask:?}");
        }
        let visits = arm.visits(Ask::ColdAndWarm, 10);
        assert!(
            visits.iter().any(|visit| visit.t_secs < 200.0)
                && visits.iter().any(|visit| visit.t_secs > WARM_S)
        );
    }

    #[test]
    fn an_encoder_that_is_read_later_reads_where_the_joint_is() {
        let mut wish = Wish::of(Family::Single, Plan::Rich, 5.0, Some(Kind::EarlyLog));
        wish.seed = 5;
        let (_, mut arm) = Arm::make(&wish).expect("an arm");
        let session = arm.again(Ask::LogLater, 20).expect("a session");
        let poses = session.poses.expect("poses");
        let lag = |row: &plumbline_model::session::PoseRow| -> f64 {
            let pairs = row.commanded_rad.iter().zip(&row.encoder_rad);
            pairs.filter_map(|(sent, read)| Some((sent.as_ref()? - read.as_ref()?).abs())).sum()
        };
        let mut lags: Vec<f64> = poses.rows().map(|row| lag(&row)).collect();
        lags.sort_by(f64::total_cmp);
        assert!(lags[19] > 3.0 * lags[9], "half of them were read too early: {lags:?}");
    }
}

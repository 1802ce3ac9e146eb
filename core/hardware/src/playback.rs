//! What all that plays numbered pairs shares: where it is, how fast it goes on, what it could not read.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use plumbline_model::Stamp;

use crate::error::{PairProblem, SourceError};
use crate::replay::{Pace, Replay};
use crate::source::{Counters, Next, Report};

/// Whose turn it is.
pub(crate) enum Turn {
    /// Nothing is due yet.
    NotYet,
    /// All were played, and it does not begin again.
    End,
    /// The pair of this number.
    Pair(usize),
}

/// The course of a recording that is played.
pub(crate) struct Playback {
    pairs: usize,
    replay: Replay,
    pace: Pace,
    position: usize,
    counters: Counters,
    reports: Vec<Report>,
    /// Pairs that failed: each is told once, not once a round.
    told: HashSet<usize>,
    /// Pairs in a row that could not be used, and what was wrong with the first.
    failed_in_a_row: usize,
    first_failure: String,
}

impl Playback {
    /// Of so many pairs, from the first one on; `reports` is what is to be told of them already.
    pub fn new(pairs: usize, replay: Replay, reports: Vec<Report>) -> Result<Self, SourceError> {
        Ok(Self {
            pairs,
            replay: replay.check()?,
            pace: Pace::start(),
            position: 0,
            counters: Counters::default(),
            reports,
            told: HashSet::new(),
            failed_in_a_row: 0,
            first_failure: String::new(),
        })
    }

    /// Which pair is to be read now. It stays its turn until it is delivered or skipped.
    pub fn turn(&self) -> Turn {
        if !self.pace.is_due() {
            return Turn::NotYet;
        }
        match self.position {
            position if position < self.pairs => Turn::Pair(position),
            _ if self.replay.looping && self.pairs > 0 => Turn::Pair(0),
            _ => Turn::End,
        }
    }

    /// The pair whose turn it was is handed out; `recorded_hz`: how soon the next one followed it.
    pub fn deliver(&mut self, index: usize, recorded_hz: f64) -> Stamp {
        self.position = index + 1;
        self.failed_in_a_row = 0;
        self.pace.advance(self.replay.period(recorded_hz));
        let seq = self.counters.delivered;
        self.counters.delivered += 1;
        Stamp { seq, captured_at: Instant::now() }
    }

    /// The pair whose turn it was cannot be used. The next one is tried in the next call, so that no call
    /// reads two.
    ///
    /// # Errors
    /// When none of them can be used.
    pub fn skip(&mut self, index: usize, pair: String, problem: PairProblem) -> Result<Next, SourceError> {
        self.position = index + 1;
        self.counters.skipped += 1;
        if self.failed_in_a_row == 0 {
            self.first_failure = problem.to_string();
        }
        self.failed_in_a_row += 1;
        if self.told.insert(index) {
            self.reports.push(Report::Skipped { pair, problem });
        }
        if self.failed_in_a_row >= self.pairs {
            let first = self.first_failure.clone();
            return Err(SourceError::NothingUsable { pairs: self.pairs, first });
        }
        Ok(Next::NotYet)
    }

    /// Goes on at another pair, at once.
    pub fn seek(&mut self, index: usize) -> Result<(), SourceError> {
        if index >= self.pairs {
            return Err(SourceError::NoSuchPair { index, pairs: self.pairs });
        }
        self.position = index;
        self.pace.restart();
        Ok(())
    }

    /// There are so many pairs now.
    pub fn grow(&mut self, pairs: usize) {
        self.pairs = self.pairs.max(pairs);
    }

    /// Goes on in another way, at once.
    pub fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError> {
        self.replay = replay.check()?;
        self.pace.restart();
        Ok(())
    }

    pub fn tell(&mut self, report: Report) {
        self.reports.push(report);
    }

    pub fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    pub fn pairs(&self) -> usize {
        self.pairs
    }

    pub fn replay(&self) -> Replay {
        self.replay
    }

    pub fn position(&self) -> usize {
        self.position
    }

    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Time until a pair is due.
    pub fn wait(&self) -> Duration {
        self.pace.wait()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn played(playback: &mut Playback) -> Vec<usize> {
        let mut order = vec![];
        while let Turn::Pair(index) = playback.turn() {
            playback.deliver(index, 30.0);
            order.push(index);
        }
        order
    }

    #[test]
    fn every_pair_has_its_turn_once() {
        let mut playback = Playback::new(3, Replay::ONCE, vec![]).expect("a rate");
        assert_eq!(played(&mut playback), [0, 1, 2]);
        assert!(matches!(playback.turn(), Turn::End));
        playback.seek(1).expect("it is there");
        assert_eq!(played(&mut playback), [1, 2]);
        assert!(playback.seek(3).is_err());
    }

    #[test]
    fn nothing_is_played_without_end_of_nothing() {
        let playback = Playback::new(0, Replay { looping: true, ..Replay::ONCE }, vec![]).expect("a rate");
        assert!(matches!(playback.turn(), Turn::End));
    }

    #[test]
    fn what_cannot_be_read_is_told_once_and_only_when_all_fail_is_it_an_error() {
        let looping = Replay { looping: true, ..Replay::ONCE };
        let mut playback = Playback::new(2, looping, vec![]).expect("a rate");
        let problem = || PairProblem::EyesDiffer { left: (1, 1), right: (2, 2) };
        for _round in 0..3 {
            assert!(playback.skip(0, "first".to_owned(), problem()).is_ok());
            playback.deliver(1, 30.0);
        }
        assert_eq!(playback.take_reports().len(), 1);
        assert_eq!((playback.counters().delivered, playback.counters().skipped), (3, 3));
        assert!(playback.skip(0, "first".to_owned(), problem()).is_ok());
        assert!(playback.skip(1, "second".to_owned(), problem()).is_err());
    }
}

//! Pairs from memory: synthetic worlds, tests, demonstrations.

use std::time::{Duration, Instant};

use plumbline_model::{Stamp, StereoFrame};

use crate::error::SourceError;
use crate::replay::{Pace, Replay};
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, SourceKind, StereoSource};

/// Delivers prepared pairs, each with a fresh stamp.
pub struct MemorySource {
    title: String,
    pairs: Vec<StereoFrame>,
    replay: Replay,
    pace: Pace,
    position: usize,
    counters: Counters,
}

impl MemorySource {
    /// A source from pairs; their stamps are replaced at delivery.
    pub fn new(
        title: impl Into<String>,
        pairs: Vec<StereoFrame>,
        replay: Replay,
    ) -> Result<Self, SourceError> {
        let replay = replay.check()?;
        Ok(Self {
            title: title.into(),
            pairs,
            replay,
            pace: Pace::start(),
            position: 0,
            counters: Counters::default(),
        })
    }
}

impl StereoSource for MemorySource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        if !self.pace.is_due() {
            return Ok(Next::NotYet);
        }
        if self.position >= self.pairs.len() && self.replay.looping {
            self.position = 0;
        }
        let Some(pair) = self.pairs.get(self.position) else { return Ok(Next::End) };
        let mut frame = pair.clone();
        frame.stamp = Stamp { seq: self.counters.delivered, captured_at: Instant::now() };
        self.position += 1;
        self.counters.delivered += 1;
        self.pace.advance(self.replay.period(Replay::USUAL_RATE_HZ));
        Ok(Next::Pair(frame))
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Memory,
            title: self.title.clone(),
            image_size: self.pairs.first().map(|pair| pair.left.dimensions()),
            rate_hz: self.replay.rate_hz(Replay::USUAL_RATE_HZ),
            pair_count: Some(self.pairs.len()),
        }
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        Vec::new()
    }

    fn wait_hint(&self) -> Duration {
        self.pace.wait()
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        Some(self)
    }
}

impl FiniteSource for MemorySource {
    fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    fn position(&self) -> usize {
        self.position
    }

    fn seek(&mut self, index: usize) -> Result<(), SourceError> {
        if index >= self.pairs.len() {
            return Err(SourceError::NoSuchPair { index, pairs: self.pairs.len() });
        }
        self.position = index;
        self.pace.restart();
        Ok(())
    }

    fn replay(&self) -> Replay {
        self.replay
    }

    fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError> {
        self.replay = replay.check()?;
        self.pace.restart();
        Ok(())
    }
}

//! Pairs from memory: synthetic worlds, tests, demonstrations.

use std::time::Duration;

use plumbline_model::StereoFrame;

use crate::error::SourceError;
use crate::playback::{Playback, Turn};
use crate::replay::Replay;
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, SourceKind, StereoSource};

/// Delivers prepared pairs, each with a fresh stamp.
pub struct MemorySource {
    title: String,
    pairs: Vec<StereoFrame>,
    playback: Playback,
}

impl MemorySource {
    /// A source from pairs; their stamps are replaced at delivery.
    pub fn new(
        title: impl Into<String>,
        pairs: Vec<StereoFrame>,
        replay: Replay,
    ) -> Result<Self, SourceError> {
        let playback = Playback::new(pairs.len(), replay, Vec::new())?;
        Ok(Self { title: title.into(), pairs, playback })
    }
}

impl StereoSource for MemorySource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        let index = match self.playback.turn() {
            Turn::NotYet => return Ok(Next::NotYet),
            Turn::End => return Ok(Next::End),
            Turn::Pair(index) => index,
        };
        let stamp = self.playback.deliver(index, Replay::USUAL_RATE_HZ);
        Ok(Next::Pair(StereoFrame { stamp, ..self.pairs[index].clone() }))
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Memory,
            title: self.title.clone(),
            image_size: self.pairs.first().map(|pair| pair.left.dimensions()),
            rate_hz: self.playback.replay().rate_hz(Replay::USUAL_RATE_HZ),
            pair_count: Some(self.playback.pairs()),
        }
    }

    fn counters(&self) -> Counters {
        self.playback.counters()
    }

    fn take_reports(&mut self) -> Vec<Report> {
        self.playback.take_reports()
    }

    fn wait_hint(&self) -> Duration {
        self.playback.wait()
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        Some(self)
    }
}

impl FiniteSource for MemorySource {
    fn pair_count(&self) -> usize {
        self.playback.pairs()
    }

    fn position(&self) -> usize {
        self.playback.position()
    }

    fn seek(&mut self, index: usize) -> Result<(), SourceError> {
        self.playback.seek(index)
    }

    fn replay(&self) -> Replay {
        self.playback.replay()
    }

    fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError> {
        self.playback.set_replay(replay)
    }
}

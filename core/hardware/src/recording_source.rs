//! Both eyes of a recording, replayed at the times at which they were captured.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{ImageFormat, ImageReader, RgbImage};
use plumbline_model::{Beside, Eye, StereoFrame};
use plumbline_recording::{Jpeg, RecordedPair, Recording};

use crate::error::{PairProblem, SourceError};
use crate::image_file::{ImageProblem, file_name};
use crate::jpeg;
use crate::playback::{Playback, Turn};
use crate::replay::Replay;
use crate::source::{
    Counters, FiniteSource, Growth, Next, Report, SourceDescription, SourceKind, StereoSource,
};

/// Delivers the pairs of a recording one after the other.
pub struct RecordingSource {
    path: PathBuf,
    recording: Recording,
    playback: Playback,
    recorded_hz: f64,
    image_size: Option<(u32, u32)>,
    /// What is written at its end is shown as it comes.
    followed: Option<Following>,
}

/// When its end was looked at.
#[derive(Clone, Copy, Debug)]
struct Following {
    looked: Instant,
    grew: Instant,
}

/// Whoever writes a recording closes a part of it once a second.
const LOOKS_EVERY: Duration = Duration::from_millis(300);
/// One that has not grown for so long is not written any more.
const SILENT: Duration = Duration::from_secs(10);
/// Who shows it does not stay farther behind its end than this, s.
const BEHIND_S: f64 = 3.0;

impl RecordingSource {
    /// Replays a recording from its first pair on.
    ///
    /// # Errors
    /// When it cannot be read, or holds no images.
    pub fn open(path: &Path, replay: Replay) -> Result<Self, SourceError> {
        let refused = |problem: String| SourceError::Recording { problem };
        let mut recording = Recording::open(path).map_err(|error| refused(error.to_string()))?;
        let pairs = recording.pair_count();
        if pairs == 0 {
            return Err(refused(format!("{} holds no images of two eyes", path.display())));
        }
        let first = recording.pair(0).map_err(|error| refused(error.to_string()))?;
        let image_size = decode(&first.images[0], Eye::Left, "pair 0").ok().map(|image| image.dimensions());
        let mut reports = Vec::new();
        if !recording.is_whole() {
            reports.push(Report::Cut { file: file_name(path) });
        }
        let playback = Playback::new(pairs, replay, reports)?;
        Ok(Self {
            path: path.to_owned(),
            recorded_hz: rate(&recording),
            recording,
            playback,
            image_size,
            followed: None,
        })
    }

    /// How soon the next pair followed this one, Hz.
    fn rate_after(&self, index: usize) -> f64 {
        let captured = |index| self.recording.captured_at(index);
        let apart_s = captured(index).zip(captured(index + 1));
        let apart_s = apart_s.map_or(0.0, |(this, next)| next.duration_since(this).as_secs_f64());
        if apart_s > 0.0 { 1.0 / apart_s } else { self.recorded_hz }
    }

    /// All that there is was shown: looks whether more has come.
    fn wait_for_more(&mut self, following: Following) -> Result<Next, SourceError> {
        let now = Instant::now();
        if now.saturating_duration_since(following.looked) < LOOKS_EVERY {
            return Ok(Next::NotYet);
        }
        let came = self.take_up()?;
        let grew = if came > 0 { now } else { following.grew };
        self.followed = Some(Following { looked: now, grew });
        let behind = (BEHIND_S * self.recorded_hz) as usize;
        if came > behind {
            self.playback.seek(self.playback.pairs() - 1)?;
        }
        let is_silent = now.saturating_duration_since(grew) > SILENT;
        if came == 0 && (self.recording.is_whole() || is_silent) {
            self.followed = None;
            let why = if is_silent { "has not grown for ten seconds" } else { "was finished" };
            let said = format!("{} {why}: this is its end", file_name(&self.path));
            self.playback.tell(Report::Unlike(said));
            return Ok(Next::End);
        }
        Ok(Next::NotYet)
    }

    /// How many pairs have come.
    fn take_up(&mut self) -> Result<usize, SourceError> {
        let came = self.recording.go_on();
        let came = came.map_err(|error| SourceError::Recording { problem: error.to_string() })?;
        self.playback.grow(self.recording.pair_count());
        Ok(came)
    }

    fn is_at_end(&self) -> bool {
        self.playback.position() >= self.playback.pairs()
    }

    fn load(&mut self, index: usize) -> Result<(RecordedPair, [RgbImage; 2]), PairProblem> {
        let name = pair_name(index);
        let damaged = |detail: String| PairProblem::Image {
            eye: Eye::Left,
            problem: ImageProblem::Damaged { file: name.clone(), detail },
        };
        let pair = self.recording.pair(index).map_err(|error| damaged(error.to_string()))?;
        let left = decode(&pair.images[0], Eye::Left, &name)?;
        let right = decode(&pair.images[1], Eye::Right, &name)?;
        if left.dimensions() != right.dimensions() {
            return Err(PairProblem::EyesDiffer { left: left.dimensions(), right: right.dimensions() });
        }
        Ok((pair, [left, right]))
    }
}

fn pair_name(index: usize) -> String {
    format!("pair {index}")
}

/// Pairs per second, on the whole; the usual rate where times do not tell.
fn rate(recording: &Recording) -> f64 {
    let last = recording.pair_count().saturating_sub(1);
    let took = recording.captured_at(0).zip(recording.captured_at(last));
    let took_s = took.map_or(0.0, |(first, last)| last.duration_since(first).as_secs_f64());
    if took_s > 0.0 { last as f64 / took_s } else { Replay::USUAL_RATE_HZ }
}

fn decode(image: &Jpeg, eye: Eye, name: &str) -> Result<RgbImage, PairProblem> {
    let file = name.to_owned();
    if !jpeg::is_complete(&image.0) {
        let problem = ImageProblem::Truncated { file, bytes: image.0.len() };
        return Err(PairProblem::Image { eye, problem });
    }
    let decoded = ImageReader::with_format(Cursor::new(&image.0), ImageFormat::Jpeg).decode();
    let damaged = |error: image::ImageError| PairProblem::Image {
        eye,
        problem: ImageProblem::Damaged { file, detail: error.to_string() },
    };
    Ok(decoded.map_err(damaged)?.into_rgb8())
}

impl StereoSource for RecordingSource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        if let Some(following) = self.followed.filter(|_| self.is_at_end()) {
            return self.wait_for_more(following);
        }
        let index = match self.playback.turn() {
            Turn::NotYet => return Ok(Next::NotYet),
            Turn::End => return Ok(Next::End),
            Turn::Pair(index) => index,
        };
        match self.load(index) {
            Ok((pair, [left, right])) => {
                let recorded_hz = self.rate_after(index);
                Ok(Next::Pair(StereoFrame {
                    stamp: self.playback.deliver(index, recorded_hz),
                    left: Arc::new(left),
                    right: Arc::new(right),
                    time_difference_s: Some(pair.right_later_s),
                    name: Some(pair_name(index)),
                    beside: Beside { jpegs: None, then: Some(pair.eyes) },
                }))
            }
            Err(problem) => self.playback.skip(index, pair_name(index), problem),
        }
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Recording,
            title: format!("recording {}", file_name(&self.path)),
            image_size: self.image_size,
            rate_hz: self.playback.replay().rate_hz(self.recorded_hz),
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
        if self.followed.is_some() && self.is_at_end() { LOOKS_EVERY } else { self.playback.wait() }
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        Some(self)
    }
}

impl FiniteSource for RecordingSource {
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

    fn growth(&self) -> Growth {
        match self.followed {
            Some(_) => Growth::Followed,
            None if self.recording.is_whole() => Growth::Ended,
            None => Growth::Open,
        }
    }

    fn follow(&mut self, on: bool) -> Result<(), SourceError> {
        if !on || self.recording.is_whole() {
            self.followed = None;
            return Ok(());
        }
        self.take_up()?;
        let now = Instant::now();
        self.followed = Some(Following { looked: now, grew: now });
        self.playback.seek(self.playback.pairs() - 1)
    }
}

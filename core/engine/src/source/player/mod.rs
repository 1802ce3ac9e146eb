//! Plays a source: asks it for pairs, holds it, steps, winds, and says how it is doing.

use std::path::Path;
use std::time::Duration;

use plumbline_hardware::{
    Growth, Next, Opener, Replay, ReplayRate, Report, Retrying, SourceError, SourceKind, SourceOptions,
    SourceSpec, SourceStatus as Presence, StereoSource, open_retrying,
};
use plumbline_model::StereoFrame;
use plumbline_model::robot::default_rig;
use plumbline_recording::Whose;

use super::command::Control;
use super::view::{ReplayView, SourceCounters, SourceStatus, SourceView};
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;

/// Single photographs are shown at this rate unless asked otherwise: slow enough to be looked at.
const PHOTOGRAPHS_PER_SECOND: f64 = 4.0;
/// While nothing is due, commands are waited for at most this long.
const IDLE: Duration = Duration::from_secs(1);
/// Of reports that come at once, so many are told one by one.
const TOLD_AT_ONCE: usize = 5;

/// A message to the operator.
pub type Note = (NoticeLevel, String);

/// What asking for a pair gave.
#[derive(Debug)]
pub enum Polled {
    /// A pair to show.
    Frame(StereoFrame),
    /// Nothing; ask again after this time or after a command.
    Wait(Duration),
}

/// Plays one source after the other. Sequence numbers go on over all of them, so that pairs of
/// different sources never have the same stamp.
pub struct Player {
    opener: Opener,
    /// Of which robot recordings may be.
    rig: String,
    source: Option<(SourceSpec, Retrying)>,
    playing: bool,
    ended: bool,
    /// Show one pair although not playing.
    show_one: bool,
    /// Going back to this index; a bad pair there must not send us forward again.
    stepping_back_to: Option<u64>,
    shown: Option<u64>,
    replay: Replay,
    next_seq: u64,
    opened: u64,
}

impl Default for Player {
    fn default() -> Self {
        Self::with_opener(Box::new(open_retrying))
    }
}

impl Player {
    /// A player that opens sources in its own way.
    pub fn with_opener(opener: Opener) -> Self {
        Self {
            opener,
            rig: default_rig().name.clone(),
            source: None,
            playing: false,
            ended: false,
            show_one: false,
            stepping_back_to: None,
            shown: None,
            replay: Replay::default(),
            next_seq: 0,
            opened: 0,
        }
    }

    /// Takes the place of a player that failed: pairs and sources are counted on, so that none has
    /// the stamp of one before.
    pub fn in_place_of_one(mut self, next_seq: u64, opened: u64) -> Self {
        (self.next_seq, self.opened) = (next_seq, opened);
        self
    }

    /// Does what the operator asked; gives messages for him.
    pub fn control(&mut self, control: Control) -> Vec<Note> {
        let result = match control {
            Control::Open(spec) => self.open(spec),
            Control::OpenPaths(paths) => SourceSpec::from_paths(&paths).and_then(|spec| self.open(spec)),
            Control::Close => {
                self.source = None;
                self.shown = None;
                self.opened += 1;
                Ok(())
            }
            Control::Retry => {
                if let Some((_, source)) = &mut self.source {
                    source.retry_now();
                }
                Ok(())
            }
            Control::Play => self.play(),
            Control::Pause => {
                self.playing = false;
                self.follow(false)
            }
            // Who looks back does not want to be taken to the end again.
            Control::Step(by) => self.follow(false).and_then(|()| self.step(by)),
            Control::Seek(index) => self.follow(false).and_then(|()| self.seek(index)),
            Control::Loop(looping) => self.set_replay(Replay { looping, ..self.replay }),
            Control::Follow(on) => self.follow(on),
            Control::PairsPerSecond(rate) => {
                self.set_replay(Replay { rate: ReplayRate::PairsPerSecond(rate), ..self.replay })
            }
        };
        match result {
            Ok(()) => Vec::new(),
            Err(error) => vec![(NoticeLevel::Error, sentence(&error.to_string()))],
        }
    }

    /// Asks for the next pair to show.
    pub fn poll(&mut self) -> (Polled, Vec<Note>) {
        let Some((_, source)) = &mut self.source else { return (Polled::Wait(IDLE), Vec::new()) };
        let lost = matches!(source.status(), Presence::Lost(_));
        if !(self.playing || self.show_one || lost) {
            return (Polled::Wait(IDLE), Vec::new());
        }
        let next = source.next_pair();
        let notes = notes(source.take_reports());
        let wait = source.wait_hint();
        let polled = match next {
            Ok(Next::Pair(frame)) => self.deliver(frame),
            Ok(Next::NotYet) => Polled::Wait(wait.clamp(Duration::from_micros(500), IDLE)),
            Ok(Next::End) => {
                (self.ended, self.playing, self.show_one) = (true, false, false);
                Polled::Wait(IDLE)
            }
            // A source that is retried turns its errors into a loss; this one cannot be.
            Err(error) => {
                self.playing = false;
                return (Polled::Wait(IDLE), vec![(NoticeLevel::Error, sentence(&error.to_string()))]);
            }
        };
        (polled, notes)
    }

    /// Counts sources opened and closed.
    pub fn opened(&self) -> u64 {
        self.opened
    }

    /// How the source is doing.
    pub fn view(&mut self) -> SourceView {
        let (playing, ended, shown, looping) = (self.playing, self.ended, self.shown, self.replay.looping);
        let opened = self.opened;
        let Some((spec, source)) = &mut self.source else {
            return SourceView { opened, ..SourceView::default() };
        };
        let status = match source.status() {
            Presence::Lost(lost) => {
                SourceStatus::Lost { reason: lost.reason, since: lost.since, attempts: lost.attempts }
            }
            Presence::Running if ended => SourceStatus::Ended,
            Presence::Running if playing => SourceStatus::Running,
            Presence::Running => SourceStatus::Paused,
        };
        let growth = source.as_finite().map_or(Growth::Ended, |finite| finite.growth());
        let description = source.describe();
        let counters = source.counters();
        SourceView {
            opened,
            spec: Some(spec.clone()),
            description: description.title,
            status,
            replay: description.pair_count.map(|length| ReplayView {
                position: shown,
                length: length as u64,
                playing,
                looping,
                pairs_per_second: description.rate_hz,
                growth,
            }),
            photographs: is_photographs(description.kind),
            image_size_px: description.image_size,
            counters: SourceCounters {
                delivered: counters.delivered,
                unusable: counters.skipped,
                superseded: counters.superseded,
                unpaired_left: counters.unpaired_left,
                unpaired_right: counters.unpaired_right,
            },
            cameras: None,
        }
    }

    /// Opens a source; if that fails the present one stays.
    fn open(&mut self, spec: SourceSpec) -> Result<(), SourceError> {
        if let SourceSpec::Recording { file, .. } = &spec {
            self.refuse_another_robots(file)?;
        }
        let rate = match spec {
            SourceSpec::Folder(_) | SourceSpec::Folders { .. } => {
                ReplayRate::PairsPerSecond(PHOTOGRAPHS_PER_SECOND)
            }
            SourceSpec::Videos { .. }
            | SourceSpec::Recording { .. }
            | SourceSpec::Cameras { .. }
            | SourceSpec::Twin => ReplayRate::AsRecorded,
        };
        let replay = Replay { rate, looping: true };
        // Cameras can be opened only once, so the same ones must be let go first.
        if self.source.as_ref().is_some_and(|(present, _)| *present == spec) {
            self.source = None;
        }
        let source = (self.opener)(&spec, &SourceOptions { replay, ..SourceOptions::default() })?;
        self.source = Some((spec, source));
        self.opened += 1;
        (self.playing, self.ended, self.show_one) = (true, false, false);
        (self.shown, self.stepping_back_to, self.replay) = (None, None, replay);
        Ok(())
    }

    /// Its places would come out by the eyes and the head of this one. A recording that does not say whose it is,
    /// is played.
    fn refuse_another_robots(&self, file: &Path) -> Result<(), SourceError> {
        let refused = |problem: String| SourceError::Recording { problem };
        let whose = Whose::read(file).map_err(|error| refused(error.to_string()))?;
        match whose.rig.filter(|rig| !rig.is_empty() && *rig != self.rig) {
            None => Ok(()),
            Some(other) => Err(refused(format!(
                "{} is a recording of the robot {other}, and this one is {}: places would come out wrong. Play it \
                 where {other} is set up, or look at it with another program (Foxglove, Rerun)",
                file.display(),
                self.rig
            ))),
        }
    }

    fn deliver(&mut self, mut frame: StereoFrame) -> Polled {
        self.shown =
            self.finite(|finite| finite.position() as u64).map(|position| position.saturating_sub(1));
        if let (Some(wanted), Some(shown)) = (self.stepping_back_to.take(), self.shown)
            && shown > wanted
            && wanted > 0
        {
            // The pair there cannot be read; the one before it may be.
            self.stepping_back_to = Some(wanted - 1);
            match self.wind(wanted - 1) {
                Ok(()) => return Polled::Wait(Duration::ZERO),
                Err(error) => log::warn!("winding back ends here: {error}"),
            }
        }
        self.show_one = false;
        self.ended = false;
        frame.stamp.seq = self.next_seq;
        self.next_seq += 1;
        Polled::Frame(frame)
    }

    fn play(&mut self) -> Result<(), SourceError> {
        if self.ended {
            self.wind(0)?;
        }
        (self.playing, self.ended) = (self.source.is_some(), false);
        Ok(())
    }

    fn step(&mut self, by: i64) -> Result<(), SourceError> {
        let Some(count) = self.finite(|finite| finite.pair_count() as u64) else {
            self.playing = false;
            self.show_one = true;
            return Ok(());
        };
        let target = match self.shown {
            Some(shown) => shown.saturating_add_signed(by).min(count.saturating_sub(1)),
            None => 0,
        };
        self.seek(target)?;
        self.stepping_back_to = (by < 0).then_some(target);
        self.playing = false;
        Ok(())
    }

    fn seek(&mut self, index: u64) -> Result<(), SourceError> {
        self.wind(index)?;
        (self.show_one, self.ended, self.stepping_back_to) = (true, false, None);
        Ok(())
    }

    /// Goes to the end of what is still being written, and on with it.
    fn follow(&mut self, on: bool) -> Result<(), SourceError> {
        self.finite(|finite| finite.follow(on)).unwrap_or(Ok(()))?;
        if self.finite(|finite| finite.growth()) == Some(Growth::Followed) {
            (self.playing, self.ended, self.stepping_back_to) = (true, false, None);
        }
        Ok(())
    }

    fn wind(&mut self, index: u64) -> Result<(), SourceError> {
        self.finite(|finite| finite.seek(usize::try_from(index).unwrap_or(usize::MAX))).unwrap_or(Ok(()))
    }

    fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError> {
        self.finite(|finite| finite.set_replay(replay)).unwrap_or(Ok(()))?;
        self.replay = replay;
        Ok(())
    }

    /// Does something with a source that has a beginning and an end.
    fn finite<T>(&mut self, act: impl FnOnce(&mut dyn plumbline_hardware::FiniteSource) -> T) -> Option<T> {
        self.source.as_mut()?.1.as_finite().map(act)
    }
}

/// Whether the pairs of such a source are photographs rather than a stream in time.
fn is_photographs(kind: SourceKind) -> bool {
    match kind {
        SourceKind::Folder => true,
        SourceKind::Cameras
        | SourceKind::Videos
        | SourceKind::Recording
        | SourceKind::Memory
        | SourceKind::Twin => false,
    }
}

fn notes(reports: Vec<Report>) -> Vec<Note> {
    let more = reports.len().saturating_sub(TOLD_AT_ONCE);
    let mut notes: Vec<Note> = reports
        .iter()
        .take(TOLD_AT_ONCE)
        .map(|report| {
            let level = match report {
                Report::Converted { .. } | Report::Unlike(_) => NoticeLevel::Info,
                Report::Returned { .. } => NoticeLevel::Success,
                Report::Unpaired { .. }
                | Report::Ignored { .. }
                | Report::Cut { .. }
                | Report::Skipped { .. }
                | Report::Lost { .. } => NoticeLevel::Warning,
            };
            let text = match report {
                Report::Lost { .. } | Report::Returned { .. } => format!("The source is {report}."),
                other => sentence(&other.to_string()),
            };
            (level, text)
        })
        .collect();
    if more > 0 {
        notes.push((NoticeLevel::Warning, format!("… and {more} more like these.")));
    }
    notes
}

#[cfg(test)]
mod tests;

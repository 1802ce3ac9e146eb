//! What every source of image pairs offers.

use std::time::Duration;

use plumbline_model::{Eye, StereoFrame};

use crate::error::{PairProblem, SourceError, other};
use crate::image_file::ImageNote;
use crate::replay::Replay;

/// A source of image pairs: cameras, a folder, videos, memory.
///
/// The caller owns the thread and asks again and again; a source never waits for longer than
/// it takes to read one pair.
pub trait StereoSource: Send {
    /// The next pair, if it is due.
    ///
    /// An error means that the source as a whole is gone or broken (a camera unplugged, a
    /// folder deleted). A single bad pair is no error: it is skipped, counted and told in
    /// [`take_reports`](Self::take_reports).
    fn next_pair(&mut self) -> Result<Next, SourceError>;

    /// What this source is, in words and numbers for the operator.
    fn describe(&self) -> SourceDescription;

    /// How many pairs and frames went where since the source was opened.
    fn counters(&self) -> Counters;

    /// What happened since the last call: files without a partner, skipped pairs, notes.
    /// Every kind of note is told once per source, every bad pair once.
    fn take_reports(&mut self) -> Vec<Report>;

    /// How long a caller may sleep after [`Next::NotYet`] without making the next pair late.
    fn wait_hint(&self) -> Duration {
        Duration::from_millis(2)
    }

    /// The source as one with a beginning and an end, if it has them. Cameras have not.
    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        None
    }
}

/// A source that can be counted and wound to a place: a folder, videos, memory.
pub trait FiniteSource {
    /// Number of pairs from beginning to end, bad ones included.
    fn pair_count(&self) -> usize;

    /// Index (from 0) of the pair that is delivered next; `pair_count()` at the end.
    fn position(&self) -> usize;

    /// Makes `index` the next pair and delivers it without waiting for its time.
    fn seek(&mut self, index: usize) -> Result<(), SourceError>;

    /// How it is replayed.
    fn replay(&self) -> Replay;

    /// Changes rate and looping from the next pair on; refuses a rate that is no rate.
    fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError>;

    /// Whether more pairs may come at its end.
    fn growth(&self) -> Growth {
        Growth::Ended
    }

    /// Goes to its end, and on with what comes there; or does so no more. What has ended stays as it is.
    ///
    /// # Errors
    /// When it cannot be read any more.
    fn follow(&mut self, _on: bool) -> Result<(), SourceError> {
        Ok(())
    }
}

/// Whether more pairs may come at the end of a source that has one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Growth {
    /// No.
    #[default]
    Ended,
    /// It was not finished: it may be written still.
    Open,
    /// Yes, and they are shown as they come.
    Followed,
}

/// Answer of a source that is asked for a pair.
#[derive(Clone, Debug)]
pub enum Next {
    /// A pair.
    Pair(StereoFrame),
    /// There is none left, and there will be none without [`FiniteSource::seek`].
    End,
    /// None is due at the moment; ask again, see [`StereoSource::wait_hint`].
    NotYet,
}

/// The kind of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A pair of cameras.
    Cameras,
    /// Image files.
    Folder,
    /// A pair of video files.
    Videos,
    /// `log.mcap` of a session.
    Recording,
    /// Images in memory.
    Memory,
    /// The eyes of the simulated robot.
    Twin,
}

/// What a source is.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceDescription {
    /// The kind.
    pub kind: SourceKind,
    /// One line for the operator, for example `30 pairs in eyes/2026-11-21`.
    pub title: String,
    /// Width and height of the images in pixels, as far as known before the first pair.
    pub image_size: Option<(u32, u32)>,
    /// Pairs per second it aims at; `None` if as fast as it is asked.
    pub rate_hz: Option<f64>,
    /// Number of pairs, `None` for a live source.
    pub pair_count: Option<usize>,
}

/// Where pairs and frames went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Pairs delivered.
    pub delivered: u64,
    /// Pairs skipped because one of their images could not be used.
    pub skipped: u64,
    /// Live pairs that were replaced by a newer one before anybody asked for them.
    pub superseded: u64,
    /// Left frames without a partner of the same time.
    pub unpaired_left: u64,
    /// Right frames without a partner of the same time.
    pub unpaired_right: u64,
}

impl Counters {
    /// Counts one frame of `eye` that found no partner.
    pub(crate) fn count_unpaired(&mut self, eye: Eye) {
        match eye {
            Eye::Left => self.unpaired_left += 1,
            Eye::Right => self.unpaired_right += 1,
        }
    }
}

/// Something the operator should know about a source that goes on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Report {
    /// Files of one eye have no partner in the other.
    #[error("{}", unpaired(*.eye, .files))]
    Unpaired {
        /// The eye that has the files.
        eye: Eye,
        /// Their names, at least one.
        files: Vec<String>,
    },
    /// An image file of a kind that is not read, or whose name tells no eye.
    #[error("{file} is left out: {reason}")]
    Ignored {
        /// File name.
        file: String,
        /// Why, and what to do.
        reason: String,
    },
    /// A pair was skipped; the source goes on with the next.
    #[error("pair {pair} is skipped: {problem}")]
    Skipped {
        /// Name of the pair.
        pair: String,
        /// What is wrong with it.
        problem: PairProblem,
    },
    /// Images had to be converted. Told for the first image of each kind of note.
    #[error("{file}: {note}")]
    Converted {
        /// First file this was seen in.
        file: String,
        /// What was done.
        note: ImageNote,
    },
    /// A recording that was not finished.
    #[error("{file} was cut off: what was recorded in its last second, and after it, is not there")]
    Cut {
        /// File name.
        file: String,
    },
    /// The two videos or cameras are not alike.
    #[error("{0}")]
    Unlike(String),
    /// The source was lost and is retried; told by [`Retrying`](crate::Retrying).
    #[error("lost: {reason}")]
    Lost {
        /// Why.
        reason: String,
    },
    /// The source came back; told by [`Retrying`](crate::Retrying).
    #[error("back after {:.1} s", .after.as_secs_f64())]
    Returned {
        /// How long it was gone.
        after: Duration,
    },
}

/// One sentence, however many files it is about.
fn unpaired(eye: Eye, files: &[String]) -> String {
    /// So many are named.
    const NAMED: usize = 3;
    let partner = other(&eye);
    if let [file] = files {
        return format!("{file} has no partner: there is no {partner} image of that name, so it is left out");
    }
    let named = files.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    let more = files.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!(
        "{} {eye} images have no {partner} image of the same name and are left out: {named}{more}",
        files.len()
    )
}

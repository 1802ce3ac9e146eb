//! A folder of pairs, replayed.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::{Stamp, StereoFrame};

use crate::error::{PairProblem, SourceError};
use crate::folder::{LoadedPair, PairFolder};
use crate::image_file::ImageNote;
use crate::replay::{Pace, Replay};
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, SourceKind, StereoSource};

/// Delivers the pairs of a [`PairFolder`] one after the other.
pub struct FolderSource {
    folder: PairFolder,
    replay: Replay,
    pace: Pace,
    position: usize,
    counters: Counters,
    /// Pairs that failed, and notes that were told: each is reported once, not once a round.
    told_pairs: HashSet<usize>,
    told_notes: HashSet<ImageNote>,
    reports: Vec<Report>,
    /// Pairs in a row that could not be used, and what was wrong with the first.
    failed_in_a_row: usize,
    first_failure: String,
}

impl FolderSource {
    /// Replays a folder from its first pair on.
    pub fn new(folder: PairFolder, replay: Replay) -> Result<Self, SourceError> {
        let replay = replay.check()?;
        Ok(Self {
            reports: folder.reports().to_vec(),
            folder,
            replay,
            pace: Pace::start(),
            position: 0,
            counters: Counters::default(),
            told_pairs: HashSet::new(),
            told_notes: HashSet::new(),
            failed_in_a_row: 0,
            first_failure: String::new(),
        })
    }

    /// The folder that is replayed.
    pub fn folder(&self) -> &PairFolder {
        &self.folder
    }

    /// A file that cannot be read may mean that the whole folder is gone.
    fn check_folders(&self) -> Result<(), SourceError> {
        let (left, right) = self.folder.folders();
        let missing = |path: &Path| SourceError::Lost {
            reason: format!(
                "the folder {} is gone; bring it back, or connect its disk again",
                path.display()
            ),
        };
        match [left, right].into_iter().find(|path| !path.is_dir()) {
            Some(path) => Err(missing(path)),
            None => Ok(()),
        }
    }

    fn frame(&mut self, name: String, pair: LoadedPair) -> StereoFrame {
        for (file, note) in pair.notes {
            if self.told_notes.insert(note) {
                self.reports.push(Report::Converted { file, note });
            }
        }
        let seq = self.counters.delivered;
        self.counters.delivered += 1;
        StereoFrame {
            stamp: Stamp { seq, captured_at: Instant::now() },
            left: Arc::new(pair.left),
            right: Arc::new(pair.right),
            time_difference_s: None,
            name: Some(name),
        }
    }

    fn skip(&mut self, index: usize, pair: String, problem: PairProblem) -> Result<(), SourceError> {
        self.counters.skipped += 1;
        if self.failed_in_a_row == 0 {
            self.first_failure = problem.to_string();
        }
        self.failed_in_a_row += 1;
        if self.told_pairs.insert(index) {
            self.reports.push(Report::Skipped { pair, problem });
        }
        let pairs = self.folder.pairs().len();
        if self.failed_in_a_row >= pairs {
            return Err(SourceError::NothingUsable { pairs, first: self.first_failure.clone() });
        }
        Ok(())
    }
}

impl StereoSource for FolderSource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        if !self.pace.is_due() {
            return Ok(Next::NotYet);
        }
        if self.position >= self.folder.pairs().len() {
            if !self.replay.looping {
                return Ok(Next::End);
            }
            self.position = 0;
        }
        self.check_folders()?;
        let index = self.position;
        self.position += 1;
        let files = &self.folder.pairs()[index];
        let name = files.name.clone();
        match self.folder.load(files) {
            Ok(pair) => {
                self.failed_in_a_row = 0;
                self.pace.advance(self.replay.period(Replay::USUAL_RATE_HZ));
                Ok(Next::Pair(self.frame(name, pair)))
            }
            // The next one is tried in the next call, so that no call reads two pairs.
            Err(problem) => {
                self.skip(index, name, problem)?;
                Ok(Next::NotYet)
            }
        }
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Folder,
            title: self.folder.title(),
            image_size: self.folder.image_size(),
            rate_hz: self.replay.rate_hz(Replay::USUAL_RATE_HZ),
            pair_count: Some(self.folder.pairs().len()),
        }
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    fn wait_hint(&self) -> Duration {
        self.pace.wait()
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        Some(self)
    }
}

impl FiniteSource for FolderSource {
    fn pair_count(&self) -> usize {
        self.folder.pairs().len()
    }

    fn position(&self) -> usize {
        self.position
    }

    fn seek(&mut self, index: usize) -> Result<(), SourceError> {
        let pairs = self.pair_count();
        if index >= pairs {
            return Err(SourceError::NoSuchPair { index, pairs });
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

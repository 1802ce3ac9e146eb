//! A folder of pairs, replayed.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use plumbline_model::StereoFrame;

use crate::error::SourceError;
use crate::folder::{LoadedPair, PairFolder};
use crate::image_file::ImageNote;
use crate::playback::{Playback, Turn};
use crate::replay::Replay;
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, SourceKind, StereoSource};

/// Delivers the pairs of a [`PairFolder`] one after the other.
pub struct FolderSource {
    folder: PairFolder,
    playback: Playback,
    /// Notes that were told: each is reported once, not once a round.
    told_notes: HashSet<ImageNote>,
}

impl FolderSource {
    /// Replays a folder from its first pair on.
    pub fn new(folder: PairFolder, replay: Replay) -> Result<Self, SourceError> {
        let playback = Playback::new(folder.pairs().len(), replay, folder.reports().to_vec())?;
        Ok(Self { folder, playback, told_notes: HashSet::new() })
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

    fn frame(&mut self, index: usize, name: String, pair: LoadedPair) -> StereoFrame {
        for (file, note) in pair.notes {
            if self.told_notes.insert(note) {
                self.playback.tell(Report::Converted { file, note });
            }
        }
        StereoFrame {
            stamp: self.playback.deliver(index, Replay::USUAL_RATE_HZ),
            left: Arc::new(pair.left),
            right: Arc::new(pair.right),
            time_difference_s: None,
            name: Some(name),
            beside: Default::default(),
        }
    }
}

impl StereoSource for FolderSource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        let index = match self.playback.turn() {
            Turn::NotYet => return Ok(Next::NotYet),
            Turn::End => return Ok(Next::End),
            Turn::Pair(index) => index,
        };
        self.check_folders()?;
        let files = &self.folder.pairs()[index];
        let name = files.name.clone();
        match self.folder.load(files) {
            Ok(pair) => Ok(Next::Pair(self.frame(index, name, pair))),
            Err(problem) => self.playback.skip(index, name, problem),
        }
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Folder,
            title: self.folder.title(),
            image_size: self.folder.image_size(),
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

impl FiniteSource for FolderSource {
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

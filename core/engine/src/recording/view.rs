//! Recording, for the window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crate::ground::jobs::JobId;

/// Recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordingView {
    /// Whether it records.
    pub state: RecordingState,
    /// The recording that was finished last, in this run of the program.
    pub last: Option<Arc<Recorded>>,
    /// One is being written as a data set.
    pub exporting: Option<JobId>,
}

impl RecordingView {
    /// Whether it records, or is about to.
    pub fn is_on(&self) -> bool {
        self.state != RecordingState::Off
    }
}

/// Whether it records.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum RecordingState {
    /// No.
    #[default]
    Off,
    /// The file is being made.
    Begins,
    /// Yes.
    On {
        /// The session's folder.
        session: PathBuf,
        /// How much.
        so_far: RecordedSoFar,
    },
    /// What waits is being written.
    Ends,
}

/// How much was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordedSoFar {
    /// For how long.
    pub time: Duration,
    /// Pairs of images.
    pub pairs: u64,
    /// Pairs and messages that are not in it, because the disk or the processor did not keep up, this program itself
    /// included.
    pub dropped: u64,
    /// Bytes of messages.
    pub bytes: u64,
}

/// A recording that was finished.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// The session's folder.
    pub session: PathBuf,
    /// How much.
    pub so_far: RecordedSoFar,
}

impl Recorded {
    /// The recording itself.
    pub fn file(&self) -> PathBuf {
        self.session.join(plumbline_recording::FILE)
    }
}

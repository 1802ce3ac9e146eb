//! The thread that looks: it keeps what it remembers of the eyes from look to look.

use std::sync::Arc;

use image::GrayImage;
use plumbline_drift::{Look, Watcher, WatcherSetup};
use plumbline_model::{Stamp, StereoFrame};

use crate::ground::stage::Stage;
use crate::ground::text::sentence;
use crate::ground::watched::WatchedThread;

/// A pair to look at.
#[derive(Clone, Debug)]
pub struct DriftInput {
    /// Which watch, counted: another one remembers nothing of the one before.
    pub watch: u64,
    /// The pair.
    pub frame: StereoFrame,
    /// What looking rests on.
    pub setup: WatcherSetup,
    /// When it was, on the clock of the course, s.
    pub at_s: f64,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct DriftOutput {
    /// Of which watch.
    pub watch: u64,
    /// When the pair was, s.
    pub at_s: f64,
    /// What was found.
    pub look: Result<Look, DriftFailure>,
}

/// Why nothing came of a look.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DriftFailure(pub String);

/// Keeps what it remembers.
#[derive(Debug, Default)]
pub struct DriftStage {
    watch: u64,
    watcher: Watcher,
}

impl Stage for DriftStage {
    type Input = Arc<DriftInput>;
    type Output = DriftOutput;
    type Key = (u64, u64);
    const THREAD: WatchedThread = WatchedThread::Drift;

    fn stamp(input: &Arc<DriftInput>) -> Stamp {
        input.frame.stamp
    }

    fn key(input: &Arc<DriftInput>) -> Self::Key {
        (input.watch, input.frame.stamp.seq)
    }

    fn process(&mut self, input: Arc<DriftInput>) -> DriftOutput {
        if self.watch != input.watch {
            *self = Self { watch: input.watch, watcher: Watcher::default() };
        }
        let gray = |image| -> GrayImage { image::imageops::grayscale(image) };
        let (left, right) = (gray(&*input.frame.left), gray(&*input.frame.right));
        let look = self.watcher.look(&input.setup, (&left, &right));
        let look = look.map_err(|error| DriftFailure(sentence(&error.to_string())));
        DriftOutput { watch: input.watch, at_s: input.at_s, look }
    }
}

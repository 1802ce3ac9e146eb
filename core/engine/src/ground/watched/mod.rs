//! Watching over the engine's threads: one that ends although nobody asked it to, or gives no sign
//! of life in time, is noticed, told with what it means, and can be started again.
//!
//! A thread runs through [`spawn`] and promises its next sign of life with [`Pulse::promise`]. A
//! panic is caught, logged with the thread's name, and told through the bell; only then is what the
//! thread owned let go, because that may take as long as a servo is silent.

mod fault;
mod pulse;
#[cfg(test)]
mod tests;
mod trial;

use std::panic::AssertUnwindSafe;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

pub use fault::ThreadFault;
pub use pulse::{Pulse, Trouble};
pub use trial::{MadeUpEyes, Strike, Trial};

use super::jobs::panic_message;
use super::workers::start_shared_workers;

/// When a thread is let go, it gets this long to come to its end.
const COMING_TO_ITS_END: Duration = Duration::from_secs(10);

/// The threads that are watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WatchedThread {
    /// Owns the state and gives everybody work.
    Engine,
    /// Connects, previews, jogs and moves; the twin lives in it too.
    Robot,
    /// Waits for cameras and disks.
    Source,
    /// Rectifies and matches.
    Rectify,
    /// Looks for the chessboard.
    Corners,
    /// Measures the point under the mouse.
    Probe,
    /// Detects objects.
    Detect,
    /// Watches drift.
    Drift,
    /// Writes commands down.
    Journal,
}

impl WatchedThread {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Engine,
        Self::Robot,
        Self::Source,
        Self::Rectify,
        Self::Corners,
        Self::Probe,
        Self::Detect,
        Self::Drift,
        Self::Journal,
    ];

    /// Its name in a debugger, in the log and in a panic message.
    pub fn name(self) -> &'static str {
        match self {
            Self::Engine => "engine",
            Self::Robot => "robot",
            Self::Source => "source",
            Self::Rectify => "rectify",
            Self::Corners => "corners",
            Self::Probe => "probe",
            Self::Detect => "detect",
            Self::Drift => "drift",
            Self::Journal => "journal",
        }
    }

    /// What it is to an operator; stands inside a sentence.
    pub fn title(self) -> &'static str {
        match self {
            Self::Engine => "the heart of the program",
            Self::Robot => "what talks to the arm",
            Self::Source => "what brings the images",
            Self::Rectify => "what rectifies and matches the images",
            Self::Corners => "what looks for the chessboard",
            Self::Probe => "what measures points",
            Self::Detect => "what detects objects",
            Self::Drift => "what watches drift",
            Self::Journal => "what writes the journal",
        }
    }

    /// What it means that it ended, and what to do: a sentence.
    pub fn meaning_of_end(self) -> &'static str {
        match self {
            Self::Engine => {
                "The heart of the program has failed inside: nothing that is shown is new, the arm holds its last goal, STOP is pressed, and nothing can be moved from here. What was accepted is safe. Keep the power switch in reach, and start it again."
            }
            Self::Robot => {
                "What talks to the arm has failed inside: the arm holds its last goal, STOP is pressed, and nothing can be moved from here. Keep the power switch in reach, start it again, and then connect."
            }
            Self::Source => {
                "What brings the images has failed inside: the pictures that are shown are old. Start it again."
            }
            Self::Rectify => {
                "What rectifies and matches the images has failed inside: there are no rectified views and no depth. Start it again."
            }
            Self::Corners => {
                "What looks for the chessboard has failed inside: no board is found and nothing is captured by itself. Start it again."
            }
            Self::Probe => "What measures points has failed inside: no point is measured. Start it again.",
            Self::Detect => {
                "What detects objects has failed inside: boxes are not shown any more. Start it again."
            }
            Self::Drift => {
                "What watches drift has failed inside: nobody looks whether places stay where they are. Start it again."
            }
            Self::Journal => {
                "The journal is not written any more: what you do is done, but a report of a mistake will lack it. Look at the disk, then start it again."
            }
        }
    }

    /// What it means that it gives no sign of life, and what to do: a sentence.
    pub fn meaning_of_silence(self) -> &'static str {
        match self {
            Self::Engine => {
                "The heart of the program gives no sign of life: nothing that is shown is new. STOP works. Wait, or close the program; keep the power switch in reach."
            }
            Self::Robot => {
                "What talks to the arm gives no sign of life: STOP was pressed for you, and nothing can be moved from here. Wait, or close the program; keep the power switch in reach."
            }
            Self::Source => {
                "What brings the images gives no sign of life: the pictures that are shown are old. Look at cameras, cables and disk; if it stays so, close the program and start it anew."
            }
            Self::Journal => {
                "The journal waits for the disk: what you do is done, but may not be written down. Look at the disk."
            }
            Self::Rectify | Self::Corners | Self::Probe | Self::Detect | Self::Drift => {
                "A part of the live view is at work on one pair without end: what it shows is old. Wait, or close the program and start it anew."
            }
        }
    }
}

/// What is done about a thread that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WatchCommand {
    /// Starts it again. The robot's is then not connected, and nothing moves.
    StartAgain(WatchedThread),
}

/// A watched thread that runs. Dropped, it is asked to end and waited for, but not for ever.
pub struct Watched {
    pulse: Pulse,
    thread: Option<JoinHandle<()>>,
}

impl Watched {
    /// Says that an end is asked for from now on; called before the thread is cut off.
    pub fn ask_to_end(&self) {
        self.pulse.ask_to_end();
    }

    /// Its signs of life.
    pub fn pulse(&self) -> &Pulse {
        &self.pulse
    }

    /// Whether nothing of it runs any more, so that another can take its place.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.pulse.ask_to_end();
        let Some(thread) = self.thread.take() else { return };
        let until = Instant::now() + COMING_TO_ITS_END;
        while !thread.is_finished() {
            if Instant::now() >= until {
                // Whoever closes the window must not wait for a thread that hangs.
                log::error!("the thread {} does not come to its end and is left", self.pulse.thread().name());
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        // A panic was caught and told.
        let _ = thread.join();
    }
}

/// Runs `work` on a thread of the name, with what it owns. When it panics, or returns although
/// nobody asked it to end, that is told first; then what it owned is dropped.
///
/// # Errors
/// When the system gives no thread.
pub fn spawn<S: Send + 'static>(
    pulse: Pulse,
    mut owned: S,
    work: impl FnOnce(&mut S, &Pulse) + Send + 'static,
) -> std::io::Result<Watched> {
    // Before anything of the engine can ask for one of them.
    start_shared_workers();
    let watching = pulse.clone();
    let thread = std::thread::Builder::new().name(pulse.thread().name().to_owned()).spawn(move || {
        // What it owned is only dropped afterwards, so nothing half done is used by anybody.
        let result = std::panic::catch_unwind(AssertUnwindSafe(|| work(&mut owned, &watching)));
        match result {
            Err(panic) => watching.fail(&panic_message(panic.as_ref())),
            Ok(()) => watching.returned(),
        }
        let dropped = std::panic::catch_unwind(AssertUnwindSafe(|| drop(owned)));
        if let Err(panic) = dropped {
            watching.fail(&panic_message(panic.as_ref()));
        }
        watching.wake();
    })?;
    Ok(Watched { pulse, thread: Some(thread) })
}

//! The thread that captures one eye.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plumbline_model::Eye;

use super::capture::{Captured, EyeCamera};
use crate::error::SourceError;

/// Frames that wait to be collected; older ones go and are counted.
const INBOX_FRAMES: usize = 4;
/// Damaged frames in a row after which the camera counts as broken.
const DAMAGED_LIMIT: u32 = 30;

/// What the thread hands over.
struct Inbox {
    frames: Mutex<VecDeque<(Instant, Captured)>>,
    last_frame_at: Mutex<Instant>,
    gone: Mutex<Option<String>>,
    dropped: AtomicU64,
    stop: AtomicBool,
}

/// Captures one eye until it is dropped or its camera is gone.
pub(super) struct EyeThread {
    inbox: Arc<Inbox>,
    handle: Option<JoinHandle<()>>,
}

impl EyeThread {
    pub(super) fn start(eye: Eye, camera: Box<dyn EyeCamera>) -> Result<Self, SourceError> {
        let inbox = Arc::new(Inbox {
            frames: Mutex::new(VecDeque::with_capacity(INBOX_FRAMES + 1)),
            last_frame_at: Mutex::new(Instant::now()),
            gone: Mutex::new(None),
            dropped: AtomicU64::new(0),
            stop: AtomicBool::new(false),
        });
        let shared = Arc::clone(&inbox);
        let handle = std::thread::Builder::new()
            .name(format!("{eye} camera"))
            .spawn(move || capture(camera, &shared))
            .map_err(|error| SourceError::NoThread(error.to_string()))?;
        Ok(Self { inbox, handle: Some(handle) })
    }

    /// Frames since the last call with their host time of capture, oldest first.
    pub(super) fn take_frames(&self) -> VecDeque<(Instant, Captured)> {
        std::mem::take(&mut *lock(&self.inbox.frames))
    }

    /// Frames since the last call that were dropped: damaged, or not collected in time.
    pub(super) fn take_dropped(&self) -> u64 {
        self.inbox.dropped.swap(0, Ordering::Relaxed)
    }

    /// Why this eye delivers no more, if so.
    pub(super) fn gone(&self, silence_limit: Duration) -> Option<String> {
        // Asked first: a thread that ends in an orderly way leaves its reason before.
        let has_ended = self.handle.as_ref().is_some_and(JoinHandle::is_finished);
        if let Some(reason) = lock(&self.inbox.gone).clone() {
            return Some(reason);
        }
        if has_ended {
            return Some("stopped because its thread failed; this is a defect of the program".to_owned());
        }
        let silent_for = lock(&self.inbox.last_frame_at).elapsed();
        (silent_for > silence_limit).then(|| {
            format!(
                "has sent no image for {:.1} s; check its cable, or plug it in again",
                silent_for.as_secs_f64()
            )
        })
    }
}

impl Drop for EyeThread {
    fn drop(&mut self) {
        self.inbox.stop.store(true, Ordering::Relaxed);
        let Some(handle) = self.handle.take() else { return };
        // A camera that hangs keeps its thread for seconds; it is left to end by itself
        // rather than making its owner wait.
        let deadline = Instant::now() + Duration::from_millis(300);
        while !handle.is_finished() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(2));
        }
        if handle.is_finished() && handle.join().is_err() {
            log::error!("a camera thread failed");
        }
    }
}

fn capture(mut camera: Box<dyn EyeCamera>, inbox: &Inbox) {
    let mut damaged = 0;
    while !inbox.stop.load(Ordering::Relaxed) {
        if let Err(reason) = camera.grab() {
            *lock(&inbox.gone) = Some(reason);
            return;
        }
        let captured_at = Instant::now();
        *lock(&inbox.last_frame_at) = captured_at;
        match camera.retrieve() {
            Ok(frame) => {
                damaged = 0;
                let mut frames = lock(&inbox.frames);
                frames.push_back((captured_at, frame));
                if frames.len() > INBOX_FRAMES {
                    frames.pop_front();
                    inbox.dropped.fetch_add(1, Ordering::Relaxed);
                }
            }
            Err(reason) => {
                damaged += 1;
                inbox.dropped.fetch_add(1, Ordering::Relaxed);
                if damaged >= DAMAGED_LIMIT {
                    *lock(&inbox.gone) =
                        Some(format!("sends damaged images only ({reason}); check its cable"));
                    return;
                }
            }
        }
    }
}

/// A panic elsewhere leaves plain values behind, which stay usable.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

//! Two things that pass every queue: the stop, and the sign of life of whoever commands.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The stop. Latches: only [`release`](Self::release) lets anything move again. Clones are the same
/// switch.
#[derive(Clone, Debug, Default)]
pub struct StopSwitch(Arc<AtomicBool>);

impl StopSwitch {
    /// Whatever moves has to hold, now.
    pub fn press(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// To be called on the operator's explicit wish only. Nothing moves by that.
    pub fn release(&self) {
        self.0.store(false, Ordering::SeqCst);
    }

    /// Whether it is pressed and not released.
    pub fn is_pressed(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }

    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        self.0.clone()
    }
}

impl From<Arc<AtomicBool>> for StopSwitch {
    fn from(flag: Arc<AtomicBool>) -> Self {
        Self(flag)
    }
}

/// A sign of life, given again and again.
#[derive(Clone, Debug)]
pub struct Heartbeat {
    alive_ms: Arc<AtomicU64>,
    origin: Instant,
}

impl Default for Heartbeat {
    fn default() -> Self {
        Self { alive_ms: Arc::default(), origin: Instant::now() }
    }
}

impl Heartbeat {
    /// A counter that somebody else keeps: milliseconds since `origin`.
    pub fn from_parts(alive_ms: Arc<AtomicU64>, origin: Instant) -> Self {
        Self { alive_ms, origin }
    }

    /// Alive now.
    pub fn beat(&self) {
        let now_ms = u64::try_from(self.origin.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.alive_ms.store(now_ms, Ordering::Relaxed);
    }

    /// Time since the last sign of life.
    pub fn age(&self) -> Duration {
        self.origin.elapsed().saturating_sub(Duration::from_millis(self.alive_ms.load(Ordering::Relaxed)))
    }
}

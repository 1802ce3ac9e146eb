//! Wakes the engine: ringing twice before it looks is the same as ringing once.

use crossbeam_channel::{Receiver, Sender};

/// Rings from any thread; never waits.
#[derive(Clone, Debug)]
pub struct Bell {
    ring: Sender<()>,
}

impl Bell {
    /// A bell and the ear that hears it.
    pub fn new() -> (Self, Receiver<()>) {
        let (ring, heard) = crossbeam_channel::bounded(1);
        (Self { ring }, heard)
    }

    /// Rings.
    pub fn ring(&self) {
        // Full: it was rung already. Disconnected: nobody listens any more.
        let _ = self.ring.try_send(());
    }
}

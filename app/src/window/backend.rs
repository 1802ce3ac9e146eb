//! What the window needs of the engine; tests put made-up views in its place.

use std::sync::Arc;

use plumbline_engine::{Command, Engine, View};

/// Gives views, takes commands; neither ever waits.
pub trait Backend {
    /// The newest snapshot.
    fn view(&self) -> Arc<View>;
    /// Hands a command over.
    fn send(&self, command: Command);
    /// Whatever moves holds, past every queue.
    fn stop(&self);
    /// Says that the window is alive; without it the arm holds.
    fn heartbeat(&self);
}

impl Backend for Engine {
    fn view(&self) -> Arc<View> {
        Self::view(self)
    }

    fn send(&self, command: Command) {
        Self::send(self, command);
    }

    fn stop(&self) {
        Self::stop(self);
    }

    fn heartbeat(&self) {
        Self::heartbeat(self);
    }
}

//! What the window needs of the engine; tests put made-up views in its place.

use std::sync::Arc;

use plumbline_engine::{Command, Engine, View};

/// Lets whatever moves hold, past every queue, from any thread.
pub type Stopper = Arc<dyn Fn() + Send + Sync>;

/// Gives views, takes commands; neither ever waits.
pub trait Backend {
    /// The newest snapshot.
    fn view(&self) -> Arc<View>;
    /// Hands a command over.
    fn send(&self, command: Command);
    /// Whatever moves holds, past every queue.
    fn stop(&self);
    /// The same for other threads.
    fn stopper(&self) -> Stopper;
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

    fn stopper(&self) -> Stopper {
        Arc::new(Self::stopper(self))
    }

    fn heartbeat(&self) {
        Self::heartbeat(self);
    }
}

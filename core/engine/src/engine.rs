//! The handle that the window holds.

use std::sync::{Arc, Mutex, PoisonError};

use crossbeam_channel::{Sender, TrySendError};

use crate::command::Command;
use crate::settings::EngineSettings;
use crate::view::View;

/// Called from any thread when there is a new view; must return at once.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// The running application minus the window. Dropping it stops every thread.
pub struct Engine {
    commands: Option<Sender<Command>>,
    view: Arc<Mutex<Arc<View>>>,
}

impl Engine {
    /// Starts the threads. Never fails: what could not be started (a data folder that cannot
    /// be written, a source that cannot be opened) is said in the view.
    pub fn start(settings: EngineSettings, wake: Wake) -> Self {
        let _ = (settings, wake);
        let (commands, _received) = crossbeam_channel::bounded(1024);
        Self { commands: Some(commands), view: Arc::default() }
    }

    /// Hands a command over; returns at once.
    pub fn send(&self, command: impl Into<Command>) {
        let Some(commands) = &self.commands else { return };
        if let Err(TrySendError::Full(command)) = commands.try_send(command.into()) {
            log::error!("the engine does not keep up; lost {command:?}");
        }
    }

    /// The newest snapshot.
    pub fn view(&self) -> Arc<View> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

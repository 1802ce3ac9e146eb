//! The handle that the window holds, and the thread behind it.

mod hub;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use crossbeam_channel::{Sender, TrySendError};

use crate::command::Command;
use crate::robot::Switches;
use crate::settings::EngineSettings;
use crate::view::View;

/// Called from any thread when there is a new view; must return at once.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Commands that may wait.
const WAITING: usize = 1024;

/// The running application minus the window. Dropping it stops every thread.
pub struct Engine {
    commands: Option<Sender<Command>>,
    shared: Arc<Shared>,
    hub: Option<JoinHandle<()>>,
}

/// What both sides can reach.
struct Shared {
    /// Held only for as long as it takes to clone or replace the `Arc`.
    view: Mutex<Arc<View>>,
    lost_commands: AtomicU64,
    wake: Wake,
    switches: Switches,
}

impl Shared {
    fn publish(&self, view: View) {
        let replaced = {
            let mut newest = self.view.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::replace(&mut *newest, Arc::new(view))
        };
        // Freed outside of the lock: images may hang on it.
        drop(replaced);
        (self.wake)();
    }

    fn view(&self) -> Arc<View> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Engine {
    /// Starts the threads. Never fails: what could not be started (a data folder that cannot
    /// be written, a source that cannot be opened) is said in the view.
    pub fn start(settings: EngineSettings, wake: Wake) -> Self {
        let (commands, received) = crossbeam_channel::bounded(WAITING);
        let shared = Arc::new(Shared {
            view: Mutex::default(),
            lost_commands: AtomicU64::new(0),
            wake,
            switches: Switches::default(),
        });
        let for_hub = shared.clone();
        let hub = std::thread::Builder::new()
            .name("engine".into())
            .spawn(move || hub::run(settings, &received, &for_hub));
        if let Err(error) = &hub {
            log::error!("the system gives no thread for the engine: {error}");
        }
        Self { commands: Some(commands), shared, hub: hub.ok() }
    }

    /// Hands a command over; returns at once. If a thousand commands wait already it is lost,
    /// counted and logged.
    pub fn send(&self, command: impl Into<Command>) {
        let Some(commands) = &self.commands else { return };
        if let Err(TrySendError::Full(command) | TrySendError::Disconnected(command)) =
            commands.try_send(command.into())
        {
            self.shared.lost_commands.fetch_add(1, Ordering::Relaxed);
            log::error!("the engine does not keep up; lost {command:?}");
        }
    }

    /// Whatever moves holds, and nothing moves until the operator releases it. Passes every queue:
    /// the joint bus reads it in every cycle.
    pub fn stop(&self) {
        self.shared.switches.stop.press();
    }

    /// To be called with every frame of the window: without it the arm holds.
    pub fn heartbeat(&self) {
        self.shared.switches.heartbeat.beat();
    }

    /// The newest snapshot.
    pub fn view(&self) -> Arc<View> {
        self.shared.view()
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.commands = None;
        if let Some(hub) = self.hub.take() {
            // A panic of the hub has been caught and shown.
            let _ = hub.join();
        }
    }
}

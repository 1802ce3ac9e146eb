//! The handle that the window holds, and the thread behind it.

mod caring;
mod hub;
pub mod journal;
mod libraries;
mod pipeline;
#[cfg(test)]
mod recording_cost;
pub mod replay;
pub mod settings;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TrySendError};

pub use self::libraries::libraries;
use self::settings::EngineSettings;
use crate::command::Command;
use crate::ground::bell::Bell;
use crate::ground::notice::{Notice, NoticeCommand, NoticeLevel};
use crate::ground::watched::{Pulse, ThreadFault, Trial, Trouble, WatchCommand, WatchedThread};
use crate::robot::Switches;
use crate::view::{View, view_without_its_engine};

/// Called from any thread when there is a new view; must return at once.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Commands that may wait.
const WAITING: usize = 1024;
/// When closing, the hub gets this long to let everything go.
const CLOSING: Duration = Duration::from_secs(30);

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
    /// Signs of life of the hub.
    pulse: Pulse,
    trial: Trial,
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

    /// Nobody keeps the view up to date any more: it says so.
    fn publish_failure(&self, said: &str) {
        let trouble = Trouble::Ended { said: said.to_owned(), since: Instant::now() };
        let fault = ThreadFault::new(WatchedThread::Engine, trouble, true);
        let text = format!("{} (It said: {said}.)", fault.meaning);
        self.publish_with_notice(view_without_its_engine(&self.view(), fault), NoticeLevel::Error, text);
    }

    fn publish_with_notice(&self, view: View, level: NoticeLevel, text: String) {
        log::error!("{text}");
        let number = view.notices.last().map_or(1, |notice| notice.number + 1);
        let notice = Notice { number, level, text, at: jiff::Timestamp::now(), times: 1 };
        let notices: Arc<[Notice]> = view.notices.iter().cloned().chain([notice]).collect();
        self.publish(View { revision: view.revision + 1, notices, ..view });
    }
}

impl Engine {
    /// Starts the threads. Never fails: what could not be started (a data folder that cannot
    /// be written, a source that cannot be opened) is said in the view.
    pub fn start(settings: EngineSettings, wake: Wake) -> Self {
        Self::start_on_trial(settings, wake, Trial::default())
    }

    /// The same with threads that a test can let fail.
    #[doc(hidden)]
    pub fn start_on_trial(settings: EngineSettings, wake: Wake, trial: Trial) -> Self {
        let (commands, received) = crossbeam_channel::bounded(WAITING);
        // Nobody hears its end; the thread around the hub tells it.
        let pulse = Pulse::new(WatchedThread::Engine, Bell::new().0, trial.clone());
        let shared = Arc::new(Shared {
            view: Mutex::default(),
            lost_commands: AtomicU64::new(0),
            wake,
            switches: Switches::default(),
            pulse,
            trial,
        });
        let for_hub = shared.clone();
        let hub = std::thread::Builder::new()
            .name(WatchedThread::Engine.name().to_owned())
            .spawn(move || run(settings, &received, &for_hub));
        if let Err(error) = &hub {
            shared.publish_failure(&format!("the system gives no thread: {error}"));
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

    /// The same for other threads, for as long as they like.
    pub fn stopper(&self) -> impl Fn() + Send + Sync + use<> {
        let stop = self.shared.switches.stop.clone();
        move || stop.press()
    }

    /// To be called with every frame of the window: without it the arm holds.
    pub fn heartbeat(&self) {
        self.shared.switches.heartbeat.beat();
    }

    /// The newest snapshot. When whoever makes them gives no sign of life, it says so.
    pub fn view(&self) -> Arc<View> {
        let view = self.shared.view();
        match self.shared.pulse.trouble(Instant::now()) {
            Some(trouble @ Trouble::Silent { .. }) => {
                let fault = ThreadFault::new(WatchedThread::Engine, trouble, false);
                let threads = view.threads.iter().cloned().chain([fault]).collect();
                Arc::new(View { threads, ..View::clone(&view) })
            }
            _ => view,
        }
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.commands = None;
        let Some(hub) = self.hub.take() else { return };
        let until = Instant::now() + CLOSING;
        while !hub.is_finished() {
            if Instant::now() >= until {
                // Who closes the window must not wait for what hangs.
                log::error!("the engine does not come to its end and is left");
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        // A panic of the hub has been caught and shown.
        let _ = hub.join();
    }
}

/// The hub, and another one when it failed and the operator says so.
fn run(mut settings: EngineSettings, commands: &Receiver<Command>, shared: &Shared) {
    loop {
        let data_dir = settings.data_dir.clone();
        match hub::run(settings, commands, shared) {
            Ok(()) => return,
            Err(said) => log::error!("the engine has failed: {said}"),
        }
        shared.pulse.rest();
        if !is_started_again(commands, shared) {
            return;
        }
        // Opens nothing and connects nothing by itself.
        settings = EngineSettings { data_dir, ..EngineSettings::default() };
    }
}

/// Waits until the operator starts it again; `false` when the window is closed instead.
fn is_started_again(commands: &Receiver<Command>, shared: &Shared) -> bool {
    let mut has_answered = false;
    for command in commands {
        match command {
            Command::Watch(WatchCommand::StartAgain(WatchedThread::Engine)) => return true,
            // These come by themselves, or tell something else.
            Command::Live(_) | Command::Notice(NoticeCommand::Add { .. } | NoticeCommand::Clear) => {}
            _ if has_answered => {}
            _ => {
                has_answered = true;
                let text = WatchedThread::Engine.meaning_of_end().to_owned();
                shared.publish_with_notice(View::clone(&shared.view()), NoticeLevel::Warning, text);
            }
        }
    }
    false
}

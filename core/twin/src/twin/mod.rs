//! The running twin: its threads, and what its owner may do with it.

mod command;
mod runner;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use plumbline_hardware::joints::{ScreenGone, Touch, TouchSource};
use plumbline_model::robot::Rig;

pub use command::{TwinCommand, TwinState};
use runner::{Runner, check_pace};

use crate::board_presets::default_board;
use crate::error::TwinError;
use crate::physics::World;
use crate::scenario::Scenario;
use crate::scene::{Scenery, Snapshot};
use crate::scenery::scenery;
use crate::servos::{Bank, Fault, ServoTerminal};
use crate::truth::Truth;

/// Commands that may wait; more are refused.
const COMMANDS: usize = 64;
/// Touches that may wait to be fetched; the oldest go first.
const TOUCHES: usize = 256;

/// What a twin is started with.
#[derive(Clone, Debug)]
pub struct TwinSettings {
    /// The nominal robot.
    pub rig: Arc<Rig>,
    /// What is different about this one.
    pub scenario: Scenario,
    /// Same seed, same world.
    pub seed: u64,
    /// Simulated seconds per second, 0.01–100; 1 is real time.
    pub pace: f64,
}

/// A simulated robot that runs until it is dropped.
#[derive(Debug)]
pub struct Twin {
    shared: Arc<Shared>,
    commands: SyncSender<TwinCommand>,
    terminal: Mutex<ServoTerminal>,
    baud: u32,
    seed: u64,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    world: Mutex<World>,
    bank: Arc<Mutex<Bank>>,
    latest: Mutex<(Arc<Scenery>, Snapshot)>,
    state: Mutex<TwinState>,
    touches: Mutex<Touches>,
    end: AtomicBool,
    /// A test lets the physics fail.
    struck: AtomicBool,
}

#[derive(Debug, Default)]
struct Touches {
    newest: Option<Touch>,
    waiting: VecDeque<Touch>,
}

/// What the eyes see; can be handed to a renderer.
#[derive(Clone, Debug)]
pub struct SceneSource {
    shared: Arc<Shared>,
}

impl SceneSource {
    /// Everything visible and where it is now.
    pub fn newest(&self) -> (Arc<Scenery>, Snapshot) {
        lock(&self.shared.latest).clone()
    }
}

/// The twin's touchscreen.
#[derive(Clone, Debug)]
pub struct TwinTouchscreen {
    shared: Arc<Shared>,
}

impl TwinTouchscreen {
    /// All touches since the last call, oldest first; at most 256 wait.
    pub fn take(&self) -> Vec<Touch> {
        lock(&self.shared.touches).waiting.drain(..).collect()
    }
}

impl TouchSource for TwinTouchscreen {
    fn newest(&mut self) -> Result<Option<Touch>, ScreenGone> {
        if self.shared.end.load(Ordering::Relaxed) {
            return Err(ScreenGone);
        }
        Ok(lock(&self.shared.touches).newest)
    }
}

impl Twin {
    /// Starts a twin: the robot stands in its first pose and holds, the toys are on the table,
    /// the eyes are switched on cold.
    ///
    /// # Errors
    /// When the scenario does not fit the robot, the physics does not accept it, or there is no
    /// pseudo-terminal or thread to be had.
    pub fn start(settings: TwinSettings) -> Result<Self, TwinError> {
        let TwinSettings { rig, scenario, seed, pace } = settings;
        check_pace(pace)?;
        let world = World::new(rig.clone(), &scenario, seed)?;
        let home = rig.home();
        let angles: Vec<f64> = rig.servos.iter().map(|servo| home[servo.joint]).collect();
        let bank = Arc::new(Mutex::new(Bank::new(rig.clone(), &angles)?));
        let terminal = ServoTerminal::open(bank.clone(), rig.bus.baud, seed)?;
        let latest = (Arc::new(scenery(&world, default_board(), 0)), world.snapshot());
        let shared = Arc::new(Shared {
            world: Mutex::new(world),
            bank,
            latest: Mutex::new(latest),
            state: Mutex::new(TwinState::default()),
            touches: Mutex::new(Touches::default()),
            end: AtomicBool::new(false),
            struck: AtomicBool::new(false),
        });
        let (commands, incoming) = sync_channel(COMMANDS);
        let runner = Runner::new(shared.clone(), incoming, pace);
        runner.publish();
        let thread = std::thread::Builder::new()
            .name("plumbline-twin-physics".to_owned())
            .spawn(move || runner.run())
            .map_err(TwinError::Thread)?;
        let baud = rig.bus.baud;
        Ok(Self { shared, commands, terminal: Mutex::new(terminal), baud, seed, thread: Some(thread) })
    }

    /// Whether its physics have ended although nobody asked them to: its servos then answer with
    /// angles that are not true any more.
    pub fn has_failed(&self) -> bool {
        self.thread.as_ref().is_some_and(JoinHandle::is_finished)
    }

    /// Lets the physics fail, for tests of what is said then.
    #[doc(hidden)]
    pub fn fail_on_trial(&self) {
        self.shared.struck.store(true, Ordering::Relaxed);
    }

    /// Where a host opens the servo bus. After the port was closed by a fault it may be another.
    pub fn port(&self) -> PathBuf {
        lock(&self.terminal).path().to_path_buf()
    }

    /// What the eyes see.
    pub fn scene(&self) -> SceneSource {
        SceneSource { shared: self.shared.clone() }
    }

    /// The touchscreen.
    pub fn touchscreen(&self) -> TwinTouchscreen {
        TwinTouchscreen { shared: self.shared.clone() }
    }

    /// Does something to the world. What cannot be done is told in [`TwinState::refusal`].
    pub fn send(&self, command: TwinCommand) {
        match command {
            TwinCommand::Fault { fault, on } => self.set_fault(fault, on),
            TwinCommand::ClearFaults => self.clear_faults(),
            TwinCommand::Reset => {
                self.clear_faults();
                self.queue(command);
            }
            _ => self.queue(command),
        }
    }

    fn queue(&self, command: TwinCommand) {
        if self.commands.try_send(command).is_err() {
            let text = "the twin is busy with earlier commands: try again in a moment";
            lock(&self.shared.state).refusal = Some(text.to_owned());
        }
    }

    fn clear_faults(&self) {
        Fault::ALL.iter().for_each(|fault| self.set_fault(*fault, false));
    }

    fn set_fault(&self, fault: Fault, on: bool) {
        let was_on = {
            let mut bank = lock(&self.shared.bank);
            let was_on = bank.faults().contains(&fault);
            bank.set_fault(fault, on);
            was_on
        };
        let closed = matches!(fault, Fault::PortClosed | Fault::PortClosedMidAnswer);
        if closed && was_on && !on {
            // The plug is put in again.
            match ServoTerminal::open(self.shared.bank.clone(), self.baud, self.seed) {
                Ok(terminal) => *lock(&self.terminal) = terminal,
                Err(error) => lock(&self.shared.state).refusal = Some(error.to_string()),
            }
        }
    }

    /// What the operator may see.
    pub fn state(&self) -> TwinState {
        let mut state = lock(&self.shared.state).clone();
        state.faults = lock(&self.shared.bank).faults().iter().copied().collect();
        state
    }

    /// What is really so. For judges and tests only.
    pub fn truth_for_judging(&self) -> Truth {
        lock(&self.shared.world).truth_for_judging()
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic of it was told by its own message.
            let _ = thread.join();
        }
    }
}

/// A thread that panicked leaves data that are still whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

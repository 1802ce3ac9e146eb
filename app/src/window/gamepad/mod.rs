//! A gamepad: it jogs, and it has a STOP. Having none is the usual case.
//!
//! A thread of its own waits for it, so that its STOP reaches the arm at once: also while a dialog
//! is open, while another window is in front, and while this one hangs.

mod pads;
#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use egui::Context;

use self::pads::{PadEvent, Pads, Sticks};
use super::backend::Stopper;
use crate::operator::GamepadState;

/// A stick nearer to its middle than this is at rest.
const DEAD: f32 = 0.15;
/// The thread looks this often whether it is to end, and says what the gamepad says.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// What a gamepad said longer ago than this counts no more: its thread may hang.
const FRESH: Duration = Duration::from_millis(300);

/// The gamepads of this machine.
#[derive(Default)]
pub(super) struct Gamepads {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    stops_seen: u64,
    has_told: bool,
}

/// What the thread says.
#[derive(Default)]
struct Shared {
    newest: Mutex<Option<(Instant, GamepadState)>>,
    stops: AtomicU64,
    end: AtomicBool,
    failed: AtomicBool,
}

impl Shared {
    fn newest(&self) -> MutexGuard<'_, Option<(Instant, GamepadState)>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn say(&self, state: Option<GamepadState>, wake: &dyn Fn()) {
        let mut newest = self.newest();
        let is_new = newest.as_ref().map(|(_, before)| before) != state.as_ref();
        *newest = state.map(|state| (Instant::now(), state));
        drop(newest);
        if is_new {
            wake();
        }
    }
}

impl Gamepads {
    /// Looks for gamepads as long as it lives. `stop` is called from its thread.
    pub(super) fn start(ctx: &Context, stop: Stopper) -> Self {
        let ctx = ctx.clone();
        Self::watch(pads::open, stop, move || ctx.request_repaint())
    }

    fn watch<P: Pads>(
        open: impl FnOnce() -> Option<P> + Send + 'static,
        stop: Stopper,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let shared = Arc::<Shared>::default();
        let told = shared.clone();
        let thread = std::thread::Builder::new().name("gamepad".to_owned()).spawn(move || {
            // The library of gamepads stays on the thread that made it.
            let result = catch_unwind(AssertUnwindSafe(|| {
                if let Some(pads) = open() {
                    run(pads, &told, &*stop, &wake);
                }
            }));
            *told.newest() = None;
            if result.is_err() {
                told.failed.store(true, Ordering::Release);
                wake();
            }
        });
        if let Err(error) = &thread {
            log::error!("the system gives no thread for gamepads: {error}");
            shared.failed.store(true, Ordering::Release);
        }
        Self { shared, thread: thread.ok(), stops_seen: 0, has_told: false }
    }

    /// What the first gamepad that is plugged in says. Does not wait.
    pub(super) fn newest(&self, is_focused: bool) -> Option<GamepadState> {
        let (at, state) = self.shared.newest().clone()?;
        // A window behind others must not move the robot.
        (at.elapsed() < FRESH).then_some(GamepadState { enabled: state.enabled && is_focused, ..state })
    }

    /// Whether STOP was pressed on a gamepad since the last call. The arm holds already.
    pub(super) fn take_stop(&mut self) -> bool {
        let stops = self.shared.stops.load(Ordering::Acquire);
        std::mem::replace(&mut self.stops_seen, stops) != stops
    }

    /// What to know when gamepads are not listened to any more; told once.
    pub(super) fn take_trouble(&mut self) -> Option<&'static str> {
        let failed = self.shared.failed.load(Ordering::Acquire);
        (failed && !std::mem::replace(&mut self.has_told, true)).then_some(
            "What listens to gamepads has failed inside: a gamepad neither jogs nor stops any more. Use STOP, Esc or space; start the program again to use the gamepad.",
        )
    }
}

impl Drop for Gamepads {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // A panic of it was caught and told.
            let _ = thread.join();
        }
    }
}

fn run(mut pads: impl Pads, shared: &Shared, stop: &(dyn Fn() + Send + Sync), wake: &dyn Fn()) {
    while !shared.end.load(Ordering::Acquire) {
        let event = pads.next(LOOK_EVERY);
        if event == Some(PadEvent::Stop) {
            stop();
            shared.stops.fetch_add(1, Ordering::Release);
            wake();
        }
        shared.say(pads.first().map(|(name, sticks)| state(name, &sticks)), wake);
    }
}

fn state(name: String, sticks: &Sticks) -> GamepadState {
    // Sticks count up and right as positive; the robot's y points to its left.
    let push = [
        dead_zone(sticks.left[1]),
        -dead_zone(sticks.left[0]),
        dead_zone(sticks.right[1]),
        -dead_zone(sticks.right[0]),
    ];
    GamepadState { name, enabled: sticks.enabled, push }
}

/// Zero near the middle, and from there evenly up to 1.
fn dead_zone(value: f32) -> f64 {
    let beyond = (value.abs() - DEAD) / (1.0 - DEAD);
    if beyond > 0.0 { f64::from(beyond.min(1.0) * value.signum()) } else { 0.0 }
}

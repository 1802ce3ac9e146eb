//! The thread that connects, previews, jogs and moves, so that nobody else has to wait.

use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError};

use super::control::RobotControl;
use super::touch_order::TouchNews;
use super::worker::{News, Worker};
use crate::ground::bell::Bell;
use crate::ground::notice::NoticeLevel;
use crate::ground::slot::Putter;
use crate::ground::watched::{self, Pulse, Watched};

/// Commands that may wait while something is being connected.
const WAITING: usize = 256;
/// While connected, it looks at the joints this often.
const TICK: Duration = Duration::from_millis(33);
/// While a finger is lowered onto the screen.
const LOWERING: Duration = Duration::from_millis(5);
/// Otherwise.
const IDLE: Duration = Duration::from_millis(500);
/// Without a sign of life for this long it is taken to hang.
const SILENT: Duration = Duration::from_secs(3);
/// Connecting asks servos that may not be there, and a twin is built first.
const SILENT_WHILE_CONNECTING: Duration = Duration::from_secs(90);

/// Where the thread puts what it has.
pub struct Wires {
    /// Newest state.
    pub news: Putter<News>,
    /// How touches are doing; none is lost.
    pub touches: Sender<TouchNews>,
    /// Messages for the operator.
    pub notes: Sender<(NoticeLevel, String)>,
    /// Rung when there is something.
    pub bell: Bell,
}

/// The running thread; ends when dropped.
pub struct RobotThread {
    controls: Option<Sender<RobotControl>>,
    watched: Watched,
}

impl RobotThread {
    /// Starts it. When it fails, the worker is dropped and with it the arm's driver, which lets the
    /// arm hold.
    pub fn start(worker: Worker, wires: Wires, pulse: Pulse) -> std::io::Result<Self> {
        let (controls, received) = crossbeam_channel::bounded(WAITING);
        let work = move |worker: &mut Worker, pulse: &Pulse| run(worker, &received, &wires, pulse);
        Ok(Self { controls: Some(controls), watched: watched::spawn(pulse, worker, work)? })
    }

    /// Whether it does its work.
    pub fn watched(&self) -> &Watched {
        &self.watched
    }

    /// Hands a command over; `false` when too many wait.
    pub fn control(&self, control: RobotControl) -> bool {
        match self.controls.as_ref().map(|controls| controls.try_send(control)) {
            None | Some(Ok(())) => true,
            Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) => false,
        }
    }
}

impl Drop for RobotThread {
    fn drop(&mut self) {
        self.watched.ask_to_end();
        // Cut off it ends; the watched thread is waited for.
        self.controls = None;
    }
}

fn run(worker: &mut Worker, controls: &Receiver<RobotControl>, wires: &Wires, pulse: &Pulse) {
    pulse.promise(SILENT);
    tell(worker, wires);
    let mut next = Instant::now();
    let mut told = next;
    loop {
        let period = match () {
            () if worker.is_lowering() || worker.is_led() => LOWERING,
            () if worker.is_awake() => TICK,
            () => IDLE,
        };
        pulse.promise(SILENT);
        match controls.recv_timeout(next.saturating_duration_since(Instant::now())) {
            Ok(control) => {
                // Connecting takes seconds; meanwhile the window says so.
                if let Some(connecting) = worker.announce(&control) {
                    put(connecting, wires);
                    pulse.promise(SILENT_WHILE_CONNECTING);
                } else {
                    pulse.promise(SILENT);
                }
                worker.control(control);
                tell(worker, wires);
                next = next.min(Instant::now() + period);
            }
            Err(RecvTimeoutError::Timeout) => {
                let now = Instant::now();
                worker.tick(now);
                // The window needs no news as often as the finger is looked after.
                if now.saturating_duration_since(told) >= TICK || !(worker.is_lowering() || worker.is_led()) {
                    tell(worker, wires);
                    told = now;
                }
                next = Instant::now() + period;
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

fn tell(worker: &mut Worker, wires: &Wires) {
    for note in worker.take_notes() {
        if let Err(TrySendError::Full((_, text))) = wires.notes.try_send(note) {
            log::warn!("too many messages at once, not shown: {text}");
        }
    }
    for news in worker.take_touch_news() {
        match wires.touches.try_send(news) {
            Ok(()) => wires.bell.ring(),
            Err(error) => log::error!("news of a touch was lost: {error}"),
        }
    }
    if let Some(news) = worker.take_news() {
        put(news, wires);
    }
}

fn put(news: News, wires: &Wires) {
    wires.news.put(news);
    wires.bell.ring();
}

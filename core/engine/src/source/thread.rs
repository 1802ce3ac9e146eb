//! The thread that waits for cameras and disks, so that nobody else has to.

use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError};
use plumbline_model::StereoFrame;

use super::player::{Control, Note, Player, Polled};
use crate::bell::Bell;
use crate::slot::Putter;
use crate::view::SourceView;

/// Commands that may wait while a camera is being opened.
const WAITING: usize = 64;

/// Where the thread puts what it has.
pub struct Wires {
    /// Newest pair and which source, counted, it is of.
    pub frames: Putter<(u64, StereoFrame)>,
    /// Newest state.
    pub views: Putter<SourceView>,
    /// Messages for the operator.
    pub notes: Sender<Note>,
    /// Rung when there is something.
    pub bell: Bell,
}

/// The running thread; ends when dropped.
pub struct SourceThread {
    controls: Option<Sender<Control>>,
    thread: Option<JoinHandle<()>>,
}

impl SourceThread {
    /// Starts it.
    pub fn start(player: Player, wires: Wires) -> std::io::Result<Self> {
        let (controls, received) = crossbeam_channel::bounded(WAITING);
        let thread = std::thread::Builder::new()
            .name("source".into())
            .spawn(move || run(player, &received, &wires))?;
        Ok(Self { controls: Some(controls), thread: Some(thread) })
    }

    /// Hands a command over; `false` when too many wait.
    pub fn control(&self, control: Control) -> bool {
        match self.controls.as_ref().map(|controls| controls.try_send(control)) {
            None | Some(Ok(())) => true,
            Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) => false,
        }
    }
}

impl Drop for SourceThread {
    fn drop(&mut self) {
        self.controls = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has been reported by the panic itself.
            let _ = thread.join();
        }
    }
}

fn run(mut player: Player, controls: &Receiver<Control>, wires: &Wires) {
    let mut told = SourceView::default();
    loop {
        let (polled, mut notes) = player.poll();
        let wait = match polled {
            Polled::Frame(frame) => {
                if !wires.frames.put((player.opened(), frame)) {
                    return;
                }
                wires.bell.ring();
                std::time::Duration::ZERO
            }
            Polled::Wait(time) => time,
        };
        tell(&mut player, &mut told, &mut notes, wires);
        match controls.recv_timeout(wait) {
            Ok(control) => {
                if let Control::Open(_) | Control::OpenPaths(_) = control {
                    tell_opening(&told, wires);
                }
                let mut notes = player.control(control);
                told.status = crate::view::SourceStatus::Opening;
                tell(&mut player, &mut told, &mut notes, wires);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Opening takes seconds with cameras; meanwhile the window says so.
fn tell_opening(told: &SourceView, wires: &Wires) {
    let opening = SourceView { status: crate::view::SourceStatus::Opening, ..told.clone() };
    wires.views.put(opening);
    wires.bell.ring();
}

fn tell(player: &mut Player, told: &mut SourceView, notes: &mut Vec<Note>, wires: &Wires) {
    let now = player.view();
    let changed = now != *told || !notes.is_empty();
    if now != *told {
        wires.views.put(now.clone());
        *told = now;
    }
    for (level, text) in notes.drain(..) {
        if let Err(TrySendError::Full((_, text))) = wires.notes.try_send((level, text)) {
            log::warn!("too many messages at once, not shown: {text}");
        }
    }
    if changed {
        wires.bell.ring();
    }
}

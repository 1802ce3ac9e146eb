//! The thread that waits for cameras and disks, so that nobody else has to.

use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError};
use plumbline_model::StereoFrame;

use super::command::Control;
use super::player::{Note, Player, Polled};
use super::view::{SourceStatus, SourceView};
use crate::ground::bell::Bell;
use crate::ground::slot::Putter;
use crate::ground::watched::{self, Pulse, Watched};

/// Commands that may wait while a camera is being opened.
const WAITING: usize = 64;
/// Beyond the time that it waits anyway: without a sign of life for this long it is taken to hang.
const SILENT: Duration = Duration::from_secs(3);
/// Cameras take their time to be opened, what draws the twin's eyes too, and so does winding a video.
const SILENT_WHILE_OPENING: Duration = Duration::from_secs(60);

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
    watched: Watched,
}

impl SourceThread {
    /// Starts it.
    pub fn start(player: Player, wires: Wires, pulse: Pulse) -> std::io::Result<Self> {
        let (controls, received) = crossbeam_channel::bounded(WAITING);
        let work = move |player: &mut Player, pulse: &Pulse| run(player, &received, &wires, pulse);
        Ok(Self { controls: Some(controls), watched: watched::spawn(pulse, player, work)? })
    }

    /// Whether it does its work.
    pub fn watched(&self) -> &Watched {
        &self.watched
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
        self.watched.ask_to_end();
        // Cut off it ends; the watched thread is waited for.
        self.controls = None;
    }
}

fn run(player: &mut Player, controls: &Receiver<Control>, wires: &Wires, pulse: &Pulse) {
    let mut told = SourceView::default();
    loop {
        // A lost source is opened again in between.
        let is_lost = matches!(told.status, SourceStatus::Lost { .. });
        pulse.promise(if is_lost { SILENT_WHILE_OPENING } else { SILENT });
        let (polled, mut notes) = player.poll();
        let wait = match polled {
            Polled::Frame(frame) => {
                if !wires.frames.put((player.opened(), frame)) {
                    return;
                }
                wires.bell.ring();
                Duration::ZERO
            }
            Polled::Wait(time) => time,
        };
        tell(player, &mut told, &mut notes, wires);
        pulse.promise(wait.saturating_add(SILENT));
        match controls.recv_timeout(wait) {
            Ok(control) => {
                if let Control::Open(_) | Control::OpenPaths(_) = control {
                    tell_opening(&told, wires);
                }
                pulse.promise(SILENT_WHILE_OPENING);
                let mut notes = player.control(control);
                told.status = SourceStatus::Opening;
                tell(player, &mut told, &mut notes, wires);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Opening takes seconds with cameras; meanwhile the window says so.
fn tell_opening(told: &SourceView, wires: &Wires) {
    let opening = SourceView { status: SourceStatus::Opening, ..told.clone() };
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

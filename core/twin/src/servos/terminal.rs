//! The pseudo-terminal: bytes in, bytes out, in the time that a wire would take.

use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{Deframer, Found};
use plumbline_model::duration;
use rand::{Rng, SeedableRng, rngs::StdRng};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::answer::Answer;
use super::bank::Bank;
use super::fault::Fault;
use crate::error::TwinError;

/// Bits on the wire per byte: start, eight, stop.
const BITS_PER_BYTE: f64 = 10.0;
/// How often an idle bus looks whether it shall end.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 10_000_000 };
/// Sleeping is this inexact; the rest of a wait is spent awake.
const SLEEP_SLACK: Duration = Duration::from_micros(80);

/// The host's end of the bus, and the thread behind it.
#[derive(Debug)]
pub(crate) struct ServoTerminal {
    path: PathBuf,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl ServoTerminal {
    /// Opens a pseudo-terminal and lets the bank answer on it.
    ///
    /// # Errors
    /// When there is no pseudo-terminal or no thread to be had.
    pub(crate) fn open(bank: Arc<Mutex<Bank>>, baud: u32, seed: u64) -> Result<Self, TwinError> {
        let (master, path) = open_pair().map_err(|error| TwinError::Terminal(error.into()))?;
        let end = Arc::new(AtomicBool::new(false));
        let byte_s = BITS_PER_BYTE / f64::from(baud.max(1));
        let line = Line {
            master: Some(master),
            bank,
            byte: duration::seconds(byte_s).unwrap_or_default(),
            end: end.clone(),
            free_at: Instant::now(),
            random: StdRng::seed_from_u64(seed),
        };
        let thread = std::thread::Builder::new()
            .name("plumbline-twin-servos".to_owned())
            .spawn(move || line.run())
            .map_err(TwinError::Thread)?;
        Ok(Self { path, end, thread: Some(thread) })
    }

    /// Where a host opens it.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for ServoTerminal {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic of it was told by its own message.
            let _ = thread.join();
        }
    }
}

fn open_pair() -> Result<(OwnedFd, PathBuf), Errno> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let name = ptsname(&master, Vec::new())?;
    let path = PathBuf::from(String::from_utf8_lossy(name.as_bytes()).into_owned());
    // No line editing and no translation on either side; this outlives the host's visits.
    let mut settings = tcgetattr(&master)?;
    settings.make_raw();
    tcsetattr(&master, OptionalActions::Now, &settings)?;
    rustix::io::ioctl_fionbio(&master, true)?;
    Ok((master, path))
}

struct Line {
    /// `None` once the port is gone.
    master: Option<OwnedFd>,
    bank: Arc<Mutex<Bank>>,
    /// Time of a byte.
    byte: Duration,
    end: Arc<AtomicBool>,
    /// When the last byte on the wire is over.
    free_at: Instant,
    random: StdRng,
}

impl Line {
    fn run(mut self) {
        let mut deframer = Deframer::default();
        let mut buffer = [0u8; 1024];
        while !self.end.load(Ordering::Relaxed) {
            if self.is_on(Fault::PortClosed) {
                self.master = None;
            }
            let Some(count) = self.wait(&mut buffer) else { continue };
            let now = Instant::now();
            self.free_at = self.free_at.max(now) + self.byte * count as u32;
            if self.is_on(Fault::Echo) {
                self.put(&buffer[..count]);
            }
            deframer.push(&buffer[..count]);
            while let Some(found) = deframer.pop() {
                let answers = match found {
                    Found::Frame(frame) => self.lock().answer(&frame),
                    Found::WrongCheck { id } => self.lock().broken(id),
                    Found::Garbage(_) => continue,
                };
                for answer in answers {
                    self.send(answer);
                }
            }
        }
    }

    /// Bytes from the host; `None` when there are none for now.
    fn wait(&self, buffer: &mut [u8]) -> Option<usize> {
        let pause = || std::thread::sleep(Duration::from_millis(5));
        let Some(master) = &self.master else {
            pause();
            return None;
        };
        let mut polled = [PollFd::new(master, PollFlags::IN)];
        poll(&mut polled, Some(&LOOK)).ok().filter(|ready| *ready > 0)?;
        match rustix::io::read(master, buffer) {
            Ok(count) if count > 0 => Some(count),
            // No host has it open.
            _ => {
                pause();
                None
            }
        }
    }

    /// An answer goes out when its last byte would have been on the wire, unless a fault hits it.
    fn send(&mut self, answer: Answer) {
        let Answer { mut bytes, delay_s } = answer;
        let faults = self.lock().faults().clone();
        let mut hit = |fault: Fault| faults.contains(&fault) && self.random.random_ratio(1, Fault::ONE_IN);
        if hit(Fault::Dropped) {
            return;
        }
        let late = hit(Fault::Late);
        let (garbled, cut) = (hit(Fault::Garbled), hit(Fault::Cut));
        if hit(Fault::WrongId) {
            rewrite_id(&mut bytes);
        }
        if hit(Fault::WrongChecksum)
            && let Some(check) = bytes.last_mut()
        {
            *check = !*check;
        }
        if garbled {
            let place = self.random.random_range(0..bytes.len().max(1));
            let bit = self.random.random_range(0..8);
            if let Some(byte) = bytes.get_mut(place) {
                *byte ^= 1 << bit;
            }
        }
        if cut {
            bytes.truncate(self.random.random_range(1..bytes.len().max(2)));
        }
        let lateness = if late { Fault::LATE_S } else { 0.0 };
        let waits = duration::seconds(delay_s + lateness).unwrap_or_default();
        self.free_at += waits + self.byte * bytes.len() as u32;
        sleep_until(self.free_at);
        if self.is_on(Fault::PortClosedMidAnswer) {
            self.put(&bytes[..bytes.len() / 2]);
            self.master = None;
            return;
        }
        self.put(&bytes);
    }

    fn put(&self, bytes: &[u8]) {
        let Some(master) = &self.master else { return };
        // A host that does not read loses what does not fit, as from a real adapter.
        let _ = rustix::io::write(master, bytes);
    }

    fn is_on(&self, fault: Fault) -> bool {
        self.lock().faults().contains(&fault)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Bank> {
        self.bank.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Another id with a checksum that fits.
fn rewrite_id(bytes: &mut [u8]) {
    let [_, _, id, .., check] = bytes else { return };
    *id ^= 0x40;
    let fitting = check.wrapping_add(if *id & 0x40 == 0 { 0x40 } else { 0xC0 });
    *check = fitting;
}

fn sleep_until(when: Instant) {
    let left = when.saturating_duration_since(Instant::now());
    if left > SLEEP_SLACK {
        std::thread::sleep(left - SLEEP_SLACK);
    }
    while Instant::now() < when {
        std::hint::spin_loop();
    }
}

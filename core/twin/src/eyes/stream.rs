//! The twin's eyes as a source of image pairs, like a pair of cameras.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plumbline_hardware::{Counters, Next, Report, SourceDescription, SourceError, SourceKind, StereoSource};
use plumbline_model::priority::step_back;
use plumbline_model::{Stamp, StereoFrame, duration};

use super::error::RenderError;
use super::renderer::{EyeOptions, EyeRenderer};
use super::sensor::Sensor;
use crate::scene::{Scenery, Snapshot};

/// Gives the newest scenery and where everything is; called once per pair from the eyes' own thread, so
/// it must not wait long.
pub type SceneView = Arc<dyn Fn() -> (Arc<Scenery>, Snapshot) + Send + Sync>;

/// How to open the twin's eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwinEyesOptions {
    /// Which device draws.
    pub eyes: EyeOptions,
    /// Lens and sensor to begin with.
    pub sensor: Sensor,
    /// Pairs per second to aim at, 0.1 to 120.
    pub rate_hz: f64,
    /// Seed of the noise of the first pair; every pair has noise of its own.
    pub seed: u64,
}

impl Default for TwinEyesOptions {
    fn default() -> Self {
        Self { eyes: EyeOptions::default(), sensor: Sensor::default(), rate_hz: 15.0, seed: 1 }
    }
}

/// A running source of what the twin sees. Dropping it ends its thread.
///
/// Live: whoever asks gets the newest pair, and pairs that nobody asked for in time are counted as
/// superseded.
pub struct TwinEyes {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    size: (u32, u32),
    adapter: String,
}

/// Changes a running [`TwinEyes`]; can be cloned and sent anywhere.
#[derive(Clone)]
pub struct EyeControls {
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<State>,
    wake: Condvar,
    stop: AtomicBool,
}

struct State {
    sensor: Sensor,
    rate_hz: f64,
    newest: Option<StereoFrame>,
    /// Why the thread has ended.
    failed: Option<RenderError>,
    counters: Counters,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Rates are checked where they enter.
fn period(rate_hz: f64) -> Duration {
    duration::period(rate_hz).unwrap_or(Duration::from_secs(1))
}

fn check_rate(rate_hz: f64) -> Result<f64, RenderError> {
    if (0.1..=120.0).contains(&rate_hz) { Ok(rate_hz) } else { Err(RenderError::Rate(rate_hz)) }
}

impl TwinEyes {
    /// Opens the device and starts drawing. What cannot be drawn at all is told here, not later.
    pub fn open(view: SceneView, options: TwinEyesOptions) -> Result<Self, RenderError> {
        let rate_hz = check_rate(options.rate_hz)?;
        options.sensor.check()?;
        let size = view().1.eyes.left.size_px();
        let shared = Arc::new(Shared {
            state: Mutex::new(State {
                sensor: options.sensor,
                rate_hz,
                newest: None,
                failed: None,
                counters: Counters::default(),
            }),
            wake: Condvar::new(),
            stop: AtomicBool::new(false),
        });
        let (opened, told) = std::sync::mpsc::sync_channel(1);
        let for_thread = shared.clone();
        let thread = std::thread::Builder::new()
            .name("twin eyes".to_owned())
            .spawn(move || {
                // Without a graphics card the processor draws. Threads of the driver inherit it.
                step_back();
                match EyeRenderer::new(options.eyes) {
                    Ok(renderer) => {
                        // Whoever opened waits for this; if it gave up, nobody wants images.
                        if opened.send(Ok(renderer.adapter_name().to_owned())).is_ok() {
                            Loop { shared: for_thread, view, renderer, seed: options.seed }.run();
                        }
                    }
                    Err(error) => drop(opened.send(Err(error))),
                }
            })
            .map_err(|e| RenderError::Thread(e.to_string()))?;
        let adapter = told.recv().map_err(|_| RenderError::Thread("it ended at once".to_owned()))??;
        Ok(Self { shared, thread: Some(thread), size, adapter })
    }

    /// A handle for changing sensor and rate while it runs.
    pub fn controls(&self) -> EyeControls {
        EyeControls { shared: self.shared.clone() }
    }
}

impl EyeControls {
    /// The sensor at present.
    pub fn sensor(&self) -> Sensor {
        self.shared.state().sensor
    }

    /// Changes the sensor from the next pair on.
    pub fn set_sensor(&self, sensor: Sensor) -> Result<(), RenderError> {
        sensor.check()?;
        self.shared.state().sensor = sensor;
        Ok(())
    }
}

/// What the thread owns.
struct Loop {
    shared: Arc<Shared>,
    view: SceneView,
    renderer: EyeRenderer,
    seed: u64,
}

impl Loop {
    fn run(mut self) {
        let mut due = Instant::now();
        let mut seq = 0;
        while !self.shared.stop.load(Ordering::Acquire) {
            let (sensor, period) = {
                let state = self.shared.state();
                (state.sensor, period(state.rate_hz))
            };
            match self.draw(&sensor, seq) {
                Ok(frame) => self.deliver(frame),
                Err(error) => {
                    log::warn!("the twin's eyes stopped: {error}");
                    self.shared.state().failed = Some(error);
                    return;
                }
            }
            seq += 1;
            // A pair that took too long is not caught up with.
            due = (due + period).max(Instant::now());
            self.sleep_until(due);
        }
    }

    fn draw(&mut self, sensor: &Sensor, seq: u64) -> Result<StereoFrame, RenderError> {
        let (scenery, snapshot) = (self.view)();
        let captured_at = Instant::now();
        let pair = self.renderer.render(&scenery, &snapshot, sensor, self.seed.wrapping_add(seq))?;
        Ok(StereoFrame {
            stamp: Stamp { seq, captured_at },
            left: Arc::new(pair.left),
            right: Arc::new(pair.right),
            time_difference_s: Some(0.0),
            name: None,
            beside: Default::default(),
        })
    }

    fn deliver(&self, frame: StereoFrame) {
        let mut state = self.shared.state();
        if state.newest.replace(frame).is_some() {
            state.counters.superseded += 1;
        }
    }

    fn sleep_until(&self, due: Instant) {
        let state = self.shared.state();
        let wait = due.saturating_duration_since(Instant::now());
        if !wait.is_zero() && !self.shared.stop.load(Ordering::Acquire) {
            // Woken early only to end, or for another rate.
            drop(self.shared.wake.wait_timeout(state, wait));
        }
    }
}

impl StereoSource for TwinEyes {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        let mut state = self.shared.state();
        if let Some(mut frame) = state.newest.take() {
            frame.stamp.seq = state.counters.delivered;
            state.counters.delivered += 1;
            return Ok(Next::Pair(frame));
        }
        match &state.failed {
            Some(error) => Err(SourceError::Lost { reason: error.to_string() }),
            None if self.thread.as_ref().is_some_and(JoinHandle::is_finished) => {
                let reason =
                    "what draws the twin's eyes has failed inside; report it with the log".to_owned();
                Err(SourceError::Lost { reason })
            }
            None => Ok(Next::NotYet),
        }
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Twin,
            title: format!("the twin's eyes, drawn by {}", self.adapter),
            image_size: Some(self.size),
            rate_hz: Some(self.shared.state().rate_hz),
            pair_count: None,
        }
    }

    fn counters(&self) -> Counters {
        self.shared.state().counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        Vec::new()
    }
}

impl Drop for TwinEyes {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Release);
        // Under the lock, so that the thread cannot fall asleep in between.
        drop(self.shared.state());
        self.shared.wake.notify_all();
        if let Some(thread) = self.thread.take() {
            // It can only have ended by itself; there is nobody left to tell.
            let _ = thread.join();
        }
    }
}

//! A pair of USB cameras: one thread per eye, frames paired by the host time of their capture.

mod capture;
mod device;
mod eye_thread;
mod settings;

use std::sync::Arc;
use std::time::Instant;

use plumbline_model::{Beside, Eye, Stamp, StereoFrame, duration};

use crate::error::SourceError;
use crate::pair_by_time::{PairByTime, Timed};
use crate::source::{Counters, Next, Report, SourceDescription, SourceKind, StereoSource};
use capture::{Captured, Delivered, EyeCamera, V4lCamera};
pub use device::{CameraDevice, CameraProbe, camera_devices, probe_camera};
pub(crate) use device::{camera_number_at_port, camera_port};
use eye_thread::EyeThread;
pub use settings::CameraSettings;

/// Frames of an eye that wait for a partner.
const WAITING_FRAMES: usize = 4;

/// Live pairs from two cameras. If nobody asks for a while, older pairs are dropped and
/// counted: the pair that is delivered is always the newest.
pub(crate) struct CameraSource {
    title: String,
    delivered: Delivered,
    settings: CameraSettings,
    threads: [EyeThread; 2],
    pairing: PairByTime<Captured>,
    /// Zero of the clock on which frames are paired.
    epoch: Instant,
    counters: Counters,
    reports: Vec<Report>,
}

impl CameraSource {
    /// Opens both cameras and starts their threads.
    pub(crate) fn open(
        left_index: u32,
        right_index: u32,
        settings: CameraSettings,
    ) -> Result<Self, SourceError> {
        settings.check()?;
        if left_index == right_index {
            return Err(SourceError::SameCamera { index: left_index });
        }
        let open = |eye, index| {
            V4lCamera::open(index, &settings)
                .map(|camera| Box::new(camera) as Box<dyn EyeCamera>)
                .map_err(|problem| SourceError::Camera { eye, index, problem })
        };
        let cameras = [open(Eye::Left, left_index)?, open(Eye::Right, right_index)?];
        Self::start(format!("cameras {left_index} (left) and {right_index} (right)"), cameras, settings)
    }

    fn start(
        title: String,
        cameras: [Box<dyn EyeCamera>; 2],
        settings: CameraSettings,
    ) -> Result<Self, SourceError> {
        let delivered = [cameras[0].delivers(), cameras[1].delivers()];
        if delivered[0].size != delivered[1].size {
            let [(lw, lh), (rw, rh)] = [delivered[0].size, delivered[1].size];
            return Err(SourceError::CameraSetting {
                setting: "size",
                problem: format!(
                    "the left camera delivers {lw}x{lh} px and the right {rw}x{rh} px; use two cameras of the same type, or a size both can deliver"
                ),
            });
        }
        let reports = settings.compare(delivered);
        let rate_hz = delivered[0].rate_hz.max(delivered[1].rate_hz);
        let limit_s = settings.time_difference_limit_s.unwrap_or(0.5 / rate_hz);
        let [left, right] = cameras;
        Ok(Self {
            title,
            delivered: delivered[0],
            settings,
            threads: [EyeThread::start(Eye::Left, left)?, EyeThread::start(Eye::Right, right)?],
            pairing: PairByTime::new(limit_s, WAITING_FRAMES),
            epoch: Instant::now(),
            counters: Counters::default(),
            reports,
        })
    }

    /// Moves what the threads captured to the pairing; an eye that is gone ends the source.
    fn collect(&mut self) -> Result<(), SourceError> {
        let silence_limit = duration::seconds(self.settings.silence_limit_s);
        let silence_limit = silence_limit.expect("settings were checked when the cameras were opened");
        for eye in Eye::BOTH {
            let thread = &self.threads[eye.index()];
            for (captured_at, frame) in thread.take_frames() {
                let time_s = captured_at.saturating_duration_since(self.epoch).as_secs_f64();
                self.pairing.push(eye, time_s, frame, &mut self.counters);
            }
            for _ in 0..thread.take_dropped() {
                self.counters.count_unpaired(eye);
            }
            if let Some(reason) = thread.gone(silence_limit) {
                return Err(SourceError::Lost { reason: format!("the {eye} camera {reason}") });
            }
        }
        Ok(())
    }

    fn frame(&mut self, left: Timed<Captured>, right: Timed<Captured>) -> StereoFrame {
        let seq = self.counters.delivered;
        self.counters.delivered += 1;
        let jpegs = left.frame.jpeg.zip(right.frame.jpeg).map(|(left, right)| [left, right]);
        // A pair is as old as the older of its images.
        let since_epoch = duration::seconds(left.time_s.min(right.time_s));
        let captured_at = since_epoch.map_or_else(Instant::now, |time| self.epoch + time);
        StereoFrame {
            stamp: Stamp { seq, captured_at },
            time_difference_s: Some(right.time_s - left.time_s),
            left: Arc::new(left.frame.image),
            right: Arc::new(right.frame.image),
            name: None,
            beside: Beside { jpegs, then: None },
        }
    }
}

impl StereoSource for CameraSource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        self.collect()?;
        let mut newest = None;
        while let Some(pair) = self.pairing.take(&mut self.counters) {
            if newest.replace(pair).is_some() {
                self.counters.superseded += 1;
            }
        }
        Ok(match newest {
            Some((left, right)) => Next::Pair(self.frame(left, right)),
            None => Next::NotYet,
        })
    }

    fn describe(&self) -> SourceDescription {
        SourceDescription {
            kind: SourceKind::Cameras,
            title: self.title.clone(),
            image_size: Some(self.delivered.size),
            rate_hz: Some(self.delivered.rate_hz),
            pair_count: None,
        }
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod compressed_tests;

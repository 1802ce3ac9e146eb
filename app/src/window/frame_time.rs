//! How much processor time the window's own frames take.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// The last frames, for the overlay, and all of them, for the report at exit.
#[derive(Debug)]
pub struct FrameTimes {
    recent: VecDeque<(Instant, Duration)>,
    // Counts per bin of BIN; bounded memory however long the window is open.
    histogram: Vec<u64>,
    count: u64,
    longest: Duration,
    slow: u64,
}

/// Summary of a set of frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSummary {
    /// How many frames.
    pub count: u64,
    /// Half of the frames took at most this.
    pub median: Duration,
    /// 95 of 100 frames took at most this.
    pub percentile_95: Duration,
    /// The longest one.
    pub longest: Duration,
    /// Frames that took longer than [`SLOW`].
    pub slow: u64,
}

/// A frame that takes longer is seen to stutter.
pub const SLOW: Duration = Duration::from_millis(100);

const BIN: Duration = Duration::from_micros(100);
const BINS: usize = 2000;
const KEPT: usize = 240;

impl Default for FrameTimes {
    fn default() -> Self {
        Self {
            recent: VecDeque::with_capacity(KEPT),
            histogram: vec![0; BINS],
            count: 0,
            longest: Duration::ZERO,
            slow: 0,
        }
    }
}

/// Processor time that this thread has used so far; `None` where the system does not tell.
/// Time on the clock would count the waiting for a busy machine as well.
pub fn thread_processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}

/// Memory of the program that is in use now, megabytes; `None` where the system does not tell.
pub fn resident_mb() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1000.0)
}

impl FrameTimes {
    /// Adds a frame that ended now.
    pub fn add(&mut self, cpu: Duration) {
        if self.recent.len() == KEPT {
            self.recent.pop_front();
        }
        self.recent.push_back((Instant::now(), cpu));
        let bin = (cpu.as_micros() / BIN.as_micros()).min(BINS as u128 - 1) as usize;
        self.histogram[bin] += 1;
        self.count += 1;
        self.longest = self.longest.max(cpu);
        self.slow += u64::from(cpu > SLOW);
    }

    /// The last frames, oldest first.
    pub fn recent(&self) -> impl Iterator<Item = Duration> + '_ {
        self.recent.iter().map(|(_, cpu)| *cpu)
    }

    /// Frames drawn during the last second.
    pub fn per_second(&self) -> usize {
        let now = Instant::now();
        self.recent.iter().filter(|(at, _)| now.duration_since(*at) < Duration::from_secs(1)).count()
    }

    /// Over every frame so far; `None` before the first. Times are upper edges of 0.1 ms bins.
    pub fn summary(&self) -> Option<FrameSummary> {
        (self.count > 0).then(|| FrameSummary {
            count: self.count,
            median: self.percentile(0.5),
            percentile_95: self.percentile(0.95),
            longest: self.longest,
            slow: self.slow,
        })
    }

    fn percentile(&self, share: f64) -> Duration {
        let wanted = (share * self.count as f64).ceil() as u64;
        let mut seen = 0;
        for (bin, &n) in self.histogram.iter().enumerate() {
            seen += n;
            if seen >= wanted {
                return BIN * (bin as u32 + 1);
            }
        }
        BIN * BINS as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_frames() {
        let mut times = FrameTimes::default();
        assert_eq!(times.summary(), None);
        for i in 0..100 {
            times.add(Duration::from_micros(1000 + 100 * i));
        }
        let summary = times.summary().expect("frames were added");
        assert_eq!(summary.count, 100);
        // Frame number 50 of 1.0, 1.1, … ms took 5.9 ms, number 95 took 10.4 ms; plus the bin.
        assert_eq!(summary.median, Duration::from_micros(6000));
        assert_eq!(summary.percentile_95, Duration::from_micros(10500));
        assert_eq!((summary.longest, summary.slow), (Duration::from_micros(10900), 0));
        times.add(SLOW + BIN);
        assert_eq!(times.summary().map(|summary| summary.slow), Some(1));
    }

    #[test]
    fn a_very_long_frame_is_counted_and_memory_stays_bounded() {
        let mut times = FrameTimes::default();
        for _ in 0..10_000 {
            times.add(Duration::from_secs(5));
        }
        assert_eq!(times.recent().count(), KEPT);
        assert_eq!(times.summary().expect("frames").percentile_95, BIN * BINS as u32);
    }
}

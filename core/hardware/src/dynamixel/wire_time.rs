//! How long a conversation takes on the wire itself: what a faster computer cannot shorten.

/// Counts what passed over the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WireTime {
    /// Bytes from the host.
    pub bytes_out: u64,
    /// Bytes from the servos.
    pub bytes_in: u64,
    /// Answers: each was preceded by a servo's return delay.
    pub answers: u64,
    /// Times the host waited for answers: each is followed by its turnaround.
    pub turnarounds: u64,
}

/// Bits of a byte on the wire: start, eight, stop.
const BITS_PER_BYTE: f64 = 10.0;

impl WireTime {
    /// Seconds at `baud` bits per second, with a servo's return delay (s) before each answer and
    /// the host's turnaround (s, USB latency) after each wait.
    pub fn seconds(&self, baud: u32, return_delay_s: f64, turnaround_s: f64) -> f64 {
        (self.bytes_out + self.bytes_in) as f64 * BITS_PER_BYTE / f64::from(baud)
            + self.answers as f64 * return_delay_s
            + self.turnarounds as f64 * turnaround_s
    }

    /// What was added since `before`.
    pub fn since(&self, before: &Self) -> Self {
        Self {
            bytes_out: self.bytes_out - before.bytes_out,
            bytes_in: self.bytes_in - before.bytes_in,
            answers: self.answers - before.answers,
            turnarounds: self.turnarounds - before.turnarounds,
        }
    }
}

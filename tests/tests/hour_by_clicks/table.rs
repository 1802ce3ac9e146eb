//! What a walk took, as a table.

use std::fmt;
use std::time::Duration;

/// A leg that is behind.
#[derive(Debug)]
pub struct LegTaken {
    /// Its name.
    pub name: &'static str,
    /// Labels that were clicked, in their order.
    pub clicks: Vec<String>,
    /// Wall time.
    pub time: Duration,
    /// Pauses of the arm that nobody asked for.
    pub pauses: usize,
    /// Frames over 100 ms while nothing was computed.
    pub slow: usize,
}

impl fmt::Display for LegTaken {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (clicks, wall_s) = (self.clicks.len(), self.time.as_secs_f64());
        write!(to, "| {} | {clicks} | {wall_s:.0} s | {} | {} |", self.name, self.pauses, self.slow)
    }
}

/// The whole way.
#[derive(Debug)]
pub struct Taken {
    /// Its legs.
    pub legs: Vec<LegTaken>,
    /// Pauses of the arm that nobody asked for, in words.
    pub pauses: Vec<String>,
    /// Frames over 100 ms while nothing was computed, in words.
    pub slow: Vec<String>,
    /// Frames that were drawn.
    pub frames: u64,
    /// The longest frame while nothing was computed.
    pub longest: Duration,
    /// Where the bottom line led nowhere, so that the step at the left was clicked.
    pub lost: Vec<String>,
    /// Warnings that the window gave.
    pub warnings: Vec<String>,
}

impl Taken {
    /// Clicks from the first start to the end of a leg.
    ///
    /// # Panics
    /// When there is no such leg.
    pub fn clicks_until(&self, name: &str) -> usize {
        let last = self.legs.iter().position(|leg| leg.name == name).expect("a leg of the way");
        self.legs[..=last].iter().map(|leg| leg.clicks.len()).sum()
    }

    /// Wall time of the whole way, min.
    pub fn minutes(&self) -> f64 {
        self.legs.iter().map(|leg| leg.time.as_secs_f64()).sum::<f64>() / 60.0
    }
}

impl fmt::Display for Taken {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(to, "| leg | clicks | wall time | pauses not asked for | frames over 100 ms |")?;
        writeln!(to, "|---|---:|---:|---:|---:|")?;
        for leg in &self.legs {
            writeln!(to, "{leg}")?;
        }
        let clicks: usize = self.legs.iter().map(|leg| leg.clicks.len()).sum();
        let (pauses, slow) = (self.pauses.len(), self.slow.len());
        writeln!(to, "| all | {clicks} | {:.1} min | {pauses} | {slow} |", self.minutes())?;
        let longest_ms = self.longest.as_secs_f64() * 1e3;
        writeln!(to, "{} frames, the longest {longest_ms:.0} ms while nothing was computed", self.frames)?;
        for (what, all) in
            [("pause", &self.pauses), ("slow", &self.slow), ("lost", &self.lost), ("warned", &self.warnings)]
        {
            for one in all {
                writeln!(to, "{what}: {one}")?;
            }
        }
        Ok(())
    }
}

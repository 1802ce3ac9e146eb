//! The table of a run.

use std::fmt;

use super::{Summary, Tally, Verdict};

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.tallies.keys().map(String::len).max().unwrap_or(6).max(6);
        write!(f, "{:width$} {:>7}", "reader", "cases")?;
        for verdict in Verdict::ALL {
            write!(f, " {:>8}", verdict.name())?;
        }
        writeln!(f, " {:>9} {:>8}  case of it", "slowest", "mean")?;
        for (name, tally) in &self.tallies {
            row(f, width, name, tally)?;
        }
        let mut all = Tally::default();
        for tally in self.tallies.values() {
            for (verdict, count) in &tally.counts {
                *all.counts.entry(*verdict).or_default() += count;
            }
            all.slowest = all.slowest.max(tally.slowest);
            all.time += tally.time;
        }
        row(f, width, "all", &all)?;
        writeln!(f, "{} readers, {:.0} s", self.tallies.len(), self.time.as_secs_f64())
    }
}

fn row(f: &mut fmt::Formatter<'_>, width: usize, name: &str, tally: &Tally) -> fmt::Result {
    let cases: u64 = tally.counts.values().sum();
    write!(f, "{name:width$} {cases:>7}")?;
    for verdict in Verdict::ALL {
        write!(f, " {:>8}", tally.counts.get(verdict).copied().unwrap_or(0))?;
    }
    let mean_ms = tally.time.as_secs_f64() * 1e3 / cases.max(1) as f64;
    let slowest_ms = tally.slowest.as_secs_f64() * 1e3;
    writeln!(f, " {slowest_ms:>6.0} ms {mean_ms:>5.1} ms  {}", tally.slowest_index)
}

//! How large files of a kind can be. Each limit is far above what any use has needed, and far
//! below what would fill the memory.

use std::fmt;

/// A size in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Size(pub u64);

/// Rows of a table. A session of a whole day has some 10,000 touches; fits over more rows than
/// this would not end while somebody waits.
pub const MOST_ROWS: usize = 200_000;

impl Size {
    /// Settings, rigs, lists of names and other short texts: 4 MB.
    pub const SHORT: Self = Self(4_000_000);
    /// Tables, calibrations, robot descriptions and other texts: 64 MB.
    pub const TEXT: Self = Self(64_000_000);
    /// Correction models, findings and reports, which hold their evidence: 256 MB.
    pub const MODEL: Self = Self(256_000_000);
    /// One image or disparity map: 256 MB.
    pub const IMAGE: Self = Self(256_000_000);
    /// A network: 2 GB, what its format allows.
    pub const NETWORK: Self = Self(2_000_000_000);
    /// A video: 1 TB. Videos are never read whole; the limit only tells a file from nonsense.
    pub const VIDEO: Self = Self(1_000_000_000_000);
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [(u64, &str); 4] =
            [(1_000_000_000_000, "TB"), (1_000_000_000, "GB"), (1_000_000, "MB"), (1_000, "kB")];
        match UNITS.iter().find(|(bytes, _)| self.0 >= *bytes) {
            Some((bytes, unit)) if self.0.is_multiple_of(*bytes) => write!(f, "{} {unit}", self.0 / bytes),
            Some((bytes, unit)) => write!(f, "{:.1} {unit}", self.0 as f64 / *bytes as f64),
            None => write!(f, "{} bytes", self.0),
        }
    }
}

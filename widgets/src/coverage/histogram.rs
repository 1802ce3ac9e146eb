//! Counts of a quantity in equal bins.

/// A histogram over a fixed range. Values outside count in the outermost bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    range: [f64; 2],
    counts: Vec<u32>,
}

impl Histogram {
    /// An empty histogram; at least one bin.
    pub fn new(range: [f64; 2], bins: usize) -> Self {
        Self { range, counts: vec![0; bins.max(1)] }
    }

    /// Counts a value; one that is not finite counts nothing.
    pub fn add(&mut self, value: f64) {
        if value.is_finite() {
            let part = (value - self.range[0]) / (self.range[1] - self.range[0]);
            let last = self.counts.len() - 1;
            let bin = (part * self.counts.len() as f64).clamp(0.0, last as f64) as usize;
            self.counts[bin] += 1;
        }
    }

    /// Forgets all values.
    pub fn clear(&mut self) {
        self.counts.fill(0);
    }

    /// Ends of the range.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Counts, ascending.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// The first empty bin, if there is one.
    pub fn emptiest(&self) -> Option<[f64; 2]> {
        let bin = self.counts.iter().position(|count| *count == 0)?;
        let width = (self.range[1] - self.range[0]) / self.counts.len() as f64;
        let low = self.range[0] + bin as f64 * width;
        Some([low, low + width])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_value_counts_once() {
        let mut histogram = Histogram::new([0.0, 1.0], 4);
        for value in [-3.0, 0.0, 0.3, 0.5, 0.99, 1.0, 7.0, f64::NAN] {
            histogram.add(value);
        }
        assert_eq!(histogram.counts(), [2, 1, 1, 3]);
        assert_eq!(histogram.emptiest(), None);
        histogram.clear();
        assert_eq!(histogram.emptiest(), Some([0.0, 0.25]));
    }
}

//! How much lower the glass is looked for where the finger ends above it.

/// How much lower than the arm as it is described would have to be sent, m: an arm that stands higher than its
/// encoders say ends above the glass. The finger comes down slowly and stops at what it meets.
pub const LOWER_M: [f64; 3] = [0.0, 0.012, 0.024];

/// What one run knows of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Depth {
    /// Of [`LOWER_M`], what met the glass last.
    usual: usize,
    /// The touch that met nothing, and what is tried next for it.
    tried: Option<(usize, usize)>,
}

impl Depth {
    /// How much lower a touch is sent, m.
    pub fn lower_m(&self, number: usize) -> f64 {
        LOWER_M[self.step(number)]
    }

    fn step(&self, number: usize) -> usize {
        self.tried.filter(|(of, _)| *of == number).map_or(self.usual, |(_, step)| step)
    }

    /// A touch met the glass.
    pub fn met(&mut self, number: usize) {
        self.usual = self.step(number);
        self.tried = None;
    }

    /// A touch met nothing. How much lower it is looked for next, m; `None`: it was looked for everywhere.
    pub fn met_nothing(&mut self, number: usize) -> Option<f64> {
        let next = self.step(number) + 1;
        let lower_m = LOWER_M.get(next).copied();
        self.tried = lower_m.map(|_| (number, next));
        lower_m
    }

    /// Whether a touch is looked for lower than the ones before.
    pub fn is_lower(&self, number: usize) -> bool {
        self.step(number) > self.usual
    }

    /// What was tried does not count any more.
    pub fn forget(&mut self) {
        self.tried = None;
    }
}

//! How much deeper the glass is looked for where the finger ends above it.

/// How much deeper the finger goes on where it meets nothing, m: an arm that stands higher than its encoders say ends
/// above the glass. It comes from as high as always, slowly, and stops at what it meets.
pub const DEEPER_M: [f64; 3] = [0.0, 0.012, 0.024];

/// What one run knows of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Depth {
    /// Of [`DEEPER_M`], what met the glass last.
    usual: usize,
    /// The touch that met nothing, and what is tried next for it.
    tried: Option<(usize, usize)>,
}

impl Depth {
    /// How much deeper a touch may go, m.
    pub fn deeper_m(&self, number: usize) -> f64 {
        DEEPER_M[self.step(number)]
    }

    fn step(&self, number: usize) -> usize {
        self.tried.filter(|(of, _)| *of == number).map_or(self.usual, |(_, step)| step)
    }

    /// A touch met the glass.
    pub fn met(&mut self, number: usize) {
        self.usual = self.step(number);
        self.tried = None;
    }

    /// A touch met nothing. How much deeper it is looked for next, m; `None`: it was looked for everywhere.
    pub fn met_nothing(&mut self, number: usize) -> Option<f64> {
        let next = self.step(number) + 1;
        let deeper_m = DEEPER_M.get(next).copied();
        self.tried = deeper_m.map(|_| (number, next));
        deeper_m
    }

    /// What was tried does not count any more.
    pub fn forget(&mut self) {
        self.tried = None;
    }
}

//! The result: one disparity per pixel of the left view, or none.

/// Where a disparity comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Both views agree on it.
    Measured,
    /// Guessed from the surroundings, because the other view does not show this place, the
    /// views disagree, or the surface is too bare to be matched. Good for looking at, not for
    /// measuring.
    Filled,
}

/// Dense disparities of the left view, in pixels: a pixel (x, y) of the left view is shown at
/// (x − disparity, y) by the right view.
#[derive(Clone, Debug, PartialEq)]
pub struct DisparityMap {
    width_px: u32,
    height_px: u32,
    /// Row by row; +infinity where there is none, as in PFM files.
    disparities_px: Vec<f32>,
    filled: Vec<bool>,
}

impl DisparityMap {
    /// From disparities row by row (+infinity: none) and, for each, whether it was filled in.
    pub(super) fn new(width_px: u32, height_px: u32, disparities_px: Vec<f32>, filled: Vec<bool>) -> Self {
        assert_eq!(disparities_px.len(), width_px as usize * height_px as usize, "one disparity per pixel");
        assert_eq!(filled.len(), disparities_px.len(), "one origin per pixel");
        Self { width_px, height_px, disparities_px, filled }
    }

    /// From measured disparities in pixels, row by row; what is not finite counts as none.
    /// `None` when their number does not fit the size.
    pub fn from_measured(width_px: u32, height_px: u32, disparities_px: Vec<f32>) -> Option<Self> {
        let fits = disparities_px.len() == width_px as usize * height_px as usize;
        let known = |d: f32| if d.is_finite() { d } else { f32::INFINITY };
        let disparities_px: Vec<f32> = disparities_px.into_iter().map(known).collect();
        let filled = vec![false; disparities_px.len()];
        fits.then(|| Self::new(width_px, height_px, disparities_px, filled))
    }

    /// Width in pixels.
    pub fn width_px(&self) -> u32 {
        self.width_px
    }

    /// Height in pixels.
    pub fn height_px(&self) -> u32 {
        self.height_px
    }

    /// Disparity at a pixel, measured or filled in; `None` where there is none or outside.
    pub fn get(&self, x_px: u32, y_px: u32) -> Option<f32> {
        self.index(x_px, y_px).map(|i| self.disparities_px[i]).filter(|d| d.is_finite())
    }

    /// Disparity at a pixel if both views agree on it.
    pub fn measured(&self, x_px: u32, y_px: u32) -> Option<f32> {
        self.get(x_px, y_px).filter(|_| self.origin(x_px, y_px) == Some(Origin::Measured))
    }

    /// Where the disparity at a pixel comes from; `None` where there is none or outside.
    pub fn origin(&self, x_px: u32, y_px: u32) -> Option<Origin> {
        let i = self.index(x_px, y_px)?;
        match (self.disparities_px[i].is_finite(), self.filled[i]) {
            (false, _) => None,
            (true, true) => Some(Origin::Filled),
            (true, false) => Some(Origin::Measured),
        }
    }

    /// All disparities row by row, +infinity where there is none: for files and textures.
    pub fn as_slice(&self) -> &[f32] {
        &self.disparities_px
    }

    /// Part of the pixels (0..=1) that have a disparity, measured or filled in.
    pub fn valid_fraction(&self) -> f64 {
        self.fraction(|i| self.disparities_px[i].is_finite())
    }

    /// Part of the pixels (0..=1) on whose disparity both views agree.
    pub fn measured_fraction(&self) -> f64 {
        self.fraction(|i| self.disparities_px[i].is_finite() && !self.filled[i])
    }

    fn fraction(&self, counts: impl Fn(usize) -> bool) -> f64 {
        let all = self.disparities_px.len();
        (0..all).filter(|i| counts(*i)).count() as f64 / all.max(1) as f64
    }

    fn index(&self, x_px: u32, y_px: u32) -> Option<usize> {
        (x_px < self.width_px && y_px < self.height_px)
            .then(|| y_px as usize * self.width_px as usize + x_px as usize)
    }
}

//! Where the data of a correction model end, and how sure the model is at a pixel.
//!
//! A model that was learned from touches answers for every pixel, also for those that no touch
//! was near to. Two things tell the operator how far an answer may be trusted.
//!
//! # The border
//!
//! [`Border`] is drawn around the touches in three steps.
//!
//! 1. *Places.* Repeats of one target become one place. The spacing of the places is the median
//!    over them of the third nearest among the nearest neighbors to the right, below, to the left
//!    and above: in a grid its pitch, between dense parallel lines the distance of the lines. A
//!    place that has fewer than two others within three spacings is an outlier and has no say.
//! 2. *Closing.* The area is the set of pixels from which an empty disc, one that holds no place,
//!    of a radius of two spacings cannot come nearer than its radius less half a spacing. It is
//!    the union of discs about the places, closed by a disc and eroded to a margin of half a
//!    spacing. An empty disc of that size fits into no ordinary gap of the data, but it rolls
//!    into a bay and into a hole, which are outside.
//! 3. *Outline.* The distance to that union's edge is known exactly; where the area ends is
//!    traced by marching squares. Rings inside rings are holes.
//!
//! The union of discs as an estimate of a support is that of Devroye and Wise (1980, SIAM J.
//! Appl. Math. 38, 480–488). Closing it gives the α-convex hull, the curved relative of the alpha
//! shape: Edelsbrunner, Kirkpatrick and Seidel (1983, IEEE Trans. Inf. Theory 29, 551–559);
//! Rodríguez-Casal (2007, Ann. Inst. H. Poincaré Probab. Stat. 43, 763–774). The rule for the
//! spacing is this project's.
//!
//! # The spread
//!
//! [`Spread`] states, per axis, the standard deviation of the true correction at a new touch
//! about the model's answer. It is learned from residuals of touches that the model had not been
//! trained on:
//!
//! ```text
//! variance(q) = local(q) + gap · g(q)² + near · h(q)² + far · h(q)⁴ + rate² · max(h(q) − reach, 0)²
//! ```
//!
//! g is the distance to the nearest touch beyond half a spacing; outside, that of the nearest place
//! inside and the distance from it. h is the distance outside of the convex hull of the touches. The
//! four parts are fitted together to the residuals of left-out blocks and *their* distances to
//! the data that remained ([`Spread::fit_blocked`]), by maximum likelihood of zero-mean normal
//! residuals with the multiplicative updates of Févotte, Bertin and Durrieu (2009, Neural
//! Computation 21, 793–830), so that a model which extrapolates badly into a block shows it
//! outside of the border too. Beyond the `reach` of what blocks tell (9 of 10 of their touches that
//! lay outside of what remained are nearer) a stated physical rate is added
//! ([`Spread::FALLBACK_RATE_M_PER_PX`]). Growth in gaps is told from chance by Akaike's
//! criterion: if it does not pass, the local part is fitted without it. Few blocks tell little
//! about growth outside: its variance is widened as Student's t demands for their number.
//!
//! The local part is a mean of squared residuals weighted by a Gaussian of their distance and
//! blended with that of all touches. It is
//! scaled so that 1.96 standard deviations hold 95 % of the residuals themselves, each judged by
//! the others: errors of a model that is too stiff have shorter tails than a normal distribution,
//! those of touches longer ones (split conformal prediction with local weights: Lei, G'Sell,
//! Rinaldo, Tibshirani and Wasserman 2018, J. Am. Stat. Assoc. 113, 1094–1111). From fewer than
//! 34 touches it is widened by Student's t instead. Outside of the border its standard deviation
//! counts [`Spread::OUTSIDE_FACTOR`] times: there the interval may be too wide, not too narrow.

mod contour;
mod discs;
mod growth;
mod hull;
mod places;
mod region;
mod spread;
#[cfg(test)]
mod spread_tests;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;
use plumbline_model::Pixel;
use plumbline_model::session::Screen;
use serde::{Deserialize, Serialize};

pub(crate) use region::Region;
pub use spread::{Spread, SpreadError};

/// The area of the touchscreen that the touches cover.
///
/// ```
/// use plumbline_correction::border::Border;
/// use plumbline_model::Pixel;
///
/// let grid: Vec<_> = (0..24).map(|i| Pixel::new(f64::from(i % 6) * 100.0, f64::from(i / 6) * 100.0)).collect();
/// let border = Border::around(&grid).expect("a grid has an area");
/// assert!(border.contains(Pixel::new(250.0, 150.0)));
/// assert!(border.distance_outside_px(Pixel::new(800.0, 150.0)) > 200.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BorderFile", into = "BorderFile")]
pub struct Border {
    region: Region,
    rings: Vec<Vec<Pixel<Screen>>>,
}

/// Why touches have no border.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BorderError {
    /// Fewer than three places.
    #[error(
        "touches at {found} different places have no area: touch at least three places that are not on a line"
    )]
    TooFew {
        /// Places, repeats counted once.
        found: usize,
    },
    /// Nothing was touched beside the line.
    #[error("all touches lie on a line: touch places to both sides of it, a grid is best")]
    OnALine,
    /// A position that is no number.
    #[error("touch {index} (counted from 0) is at no finite pixel: reject it and touch again")]
    NotFinite {
        /// Which one.
        index: usize,
    },
    /// A stored border is damaged.
    #[error("the stored border of a model is damaged ({reason}): train the model again")]
    Damaged {
        /// What is wrong with it.
        reason: &'static str,
    },
}

impl Border {
    /// Draws the border around touches; their order does not matter, repeats count once and an
    /// outlier is left outside.
    ///
    /// # Errors
    /// Without three places that are not on a line, and for a pixel that is not finite.
    pub fn around(pixels: &[Pixel<Screen>]) -> Result<Self, BorderError> {
        let points: Vec<Vector2<f64>> = pixels.iter().map(Pixel::vector).collect();
        Ok(Self::of_region(Region::around(&points)?))
    }

    fn of_region(region: Region) -> Self {
        let rings =
            region.rings().iter().map(|ring| ring.iter().map(|&p| Pixel::from(p)).collect()).collect();
        Self { region, rings }
    }

    /// Whether a pixel lies in the area.
    pub fn contains(&self, pixel: Pixel<Screen>) -> bool {
        self.region.contains(pixel.vector())
    }

    /// Distance from the area in pixels; 0 inside.
    pub fn distance_outside_px(&self, pixel: Pixel<Screen>) -> f64 {
        self.region.distance_outside(pixel.vector())
    }

    /// The pixel of the area that is nearest: the pixel itself inside, else one on the border.
    pub fn nearest_inside(&self, pixel: Pixel<Screen>) -> Pixel<Screen> {
        Pixel::from(self.region.nearest_inside(pixel.vector()))
    }

    /// The outer edge of the largest part of the area: corners of a polygon, the last one joined
    /// to the first. Data with holes or in several parts have more [`Self::rings`].
    pub fn outline(&self) -> &[Pixel<Screen>] {
        &self.rings[0]
    }

    /// All edges, the one around the largest area first: parts, and holes inside of them.
    pub fn rings(&self) -> &[Vec<Pixel<Screen>>] {
        &self.rings
    }

    /// Spacing of the touched places in pixels; the margin around the outermost is half of it.
    pub fn spacing_px(&self) -> f64 {
        self.region.spacing()
    }
}

/// A border as it is stored: pixels (u, v).
#[derive(Clone, Debug, Serialize, Deserialize)]
struct BorderFile {
    spacing_px: f64,
    rings_px: Vec<Vec<[f64; 2]>>,
}

impl From<Border> for BorderFile {
    fn from(border: Border) -> Self {
        let ring = |ring: &Vec<Vector2<f64>>| ring.iter().map(|p| [p.x, p.y]).collect();
        Self {
            spacing_px: border.region.spacing(),
            rings_px: border.region.rings().iter().map(ring).collect(),
        }
    }
}

impl TryFrom<BorderFile> for Border {
    type Error = BorderError;

    fn try_from(file: BorderFile) -> Result<Self, BorderError> {
        let ring = |ring: Vec<[f64; 2]>| ring.into_iter().map(Vector2::from).collect();
        let rings = file.rings_px.into_iter().map(ring).collect();
        Ok(Self::of_region(Region::from_rings(rings, file.spacing_px)?))
    }
}

//! An area of the plane bounded by polygons, drawn around points. The unit is that of the points.

use nalgebra::Vector2;

use super::BorderError;
use super::contour::Lattice;
use super::discs::Discs;
use super::places::Places;

/// An empty disc of this radius, in spacings, separates.
const EMPTY_DISC: f64 = 2.0;
/// The area goes this far beyond its outermost places, in spacings.
pub(super) const MARGIN: f64 = 0.5;
/// Cells of the tracing lattice per spacing, and the most along one side.
const CELLS_PER_SPACING: f64 = 6.0;
const MOST_CELLS: f64 = 600.0;

/// Polygons: edges of parts of the area, and of holes in them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Region {
    rings: Vec<Vec<Vector2<f64>>>,
    spacing: f64,
}

impl Region {
    /// The area around points, see the description of the module.
    pub fn around(points: &[Vector2<f64>]) -> Result<Self, BorderError> {
        let Places { places, spacing } = Places::of(points)?;
        let radius = EMPTY_DISC * spacing;
        let lattice = lattice(&places, spacing);
        let discs = Discs::new(places, radius);
        let depth = radius - MARGIN * spacing;
        Self::from_rings(lattice.rings(|point| discs.is_deep(point, depth)), spacing)
    }

    /// From its edges.
    pub fn from_rings(mut rings: Vec<Vec<Vector2<f64>>>, spacing: f64) -> Result<Self, BorderError> {
        let damaged = |reason| Err(BorderError::Damaged { reason });
        if !(spacing > 0.0 && spacing.is_finite()) {
            return damaged("its spacing is not positive");
        }
        if rings.is_empty() || rings.iter().any(|ring| ring.len() < 3) {
            return damaged("an edge has fewer than three corners");
        }
        if rings.iter().flatten().any(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return damaged("a corner is no number");
        }
        rings.sort_by(|a, b| area(b).total_cmp(&area(a)));
        Ok(Self { rings, spacing })
    }

    pub fn rings(&self) -> &[Vec<Vector2<f64>>] {
        &self.rings
    }

    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Whether a point lies inside an odd number of edges.
    pub fn contains(&self, point: Vector2<f64>) -> bool {
        let crosses = |(a, b): &(Vector2<f64>, Vector2<f64>)| {
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.segments().filter(crosses).count() % 2 == 1
    }

    /// Distance from the area; 0 inside. NaN for a point that is not a number.
    pub fn distance_outside(&self, point: Vector2<f64>) -> f64 {
        (self.nearest_inside(point) - point).norm()
    }

    /// The point itself inside, else the nearest one of an edge.
    pub fn nearest_inside(&self, point: Vector2<f64>) -> Vector2<f64> {
        if self.contains(point) {
            return point;
        }
        let mut nearest = self.rings[0][0];
        for (a, b) in self.segments() {
            let along = b - a;
            // Two corners may coincide where the edge passes through a node of the lattice.
            let share = (point - a).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
            let candidate = a + share.clamp(0.0, 1.0) * along;
            if (candidate - point).norm_squared() < (nearest - point).norm_squared() {
                nearest = candidate;
            }
        }
        nearest
    }

    fn segments(&self) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> + '_ {
        self.rings.iter().flat_map(|ring| (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])))
    }
}

fn area(ring: &[Vector2<f64>]) -> f64 {
    (0..ring.len()).map(|i| ring[i].perp(&ring[(i + 1) % ring.len()])).sum::<f64>().abs() / 2.0
}

/// Nodes over the places and two spacings around them.
fn lattice(places: &[Vector2<f64>], spacing: f64) -> Lattice {
    let rim = Vector2::repeat(2.0 * spacing);
    let low = places.iter().fold(Vector2::repeat(f64::INFINITY), |low, p| low.inf(p)) - rim;
    let high = places.iter().fold(Vector2::repeat(f64::NEG_INFINITY), |high, p| high.sup(p)) + rim;
    let extent = high - low;
    let cell = (spacing / CELLS_PER_SPACING).max(extent.max() / MOST_CELLS);
    let nodes = |length: f64| (length / cell).ceil() as usize + 1;
    Lattice { origin: low, cell, size: (nodes(extent.x), nodes(extent.y)) }
}

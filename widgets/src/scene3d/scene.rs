//! What is in the scene: plain data, in the robot's frame, in meters.

use std::sync::Arc;

use egui::Color32;
use nalgebra::{Isometry3, Point3};

use super::facets::TriangleMesh;

/// Names a thing that can be clicked; the caller decides what it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PickId(pub u64);

/// What something means, and with that how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// Where the sensors say it is.
    Measured,
    /// Where a model says it is, as solid as if it were there.
    Predicted,
    /// Where it would be: predicted, translucent, over everything it is in front of.
    Ghost,
    /// Parts without a meaning of their own.
    Neutral,
    /// The touchscreen.
    Screen,
    /// The table.
    Table,
    /// A thing with a color of its own.
    Object(Color32),
    /// What the operator chose.
    Selected,
    /// Look here: a joint at its limit, a contact.
    Warning,
}

/// A shape around its own origin. Lengths in meters.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Edge lengths along x, y, z.
    Box {
        /// Whole edges, not halves.
        size_m: [f64; 3],
    },
    /// Radii along x, y, z.
    Ellipsoid {
        /// Half axes.
        radii_m: [f64; 3],
    },
    /// Along z: a cylinder with a half sphere at either end.
    Capsule {
        /// Of the cylinder and of the half spheres.
        radius_m: f64,
        /// Between the centers of the half spheres.
        length_m: f64,
    },
    /// Along z.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// From end to end.
        length_m: f64,
    },
    /// Any triangles; shared, because they are large and rarely change.
    Mesh(Arc<TriangleMesh>),
}

impl Shape {
    /// Radius of a sphere around the shape's origin that holds all of it. Not finite or not
    /// positive for a shape that cannot be drawn.
    pub fn bounding_radius_m(&self) -> f64 {
        let norm = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        match self {
            Self::Box { size_m } => usable(size_m, norm(size_m) / 2.0),
            // The largest radius; `max` alone would lose a NaN.
            Self::Ellipsoid { radii_m } => usable(radii_m, radii_m.iter().copied().fold(0.0, f64::max)),
            Self::Capsule { radius_m, length_m } if *length_m >= 0.0 => {
                usable(&[*radius_m], radius_m + length_m / 2.0)
            }
            Self::Capsule { .. } => f64::NAN,
            Self::Cylinder { radius_m, length_m } => {
                usable(&[*radius_m, *length_m], radius_m.hypot(length_m / 2.0))
            }
            Self::Mesh(mesh) => mesh.bounding_radius_m(),
        }
    }
}

/// The radius, where every length is a positive number.
fn usable(lengths_m: &[f64], radius_m: f64) -> f64 {
    if lengths_m.iter().all(|length| length.is_finite() && *length > 0.0) { radius_m } else { f64::NAN }
}

/// A shape at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its form.
    pub shape: Shape,
    /// Takes points of the shape to the robot's frame.
    pub robot_from_shape: Isometry3<f64>,
    /// What it means.
    pub tint: Tint,
    /// Who it is, if it can be clicked.
    pub pick: Option<PickId>,
}

impl Solid {
    /// A shape that is only looked at.
    pub fn new(shape: Shape, robot_from_shape: Isometry3<f64>, tint: Tint) -> Self {
        Self { shape, robot_from_shape, tint, pick: None }
    }

    /// Makes it clickable.
    pub fn pick(mut self, id: PickId) -> Self {
        self.pick = Some(id);
        self
    }

    /// Whether it has a place and a size, so that it can be drawn.
    pub fn is_drawable(&self) -> bool {
        let place = self.robot_from_shape.to_homogeneous();
        let radius_m = self.shape.bounding_radius_m();
        place.iter().all(|c| c.is_finite()) && radius_m.is_finite() && radius_m > 0.0
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineStyle {
    /// All of it the same.
    Plain,
    /// Old points, at the beginning, fade.
    Trail,
    /// With a head at the last point.
    Arrow,
}

/// A line through points, hidden by solids in front of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// At least two points in the robot's frame.
    pub points_m: Vec<Point3<f64>>,
    /// What it means.
    pub tint: Tint,
    /// Width on screen in points.
    pub width: f32,
    /// How it is drawn.
    pub style: LineStyle,
}

impl Line {
    /// A plain line.
    pub fn new(points_m: Vec<Point3<f64>>, tint: Tint) -> Self {
        Self { points_m, tint, width: 1.5, style: LineStyle::Plain }
    }

    /// The way something went, oldest point first.
    pub fn trail(points_m: Vec<Point3<f64>>, tint: Tint) -> Self {
        Self { width: 2.0, style: LineStyle::Trail, ..Self::new(points_m, tint) }
    }

    /// From one point to another.
    pub fn arrow(from_m: Point3<f64>, to_m: Point3<f64>, tint: Tint) -> Self {
        Self { width: 2.0, style: LineStyle::Arrow, ..Self::new(vec![from_m, to_m], tint) }
    }

    /// Another width, in points.
    pub fn width(mut self, width: f32) -> Self {
        self.width = width;
        self
    }

    fn is_drawable(&self) -> bool {
        let finite = |p: &Point3<f64>| p.iter().all(|c| c.is_finite());
        self.points_m.len() >= 2 && self.width > 0.0 && self.points_m.iter().all(finite)
    }
}

/// A dot of constant size on screen, hidden by solids in front of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// In the robot's frame.
    pub at_m: Point3<f64>,
    /// Radius on screen in points.
    pub radius: f32,
    /// What it means.
    pub tint: Tint,
}

/// Words at a place. Paler where a solid hides the place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label3d {
    /// In the robot's frame.
    pub at_m: Point3<f64>,
    /// The words.
    pub text: String,
    /// What it means.
    pub tint: Tint,
}

/// A grid on a horizontal plane, with the axes named along its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Height of the plane.
    pub z_m: f64,
    /// Nearest and farthest x (forward).
    pub x_m: [f64; 2],
    /// Rightmost and leftmost y (y points left).
    pub y_m: [f64; 2],
    /// Between two lines.
    pub step_m: f64,
}

impl Grid {
    /// The working side of the table, at a height.
    pub fn table(z_m: f64) -> Self {
        Self { z_m, x_m: [0.0, 0.8], y_m: [-0.6, 0.6], step_m: 0.1 }
    }

    /// Whether it has an extent and few enough lines to draw.
    pub(super) fn is_drawable(&self) -> bool {
        let spans = [self.x_m, self.y_m].map(|[low, high]| (high - low) / self.step_m);
        self.z_m.is_finite() && self.step_m > 0.0 && spans.iter().all(|lines| (1.0..=200.0).contains(lines))
    }
}

/// Everything there is to see.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Bodies.
    pub solids: Vec<Solid>,
    /// Trails, frusta, arrows.
    pub lines: Vec<Line>,
    /// Points of constant size.
    pub dots: Vec<Dot>,
    /// Words.
    pub labels: Vec<Label3d>,
    /// The plane that things stand on; solids drop a shadow straight down on what lies there.
    pub grid: Option<Grid>,
}

impl Scene {
    /// Whether there is anything but the grid.
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty() && self.lines.is_empty() && self.dots.is_empty() && self.labels.is_empty()
    }

    /// How many things have no valid place or size and are left out of the picture.
    pub fn left_out(&self) -> usize {
        let finite = |p: &Point3<f64>| p.iter().all(|c| c.is_finite());
        self.solids.iter().filter(|solid| !solid.is_drawable()).count()
            + self.drawn_lines(false).count()
            + self.dots.iter().filter(|dot| !finite(&dot.at_m)).count()
            + self.labels.iter().filter(|label| !finite(&label.at_m)).count()
    }

    pub(super) fn drawn_lines(&self, drawable: bool) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(move |line| line.is_drawable() == drawable)
    }
}

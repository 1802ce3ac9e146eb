//! What the twin's eyes can see, as plain data: shapes with materials, carried by bodies, and
//! where bodies and eyes are at one moment. Physics writes it, the renderer draws it.
//!
//! This is the twin's truth. Nothing that calibrates, searches or grasps may read it.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::frame::{LeftCamera, RightCamera, Robot};
use plumbline_model::{Camera, Chessboard, Pose};

/// Number of a body in [`Snapshot::robot_from_body`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyIndex(pub usize);

/// Everything visible; changes only when something is added or taken away.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scenery {
    /// Counts up with every change, so that a renderer knows when to upload again.
    pub revision: u64,
    /// All visible things.
    pub items: Vec<Item>,
    /// Where light comes from.
    pub light: Light,
}

/// One visible shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Which object of the world it belongs to (0 is the background), so that boxes can be
    /// drawn from an image of ids.
    pub object: u16,
    /// The body that carries it.
    pub body: BodyIndex,
    /// Place of the shape on its body, meters.
    pub body_from_shape: Isometry3<f64>,
    /// Its form.
    pub shape: Shape,
    /// Its surface.
    pub material: Material,
}

/// Forms, all centered on their own origin; meters.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A box.
    Box {
        /// Half of its extents.
        half_m: Vector3<f64>,
    },
    /// A ball, or an ellipsoid.
    Ellipsoid {
        /// Radii along x, y, z.
        radii_m: Vector3<f64>,
    },
    /// A cylinder along z with round ends; the ends are not part of the half length.
    Capsule {
        /// Radius.
        radius_m: f64,
        /// Half of the straight part.
        half_length_m: f64,
    },
    /// A cylinder along z with flat ends.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// Half of its length.
        half_length_m: f64,
    },
    /// A flat chessboard on a sheet with a white margin one square wide; frame `Board`: origin
    /// at the first inner corner, x along the columns, y along the rows, z into the board.
    Board {
        /// Squares and their size.
        board: Chessboard,
    },
    /// Any closed or open surface.
    Mesh {
        /// Vertices, normals, triangles.
        mesh: Arc<Mesh>,
    },
}

/// A triangle mesh, meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Point3<f32>>,
    /// Unit normal of each vertex.
    pub normals: Vec<Vector3<f32>>,
    /// Triples of vertex numbers, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Diffuse reflectance of red, green, blue, 0–1, linear light.
    pub albedo: [f32; 3],
    /// Share of light reflected like by a mirror, 0–1 (the glass of the touchscreen, plastic).
    pub gloss: f32,
    /// Pattern on it.
    pub pattern: Pattern,
}

/// Patterns, fixed to the shape (so that stereo matching has something to hold on to).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// None.
    Plain,
    /// Random speckles, as on the table's laminate.
    Speckle {
        /// Typical size of a speckle, meters.
        size_m: f32,
        /// How much they differ from the albedo, 0–1.
        contrast: f32,
    },
    /// Vertical folds, as of a curtain.
    Folds {
        /// Distance of two folds, meters.
        period_m: f32,
        /// How much they differ from the albedo, 0–1.
        contrast: f32,
    },
}

/// Light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Direction that the light of the lamp goes, robot frame; need not be a unit vector.
    pub toward: Vector3<f64>,
    /// Strength of the lamp against the light from everywhere.
    pub lamp: f32,
    /// Strength of the light from everywhere.
    pub ambient: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self { toward: Vector3::new(0.35, -0.25, -1.0), lamp: 0.75, ambient: 0.35 }
    }
}

/// Where everything is at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Place of every body, by [`BodyIndex`]; the robot frame is the torso's base.
    pub robot_from_body: Vec<Isometry3<f64>>,
    /// The true eyes at this moment.
    pub eyes: TrueEyes,
}

/// The true eyes: where they are and how they project.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueEyes {
    /// Place of the left eye.
    pub robot_from_left: Pose<Robot, LeftCamera>,
    /// Place of the right eye.
    pub robot_from_right: Pose<Robot, RightCamera>,
    /// Lens of the left eye.
    pub left: Camera,
    /// Lens of the right eye.
    pub right: Camera,
}

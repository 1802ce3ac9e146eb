//! Coordinate frames as types, so that a wrong composition does not compile.
//!
//! `Pose<A, B>` is `a_from_b`: it takes a point known in `B` to the same point in `A`.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Mul;

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// A right-handed coordinate frame, in meters.
pub trait Frame: Copy + fmt::Debug + Send + Sync + 'static {
    /// Lower-case name, as it stands in files and messages.
    const NAME: &'static str;
}

macro_rules! frames {
    ($($(#[$doc:meta])* $name:ident = $text:literal;)*) => {
        $($(#[$doc])* #[derive(Clone, Copy, Debug, PartialEq, Eq)] pub struct $name;
          impl Frame for $name { const NAME: &'static str = $text; })*
    };
}

frames! {
    /// Torso base link: x forward (away from the robot), y left, z up.
    Robot = "robot";
    /// Left eye, OpenCV axes: x right, y down, z along the optical axis.
    LeftCamera = "left camera";
    /// Right eye, OpenCV axes: x right, y down, z along the optical axis.
    RightCamera = "right camera";
    /// The virtual left eye after aiming: x along the baseline towards the right eye.
    LeftRectified = "left rectified";
    /// The virtual right eye after aiming: same axes as `LeftRectified`, moved by the baseline.
    RightRectified = "right rectified";
    /// Chessboard: x along its columns, y along its rows, z into the board; origin at the
    /// first inner corner.
    Board = "board";
    /// A link of the robot, told apart at run time.
    Link = "link";
    /// The tip of a kinematic chain, told apart at run time.
    Tip = "tip";
    /// The robot's head, as its description places it.
    Head = "head";
}

/// A point whose coordinates are known in frame `F`, in meters.
pub struct Point<F: Frame> {
    /// Coordinates in meters.
    pub coords: Point3<f64>,
    frame: PhantomData<F>,
}

/// A unit vector known in frame `F`.
pub struct Direction<F: Frame> {
    vector: nalgebra::Unit<Vector3<f64>>,
    frame: PhantomData<F>,
}

/// The rigid transform `to_from_from`: takes points in `From` to points in `To`.
pub struct Pose<To: Frame, From: Frame> {
    /// Rotation and translation (meters).
    pub isometry: Isometry3<f64>,
    frames: PhantomData<(To, From)>,
}

impl<F: Frame> Point<F> {
    /// A point from its coordinates in meters.
    pub fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self::from(Point3::new(x_m, y_m, z_m))
    }

    /// Straight-line distance to another point of the same frame, in meters.
    pub fn distance_m(&self, other: &Self) -> f64 {
        (self.coords - other.coords).norm()
    }

    /// Distance from the origin of the frame, in meters.
    pub fn range_m(&self) -> f64 {
        self.coords.coords.norm()
    }

    /// Direction from the origin of the frame; `None` at the origin.
    pub fn direction(&self) -> Option<Direction<F>> {
        Direction::new(self.coords.coords)
    }
}

impl<F: Frame> From<Point3<f64>> for Point<F> {
    fn from(coords: Point3<f64>) -> Self {
        Self { coords, frame: PhantomData }
    }
}

impl<F: Frame> Direction<F> {
    /// Normalizes; `None` when the vector is too short or not finite.
    pub fn new(vector: Vector3<f64>) -> Option<Self> {
        // The length of a vector of wild components is not finite, which leaves a unit of length zero.
        nalgebra::Unit::try_new(vector, 1e-12)
            .filter(|unit| vector.norm().is_finite() && unit.iter().all(|c| c.is_finite()))
            .map(|vector| Self { vector, frame: PhantomData })
    }

    /// The unit vector.
    pub fn vector(&self) -> Vector3<f64> {
        self.vector.into_inner()
    }

    /// Angle to another direction, in radians.
    pub fn angle_rad(&self, other: &Self) -> f64 {
        // atan2 keeps its precision for small angles, where acos loses it.
        self.vector.cross(&other.vector).norm().atan2(self.vector.dot(&other.vector))
    }
}

impl<To: Frame, From: Frame> Pose<To, From> {
    /// From rotation and translation (meters).
    pub fn new(isometry: Isometry3<f64>) -> Self {
        Self { isometry, frames: PhantomData }
    }

    /// From a rotation vector (axis times angle, radians) and a translation (meters).
    pub fn from_rotation_vector(rotation_rad: Vector3<f64>, translation_m: Vector3<f64>) -> Self {
        Self::new(Isometry3::new(translation_m, rotation_rad))
    }

    /// From a rotation matrix and a translation; the matrix is made orthonormal first.
    pub fn from_matrix(rotation: &Matrix3<f64>, translation_m: Vector3<f64>) -> Self {
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(rotation));
        Self::new(Isometry3::from_parts(Translation3::from(translation_m), rotation))
    }

    /// No motion.
    pub fn identity() -> Self {
        Self::new(Isometry3::identity())
    }

    /// `from_from_to`: the transform the other way.
    pub fn inverse(&self) -> Pose<From, To> {
        Pose::new(self.isometry.inverse())
    }

    /// Rotation matrix.
    pub fn rotation(&self) -> Matrix3<f64> {
        self.isometry.rotation.to_rotation_matrix().into_inner()
    }

    /// Rotation vector (axis times angle), radians.
    pub fn rotation_vector_rad(&self) -> Vector3<f64> {
        self.isometry.rotation.scaled_axis()
    }

    /// Translation in meters: the origin of `From`, in `To`.
    pub fn translation_m(&self) -> Vector3<f64> {
        self.isometry.translation.vector
    }

    /// Turns a direction of `From` into `To`.
    pub fn turn(&self, direction: &Direction<From>) -> Direction<To> {
        Direction {
            vector: nalgebra::Unit::new_unchecked(self.isometry.rotation * direction.vector()),
            frame: PhantomData,
        }
    }
}

impl<A: Frame, B: Frame, C: Frame> Mul<Pose<B, C>> for Pose<A, B> {
    type Output = Pose<A, C>;
    fn mul(self, b_from_c: Pose<B, C>) -> Pose<A, C> {
        Pose::new(self.isometry * b_from_c.isometry)
    }
}

impl<A: Frame, B: Frame> Mul<Point<B>> for Pose<A, B> {
    type Output = Point<A>;
    fn mul(self, point_in_b: Point<B>) -> Point<A> {
        Point::from(self.isometry * point_in_b.coords)
    }
}

// Derives would ask the frame markers for the same traits; these types do not need them to.
impl<F: Frame> Clone for Point<F> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F: Frame> Copy for Point<F> {}
impl<F: Frame> PartialEq for Point<F> {
    fn eq(&self, other: &Self) -> bool {
        self.coords == other.coords
    }
}
impl<F: Frame> fmt::Debug for Point<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {}) m in {}", self.coords.x, self.coords.y, self.coords.z, F::NAME)
    }
}
impl<F: Frame> Clone for Direction<F> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F: Frame> Copy for Direction<F> {}
impl<F: Frame> fmt::Debug for Direction<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "direction ({}, {}, {}) in {}", self.vector.x, self.vector.y, self.vector.z, F::NAME)
    }
}
impl<A: Frame, B: Frame> Clone for Pose<A, B> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<A: Frame, B: Frame> Copy for Pose<A, B> {}
impl<A: Frame, B: Frame> PartialEq for Pose<A, B> {
    fn eq(&self, other: &Self) -> bool {
        self.isometry == other.isometry
    }
}
impl<A: Frame, B: Frame> fmt::Debug for Pose<A, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (r, t) = (self.rotation_vector_rad(), self.translation_m());
        write!(
            f,
            "{} from {}: rotation ({}, {}, {}) rad, translation ({}, {}, {}) m",
            A::NAME,
            B::NAME,
            r.x,
            r.y,
            r.z,
            t.x,
            t.y,
            t.z
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose() -> Pose<RightCamera, LeftCamera> {
        Pose::from_rotation_vector(Vector3::new(0.1, -0.2, 0.3), Vector3::new(-0.07, 0.001, 0.002))
    }

    #[test]
    fn inverse_undoes() {
        let point_in_left = Point::<LeftCamera>::new(0.1, 0.2, 0.5);
        let back = pose().inverse() * (pose() * point_in_left);
        assert!(back.distance_m(&point_in_left) < 1e-15);
    }

    #[test]
    fn rotation_vector_round_trips() {
        let r = pose().rotation_vector_rad();
        assert!((r - Vector3::new(0.1, -0.2, 0.3)).norm() < 1e-15);
    }

    #[test]
    fn small_angles_keep_their_precision() {
        let a = Direction::<Robot>::new(Vector3::new(1.0, 0.0, 0.0)).expect("unit");
        let b = Direction::<Robot>::new(Vector3::new(1.0, 1e-9, 0.0)).expect("unit");
        assert!((a.angle_rad(&b) - 1e-9).abs() < 1e-18);
    }

    #[test]
    fn a_zero_vector_has_no_direction() {
        assert!(Direction::<Robot>::new(Vector3::zeros()).is_none());
        assert!(Direction::<Robot>::new(Vector3::new(f64::NAN, 0.0, 1.0)).is_none());
        assert!(Direction::<Robot>::new(Vector3::new(1e308, 1e308, 0.0)).is_none());
    }
}

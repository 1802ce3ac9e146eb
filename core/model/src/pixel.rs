//! Pixels of raw and of rectified images as different types. (0, 0) is the center of the
//! top-left pixel.

use std::fmt;
use std::marker::PhantomData;

use nalgebra::Vector2;

/// Which image a pixel belongs to.
pub trait PixelSpace: Copy + fmt::Debug + Send + Sync + 'static {
    /// Name for messages.
    const NAME: &'static str;
}

/// The image as the camera delivers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raw;
impl PixelSpace for Raw {
    const NAME: &'static str = "raw";
}

/// The image after aiming and rectification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectified;
impl PixelSpace for Rectified {
    const NAME: &'static str = "rectified";
}

/// A position in an image, in pixels.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(bound = "")]
pub struct Pixel<S: PixelSpace> {
    /// Column, to the right.
    pub u_px: f64,
    /// Row, downward.
    pub v_px: f64,
    #[serde(skip)]
    space: PhantomData<S>,
}

impl<S: PixelSpace> Pixel<S> {
    /// From column and row.
    pub fn new(u_px: f64, v_px: f64) -> Self {
        Self { u_px, v_px, space: PhantomData }
    }

    /// As a vector (u, v).
    pub fn vector(&self) -> Vector2<f64> {
        Vector2::new(self.u_px, self.v_px)
    }

    /// Distance in pixels.
    pub fn distance_px(&self, other: &Self) -> f64 {
        (self.vector() - other.vector()).norm()
    }

    /// Whether the pixel lies on an image of this size (centers of the outer pixels included).
    pub fn is_inside(&self, size: (u32, u32)) -> bool {
        self.u_px >= 0.0
            && self.v_px >= 0.0
            && self.u_px <= f64::from(size.0) - 1.0
            && self.v_px <= f64::from(size.1) - 1.0
    }
}

impl<S: PixelSpace> From<Vector2<f64>> for Pixel<S> {
    fn from(v: Vector2<f64>) -> Self {
        Self::new(v.x, v.y)
    }
}
impl<S: PixelSpace> Clone for Pixel<S> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: PixelSpace> Copy for Pixel<S> {}
impl<S: PixelSpace> PartialEq for Pixel<S> {
    fn eq(&self, other: &Self) -> bool {
        self.u_px == other.u_px && self.v_px == other.v_px
    }
}
impl<S: PixelSpace> fmt::Debug for Pixel<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} pixel ({}, {})", S::NAME, self.u_px, self.v_px)
    }
}

/// One of the two eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Eye {
    /// The robot's left eye.
    Left,
    /// The robot's right eye.
    Right,
}

impl Eye {
    /// Both eyes, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 0 for left, 1 for right.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }
}

impl fmt::Display for Eye {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

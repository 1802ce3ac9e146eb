//! The twin's eyes: what both cameras of the robot see of a [`Scenery`](crate::scene::Scenery),
//! rendered on whatever Vulkan device there is, the CPU included.
//!
//! Every pixel sends four rays through the lens (Kannala–Brandt, inverted exactly) against analytic
//! shapes, so edges and chessboard corners are where the camera model says, to about 1/1000 px. Tiles
//! of 16×16 pixels know which shapes they can meet. Light comes from one lamp with shadows and
//! evenly from everywhere; flat glossy boxes mirror. A [`Sensor`] makes an image of it: lens blur,
//! exposure, face shell, noise.
//!
//! Left out: light that bounces, depth of field, motion blur, rolling shutter.

mod buffers;
mod error;
mod gpu;
mod layouts;
mod mesh_tree;
mod numbers;
mod pack;
mod renderer;
pub mod sample;
mod sensor;
mod shadow;
mod speckle;
mod stream;
mod tiles;

pub use error::RenderError;
pub use gpu::AdapterChoice;
pub use renderer::{EyeOptions, EyeRenderer, LabeledPair, ObjectImage, RenderedPair};
pub(crate) use sensor::theta_d;
pub use sensor::{FaceShell, Sensor};

pub use stream::{EyeControls, SceneView, TwinEyes, TwinEyesOptions};

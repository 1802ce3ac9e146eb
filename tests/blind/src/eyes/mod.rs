//! Eyes in a head that turns, and one thing watched over time.
//!
//! Fisheye lenses of the rig's numbers look at things whose places are known to a share of the noise; image points or
//! estimates in the robot's frame are written. Bodies are turned and moved in their sockets, lenses and sensors are
//! changed, zeros and axes of the neck are off, and all of it is followed through own optics.

mod cases;
mod head;
mod plan;
mod secret;

pub use cases::{make, recipes};
pub use secret::Kind;

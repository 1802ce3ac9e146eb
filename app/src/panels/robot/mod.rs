//! The robot: where it is, moving it by joints, by poses, by hand. Whatever moves is shown
//! first and runs only when asked for.

pub mod state;

mod bodies;
mod inspector;
mod jog;
mod joints;
mod parts;
mod poses;
mod scene;

pub use inspector::show as show_inspector;
pub use jog::show as show_jog;
pub use joints::show as show_joints;
pub use poses::show as show_poses;
pub use scene::show as show_scene;

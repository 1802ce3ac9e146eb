//! Widgets over plain data. They draw what they are given, return what the operator did, and
//! compute nothing that takes longer than a frame.

pub mod empty;
pub mod format;
pub mod glyph;
pub mod image_view;
pub mod overlay;
pub mod texture;
pub mod theme;

pub use empty::{EmptyState, Message, empty_state};
pub use image_view::{Content, ImageTransform, ImageView, ImageViewResponse, ViewState};
pub use overlay::{Ink, Mark, Overlay, PointShape};
pub use texture::{Picture, Sampling, TextureCache};
pub use theme::Role;

//! Widgets over plain data. They draw what they are given, return what the operator did, and
//! compute nothing that takes longer than a frame.

pub mod axis;
pub mod colormap;
pub mod compare;
pub mod empty;
pub mod format;
pub mod ghost;
pub mod glyph;
pub mod image_view;
pub mod overlay;
pub mod residuals;
pub mod texture;
pub mod theme;

pub use colormap::{ColorScale, Colormap, Orientation, ScaleBar};
pub use empty::{EmptyState, Message, empty_state};
pub use ghost::{Ghost, ghost};
pub use image_view::{Content, ImageTransform, ImageView, ImageViewResponse, ViewState};
pub use overlay::{Ink, Mark, Overlay, PointShape};
pub use residuals::{arrow_scale, residual_arrows};
pub use texture::{Picture, Sampling, TextureCache};
pub use theme::Role;

//! Widgets over plain data. They draw what they are given, return what the operator did, and
//! compute nothing that takes longer than a frame.

mod arrow_key;
pub mod axis;
pub mod bars;
pub mod box_canvas;
pub mod buttons;
pub mod colormap;
pub mod compare;
pub mod coverage;
pub mod empty;
pub mod format;
pub mod gallery;
pub mod ghost;
pub mod glyph;
pub mod history;
pub mod image_view;
pub mod intervals;
pub mod jog_pad;
pub mod joint_row;
pub mod key_value;
pub mod lamp;
pub mod loss_curves;
pub mod notifications;
pub mod number_field;
pub mod overlay;
mod own_part;
pub mod parameter;
pub mod probability;
pub mod progress;
pub mod rail;
pub mod residuals;
pub mod scatter;
pub mod scene3d;
pub mod seen;
pub mod steady;
pub mod table_map;
pub mod texture;
pub mod theme;
pub mod touch_pattern;
pub mod view_state;

pub use bars::{BarRef, BarsResponse, PairBar, PairBars};
pub use box_canvas::{BoxCanvas, CanvasBox, CanvasResponse, CanvasState, Placed};
pub use buttons::{ArmState, accent_button, choice, primary_button, stop_button, stop_keys, stop_pressed};
pub use colormap::{ColorScale, Colormap, Orientation, ScaleBar};
pub use coverage::{Coverage, coverage_view};
pub use empty::{EmptyState, Message, empty_state};
pub use format::Quantity;
pub use ghost::{Ghost, ghost};
pub use history::{History, Sparkline};
pub use image_view::{Content, ImageTransform, ImageView, ImageViewResponse, ViewState};
pub use intervals::{IntervalRow, Intervals, Level};
pub use jog_pad::{JogIntent, JogPad, JogPadResponse, JogSpeed};
pub use joint_row::{
    Freshness, JointHistory, JointRow, JointRowResponse, JointState, ReducedRange, joint_header,
};
pub use key_value::{KeyValue, big_figure, key_value_grid};
pub use lamp::{Health, Lamp};
pub use loss_curves::{LossCurve, LossCurves, loss_legend, loss_range};
pub use notifications::{Notification, Notifications, Severity};
pub use number_field::NumberField;
pub use overlay::{Ink, Mark, Overlay, PointShape};
pub use probability::{ShareRow, probability_bar, share_rows};
pub use progress::{ProgressAction, ProgressLine, progress_bar};
pub use rail::{RailStep, StepState};
pub use residuals::{arrow_scale, residual_arrows};
pub use scatter::{Scatter, ScatterSeries};
pub use scene3d::{Scene, Scene3d, Scene3dResponse, SceneCamera};
pub use seen::{Memo, Seen};
pub use table_map::{
    BeforeAfter, Border, Outline, Place, PointsResponse, ScalarField, TableMap, TableMapResponse, TableMark,
    TablePoint, TableScene,
};
pub use texture::{Picture, Sampling, TextureCache};
pub use theme::Role;
pub use theme::{class_color, class_swatch, class_words};
pub use touch_pattern::{PatternArea, TouchMark, TouchMarkState, TouchPattern, TouchPatternResponse};

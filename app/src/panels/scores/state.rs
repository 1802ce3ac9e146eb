//! How scores are looked at.

use plumbline_widgets::image_view::ViewState;

/// How scores are looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct ScoresPanels {
    /// The model whose confusion matrix is shown, by place in the table.
    pub model: usize,
    /// Whether the matrix shows shares of the row rather than counts.
    pub shares: bool,
    /// Zoom of the large picture.
    pub view: ViewState,
}

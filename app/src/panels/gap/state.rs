//! How the gap is looked at.

use plumbline_engine::view::ShownFinding;
use plumbline_widgets::{Memo, Seen};

use super::drawn::Drawn;
use super::points::{Along, Points};
use crate::panels::arrows::Errors;

/// How the gap is looked at: kept from frame to frame, never saved.
#[derive(Debug, Default)]
pub struct GapPanels {
    /// Which errors the map shows.
    pub errors: Errors,
    /// The covariate that residuals are drawn against; `None`: the one that tells most.
    pub covariate: Option<usize>,
    /// Which part of the residual is drawn.
    pub along: Along,
    /// How the candidates are sorted.
    pub sort: Sort,
    /// The finding that `covariate` belongs to.
    pub(crate) of: String,
    /// Whether the search ran in the last frame.
    pub searching_seen: bool,
    pub(crate) map: Memo<Seen<ShownFinding>, Drawn>,
    pub(crate) scatter: Memo<(Seen<ShownFinding>, usize, Along), Points>,
}

/// How the candidates are sorted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sort {
    /// The most probable first.
    #[default]
    Probability,
    /// What the residual points at most first.
    Score,
    /// By name.
    Name,
}

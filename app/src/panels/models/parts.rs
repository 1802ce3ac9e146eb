//! What the panes of this folder share.

use std::sync::Arc;

use super::verdict::{Basis, Facts};
use crate::operator::snapshot::models::Method;
use crate::panels::PanelContext;

/// What is told about all methods.
pub fn facts(cx: &mut PanelContext<'_>) -> Arc<Facts> {
    let models = &cx.view.models;
    cx.state.models.standing.get(Basis::of(models), || Facts::of(models))
}

/// What a method is made of; short, for a narrow tile.
pub fn about(method: Method) -> &'static str {
    match method {
        Method::M1 => "place and heights of the grid",
        Method::M2 => "small network, height of M1",
        Method::M3 => "larger network for x, y, z",
    }
}

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

/// What the network of a method looks like as published, or what it is instead.
pub fn about(method: Method) -> &'static str {
    match method {
        Method::M1 => "screen placement, measured height between grid points",
        Method::M2 => "network 2–16–2 for x and y, height of M1",
        Method::M3 => "network 2–64–3 for x, y and z",
    }
}

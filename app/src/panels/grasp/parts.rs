//! What the panes of this folder share with others.

use nalgebra::Point3;
use plumbline_model::robot::Posture;

use crate::operator::Screen;
use crate::panels::PanelContext;

/// The posture of the planned motion at which the ghost stands; `None` while nothing is planned.
pub fn ghost(cx: &PanelContext<'_>) -> Option<Posture> {
    let plan = cx.view.grasp.plan.as_ref().filter(|_| cx.screen == Screen::Grasp)?;
    let last = plan.postures.len().checked_sub(1)?;
    let at = cx.state.grasp.along.clamp(0.0, 1.0) * last as f64;
    let (from, part) = (at.floor() as usize, at.fract());
    let next = plan.postures.get(from + 1).unwrap_or(&plan.postures[last]);
    Some(plan.postures[from.min(last)].toward(next, part))
}

/// Where the palm would go, robot frame, m.
pub fn palm_way(cx: &PanelContext<'_>) -> Vec<Point3<f64>> {
    let plan = cx.view.grasp.plan.as_ref().filter(|_| cx.screen == Screen::Grasp);
    plan.map(|plan| plan.palm_way_m.iter().map(|[x, y, z]| Point3::new(*x, *y, *z)).collect())
        .unwrap_or_default()
}

//! Where to hold the board next.

use egui::Align2;

use crate::overlay::{Mark, Overlay, PointShape, bounds_px};
use crate::theme::Role;

/// How far the board that is seen is from where it is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ghost {
    /// Not there yet.
    Wanted,
    /// There: hold still.
    Reached,
}

/// The outline of a board, as corners in drawing order in the pixels of one eye, with a word of
/// what to do at its top. The first corner is marked, so that the board is not held upside down.
/// Nothing for fewer than three corners.
pub fn ghost(outline_px: &[[f64; 2]], ghost: Ghost, text: &str) -> Overlay {
    let mut overlay = Overlay::new();
    let (Some(bounds), true) = (bounds_px(outline_px), outline_px.len() >= 3) else {
        return overlay;
    };
    let (role, opacity) = match ghost {
        Ghost::Wanted => (Role::Predicted, 0.12),
        Ghost::Reached => (Role::Accepted, 0.25),
    };
    let points_px = outline_px.to_vec();
    overlay.push(Mark::Area { points_px: points_px.clone(), opacity, ink: role.into() });
    overlay.push(Mark::Line {
        points_px,
        closed: true,
        dashed: ghost == Ghost::Wanted,
        width_pt: 2.0,
        ink: role.into(),
    });
    overlay.point(outline_px[0], PointShape::Dot, 5.0, role);
    if !text.is_empty() {
        let at_px = [f64::from(bounds.center().x), f64::from(bounds.center().y)];
        overlay.push(Mark::Text {
            at_px,
            text: text.to_owned(),
            anchor: Align2::CENTER_CENTER,
            ink: role.into(),
        });
    }
    overlay
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTLINE: [[f64; 2]; 4] = [[10.0, 10.0], [60.0, 12.0], [58.0, 40.0], [9.0, 38.0]];

    #[test]
    fn wanted_is_dashed_and_reached_is_not() {
        let dashed = |state| {
            let overlay = ghost(&OUTLINE, state, "Hold the board here");
            overlay.marks.iter().any(|mark| matches!(mark, Mark::Line { dashed: true, closed: true, .. }))
        };
        assert!(dashed(Ghost::Wanted));
        assert!(!dashed(Ghost::Reached));
    }

    #[test]
    fn too_few_corners_draw_nothing() {
        assert!(ghost(&OUTLINE[..2], Ghost::Wanted, "").marks.is_empty());
        assert!(ghost(&[], Ghost::Wanted, "").marks.is_empty());
    }
}

//! Which part of a box is under the pointer, and what dragging it does. Plain geometry in pixels.

use plumbline_model::PixelBox;

/// Which edge of an axis is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// None of them.
    #[default]
    None,
    /// Left or top.
    Low,
    /// Right or bottom.
    High,
}

/// What is held of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// The whole box.
    Body,
    /// An edge, or two that meet at a corner.
    Edges {
        /// Left or right.
        x: Side,
        /// Top or bottom.
        y: Side,
    },
}

/// Edges stay this far apart, px.
const LEAST_PX: f32 = 2.0;

/// What is under a point, within a tolerance that leaves the middle of a small box for moving it.
pub fn grip_at(area: &PixelBox, [x, y]: [f32; 2], tolerance_px: f32) -> Option<Grip> {
    let outside = |v: f32, low: f32, high: f32| v < low - tolerance_px || v > high + tolerance_px;
    if outside(x, area.x0_px, area.x1_px) || outside(y, area.y0_px, area.y1_px) {
        return None;
    }
    let side = |v: f32, low: f32, high: f32| {
        let inside = tolerance_px.min(0.25 * (high - low));
        if v < low + inside {
            Side::Low
        } else if v > high - inside {
            Side::High
        } else {
            Side::None
        }
    };
    match (side(x, area.x0_px, area.x1_px), side(y, area.y0_px, area.y1_px)) {
        (Side::None, Side::None) => Some(Grip::Body),
        (x, y) => Some(Grip::Edges { x, y }),
    }
}

/// The box that a click means: the smallest one under the point, so that a box inside another can be
/// reached.
pub fn box_at<'a>(boxes: impl Iterator<Item = (usize, &'a PixelBox)>, [x, y]: [f32; 2]) -> Option<usize> {
    let under = boxes
        .filter(|(_, area)| (area.x0_px..=area.x1_px).contains(&x) && (area.y0_px..=area.y1_px).contains(&y));
    under.min_by(|(_, a), (_, b)| a.area_px2().total_cmp(&b.area_px2())).map(|(index, _)| index)
}

/// The box after what is held of it was dragged by so many pixels, on an image of this size.
pub fn dragged(area: &PixelBox, grip: Grip, [dx, dy]: [f32; 2], size_px: [f32; 2]) -> PixelBox {
    let [width, height] = size_px;
    match grip {
        Grip::Body => {
            let shift = |low: f32, high: f32, by: f32, size: f32| by.max(-low).min(size - high);
            let dx = shift(area.x0_px, area.x1_px, dx, width);
            let dy = shift(area.y0_px, area.y1_px, dy, height);
            PixelBox::new(area.x0_px + dx, area.y0_px + dy, area.x1_px + dx, area.y1_px + dy)
        }
        Grip::Edges { x, y } => {
            let (x0_px, x1_px) = pulled(area.x0_px, area.x1_px, x, dx, width);
            let (y0_px, y1_px) = pulled(area.y0_px, area.y1_px, y, dy, height);
            PixelBox::new(x0_px, y0_px, x1_px, y1_px)
        }
    }
}

/// The edges of one axis after one of them was pulled; never beyond the other one or off the image.
fn pulled(low: f32, high: f32, side: Side, by: f32, size: f32) -> (f32, f32) {
    match side {
        Side::None => (low, high),
        Side::Low => ((low + by).max(0.0).min(high - LEAST_PX), high),
        Side::High => (low, (high + by).min(size).max(low + LEAST_PX)),
    }
}

/// The box between two corners, on an image of this size; `None` for less than a box can be.
pub fn between(a: [f32; 2], b: [f32; 2], [width, height]: [f32; 2]) -> Option<PixelBox> {
    let edges = |a: f32, b: f32, size: f32| (a.min(b).max(0.0), a.max(b).min(size));
    let ((x0, x1), (y0, y1)) = (edges(a[0], b[0], width), edges(a[1], b[1], height));
    (x1 - x0 >= LEAST_PX && y1 - y0 >= LEAST_PX).then(|| PixelBox::new(x0, y0, x1, y1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: PixelBox = PixelBox { x0_px: 100.0, y0_px: 50.0, x1_px: 160.0, y1_px: 90.0 };
    const SIZE: [f32; 2] = [640.0, 480.0];

    #[test]
    fn every_part_of_a_box_can_be_held() {
        use Side::{High, Low, None};
        for (at, x, y) in [
            ([100.0, 50.0], Low, Low),
            ([98.0, 70.0], Low, None),
            ([162.0, 92.0], High, High),
            ([130.0, 48.0], None, Low),
            ([159.0, 51.0], High, Low),
        ] {
            assert_eq!(grip_at(&AREA, at, 4.0), Some(Grip::Edges { x, y }), "{at:?}");
        }
        assert_eq!(grip_at(&AREA, [130.0, 70.0], 4.0), Some(Grip::Body));
        assert_eq!(grip_at(&AREA, [94.0, 70.0], 4.0), Option::None);
        let tiny = PixelBox::new(10.0, 10.0, 14.0, 14.0);
        assert_eq!(grip_at(&tiny, [12.0, 12.0], 10.0), Some(Grip::Body), "it can still be moved");
    }

    #[test]
    fn the_smallest_box_under_a_click_is_meant() {
        let boxes = [PixelBox::new(0.0, 0.0, 100.0, 100.0), PixelBox::new(20.0, 20.0, 40.0, 40.0)];
        let at = |point| box_at(boxes.iter().enumerate(), point);
        assert_eq!((at([30.0, 30.0]), at([60.0, 60.0]), at([120.0, 60.0])), (Some(1), Some(0), None));
    }

    #[test]
    fn a_moved_box_keeps_its_size_and_stays_on_the_image() {
        for by in [[5.0, -3.0], [-1e4, 1e4], [1e4, -1e4]] {
            let moved = dragged(&AREA, Grip::Body, by, SIZE);
            assert!((moved.width_px() - AREA.width_px()).abs() < 1e-3);
            assert!((moved.height_px() - AREA.height_px()).abs() < 1e-3);
            assert_eq!(moved.on_image((640, 480)), Some(moved), "{by:?}");
        }
        assert_eq!(dragged(&AREA, Grip::Body, [5.0, -3.0], SIZE), PixelBox::new(105.0, 47.0, 165.0, 87.0));
    }

    #[test]
    fn an_edge_moves_alone_and_never_beyond_the_other_one() {
        let left = Grip::Edges { x: Side::Low, y: Side::None };
        assert_eq!(dragged(&AREA, left, [-20.0, 99.0], SIZE), PixelBox::new(80.0, 50.0, 160.0, 90.0));
        assert_eq!(dragged(&AREA, left, [1e4, 0.0], SIZE).x0_px, 158.0);
        assert_eq!(dragged(&AREA, left, [-1e4, 0.0], SIZE).x0_px, 0.0);
        let corner = Grip::Edges { x: Side::High, y: Side::High };
        assert_eq!(dragged(&AREA, corner, [1e4, 10.0], SIZE), PixelBox::new(100.0, 50.0, 640.0, 100.0));
    }

    #[test]
    fn a_drawn_box_has_its_corners_in_order_and_a_slip_is_none() {
        let drawn = between([200.0, 90.0], [150.0, 120.0], SIZE);
        assert_eq!(drawn, Some(PixelBox::new(150.0, 90.0, 200.0, 120.0)));
        assert_eq!(
            between([200.0, 90.0], [700.0, 500.0], SIZE),
            Some(PixelBox::new(200.0, 90.0, 640.0, 480.0))
        );
        assert_eq!(between([200.0, 90.0], [201.0, 120.0], SIZE), None);
        assert_eq!(between([-9.0, 5.0], [-2.0, 50.0], SIZE), None);
    }
}

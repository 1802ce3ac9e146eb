//! From a place on an image to the thing that is meant.

use plumbline_grasp::things::Thing;
use plumbline_model::Eye;
use plumbline_model::detection::PixelBox;

use super::around::GraspAround;
use super::command::GraspTarget;
use crate::detect::view::ObjectView;

/// Farther from every box than this nothing was pointed at, px.
const NEAR_BOX_PX: f64 = 60.0;

/// The thing that was detected nearest to there, if it can be held.
pub fn pointed_at(around: &GraspAround, eye: Eye, at_px: [f64; 2]) -> Option<GraspTarget> {
    nearest(&around.found.as_ref()?.objects, eye, at_px)
}

fn nearest(objects: &[ObjectView], eye: Eye, at_px: [f64; 2]) -> Option<GraspTarget> {
    let held = |name: &str| Thing::of_class(name).is_some_and(|thing| thing.can_be_held);
    let off_px = |area: &PixelBox| {
        let out = |at: f64, low: f32, high: f32| (f64::from(low) - at).max(at - f64::from(high)).max(0.0);
        out(at_px[0], area.x0_px, area.x1_px).hypot(out(at_px[1], area.y0_px, area.y1_px))
    };
    let candidates = objects.iter().filter(|object| held(&object.name));
    let near = candidates.filter_map(|object| Some((off_px(&object.seen(eye)?.area), object)));
    let (_, object) = near.filter(|(off, _)| *off < NEAR_BOX_PX).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let near_m = object.best_place().ok().map(|place| {
        let point = place.point_in_robot.coords;
        [point.x, point.y]
    });
    Some(GraspTarget { class: Some(object.name.clone()), near_m })
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;
    use plumbline_model::detection::ClassIndex;
    use plumbline_model::frame::Point;

    use super::*;
    use crate::detect::view::{ObjectPlaceView, SeenBox};

    fn tomato(left_px: f32, y_m: f64) -> ObjectView {
        let seen = |shift_px: f32| SeenBox {
            confidence: 0.9,
            area: PixelBox {
                x0_px: left_px - shift_px,
                y0_px: 300.0,
                x1_px: left_px - shift_px + 26.0,
                y1_px: 326.0,
            },
            rectified: [].into(),
            line_in_other: [].into(),
        };
        ObjectView {
            class: ClassIndex(0),
            name: "Tomato".to_owned(),
            left: Some(seen(0.0)),
            right: Some(seen(28.0)),
            epipolar_px: Some(0.2),
            alone_because: None,
            place: Ok(ObjectPlaceView {
                point_in_robot: Point::new(0.3, y_m, 0.08),
                sigma_m: [0.002; 3],
                wide_because: None,
                covariance_m2: Matrix3::identity() * 4e-6,
                range_m: 0.45,
                range_sigma_m: 0.003,
                model: "as described".into(),
            }),
            stands: None,
            voted: [].into(),
            leak: None,
            doubts: vec![],
        }
    }

    #[test]
    fn of_two_tomatoes_the_one_that_was_clicked_on_is_meant_in_either_eye() {
        let objects = [tomato(360.0, -0.1), tomato(310.0, 0.02)];
        let meant = |eye, at_px| nearest(&objects, eye, at_px).and_then(|target| target.near_m);
        assert_eq!(meant(Eye::Left, [373.0, 310.0]), Some([0.3, -0.1]));
        assert_eq!(meant(Eye::Left, [318.0, 310.0]), Some([0.3, 0.02]));
        // The same pixel means the other one in the other eye.
        assert_eq!(meant(Eye::Right, [340.0, 310.0]), Some([0.3, -0.1]));
        assert_eq!(meant(Eye::Right, [300.0, 310.0]), Some([0.3, 0.02]));
        assert_eq!(meant(Eye::Left, [100.0, 100.0]), None, "nothing is there");
    }

    #[test]
    fn what_no_hand_can_hold_is_not_meant() {
        let banana = ObjectView { name: "Banana".to_owned(), ..tomato(360.0, -0.1) };
        assert_eq!(nearest(&[banana], Eye::Left, [370.0, 310.0]), None);
    }
}

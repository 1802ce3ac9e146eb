//! From a place on an image to the thing that is meant.

use plumbline_grasp::things::Thing;
use plumbline_model::Eye;
use plumbline_model::detection::PixelBox;

use super::around::GraspAround;
use super::command::GraspTarget;

/// Farther from every box than this nothing was pointed at, px.
const NEAR_BOX_PX: f64 = 60.0;

/// The thing that was detected nearest to there, if it can be held.
pub fn pointed_at(around: &GraspAround, eye: Eye, at_px: [f64; 2]) -> Option<GraspTarget> {
    let found = around.found.as_ref()?;
    let held = |name: &str| Thing::of_class(name).is_some_and(|thing| thing.can_be_held);
    let off_px = |area: &PixelBox| {
        let out = |at: f64, low: f32, high: f32| (f64::from(low) - at).max(at - f64::from(high)).max(0.0);
        out(at_px[0], area.x0_px, area.x1_px).hypot(out(at_px[1], area.y0_px, area.y1_px))
    };
    let candidates = found.objects.iter().filter(|object| held(&object.name));
    let near = candidates.filter_map(|object| Some((off_px(&object.seen(eye)?.area), object)));
    let (_, object) = near.filter(|(off, _)| *off < NEAR_BOX_PX).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let near_m = object.place.as_ref().ok().map(|place| {
        let point = place.point_in_robot.coords;
        [point.x, point.y]
    });
    Some(GraspTarget { class: Some(object.name.clone()), near_m })
}

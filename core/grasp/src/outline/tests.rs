use plumbline_model::robot::default_rig;

use super::*;
use crate::things::Round;

fn model() -> RobotModel {
    RobotModel::nominal(default_rig())
}

/// Boxes around a thing that stands at a place, with the head at home.
pub(crate) fn boxes_around(model: &RobotModel, thing: &Thing, xy_m: Vector2<f64>) -> [Option<[f32; 4]>; 2] {
    boxes_of_size(model, thing, xy_m, 1.0)
}

/// The same of a thing that is larger than is known by a factor.
pub(crate) fn boxes_of_size(
    model: &RobotModel,
    thing: &Thing,
    xy_m: Vector2<f64>,
    scale: f64,
) -> [Option<[f32; 4]>; 2] {
    let posture = model.rig().home();
    let empty =
        Boxes { boxes_px: &[Some([0.0; 4]), Some([0.0; 4])], posture: &posture, under: SeenUnder::default() };
    let extents = empty.extents(model, thing, &State { scale, ..State::at(xy_m) }, 0.0).expect("seen");
    // Edges of boxes count from the corner of a pixel.
    extents.map(|extent| {
        extent.map(|(low, high)| [low[0], low[1], high[0], high[1]].map(|at| (at + 0.5) as f32))
    })
}

#[test]
fn a_thing_is_found_where_its_outline_is_seen_with_both_eyes_and_with_one() {
    let model = model();
    let posture = model.rig().home();
    let tomato = Thing::of_class("Tomato").expect("known");
    for (at_m, thing) in crate::PLACES_M.into_iter().zip(Thing::held().cycle()) {
        let truly = Vector2::from(at_m);
        let both = boxes_around(&model, &thing, truly);
        let off = Vector2::new(0.02, -0.015);
        for seen in [both, [both[0], None], [None, both[1]]] {
            let boxes = Boxes { boxes_px: &seen, posture: &posture, under: SeenUnder::default() };
            let found = boxes.on_table(&model, &thing, truly + off).expect("found");
            assert!((found.xy_m - truly).norm() < 1e-4, "{thing:?} at {at_m:?}: {found:?}");
            let sigma_m = found.covariance_m2.trace().sqrt();
            assert!((0.001..0.02).contains(&sigma_m), "{at_m:?}: {sigma_m}");
        }
    }
    let unseen = Boxes { boxes_px: &[None, None], posture: &posture, under: SeenUnder::default() };
    assert_eq!(unseen.on_table(&model, &tomato, Vector2::new(0.3, 0.0)), None);
}

#[test]
fn a_thing_of_another_size_is_found_where_it_stands_and_how_large_it_is() {
    let model = model();
    let posture = model.rig().home();
    for (at_m, thing) in crate::PLACES_M.into_iter().zip(Thing::held().cycle()) {
        let truly = Vector2::from(at_m);
        for scale in [0.85, 1.0, 1.15] {
            let seen = boxes_of_size(&model, &thing, truly, scale);
            let boxes = Boxes { boxes_px: &seen, posture: &posture, under: SeenUnder::default() };
            let found = boxes.on_table(&model, &thing, truly).expect("found");
            let off = found.scale - scale;
            assert!(
                off.abs() < found.scale_sigma.min(0.6 * (scale - 1.0).abs() + 1e-6),
                "{thing:?}, {scale}: {found:?}"
            );
            assert!((0.02..0.1).contains(&found.scale_sigma), "{thing:?}: {found:?}");
            // What is left goes with the size that is left.
            let by_scale_m = found.by_scale_m * off / found.scale_sigma;
            let left_m = (found.xy_m - truly - by_scale_m).norm();
            assert!(left_m < 1e-3, "{thing:?} at {at_m:?}, {scale}: {left_m} m, {found:?}");
        }
        for scale in [0.55, 1.9] {
            let other = boxes_of_size(&model, &thing, truly, scale);
            let boxes = Boxes { boxes_px: &other, posture: &posture, under: SeenUnder::default() };
            let found = boxes.on_table(&model, &thing, truly).expect("there is a size that fits best");
            assert!(!boxes.fit(&model, &thing, &found), "{thing:?} at {at_m:?}, {scale}: {found:?}");
        }
    }
}

#[test]
fn a_mushroom_is_seen_by_its_cap() {
    let model = model();
    let posture = model.rig().home();
    let mushroom = Thing::of_class("Mushroom").expect("known");
    let truly = Vector2::new(0.3, 0.1);
    let seen = boxes_around(&model, &mushroom, truly);
    let boxes = Boxes { boxes_px: &seen, posture: &posture, under: SeenUnder::default() };
    // Taken for one ellipsoid of its height it would stand farther from the eyes.
    const ONE: [Round; 1] = [Round { width_m: 0.044, from_m: 0.0, to_m: 0.040 }];
    let one = Thing { rounds: &ONE, ..mushroom };
    let taken = boxes.on_table(&model, &one, truly).expect("found");
    assert!(taken.xy_m.norm() - truly.norm() > 0.005, "{taken:?}");
}

#[test]
fn a_box_that_is_off_by_a_pixel_moves_it_by_about_what_is_stated() {
    let model = model();
    let posture = model.rig().home();
    let tomato = Thing::of_class("Tomato").expect("known");
    let truly = Vector2::new(0.3, 0.1);
    let mut seen = boxes_around(&model, &tomato, truly);
    for area in seen.iter_mut().flatten() {
        *area = area.map(|at| at + BOX_SIGMA_PX as f32);
    }
    let boxes = Boxes { boxes_px: &seen, posture: &posture, under: SeenUnder::default() };
    let found = boxes.on_table(&model, &tomato, truly).expect("found");
    let off_m = (found.xy_m - truly).norm();
    let sigma_m = found.covariance_m2.trace().sqrt();
    assert!(off_m > 0.0005 && off_m < 3.0 * sigma_m, "{off_m} m, stated {sigma_m} m");
}

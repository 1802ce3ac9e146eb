use std::sync::Arc;

use nalgebra::{Matrix3, Vector2, Vector3};
use plumbline_effects::rig_model::{ModelEffect, PlacedScreen, RigModel};
use plumbline_effects::robot_model::SeenUnder;
use plumbline_effects::{Kind, RobotModel};
use plumbline_model::robot::default_rig;
use plumbline_model::{LeftCamera, Point};
use plumbline_vision::synthetic::Noise;

use super::*;
use crate::outline::tests::{boxes_around, boxes_of_size};
use crate::outline::{BOX_SIGMA_PX, MARGIN_SIGMA_PX, SCALE_SIGMA, SIZE_SIGMA_PX};

/// A robot whose table was measured.
fn model(over_table_m: Option<f64>) -> RobotModel {
    let rig = default_rig();
    let screen = rig.touchscreen.clone();
    let mut added = RigModel::nominal(&rig);
    let session = "touches".to_owned();
    added.contents.screens.push(PlacedScreen { session, nominal: screen.clone(), screen, over_table_m });
    // Zero does nothing; a model without any effect counts as that of the description.
    added.contents.effects.push(ModelEffect {
        id: Kind::EyeYaw.id().to_owned(),
        site: "right".to_owned(),
        title: String::new(),
        tip: None,
        shape: None,
        reference_s: 0.0,
        values: vec![0.0],
        covariance: vec![],
        probability: None,
        parameters: vec![],
    });
    RobotModel::new(rig, Arc::new(added)).expect("it fits")
}

fn middle_m(model: &RobotModel, thing: &Thing, at_m: [f64; 2]) -> Vector3<f64> {
    let [x, y] = at_m;
    Vector3::new(x, y, support_m(model, x, y) + 0.5 * thing.height_m)
}

/// Where both eyes put a point of the robot's frame.
fn in_left(model: &RobotModel, point_m: Vector3<f64>) -> Point<LeftCamera> {
    let left_from_robot = model.robot_from_left(&model.rig().home()).inverse();
    left_from_robot * Point::new(point_m.x, point_m.y, point_m.z)
}

/// The same covariance in the axes of the left eye.
fn turned(model: &RobotModel, covariance_m2: Matrix3<f64>) -> Matrix3<f64> {
    let turn = model.robot_from_left(&model.rig().home()).rotation();
    turn.transpose() * covariance_m2 * turn
}

/// Along the line of sight of the left eye, of length 1.
fn sight(model: &RobotModel, point_m: &Vector3<f64>) -> Vector3<f64> {
    (point_m - model.robot_from_left(&model.rig().home()).translation_m()).normalize()
}

#[test]
fn a_thing_that_is_seen_too_far_along_the_line_of_sight_is_where_it_stands() {
    let model = model(Some(0.002));
    let posture = model.rig().home();
    for (at_m, thing) in crate::PLACES_M.into_iter().zip(Thing::held().cycle()) {
        let truly_m = middle_m(&model, &thing, at_m);
        let boxes_px = boxes_around(&model, &thing, Vector2::from(at_m));
        let boxes = Boxes { boxes_px: &boxes_px, posture: &posture, under: SeenUnder::default() };
        let along = sight(&model, &truly_m);
        let covariance_m2 = along * along.transpose() * 0.01_f64.powi(2) + Matrix3::identity() * 1e-8;
        for off_m in [-0.012, 0.012] {
            let in_left = in_left(&model, truly_m + along * off_m);
            let covariance_m2 = turned(&model, covariance_m2);
            let seen = model.place(&in_left, &covariance_m2, &posture, &boxes.under).expect("seen");
            let found = place(&model, &thing, &boxes, &in_left, &covariance_m2).expect("it stands there");
            assert_eq!(found.larger_by(), None, "{found:?}");
            let found = found.place;
            let left_m = (found.point.coords.coords - truly_m).norm();
            assert!(left_m < 2e-4, "{thing:?} at {at_m:?}: {left_m} m");
            assert!(found.sigma_m() < 0.6 * seen.sigma_m(), "{} of {} m", found.sigma_m(), seen.sigma_m());
        }
    }
}

#[test]
fn what_hangs_in_the_air_and_what_stands_on_a_table_that_nobody_measured_stays_where_it_is_seen() {
    let measured = model(Some(0.002));
    let posture = measured.rig().home();
    let thing = Thing::of_class("Tomato").expect("known");
    let boxes_px = boxes_around(&measured, &thing, Vector2::new(0.3, 0.1));
    let boxes = Boxes { boxes_px: &boxes_px, posture: &posture, under: SeenUnder::default() };
    let standing_m = middle_m(&measured, &thing, [0.3, 0.1]);
    let covariance_m2 = Matrix3::identity() * 4e-6;
    let at = |model: &RobotModel, boxes: &Boxes<'_>, point_m: Vector3<f64>| {
        place(model, &thing, boxes, &in_left(model, point_m), &covariance_m2)
    };
    assert!(at(&measured, &boxes, standing_m).is_some());
    assert_eq!(at(&model(None), &boxes, standing_m), None);
    assert_eq!(at(&measured, &boxes, standing_m + Vector3::z() * 0.06), None);
    // Half hidden in both eyes, and cut off by the border of one image.
    let half = boxes_px.map(|area| area.map(|[x0, y0, x1, y1]| [x0, y0, x1, y0 + 0.4 * (y1 - y0)]));
    assert_eq!(at(&measured, &Boxes { boxes_px: &half, ..boxes }, standing_m), None);
    // A third of it and more from any side: it is not taken for a smaller one that stands elsewhere.
    for share in [0.3, 0.45] {
        for side in 0..4 {
            let hidden = boxes_px.map(|area| {
                area.map(|mut edges| {
                    let part = share * (edges[side % 2 + 2] - edges[side % 2]);
                    edges[side] += if side < 2 { part } else { -part };
                    edges
                })
            });
            let found = at(&measured, &Boxes { boxes_px: &hidden, ..boxes }, standing_m);
            assert_eq!(found, None, "{share} hidden from side {side}");
        }
    }
    let cut = [boxes_px[0].map(|[_, y0, x1, y1]| [0.0, y0, x1, y1]), boxes_px[1]];
    assert_eq!(at(&measured, &Boxes { boxes_px: &cut, ..boxes }, standing_m), None);
    let nowhere = Boxes { boxes_px: &[None, None], ..boxes };
    assert_eq!(at(&measured, &nowhere, standing_m), None);
}

#[test]
fn a_toy_of_another_size_says_so_and_its_middle_is_as_high_as_it_is_large() {
    let model = model(Some(0.002));
    let posture = model.rig().home();
    let thing = Thing::of_class("Tomato").expect("known");
    for (scale, is_told) in [(0.75, true), (0.97, false), (1.0, false), (1.03, false), (1.25, true)] {
        let boxes_px = boxes_of_size(&model, &thing, Vector2::new(0.3, 0.1), scale);
        let boxes = Boxes { boxes_px: &boxes_px, posture: &posture, under: SeenUnder::default() };
        let larger = Thing { height_m: scale * thing.height_m, ..thing };
        let truly_m = middle_m(&model, &larger, [0.3, 0.1]);
        let covariance_m2 = Matrix3::identity() * 4e-6;
        let found = place(&model, &thing, &boxes, &in_left(&model, truly_m), &covariance_m2);
        let found = found.expect("it stands there");
        assert_eq!(found.larger_by().map(f64::signum), is_told.then(|| (scale - 1.0).signum()), "{found:?}");
        let off_m = found.place.point.coords.coords - truly_m;
        assert!(off_m.norm() < 0.003, "{scale}: {off_m} m");
        assert!(off_m.norm() < 3.0 * found.place.sigma_m(), "{scale}: {off_m} m");
    }
}

/// Boxes, sizes, heights and an eye that is turned are off as is stated: errors and statement agree.
#[test]
fn what_is_stated_holds_for_boxes_sizes_heights_and_rays_that_are_off_as_they_say() {
    let model = model(Some(0.002));
    let posture = model.rig().home();
    let mut chi2 = vec![];
    let (mut noise, mut refused) = (Noise::new(7), 0);
    for (at_m, thing) in crate::PLACES_M.into_iter().zip(Thing::held().cycle()).cycle().take(220) {
        let truly_m = middle_m(&model, &thing, at_m);
        let scale = 1.0 + SCALE_SIGMA * noise.normal().clamp(-1.4, 1.4);
        let mut boxes_px = boxes_of_size(&model, &thing, Vector2::from(at_m), scale);
        let margin = MARGIN_SIGMA_PX * noise.normal();
        for [x0, y0, x1, y1] in boxes_px.iter_mut().flatten() {
            let [across, down] = [0; 2].map(|_| (BOX_SIGMA_PX * noise.normal()) as f32);
            let [wider, higher] = [0; 2].map(|_| (margin + 0.5 * SIZE_SIGMA_PX * noise.normal()) as f32);
            (*x0, *x1) = (*x0 + across - wider, *x1 + across + wider);
            (*y0, *y1) = (*y0 + down - higher, *y1 + down + higher);
        }
        let boxes = Boxes { boxes_px: &boxes_px, posture: &posture, under: SeenUnder::default() };
        let along = sight(&model, &truly_m);
        let covariance_m2 = along * along.transpose() * 0.005_f64.powi(2);
        let in_left = in_left(&model, truly_m + along * (0.005 * noise.normal()));
        let Some(found) = place(&model, &thing, &boxes, &in_left, &turned(&model, covariance_m2)) else {
            // Boxes that are farther off than nearly all are taken for those of a part.
            refused += 1;
            continue;
        };
        let found = found.place;
        // The table is as high as is thought, so that the height is exact, and one number less is random.
        let error_m = (found.point.coords.coords - truly_m).xy();
        let by_boxes = boxes.on_table(&model, &thing, truly_m.xy()).expect("found");
        let by_boxes_m2 = by_boxes.covariance_m2 - by_boxes.by_height_m * by_boxes.by_height_m.transpose();
        chi2.push((error_m.transpose() * by_boxes_m2.try_inverse().expect("regular") * error_m).x);
        for (stated_m2, by_boxes_m2) in
            found.covariance_m2.diagonal().iter().zip(by_boxes.covariance_m2.diagonal().iter())
        {
            assert!(
                *stated_m2 >= 0.999 * by_boxes_m2,
                "less than its boxes say: {stated_m2} of {by_boxes_m2}"
            );
        }
    }
    assert!(refused < 22, "{refused} of 220 are not believed");
    let mean = chi2.iter().sum::<f64>() / chi2.len() as f64;
    assert!((1.5..2.5).contains(&mean), "2 where it is honest: {mean}");
}

//! Where a thing of known shape is that stands on the table.
//!
//! Two eyes that are 7 cm apart tell the distance of a thing half a meter away to a few millimeters only, and what
//! is matched on it lies somewhere on its relief. Where it stands on the table, its outline and the height of the
//! table say more: what is left of the eyes' errors is what they do across the line of sight.

use nalgebra::{Matrix3, Vector3};
use plumbline_effects::{PlaceInRobot, RobotModel};
use plumbline_model::{LeftCamera, Point};

use crate::outline::{Boxes, HEIGHT_SIGMA_M, OnTable};
use crate::table::support_m;
use crate::things::Thing;

/// A thing whose middle seems to be this far from where the table says is somewhere else, m, beside
/// three standard deviations.
const NOT_ON_TABLE_M: f64 = 0.03;
/// Where the boxes put a thing this far from where both eyes see it, m, beside three standard deviations, they are of
/// something else.
const APART_M: f64 = 0.015;
/// A line of sight that comes in flatter than this (sine of the angle with the table) says nothing of where it
/// meets the table.
const FLATTEST: f64 = 0.1;

/// A thing of known shape on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stands {
    /// Where its middle is.
    pub place: PlaceInRobot,
    /// How large it is, as a share of the size that is known of its class.
    pub scale: f64,
    /// Standard deviation of `scale`.
    pub scale_sigma: f64,
}

impl Stands {
    /// By how much it is larger than is known of its class (smaller: negative), as a share; `None`: as large as is known,
    /// as far as that can be told.
    pub fn larger_by(&self) -> Option<f64> {
        let by = self.scale - 1.0;
        (by.abs() > 2.0 * self.scale_sigma).then_some(by)
    }
}

/// The place of a thing that seems to stand on the table, by the boxes around its outline and the height of the
/// table; both eyes put it at `in_left` (left camera, m; covariance in its axes, m²). `None`: the height of the table was
/// not measured, the thing does not seem to stand on it, its boxes fit no place there, or they are of a part of it only.
pub fn place(
    model: &RobotModel,
    thing: &Thing,
    boxes: &Boxes<'_>,
    in_left: &Point<LeftCamera>,
    covariance_m2: &Matrix3<f64>,
) -> Option<Stands> {
    model.glass_over_table_m()?;
    let seen = model.place(in_left, covariance_m2, boxes.posture, &boxes.under)?;
    let seen_m = seen.point.coords.coords;
    if over_table_m(model, thing, &seen_m, &(seen.covariance_m2 - seen.by_mount_m2)).is_some() {
        return None;
    }
    let found = boxes.whole_on_table(model, thing, seen_m.xy())?;
    let apart_m = (found.xy_m - seen_m.xy()).norm();
    if apart_m > APART_M + 3.0 * flat_sigma_m(&seen.covariance_m2) {
        return None;
    }
    let [x, y] = found.xy_m.into();
    let point_m = Vector3::new(x, y, support_m(model, x, y) + 0.5 * thing.height_m * found.scale);
    let onto_table = onto_table(model, boxes, &point_m)?;
    // What is not known of mount, lenses and effects moves the rays, and where they meet does not matter any
    // more: it is brought along the line of sight to the table. What was read in the images is in the boxes.
    let of_eyes = model.place(in_left, &Matrix3::zeros(), boxes.posture, &boxes.under)?;
    let brought = |covariance_m2: &Matrix3<f64>| onto_table * covariance_m2 * onto_table.transpose();
    let by_mount_m2 = brought(&of_eyes.by_mount_m2);
    let covariance_m2 = brought(&of_eyes.covariance_m2) + of_outline(&found, thing);
    let point = Point::new(point_m.x, point_m.y, point_m.z);
    let place = PlaceInRobot { point, covariance_m2, by_mount_m2 };
    Some(Stands { place, scale: found.scale, scale_sigma: found.scale_sigma })
}

/// How far over the table a thing seems to be that does not stand on it (under it: negative), m; `None`: it
/// seems to stand there. `covariance_m2` is that of its place without the mount of the eyes: it moves all that is seen
/// alike, and how far mounts that nobody measured are usually off would let a thing in the air pass.
pub fn over_table_m(
    model: &RobotModel,
    thing: &Thing,
    point_m: &Vector3<f64>,
    covariance_m2: &Matrix3<f64>,
) -> Option<f64> {
    let off_m = point_m.z - support_m(model, point_m.x, point_m.y) - 0.5 * thing.height_m;
    let sigma_m = covariance_m2[(2, 2)].max(0.0).sqrt();
    (off_m.abs() > NOT_ON_TABLE_M + 3.0 * sigma_m).then_some(off_m)
}

/// Standard deviation along the table, both directions together, m.
fn flat_sigma_m(covariance_m2: &Matrix3<f64>) -> f64 {
    (covariance_m2[(0, 0)] + covariance_m2[(1, 1)]).max(0.0).sqrt()
}

/// Moves a place along the line of sight until it is as high as it was meant to be. `None`: the line of sight is
/// too flat.
fn onto_table(model: &RobotModel, boxes: &Boxes<'_>, point_m: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let up = model.touchscreen().normal().vector();
    let sight = (point_m - model.robot_from_left(boxes.posture).translation_m()).try_normalize(0.0)?;
    let down = up.dot(&sight);
    (down.abs() > FLATTEST).then(|| Matrix3::identity() - sight * up.transpose() / down)
}

/// Covariance by boxes, size and height with the height of the middle itself, m².
fn of_outline(found: &OnTable, thing: &Thing) -> Matrix3<f64> {
    let OnTable { by_height_m, by_scale_m, .. } = found;
    let by_boxes =
        found.covariance_m2 - by_height_m * by_height_m.transpose() - by_scale_m * by_scale_m.transpose();
    let by_height = Vector3::new(by_height_m.x, by_height_m.y, HEIGHT_SIGMA_M);
    let middle_sigma_m = 0.5 * thing.height_m * found.scale_sigma;
    let by_scale = Vector3::new(by_scale_m.x, by_scale_m.y, middle_sigma_m);
    let mut covariance_m2 = by_height * by_height.transpose() + by_scale * by_scale.transpose();
    let mut flat = covariance_m2.fixed_view_mut::<2, 2>(0, 0);
    flat += by_boxes;
    covariance_m2
}

#[cfg(test)]
mod tests;

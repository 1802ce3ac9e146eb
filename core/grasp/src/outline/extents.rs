//! How large a thing of known shape is seen: the outline around its ellipsoids in the images.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use plumbline_effects::RobotModel;
use plumbline_model::{Eye, Pixel, Point, Raw};

use super::{Boxes, State};
use crate::table::support_m;
use crate::things::{Round, Thing};

/// Points of an outline.
const POINTS: usize = 24;

/// Least and largest u and v, raw px.
pub(super) type Extent = ([f64; 2], [f64; 2]);

impl Boxes<'_> {
    /// Least and largest u and v of the outline of a thing that stands there, raw px, in each eye that has a box.
    pub(super) fn extents(
        &self,
        model: &RobotModel,
        thing: &Thing,
        state: &State,
        higher_m: f64,
    ) -> Option<[Option<Extent>; 2]> {
        let xy_m = state.xy_m;
        let stands_on_m = support_m(model, xy_m.x, xy_m.y) + higher_m;
        let robot_from_left = model.robot_from_left(self.posture).isometry;
        let right_from_left = model.rig().eyes.cameras.right_from_left.isometry;
        let mut extents = [None; 2];
        for eye in Eye::BOTH {
            if self.boxes_px[eye.index()].is_none() {
                continue;
            }
            let eye_at = match eye {
                Eye::Left => robot_from_left * Point3::origin(),
                Eye::Right => robot_from_left * right_from_left.inverse() * Point3::origin(),
            };
            let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
            for round in thing.rounds {
                for point in
                    outline(&round.scaled(state.scale), &Point3::new(xy_m.x, xy_m.y, stands_on_m), &eye_at)?
                {
                    let point = Point::new(point.x, point.y, point.z);
                    let (left, right) = model.project(&point, self.posture, &self.under)?;
                    let Pixel::<Raw> { u_px, v_px, .. } = if eye == Eye::Left { left } else { right };
                    for (k, at_px) in [u_px, v_px].into_iter().enumerate() {
                        (low[k], high[k]) = (low[k].min(at_px), high[k].max(at_px));
                    }
                }
            }
            extents[eye.index()] = Some((low, high));
        }
        Some(extents)
    }
}

/// Outline of an ellipsoid over a place on which it stands, seen from somewhere outside of it, m.
fn outline(round: &Round, stands: &Point3<f64>, eye: &Point3<f64>) -> Option<Vec<Point3<f64>>> {
    let wide = 0.5 * round.width_m;
    let half = Vector3::new(wide, wide, 0.5 * (round.to_m - round.from_m));
    let middle = stands + Vector3::z() * (0.5 * (round.from_m + round.to_m));
    // Where the ellipsoid is a ball of radius 1, its outline is a circle.
    let toward = (eye - middle).component_div(&half);
    let far = toward.norm();
    if far <= 1.0 {
        return None;
    }
    let axis = toward / far;
    let side = axis.cross(&Vector3::z()).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let up = side.cross(&axis);
    let radius = (1.0 - far.powi(-2)).sqrt();
    let point = |i: usize| {
        let (sine, cosine) = (TAU * i as f64 / POINTS as f64).sin_cos();
        middle + (axis / far + (side * cosine + up * sine) * radius).component_mul(&half)
    };
    Some((0..POINTS).map(point).collect())
}

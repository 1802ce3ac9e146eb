//! What a rig is made of: its parts, its surroundings, and what moves what.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::model::Body;
use super::solid::Solid;
use crate::robot::{Description, JointIndex, JointKind, Link, LinkIndex, Rig, Shape, Visual};

/// The table is taken to be solid down to here below its top, m: nothing passes under it.
const TABLE_DEPTH_M: f64 = 1.0;
/// Thickness of the touchscreen below its surface, m.
const SCREEN_DEPTH_M: f64 = 0.04;
/// A shape of a link.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub link: LinkIndex,
    pub link_from_shape: Isometry3<f64>,
    pub shape: Shape,
}

/// The shapes of all links.
pub(super) fn parts(description: &Description) -> Vec<Part> {
    let links = description.links().iter().enumerate();
    let of_link = |(i, link): (usize, &Link)| -> Vec<Part> {
        let part = |collision: &Visual| Part {
            link: LinkIndex(i),
            link_from_shape: collision.link_from_shape,
            shape: collision.shape,
        };
        link.collisions.iter().map(part).collect()
    };
    links.flat_map(of_link).collect()
}

/// Table, touchscreen and the lowest height allowed.
pub(super) fn surroundings(rig: &Rig) -> Vec<(Body, Solid)> {
    let table = &rig.table;
    let ([x0, x1], [y0, y1]) = (table.x_range_m, table.y_range_m);
    let half_m = Vector3::new(0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * TABLE_DEPTH_M);
    let center = Translation3::new(0.5 * (x0 + x1), 0.5 * (y0 + y1), table.height_m - 0.5 * TABLE_DEPTH_M);
    let table =
        Solid::new(&Shape::Box { half_m }, &Isometry3::from_parts(center, UnitQuaternion::identity()));
    let screen = &rig.touchscreen;
    let (u, v) = (screen.u_axis.vector(), screen.v_axis.vector());
    let down = u.cross(&v);
    let middle: Point3<f64> = screen.origin.coords
        + u * (0.5 * screen.width_m)
        + v * (0.5 * screen.height_m)
        + down * (0.5 * SCREEN_DEPTH_M);
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[u, v, down]));
    let half_m = Vector3::new(0.5 * screen.width_m, 0.5 * screen.height_m, 0.5 * SCREEN_DEPTH_M);
    let place =
        Isometry3::from_parts(Translation3::from(middle), UnitQuaternion::from_rotation_matrix(&axes));
    let screen = Solid::new(&Shape::Box { half_m }, &place);
    vec![(Body::Table, table), (Body::Touchscreen, screen), (Body::Floor, Solid::below(rig.gate.floor_m))]
}

/// The bit of a joint. Robots with more than 128 joints share bits, which leaves pairs out: none is known.
pub(super) fn bit(joint: JointIndex) -> u128 {
    1u128.wrapping_shl(joint.0 as u32)
}

/// Joints that move a link, one bit each.
pub(super) fn movers(description: &Description, mut link: LinkIndex) -> u128 {
    let mut bits = 0;
    while let Some(joint) = description.joint_above(link) {
        bits |= match &joint.kind {
            JointKind::Fixed => 0,
            JointKind::Revolute { index, .. } => bit(*index),
            JointKind::Coupled { mimic, .. } => bit(mimic.source),
        };
        link = joint.parent;
    }
    bits
}

/// Whether nothing with a shape lies between two links of a branch.
pub(super) fn joined(description: &Description, a: LinkIndex, b: LinkIndex) -> bool {
    let carrier = |mut link: LinkIndex| {
        while let Some(parent) = description.links()[link.0].parent {
            if !description.links()[parent.0].collisions.is_empty() {
                return Some(parent);
            }
            link = parent;
        }
        None
    };
    carrier(a) == Some(b) || carrier(b) == Some(a)
}

/// How far the parts below a joint reach from its origin, m, by movable joint. What follows a
/// joint by a factor is added to it.
pub(super) fn reach_m(description: &Description) -> Vec<f64> {
    let links = description.links();
    let mut extent_m = vec![0.0f64; links.len()];
    let mut reach_m = vec![0.0; description.movable_count()];
    for i in (0..links.len()).rev() {
        for collision in &links[i].collisions {
            let solid = Solid::new(&collision.shape, &collision.link_from_shape);
            extent_m[i] = extent_m[i].max(solid.ball.0.coords.norm() + solid.ball.1);
        }
        let Some(joint) = description.joint_above(LinkIndex(i)) else { continue };
        match &joint.kind {
            JointKind::Fixed => {}
            JointKind::Revolute { index, .. } => reach_m[index.0] += extent_m[i],
            JointKind::Coupled { mimic, .. } => reach_m[mimic.source.0] += extent_m[i] * mimic.ratio.abs(),
        }
        let through = joint.parent_from_joint.translation.vector.norm() + extent_m[i];
        extent_m[joint.parent.0] = extent_m[joint.parent.0].max(through);
    }
    reach_m
}

/// "right_lower_arm" → "right lower arm", "l_thumb_intermediate_link" → "left thumb intermediate", "r_indexfinger" →
/// "right index finger".
pub(super) fn people_name(link: &str) -> String {
    let word = |word: &str| match word {
        "r" => "right".to_owned(),
        "l" => "left".to_owned(),
        // "indexfinger"
        other => match other.strip_suffix("finger").filter(|which| !which.is_empty()) {
            Some(which) => format!("{which} finger"),
            None => other.to_owned(),
        },
    };
    link.split('_').filter(|part| *part != "link" && !part.is_empty()).map(word).collect::<Vec<_>>().join(" ")
}

//! The six toys: what collides, and (in `look`) what they look like.

pub(crate) mod look;
pub(crate) mod surface;

use std::sync::LazyLock;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use strum::{EnumString, IntoStaticStr};

use crate::scene::{Material, Pattern, Shape};

/// A toy on the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[derive(EnumString, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Toy {
    /// A red ball, a little flat, with a green star.
    Tomato,
    /// Yellow, bent.
    Banana,
    /// Yellow with an orange beak.
    Duck,
    /// A light stem with a brown cap.
    Mushroom,
    /// A white bulb.
    Onion,
    /// A small orange ball.
    Orange,
}

impl Toy {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Tomato, Self::Banana, Self::Duck, Self::Mushroom, Self::Onion, Self::Orange];

    /// Short name, lower case.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The toy of a short name.
    pub fn from_name(name: &str) -> Option<Self> {
        name.parse().ok()
    }

    /// Radius of a ball of its size, m.
    pub fn radius_m(self) -> f64 {
        match self {
            Self::Tomato => 0.030,
            Self::Banana => 0.040,
            Self::Duck => 0.027,
            Self::Mushroom => 0.022,
            Self::Onion => 0.020,
            Self::Orange => 0.018,
        }
    }

    /// Height of its origin above the surface on which it rests, m.
    pub(crate) fn rest_height_m(self) -> f64 {
        match self {
            Self::Tomato => 0.027,
            Self::Banana => 0.015,
            Self::Duck => 0.019,
            Self::Mushroom => 0.020,
            Self::Onion => 0.020,
            Self::Orange => 0.018,
        }
    }

    /// Mass, kg.
    pub(crate) fn mass_kg(self) -> f64 {
        match self {
            Self::Tomato => 0.030,
            Self::Banana => 0.035,
            Self::Duck => 0.025,
            Self::Mushroom => 0.015,
            Self::Onion => 0.012,
            Self::Orange => 0.010,
        }
    }

    /// Where it stands at first: x and y in the robot frame, m.
    pub(crate) fn first_place_m(self) -> [f64; 2] {
        match self {
            Self::Tomato => [0.36, -0.03],
            Self::Banana => [0.29, 0.33],
            Self::Duck => [0.27, -0.14],
            Self::Mushroom => [0.48, -0.11],
            Self::Onion => [0.46, 0.16],
            Self::Orange => [0.33, 0.12],
        }
    }

    /// What it looks like.
    pub(crate) fn look(self) -> &'static [ToyPart] {
        static LOOKS: LazyLock<Vec<Vec<ToyPart>>> = LazyLock::new(|| {
            Toy::ALL.into_iter().map(|toy| look::parts(toy, &look::Look::default())).collect()
        });
        &LOOKS[self as usize]
    }

    /// The convex parts that collide; [`Toy::look`] is drawn.
    pub(crate) fn parts(self) -> &'static [ToyPart] {
        static PARTS: LazyLock<Vec<Vec<ToyPart>>> =
            LazyLock::new(|| Toy::ALL.into_iter().map(make_parts).collect());
        &PARTS[self as usize]
    }
}

/// One part of a toy.
#[derive(Clone, Debug)]
pub(crate) struct ToyPart {
    /// Place on the toy.
    pub toy_from_shape: Isometry3<f64>,
    /// Form.
    pub shape: Shape,
    /// Surface.
    pub material: Material,
}

impl ToyPart {
    /// The part of a toy of another size that collides.
    pub fn of_size(&self, factor: f64) -> Self {
        let mut part = self.clone();
        part.toy_from_shape.translation.vector *= factor;
        match &mut part.shape {
            Shape::Ellipsoid { radii_m } => *radii_m *= factor,
            Shape::Capsule { radius_m, half_length_m } | Shape::Cylinder { radius_m, half_length_m } => {
                (*radius_m, *half_length_m) = (*radius_m * factor, *half_length_m * factor);
            }
            Shape::Box { half_m } => *half_m *= factor,
            // What collides is made of none of these.
            Shape::Board { .. } | Shape::Mesh { .. } => {}
        }
        part
    }
}

const YELLOW: [f32; 3] = [0.82, 0.58, 0.015];
const WHITE: [f32; 3] = [0.78, 0.76, 0.70];

fn make_parts(toy: Toy) -> Vec<ToyPart> {
    match toy {
        Toy::Tomato => vec![
            ellipsoid([0.031, 0.031, 0.027], [0.0; 3], [0.56, 0.022, 0.014]),
            ellipsoid([0.014, 0.014, 0.003], [0.0, 0.0, 0.0255], [0.06, 0.10, 0.03]),
        ],
        Toy::Banana => banana(),
        Toy::Duck => vec![
            cylinder(0.016, 0.003, [0.0, 0.0, -0.016], YELLOW),
            ellipsoid([0.026, 0.020, 0.017], [0.0; 3], YELLOW),
            ellipsoid([0.014, 0.014, 0.014], [0.013, 0.0, 0.023], YELLOW),
            ellipsoid([0.008, 0.006, 0.003], [0.028, 0.0, 0.021], [0.80, 0.18, 0.015]),
        ],
        Toy::Mushroom => vec![
            cylinder(0.012, 0.012, [0.0, 0.0, -0.008], WHITE),
            ellipsoid([0.022, 0.022, 0.013], [0.0, 0.0, 0.009], [0.52, 0.38, 0.24]),
        ],
        Toy::Onion => vec![
            ellipsoid([0.020, 0.020, 0.020], [0.0; 3], WHITE),
            capsule([0.0, 0.0, 0.018], [0.0, 0.0, 0.028], 0.004, WHITE),
        ],
        Toy::Orange => vec![ellipsoid([0.018; 3], [0.0; 3], [0.86, 0.17, 0.012])],
    }
}

/// Straight pieces on an arc that lies flat.
fn banana() -> Vec<ToyPart> {
    let (arc_m, pieces, half_angle) = (0.085, 4, 0.85);
    let at = |i: f64| {
        let angle: f64 = half_angle * (2.0 * i / pieces as f64 - 1.0);
        // The middle of mass is near the origin.
        [arc_m * angle.cos() - 0.075, arc_m * angle.sin(), 0.0]
    };
    let mut parts: Vec<ToyPart> = (0..pieces)
        .map(|i| {
            let radius_m = if i == 0 || i == pieces - 1 { 0.0135 } else { 0.015 };
            capsule(at(i as f64), at(i as f64 + 1.0), radius_m, YELLOW)
        })
        .collect();
    let end = at(pieces as f64);
    let tip = [end[0] - 0.012, end[1] + 0.012, 0.0];
    parts.push(capsule(end, tip, 0.005, [0.20, 0.12, 0.03]));
    parts
}

fn plastic(albedo: [f32; 3]) -> Material {
    Material { albedo, gloss: 0.06, pattern: Pattern::Plain }
}

fn ellipsoid(radii_m: [f64; 3], at_m: [f64; 3], albedo: [f32; 3]) -> ToyPart {
    ToyPart {
        toy_from_shape: Isometry3::translation(at_m[0], at_m[1], at_m[2]),
        shape: Shape::Ellipsoid { radii_m: Vector3::from(radii_m) },
        material: plastic(albedo),
    }
}

fn cylinder(radius_m: f64, half_length_m: f64, at_m: [f64; 3], albedo: [f32; 3]) -> ToyPart {
    ToyPart {
        toy_from_shape: Isometry3::translation(at_m[0], at_m[1], at_m[2]),
        shape: Shape::Cylinder { radius_m, half_length_m },
        material: plastic(albedo),
    }
}

fn capsule(from_m: [f64; 3], to_m: [f64; 3], radius_m: f64, albedo: [f32; 3]) -> ToyPart {
    let (from, to) = (Vector3::from(from_m), Vector3::from(to_m));
    ToyPart {
        toy_from_shape: along(from, to),
        shape: Shape::Capsule { radius_m, half_length_m: 0.5 * (to - from).norm() },
        material: plastic(albedo),
    }
}

/// The frame in the middle of two points whose z axis goes from one to the other.
pub(crate) fn along(from_m: Vector3<f64>, to_m: Vector3<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &(to_m - from_m))
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    Isometry3::from_parts(Translation3::from(0.5 * (from_m + to_m)), turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back() {
        for toy in Toy::ALL {
            assert_eq!(Toy::from_name(toy.name()), Some(toy));
        }
        assert_eq!(Toy::from_name("cube"), None);
    }

    #[test]
    fn what_collides_is_convex_and_simple_whatever_it_looks_like() {
        let simple = |part: &ToyPart| {
            matches!(part.shape, Shape::Ellipsoid { .. } | Shape::Capsule { .. } | Shape::Cylinder { .. })
        };
        for toy in Toy::ALL {
            assert!(toy.parts().iter().all(simple), "{toy:?}");
            assert!(toy.parts().len() <= 5 && toy.look().len() < 30, "{toy:?}");
        }
    }
}

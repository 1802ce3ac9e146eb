//! How the toys look: finer than the convex parts that collide.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::surface::{lathe, mesh, skin};
use super::{Toy, ToyPart, along};
use crate::scene::{Material, Pattern, Shape};

/// One piece of a kind of toy may differ from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Look {
    /// Size against the standard one.
    pub scale: f64,
    /// Factors on the color of red, green, blue.
    pub tint: [f32; 3],
    /// Contrast of the fabric's or plastic's grain, 0–1.
    pub grain: f32,
    /// Share of light reflected like by a mirror.
    pub gloss: f32,
    /// Four numbers from -1 to 1 that shape it: bent, pressed, tilted.
    pub shape: [f64; 4],
}

impl Default for Look {
    fn default() -> Self {
        Self { scale: 1.0, tint: [1.0; 3], grain: 0.1, gloss: 0.05, shape: [0.0; 4] }
    }
}

const BANANA_YELLOW: [f32; 3] = [0.88, 0.66, 0.018];
const BANANA_TIP: [f32; 3] = [0.30, 0.19, 0.02];
const DUCK_YELLOW: [f32; 3] = [0.90, 0.63, 0.012];
const BEAK: [f32; 3] = [0.85, 0.16, 0.012];
const BLACK: [f32; 3] = [0.008, 0.008, 0.008];
const FABRIC_WHITE: [f32; 3] = [0.80, 0.79, 0.76];
const CREAM: [f32; 3] = [0.74, 0.64, 0.36];
const CAP_BROWN: [f32; 3] = [0.36, 0.145, 0.085];
const CREASE: [f32; 3] = [0.10, 0.035, 0.02];
const ORANGE: [f32; 3] = [0.90, 0.125, 0.012];
const RED: [f32; 3] = [0.56, 0.020, 0.014];
const LEAF: [f32; 3] = [0.028, 0.052, 0.022];

/// What a toy looks like, origin and axes as those of its colliding parts.
pub(crate) fn parts(toy: Toy, look: &Look) -> Vec<ToyPart> {
    let mut maker = Maker { look: *look, parts: vec![] };
    match toy {
        Toy::Tomato => maker.tomato(),
        Toy::Banana => maker.banana(),
        Toy::Duck => maker.duck(),
        Toy::Mushroom => maker.mushroom(),
        Toy::Onion => maker.onion(),
        Toy::Orange => maker.orange(),
    }
    maker.parts
}

struct Maker {
    look: Look,
    parts: Vec<ToyPart>,
}

impl Maker {
    fn put(&mut self, at: Isometry3<f64>, shape: Shape, albedo: [f32; 3], size_m: f32) {
        let Look { tint, grain, gloss, .. } = self.look;
        let albedo = [0, 1, 2].map(|i| (albedo[i] * tint[i]).clamp(0.002, 0.97));
        let pattern = if grain > 0.0 && size_m > 0.0 {
            Pattern::Speckle { size_m, contrast: grain }
        } else {
            Pattern::Plain
        };
        self.parts.push(ToyPart { toy_from_shape: at, shape, material: Material { albedo, gloss, pattern } });
    }

    /// An ellipsoid, turned about y first.
    fn ball(&mut self, radii_m: [f64; 3], at_m: [f64; 3], about_y_rad: f64, albedo: [f32; 3], size_m: f32) {
        let s = self.look.scale;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), about_y_rad);
        let at = Isometry3::from_parts(Translation3::from(Vector3::from(at_m) * s), turn);
        self.put(at, Shape::Ellipsoid { radii_m: Vector3::from(radii_m) * s }, albedo, size_m);
    }

    fn rod(&mut self, from_m: Vector3<f64>, to_m: Vector3<f64>, radius_m: f64, albedo: [f32; 3]) {
        let s = self.look.scale;
        let shape =
            Shape::Capsule { radius_m: radius_m * s, half_length_m: 0.5 * s * (to_m - from_m).norm() };
        self.put(along(from_m * s, to_m * s), shape, albedo, 0.0);
    }

    /// A red ball of fabric with shallow seams, a star of five leaves on it.
    fn tomato(&mut self) {
        let s = self.look.scale;
        let [flat, seams, turn, leaves] = self.look.shape;
        let (r, h) = (0.031 * s, 0.027 * s * (1.0 + 0.10 * flat));
        let depth = 0.025 + 0.02 * seams;
        let count = if turn > 0.0 { 6.0 } else { 5.0 };
        let profile: Vec<(f64, f64)> =
            (1..9).map(|i| tomato_outline(PI * (1.0 - f64::from(i) / 9.0), r, h)).collect();
        let groove =
            |angle: f64, _: f64| 1.0 - depth * (1.0 - (0.5 * count * angle).sin().abs()).powi(3) * 2.0;
        let body = lathe(&profile, [-0.93 * h, 0.90 * h], 24, groove);
        self.put(Isometry3::identity(), body, RED, 0.0022);
        self.star(r, h, leaves);
        let top = 0.93 * h / s;
        self.rod(Vector3::new(0.0, 0.0, top), Vector3::new(0.002, 0.001, top + 0.004), 0.0016, LEAF);
    }

    fn star(&mut self, r: f64, h: f64, wide: f64) {
        let on = |polar: f64, angle: f64, lift: f64| {
            let (x, z) = tomato_outline(polar, r, h);
            let out = 1.0 + lift;
            Vector3::new(out * x * angle.cos(), out * x * angle.sin(), out * z)
        };
        let mut vertices = vec![];
        let mut faces = vec![];
        for leaf in 0..5 {
            let angle = TAU * f64::from(leaf) / 5.0 + 0.12 * (f64::from(leaf) * 2.4).sin();
            let half = 0.42 + 0.06 * wide;
            let reach = 0.88 + 0.10 * (f64::from(leaf) * 1.7).cos() + 0.08 * wide;
            let first = vertices.len();
            vertices.extend([
                on(0.02, angle, 0.09),
                on(0.33, angle - half, 0.06),
                on(0.33, angle + half, 0.06),
                on(0.40, angle, 0.085),
                on(reach, angle, 0.06),
            ]);
            faces.extend([[0, 1, 3], [0, 3, 2], [1, 4, 3], [3, 4, 2]].map(|t| t.map(|v| first + v)));
        }
        self.put(Isometry3::identity(), mesh(&vertices, &faces), LEAF, 0.002);
    }

    /// A bent tube, a little angular, with blunt ends.
    fn banana(&mut self) {
        let s = self.look.scale;
        let [bend, thick, stem, edges] = self.look.shape;
        let half_angle = 0.85 * (1.0 + 0.15 * bend);
        let arc_m = 0.085 * 0.85 / half_angle;
        let at = |share: f64| {
            let angle = half_angle * (2.0 * share - 1.0);
            Vector3::new(arc_m * angle.cos() - 0.075 * arc_m / 0.085, arc_m * angle.sin(), 0.0)
        };
        let ring = |share: f64, radius_m: f64| -> Vec<Vector3<f64>> {
            let angle = half_angle * (2.0 * share - 1.0);
            let out = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let sides = 10;
            (0..sides)
                .map(|i| TAU * f64::from(i) / f64::from(sides))
                .map(|turn| {
                    let r = radius_m * (1.0 + (0.05 + 0.03 * edges) * (5.0 * turn).cos());
                    // Seen from the far end, counter-clockwise.
                    s * (at(share) + r * (out * turn.cos() - Vector3::z() * turn.sin() * -1.0))
                })
                .rev()
                .collect()
        };
        let full = 0.0150 * (1.0 + 0.12 * thick);
        let radii = [
            (0.0, 0.52),
            (0.07, 0.74),
            (0.18, 0.93),
            (0.35, 1.0),
            (0.5, 1.02),
            (0.65, 1.0),
            (0.8, 0.92),
            (0.9, 0.74),
            (0.96, 0.52),
            (1.0, 0.40),
        ];
        let rings: Vec<_> = radii.iter().map(|(share, r)| ring(*share, r * full)).collect();
        let body = skin(s * at(-0.015), &rings, s * at(1.012));
        self.put(Isometry3::identity(), body, BANANA_YELLOW, 0.006);
        let reach = 1.055 + 0.02 * stem;
        self.rod(at(1.0), at(reach), 0.0042, BANANA_YELLOW);
        self.rod(at(reach + 0.012), at(reach + 0.020), 0.0036, BANANA_TIP);
        self.rod(at(-0.02), at(-0.03), 0.0040, BANANA_TIP);
    }

    /// A rubber duck.
    fn duck(&mut self) {
        let [plump, tail, nod, eyes] = self.look.shape;
        let y = DUCK_YELLOW;
        let wide = 1.0 + 0.08 * plump;
        self.ball([0.0265, 0.0205 * wide, 0.0160], [0.0, 0.0, -0.003], -0.12, y, 0.0);
        self.ball([0.0180, 0.0190 * wide, 0.0130], [0.006, 0.0, -0.007], 0.0, y, 0.0);
        // The tail points up and back.
        self.ball([0.0135, 0.0095, 0.0060], [-0.0225, 0.0, 0.007 + 0.002 * tail], 0.80, y, 0.0);
        for side in [-1.0, 1.0] {
            self.ball([0.0145, 0.0050, 0.0085], [-0.004, side * 0.0178 * wide, 0.000], -0.35, y, 0.0);
        }
        let head = [0.0125 + 0.002 * nod, 0.0, 0.0235];
        self.ball([0.0075, 0.0085, 0.0070], [0.009, 0.0, 0.012], 0.0, y, 0.0);
        self.ball([0.0148, 0.0145, 0.0140], head, 0.0, y, 0.0);
        self.ball([0.0085, 0.0072, 0.0026], [head[0] + 0.0165, 0.0, head[2] - 0.001], -0.25, BEAK, 0.0);
        self.ball([0.0070, 0.0060, 0.0022], [head[0] + 0.0145, 0.0, head[2] - 0.0045], 0.25, BEAK, 0.0);
        let size = 0.0023 + 0.0004 * eyes;
        for side in [-1.0, 1.0] {
            self.ball([size; 3], [head[0] + 0.0105, side * 0.0085, head[2] + 0.0045], 0.0, BLACK, 0.0);
        }
        let s = self.look.scale;
        let foot = Shape::Cylinder { radius_m: 0.0145 * s, half_length_m: 0.0020 * s };
        self.put(Isometry3::translation(0.0, 0.0, -0.0170 * s), foot, y, 0.0);
    }

    /// A ball of a stem, and a flat cap that lies on it askew.
    fn mushroom(&mut self) {
        let s = self.look.scale;
        let [long, lean_x, lean_y, thick] = self.look.shape;
        let stem = 0.0165 * (1.0 + 0.15 * long);
        self.ball([0.0155, 0.0155, stem], [0.0, 0.0, -0.020 + stem], 0.0, FABRIC_WHITE, 0.002);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.30 * lean_x, 0.30 * lean_y, 0.0));
        let t = 1.0 + 0.25 * thick;
        let cap = |z_m: f64| {
            let place = Translation3::new(0.003 * s * lean_y, -0.003 * s * lean_x, 0.0115 * s);
            place * turn * Translation3::new(0.0, 0.0, z_m * s)
        };
        // Brown above, cream below; both round at the rim.
        let above: Vec<(f64, f64)> =
            [(0.0232, 0.0008), (0.0240, 0.0022), (0.0225, 0.0048), (0.0165, 0.0070), (0.0080, 0.0080)]
                .map(|(r, z)| (r * s, z * s * t))
                .to_vec();
        let crumple = |angle: f64, share: f64| 1.0 + (1.0 - share) * 0.035 * (3.0 * angle + 4.0 * long).cos();
        let brown = lathe(&above, [0.0008 * s, 0.0078 * s * t], 18, crumple);
        self.put(cap(0.0), brown, CAP_BROWN, 0.003);
        let below: Vec<(f64, f64)> =
            [(0.0100, -0.0035), (0.0200, -0.0030), (0.0236, -0.0008), (0.0236, 0.0010)]
                .map(|(r, z)| (r * s, z * s * t))
                .to_vec();
        let cream = lathe(&below, [-0.0035 * s * t, 0.0010 * s], 18, crumple);
        self.put(cap(0.0), cream, CREAM, 0.003);
        let crease = Shape::Ellipsoid { radii_m: Vector3::new(0.0095, 0.0009, 0.0008) * s };
        self.put(cap(0.0078 * t), crease, CREASE, 0.0);
    }

    /// A white bulb with one pointed end, like garlic.
    fn onion(&mut self) {
        let s = self.look.scale;
        let [long, lobes, bent, turn] = self.look.shape;
        let l = 1.0 + 0.15 * long;
        let profile = [
            (0.0085, -0.0185),
            (0.0150, -0.0140),
            (0.0190, -0.0070),
            (0.0203, 0.0005),
            (0.0188, 0.0075),
            (0.0145, 0.0140),
            (0.0092, 0.0192),
            (0.0060, 0.0235),
            (0.0044, 0.0280),
            (0.0034, 0.0315),
        ];
        let (cos, sin) = ((PI * turn).cos(), (PI * turn).sin());
        let sides = 16;
        let lean = |z: f64| 0.006 * bent * (z.max(0.0) / 0.03).powi(2);
        let rings: Vec<Vec<Vector3<f64>>> = profile
            .iter()
            .map(|&(r, z)| {
                (0..sides)
                    .map(|i| TAU * f64::from(i) / f64::from(sides))
                    .map(|angle| {
                        let lobe = 1.0 + (0.035 + 0.025 * lobes) * (5.0 * angle).cos() * (r / 0.02);
                        let up = if z > 0.0 { z * l } else { z };
                        let x = r * lobe * angle.cos() + lean(z) * cos;
                        let y = r * lobe * angle.sin() + lean(z) * sin;
                        s * Vector3::new(x, y, up)
                    })
                    .collect()
            })
            .collect();
        let tip = Vector3::new(lean(0.032) * cos, lean(0.032) * sin, 0.0328 * l);
        let body = skin(Vector3::new(0.0, 0.0, -0.0195 * s), &rings, tip * s);
        self.put(Isometry3::identity(), body, FABRIC_WHITE, 0.004);
    }

    /// A small ball, slightly rough, sometimes a little long.
    fn orange(&mut self) {
        let [long, flat, ..] = self.look.shape;
        let r = 0.0185;
        let radii = [r * (1.0 + 0.16 * long.max(0.0)), r * (1.0 + 0.03 * flat), r * (1.0 - 0.03 * flat)];
        self.ball(radii, [0.0; 3], 0.0, ORANGE, 0.0022);
        let s = self.look.scale;
        let dot = Shape::Ellipsoid { radii_m: Vector3::new(0.0006, 0.0020, 0.0020) * s };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2 * flat);
        let at = turn * Translation3::new(radii[0] * s, 0.0, 0.0);
        self.put(at, dot, [0.10, 0.09, 0.02], 0.0);
    }
}

/// Distance from the axis and height of a tomato's skin by the angle (rad) from its top: pressed in
/// a little at both poles.
fn tomato_outline(polar: f64, r: f64, h: f64) -> (f64, f64) {
    let dent = 1.0 - 0.10 * (1.0 - polar.sin()).powi(2);
    (r * polar.sin().max(0.0).powf(0.9), h * polar.cos() * dent)
}

#[cfg(test)]
mod tests {
    use super::super::surface::triangles;
    use super::*;

    /// Lowest and highest corner of all parts, m.
    fn extent(parts: &[ToyPart]) -> (Vector3<f64>, Vector3<f64>) {
        let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for part in parts {
            for corner in triangles(&part.shape).iter().flatten() {
                let at = (part.toy_from_shape * nalgebra::Point3::from(*corner)).coords;
                (low, high) = (low.inf(&at), high.sup(&at));
            }
        }
        (low, high)
    }

    #[test]
    fn looks_are_about_as_large_as_what_collides_and_cheap_to_draw() {
        for toy in Toy::ALL {
            let look = parts(toy, &Look::default());
            let ((low, high), (solid_low, solid_high)) = (extent(&look), extent(toy.parts()));
            for axis in 0..3 {
                assert!((low[axis] - solid_low[axis]).abs() < 0.008, "{toy:?} {low} {solid_low}");
                assert!((high[axis] - solid_high[axis]).abs() < 0.008, "{toy:?} {high} {solid_high}");
            }
            let count: usize = look
                .iter()
                .map(|part| match &part.shape {
                    Shape::Mesh { mesh } => mesh.triangles.len(),
                    _ => 1,
                })
                .sum();
            assert!(count < 600, "{toy:?}: {count} triangles");
        }
    }

    #[test]
    fn a_larger_one_is_larger() {
        for toy in Toy::ALL {
            let (low, high) = extent(&parts(toy, &Look::default()));
            let (low2, high2) = extent(&parts(toy, &Look { scale: 1.5, ..Look::default() }));
            assert!(((high2 - low2) - 1.5 * (high - low)).norm() < 1e-5, "{toy:?}");
        }
    }
}

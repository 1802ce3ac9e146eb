//! Triangles into samples, with a depth buffer. Samples are finer than pixels by a whole factor
//! and averaged at the end, which is what smooths the edges.

use egui::Color32;

/// A corner of a triangle on the raster.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    /// In samples from the left.
    pub(super) x: f32,
    /// In samples from the top.
    pub(super) y: f32,
    /// One over the distance along the optical axis, 1/m: linear on the raster, larger is nearer.
    pub(super) nearness: f32,
    /// Red, green, blue, alpha, 0 to 255.
    pub(super) color: [f32; 4],
}

/// What a triangle does to the samples it covers.
pub(super) mod mode {
    /// Replaces what is farther away.
    pub(in super::super) const SOLID: u8 = 0;
    /// Mixes its color into what is farther away, and leaves the depth alone.
    pub(in super::super) const BLEND: u8 = 1;
    /// Keeps the largest alpha: overlapping shadows are not darker than one.
    pub(in super::super) const SHADOW: u8 = 2;
}

/// Nearness and color of every sample.
#[derive(Default)]
pub(super) struct Layer {
    width: usize,
    height: usize,
    nearness: Vec<f32>,
    /// Red in the lowest byte, alpha in the highest.
    color: Vec<u32>,
    touched: Touched,
}

/// Rows and columns that may have been written to.
#[derive(Clone, Copy, Default)]
struct Touched {
    x: [usize; 2],
    y: [usize; 2],
}

impl Layer {
    /// Makes it so large. What was drawn stays if it already is: a layer that was composited is
    /// empty, and emptying it again would take as long as drawing a robot.
    pub(super) fn fit(&mut self, width: usize, height: usize) {
        if (self.width, self.height) != (width, height) {
            self.reset(width, height, Color32::TRANSPARENT);
        }
    }

    /// Makes it so large and empty. Keeps its memory.
    pub(super) fn reset(&mut self, width: usize, height: usize, background: Color32) {
        (self.width, self.height) = (width, height);
        self.touched = Touched::default();
        let samples = width * height;
        self.nearness.resize(samples, 0.0);
        self.nearness.fill(0.0);
        self.color.resize(samples, 0);
        self.color.fill(u32::from_le_bytes(background.to_array()));
    }

    /// One over the distance of what is drawn at a sample; zero where nothing is.
    pub(super) fn nearness_at(&self, x: f32, y: f32) -> Option<f32> {
        let inside = x >= 0.0 && y >= 0.0 && (x as usize) < self.width && (y as usize) < self.height;
        inside.then(|| self.nearness[y as usize * self.width + x as usize])
    }

    /// Draws a triangle, whichever way it turns. Left out if its corners are not numbers.
    pub(super) fn triangle<const MODE: u8>(&mut self, corners: [&Vertex; 3]) {
        let [mut a, mut b, mut c] = corners;
        if b.y < a.y {
            std::mem::swap(&mut a, &mut b);
        }
        if c.y < a.y {
            std::mem::swap(&mut a, &mut c);
        }
        if c.y < b.y {
            std::mem::swap(&mut b, &mut c);
        }
        let Some(plane) = Plane::new(a, b, c) else { return };
        // Samples whose middle lies beyond an edge; `as` turns what is negative into 0.
        let row = |y: f32| ((y + 0.5) as usize).min(self.height);
        let (first, last) = (row(a.y), row(c.y));
        let mut touched = [usize::MAX, 0];
        for y in first..last {
            let center = y as f32 + 0.5;
            let long = edge(a, c, center);
            let short = if center < b.y { edge(a, b, center) } else { edge(b, c, center) };
            let column = |x: f32| ((x + 0.5) as usize).min(self.width);
            let (left, right) = (column(long.min(short)), column(long.max(short)));
            if left < right {
                touched = [touched[0].min(left), touched[1].max(right)];
                self.span::<MODE>(y, left, right, &plane);
            }
        }
        if touched[0] < touched[1] {
            self.touched.include(touched, [first, last]);
        }
    }

    #[inline]
    fn span<const MODE: u8>(&mut self, y: usize, left: usize, right: usize, plane: &Plane) {
        let range = y * self.width + left..y * self.width + right;
        let nearness = &mut self.nearness[range.clone()];
        let color = &mut self.color[range];
        let count = right - left;
        let (from, to) = (plane.at(left, y), plane.at(right - 1, y));
        let per_step = 1.0 / (count - 1).max(1) as f32;
        let (start, dz) = (from.nearness, (to.nearness - from.nearness) * per_step);
        let (mut lanes, step) = (pack(&from.color), pack_step(&from.color, &to.color, per_step));
        for (i, (near, dot)) in nearness.iter_mut().zip(color.iter_mut()).enumerate() {
            let z = start + i as i32 as f32 * dz;
            match MODE {
                mode::SOLID => {
                    let nearer = z > *near;
                    *near = if nearer { z } else { *near };
                    *dot = if nearer { unpack(lanes) } else { *dot };
                }
                mode::BLEND => {
                    if z > *near {
                        let over = unpack(lanes);
                        *dot = blend(*dot, over, over >> 24);
                    }
                }
                _ => {
                    let over = unpack(lanes);
                    if over >> 24 > *dot >> 24 {
                        *near = z;
                        *dot = over;
                    }
                }
            }
            lanes = lanes.wrapping_add(step);
        }
    }

    /// Mixes another layer of the same size into this one where the rule of the row says so, from
    /// the nearness of the other layer's sample and of this one's. The other layer is empty after
    /// it.
    pub(super) fn composite<Visible: Fn(f32, f32) -> bool>(
        &mut self,
        over: &mut Layer,
        rule_of_row: impl Fn(usize) -> Visible,
    ) {
        let Touched { x: [left, right], y: [top, bottom] } = over.touched;
        for y in top..bottom {
            let visible = rule_of_row(y);
            let range = y * self.width + left..y * self.width + right;
            let below = self.color[range.clone()].iter_mut().zip(&self.nearness[range.clone()]);
            let above = over.color[range.clone()].iter_mut().zip(&mut over.nearness[range]);
            for ((color, near), (over_color, over_near)) in below.zip(above) {
                if *over_near > 0.0 {
                    if visible(*over_near, *near) {
                        *color = blend(*color, *over_color, *over_color >> 24);
                    }
                    *over_near = 0.0;
                    *over_color = 0;
                }
            }
        }
        over.touched = Touched::default();
    }

    /// The picture: every pixel the mean of its `factor`² samples. Factor 1 or 2.
    pub(super) fn resolve(&self, factor: usize) -> Vec<Color32> {
        let opaque = |packed: u32| {
            let [r, g, b, _] = packed.to_le_bytes();
            Color32::from_rgb(r, g, b)
        };
        if factor != 2 {
            return self.color.iter().copied().map(opaque).collect();
        }
        let width = self.width / 2;
        let mut pixels = Vec::with_capacity(width * (self.height / 2));
        for rows in self.color.chunks_exact(2 * self.width) {
            let (upper, lower) = rows.split_at(self.width);
            let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
            pixels.extend(pairs.map(|(u, l)| opaque(mean([u[0], u[1], l[0], l[1]]))));
        }
        pixels
    }
}

impl Touched {
    fn include(&mut self, x: [usize; 2], y: [usize; 2]) {
        let join = |ours: [usize; 2], theirs: [usize; 2]| {
            if ours[0] == ours[1] { theirs } else { [ours[0].min(theirs[0]), ours[1].max(theirs[1])] }
        };
        (self.x, self.y) = (join(self.x, x), join(self.y, y));
    }
}

/// Where the edge between two corners, upper one first, crosses the middle of a row. The same
/// for both triangles at the edge, so that there is neither gap nor overlap.
#[inline]
fn edge(upper: &Vertex, lower: &Vertex, y: f32) -> f32 {
    let height = lower.y - upper.y;
    if height <= 0.0 { upper.x } else { upper.x + (lower.x - upper.x) * ((y - upper.y) / height) }
}

/// Nearness and color as linear functions over the raster, kept between those of the corners.
struct Plane {
    origin: [f32; 2],
    start: [f32; 5],
    per_x: [f32; 5],
    per_y: [f32; 5],
    low: [f32; 5],
    high: [f32; 5],
}

struct Value {
    nearness: f32,
    color: [f32; 4],
}

impl Plane {
    fn new(a: &Vertex, b: &Vertex, c: &Vertex) -> Option<Self> {
        let (abx, aby, acx, acy) = (b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
        let area = abx * acy - acx * aby;
        // Also false for what is not a number.
        if !(area.abs() > 1e-4 && area.is_finite()) {
            return None;
        }
        let all = |v: &Vertex| [v.nearness, v.color[0], v.color[1], v.color[2], v.color[3]];
        let (va, vb, vc) = (all(a), all(b), all(c));
        let mut plane = Self {
            origin: [a.x, a.y],
            start: va,
            per_x: [0.0; 5],
            per_y: [0.0; 5],
            low: [0.0; 5],
            high: [0.0; 5],
        };
        let scale = 1.0 / area;
        for i in 0..5 {
            let (ab, ac) = (vb[i] - va[i], vc[i] - va[i]);
            plane.per_x[i] = (ab * acy - ac * aby) * scale;
            plane.per_y[i] = (ac * abx - ab * acx) * scale;
            plane.low[i] = va[i].min(vb[i]).min(vc[i]);
            plane.high[i] = va[i].max(vb[i]).max(vc[i]);
        }
        Some(plane)
    }

    /// At the middle of a sample. Kept in range, because slivers are extrapolated far.
    #[inline]
    fn at(&self, x: usize, y: usize) -> Value {
        let (dx, dy) = (x as f32 + 0.5 - self.origin[0], y as f32 + 0.5 - self.origin[1]);
        let mut v = [0.0f32; 5];
        for (i, value) in v.iter_mut().enumerate() {
            let linear = self.start[i] + dx * self.per_x[i] + dy * self.per_y[i];
            *value = linear.max(self.low[i]).min(self.high[i]);
        }
        Value { nearness: v[0], color: [v[1], v[2], v[3], v[4]] }
    }
}

// Four colors in one number, 8 bits and 8 bits of fraction each, so that one addition steps all
// of them. The sum is exact as a whole number; a lane must only never leave 0..=255, which the
// margin below keeps after the rounding of steps over the longest rows.

const MARGIN: f32 = 4.0;

#[inline]
fn fixed(c: f32) -> i64 {
    (c.clamp(MARGIN, 255.0 - MARGIN) * 256.0) as i64
}

#[inline]
fn pack(color: &[f32; 4]) -> u64 {
    let [r, g, b, a] = color.map(fixed);
    (a << 48 | b << 32 | g << 16 | r) as u64
}

#[inline]
fn pack_step(from: &[f32; 4], to: &[f32; 4], per_step: f32) -> u64 {
    let mut packed = 0i64;
    for i in (0..4).rev() {
        let step = ((to[i] - from[i]) * 256.0 * per_step) as i64;
        packed = (packed << 16).wrapping_add(step);
    }
    packed as u64
}

#[inline]
fn unpack(lanes: u64) -> u32 {
    let bytes = lanes >> 8 & 0x00FF_00FF_00FF_00FF;
    let pairs = (bytes | bytes >> 8) & 0x0000_FFFF_0000_FFFF;
    (pairs | pairs >> 16) as u32
}

/// `alpha` of 255 parts of `over` on `under`; the result is opaque.
#[inline]
fn blend(under: u32, over: u32, alpha: u32) -> u32 {
    const ODD: u32 = 0x00FF_00FF;
    // 255 becomes 256, so that opaque replaces all of it.
    let weight = alpha + (alpha >> 7);
    let mix = |under: u32, over: u32| {
        (over.wrapping_mul(weight).wrapping_add(under.wrapping_mul(256 - weight)) >> 8) & ODD
    };
    mix(under & ODD, over & ODD) | mix(under >> 8 & ODD, over >> 8 & ODD) << 8 | 0xFF00_0000
}

#[inline]
fn mean(samples: [u32; 4]) -> u32 {
    const ODD: u32 = 0x00FF_00FF;
    let mut even = 0x0002_0002u32;
    let mut odd = 0x0002_0002u32;
    for sample in samples {
        even = even.wrapping_add(sample & ODD);
        odd = odd.wrapping_add(sample >> 8 & ODD);
    }
    (even >> 2 & ODD) | (odd >> 2 & ODD) << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [f32; 4] = [250.0, 10.0, 10.0, 255.0];
    const BLUE: [f32; 4] = [10.0, 10.0, 250.0, 255.0];

    fn vertex(x: f32, y: f32, nearness: f32, color: [f32; 4]) -> Vertex {
        Vertex { x, y, nearness, color }
    }

    fn layer() -> Layer {
        let mut layer = Layer::default();
        layer.reset(20, 20, Color32::BLACK);
        layer
    }

    fn square<const MODE: u8>(layer: &mut Layer, from: f32, to: f32, nearness: f32, color: [f32; 4]) {
        let [a, b, c, d] =
            [(from, from), (to, from), (to, to), (from, to)].map(|(x, y)| vertex(x, y, nearness, color));
        layer.triangle::<MODE>([&a, &b, &c]);
        layer.triangle::<MODE>([&a, &c, &d]);
    }

    fn at(layer: &Layer, x: usize, y: usize) -> [u8; 4] {
        layer.color[y * layer.width + x].to_le_bytes()
    }

    #[test]
    fn the_nearer_one_wins_in_either_order() {
        for near_first in [true, false] {
            let mut layer = layer();
            let draw = |layer: &mut Layer, near: bool| {
                if near {
                    square::<{ mode::SOLID }>(layer, 2.0, 12.0, 2.0, RED);
                } else {
                    square::<{ mode::SOLID }>(layer, 6.0, 18.0, 1.0, BLUE);
                }
            };
            draw(&mut layer, near_first);
            draw(&mut layer, !near_first);
            assert!(at(&layer, 8, 8)[0] > 200, "near first: {near_first}");
            assert!(at(&layer, 15, 15)[2] > 200);
            assert_eq!(at(&layer, 0, 0), [0, 0, 0, 255]);
        }
    }

    /// Every sample of a fan around a point is drawn exactly once: no gap, no overlap.
    #[test]
    fn triangles_at_an_edge_share_no_sample_and_leave_none_out() {
        let mut layer = layer();
        let rim: Vec<Vertex> = (0..11)
            .map(|i| {
                let turn = i as f32 * std::f32::consts::TAU / 11.0;
                vertex(10.03 + 8.7 * turn.cos(), 9.9 + 8.7 * turn.sin(), 1.0, [255.0, 255.0, 255.0, 128.0])
            })
            .collect();
        let middle = vertex(10.4, 9.2, 1.0, [255.0, 255.0, 255.0, 128.0]);
        for i in 0..11 {
            layer.triangle::<{ mode::BLEND }>([&middle, &rim[i], &rim[(i + 1) % 11]]);
        }
        let once = at(&layer, 10, 9)[0];
        for y in 3..17 {
            for x in 3..17 {
                let inside = (x as f32 + 0.5 - 10.03).hypot(y as f32 + 0.5 - 9.9) < 7.5;
                assert!(!inside || at(&layer, x, y)[0] == once, "({x}, {y}): {:?}", at(&layer, x, y));
            }
        }
    }

    #[test]
    fn colors_run_linearly_and_stay_in_range() {
        let mut layer = layer();
        let [a, b, c, d] = [(0.0, 0.0, 0.0), (20.0, 0.0, 255.0), (20.0, 20.0, 255.0), (0.0, 20.0, 0.0)]
            .map(|(x, y, red)| vertex(x, y, 1.0, [red, 255.0 - red, 128.0, 255.0]));
        layer.triangle::<{ mode::SOLID }>([&a, &b, &c]);
        layer.triangle::<{ mode::SOLID }>([&a, &c, &d]);
        for x in 0..20 {
            let [r, g, b, _] = at(&layer, x, 7).map(f32::from);
            let expected = 255.0 * (x as f32 + 0.5) / 20.0;
            assert!((r - expected).abs() < 6.0 && (g - 255.0 + expected).abs() < 6.0, "{x}: {r} {g}");
            assert!((b - 128.0).abs() < 3.0, "{x}: {b}");
        }
    }

    #[test]
    fn degenerate_and_unreal_triangles_are_left_out() {
        let mut layer = layer();
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38];
        for value in bad {
            let corners =
                [vertex(value, 2.0, 1.0, RED), vertex(10.0, value, 1.0, RED), vertex(4.0, 15.0, value, RED)];
            layer.triangle::<{ mode::SOLID }>([&corners[0], &corners[1], &corners[2]]);
        }
        let line = [vertex(1.0, 1.0, 1.0, RED), vertex(5.0, 5.0, 1.0, RED), vertex(9.0, 9.0, 1.0, RED)];
        layer.triangle::<{ mode::SOLID }>([&line[0], &line[1], &line[2]]);
        layer.triangle::<{ mode::SOLID }>([&line[0], &line[0], &line[0]]);
        assert!(layer.color.iter().all(|c| *c == 0xFF00_0000), "nothing was drawn");
        // And what reaches far out of the picture is drawn where it is in it.
        square::<{ mode::SOLID }>(&mut layer, -1e6, 1e6, 1.0, BLUE);
        assert!(at(&layer, 10, 10)[2] > 200);
    }

    #[test]
    fn overlapping_shadows_are_no_darker_than_one() {
        let mut shadow = layer();
        shadow.reset(20, 20, Color32::TRANSPARENT);
        let mut ground = layer();
        square::<{ mode::SOLID }>(&mut ground, 0.0, 20.0, 1.0, [200.0, 200.0, 200.0, 255.0]);
        for _ in 0..3 {
            square::<{ mode::SHADOW }>(&mut shadow, 5.0, 15.0, 1.0, [0.0, 0.0, 0.0, 100.0]);
        }
        ground.composite(&mut shadow, |_| |_, _| true);
        let shaded = at(&ground, 10, 10)[0];
        assert!((115..130).contains(&shaded), "{shaded}");
        assert_eq!(at(&ground, 2, 2)[0], 200);
        // The layer can be used again at once.
        ground.composite(&mut shadow, |_| |_, _| true);
        assert_eq!(at(&ground, 10, 10)[0], shaded);
    }

    #[test]
    fn pixels_are_the_mean_of_their_samples() {
        let mut layer = layer();
        square::<{ mode::SOLID }>(&mut layer, 1.0, 20.0, 1.0, [200.0, 200.0, 200.0, 255.0]);
        let pixels = layer.resolve(2);
        assert_eq!(pixels.len(), 100);
        assert_eq!(pixels[0].r(), 50, "one of four samples");
        assert_eq!(pixels[1].r(), 100, "two of four samples");
        assert_eq!(pixels[55], Color32::from_rgb(200, 200, 200));
    }
}

//! The hand rendered into a region of a raw image: masks for showing, labels and outline for finding.

use nalgebra::{Vector2, Vector3};
use plumbline_model::{Camera, Pixel};

use super::shape::{InView, Met, Part};

/// Soft coverage of a region of a raw image.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Column of its first pixel.
    pub u0_px: u32,
    /// Row of its first pixel.
    pub v0_px: u32,
    /// Width of the region.
    pub width_px: u32,
    /// Height of the region.
    pub height_px: u32,
    /// How much of each pixel the hand covers, 0–1, row by row.
    pub coverage: Vec<f32>,
}

impl Mask {
    /// Pixels covered in all.
    pub fn area_px(&self) -> f64 {
        self.coverage.iter().map(|part| f64::from(*part)).sum()
    }
}

/// What both eyes would see of a hand: palm and digits, where the forearm does not hide them.
#[derive(Clone, Debug, PartialEq)]
pub struct HandView {
    /// In the left eye; `None`: it is outside of its image.
    pub left: Option<Mask>,
    /// In the right eye.
    pub right: Option<Mask>,
}

/// A region of a raw image, whole pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub u0: i32,
    pub v0: i32,
    pub width: usize,
    pub height: usize,
}

impl Region {
    /// The part of the image around the hand, with a margin; and which share of the hand's
    /// enclosing rectangle lies on the image (0–1). `None` when nothing of it does.
    pub fn around(hand: &InView, camera: &Camera, margin_px: f64) -> Option<(Self, f64)> {
        let focal_px = camera.model.focal_px().0;
        let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
        for (middle, radius_m) in hand.hand_balls() {
            let Ok(pixel) = camera.project(middle) else { continue };
            let reach = Vector2::repeat(focal_px * (radius_m / middle.norm()).min(1.0).asin());
            low = low.inf(&(pixel.vector() - reach));
            high = high.sup(&(pixel.vector() + reach));
        }
        let whole = (high - low).product();
        let last = Vector2::new(f64::from(camera.width_px), f64::from(camera.height_px)).add_scalar(-1.0);
        let on_image = (high.inf(&last) - low.sup(&Vector2::zeros())).map(|side| side.max(0.0)).product();
        if !(whole > 0.0) || !(on_image > 0.0) {
            return None;
        }
        let margin = Vector2::repeat(margin_px);
        let from = (low - margin).sup(&Vector2::zeros()).map(f64::floor);
        let to = (high + margin).inf(&last).map(f64::ceil);
        let size = (to - from).add_scalar(1.0);
        let region =
            Self { u0: from.x as i32, v0: from.y as i32, width: size.x as usize, height: size.y as usize };
        Some((region, on_image / whole))
    }

    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Column and row in the image of a place in the region's list.
    pub fn pixel(&self, index: usize) -> (i32, i32) {
        (self.u0 + (index % self.width) as i32, self.v0 + (index / self.width) as i32)
    }
}

/// Unit directions of the pixel middles of a region; `None` where the lens sees nothing.
pub(super) fn rays(region: &Region, camera: &Camera) -> Vec<Option<Vector3<f64>>> {
    (0..region.len())
        .map(|i| {
            let (u, v) = region.pixel(i);
            direction(camera, f64::from(u), f64::from(v))
        })
        .collect()
}

fn direction(camera: &Camera, u_px: f64, v_px: f64) -> Option<Vector3<f64>> {
    camera.unproject(Pixel::new(u_px, v_px)).ok()
}

/// Which part each pixel of a region shows, by the ray through its middle.
pub(super) fn labels(hand: &InView, rays: &[Option<Vector3<f64>>]) -> Vec<Option<Part>> {
    rays.iter().map(|ray| ray.and_then(|ray| hand.cast(&ray)).map(|met| met.part)).collect()
}

/// Coverage by four rays per pixel.
pub(super) fn mask(hand: &InView, camera: &Camera) -> Option<Mask> {
    let (region, _) = Region::around(hand, camera, 1.0)?;
    let offsets = [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)];
    let shows = |u: f64, v: f64| {
        let part = direction(camera, u, v).and_then(|ray| hand.cast(&ray)).map(|met| met.part);
        matches!(part, Some(Part::Palm | Part::Digit))
    };
    let coverage = |i: usize| {
        let (u, v) = region.pixel(i);
        let hits = offsets.iter().filter(|(du, dv)| shows(f64::from(u) + du, f64::from(v) + dv)).count();
        hits as f32 / offsets.len() as f32
    };
    Some(Mask {
        u0_px: region.u0 as u32,
        v0_px: region.v0 as u32,
        width_px: region.width as u32,
        height_px: region.height as u32,
        coverage: (0..region.len()).map(coverage).collect(),
    })
}

/// A point where the hand ends against what lies behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RimPoint {
    /// Where on the raw image.
    pub pixel: Vector2<f64>,
    /// Unit normal, out of the hand.
    pub normal: Vector2<f64>,
    /// Point of the hand's surface there, frame of the tip, m.
    pub in_tip: Vector3<f64>,
    /// Which solid of the hand, and the part that it belongs to.
    pub solid: usize,
    pub part: Part,
    /// Length of rim that it stands for, px.
    pub length_px: f64,
}

/// Bisections of the way from one pixel to the next: to 1/32 px.
const BISECTIONS: usize = 5;
/// Pixels to each side that the normal is taken from.
const NORMAL_REACH: i32 = 4;

/// The rim of palm and digits against the background; where they meet the forearm there is none.
pub(super) fn rim(hand: &InView, camera: &Camera, region: &Region, labels: &[Option<Part>]) -> Vec<RimPoint> {
    let mut points = vec![];
    let tip_from_camera = hand.camera_from_tip.inverse();
    let (width, height) = (region.width as i32, region.height as i32);
    let at = |u: i32, v: i32| {
        let inside = u >= 0 && v >= 0 && u < width && v < height;
        inside.then(|| labels[(v * width + u) as usize])
    };
    for v in 0..height {
        for u in 0..width {
            let Some(Some(Part::Palm | Part::Digit)) = at(u, v) else { continue };
            for (du, dv) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                if at(u + du, v + dv) != Some(None) {
                    continue;
                }
                let Some(normal) = outward(&at, u, v, du, dv) else { continue };
                let start = Vector2::new(f64::from(region.u0 + u), f64::from(region.v0 + v));
                let step = Vector2::new(f64::from(du), f64::from(dv));
                let Some((share, ray, met)) = last_met(hand, camera, &start, &step) else { continue };
                points.push(RimPoint {
                    pixel: start + step * share,
                    normal,
                    in_tip: (tip_from_camera * nalgebra::Point3::from(ray * met.range_m)).coords,
                    solid: met.solid,
                    part: met.part,
                    // A rim at a slant crosses the grid more often than its length says.
                    length_px: normal.dot(&step).abs(),
                });
            }
        }
    }
    points
}

/// Along the way of one pixel from inside out: share of it, ray and meeting where the hand is met for
/// the last time.
fn last_met(
    hand: &InView,
    camera: &Camera,
    start: &Vector2<f64>,
    step: &Vector2<f64>,
) -> Option<(f64, Vector3<f64>, Met)> {
    let look = |share: f64| {
        let pixel = start + step * share;
        let ray = direction(camera, pixel.x, pixel.y)?;
        hand.cast(&ray).filter(|met| met.part != Part::Forearm).map(|met| (ray, met))
    };
    let (mut inside, mut outside) = (0.0, 1.0);
    let mut last = look(0.0)?;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (inside + outside);
        match look(middle) {
            Some(found) => (inside, last) = (middle, found),
            None => outside = middle,
        }
    }
    Some((0.5 * (inside + outside), last.0, last.1))
}

/// Normal of the rim between a pixel and its neighbor: away from the middle of what is covered nearby.
fn outward(
    at: &impl Fn(i32, i32) -> Option<Option<Part>>,
    u: i32,
    v: i32,
    du: i32,
    dv: i32,
) -> Option<Vector2<f64>> {
    let middle = Vector2::new(f64::from(u) + 0.5 * f64::from(du), f64::from(v) + 0.5 * f64::from(dv));
    let mut sum = Vector2::zeros();
    for row in v - NORMAL_REACH..=v + NORMAL_REACH {
        for column in u - NORMAL_REACH..=u + NORMAL_REACH {
            if at(column, row).flatten().is_some() {
                let away = Vector2::new(f64::from(column), f64::from(row)) - middle;
                sum -= away * (-0.25 * away.norm_squared()).exp();
            }
        }
    }
    // Thin parts have as much to either side.
    sum.try_normalize(0.3).or_else(|| Vector2::new(f64::from(du), f64::from(dv)).try_normalize(0.0))
}

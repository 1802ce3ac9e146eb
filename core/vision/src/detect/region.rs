//! A part of an image that is worth looking at.
//!
//! The eyes of the robot are fisheye lenses: around the disc that they draw, an image is black, and
//! the table takes up a small part of the disc. A network that takes images of any size looks at a
//! part in a fraction of the time, at the same scale and so with the same things found.

use image::RgbImage;
use plumbline_model::detection::PixelBox;
use plumbline_model::stereo::StereoCameras;
use plumbline_model::workspace::Workspace;
use plumbline_model::{Eye, Pixel, Raw};

/// What is nowhere brighter than this is black: outside the lens, noise and JPEG reach some 20.
const BLACK: u8 = 32;
/// Edges of the lit part lie on multiples of this, px, so that noise does not move them.
const STEP_PX: u32 = 8;
/// Hands and things at the edge of the workspace reach so far beyond it, m.
const BEYOND_M: f64 = 0.05;
/// Places along each side of the workspace that are looked for in the image: a fisheye bends its
/// edges.
const PLACES: u32 = 12;
/// Pixels around the workspace, so that nothing is cut where it ends.
const AROUND_PX: f64 = 8.0;
/// Less of the workspace than this share is not in view: the head looks elsewhere.
const LEAST_IN_VIEW: f64 = 0.5;

/// A part of an image, whole pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Region {
    /// First column.
    pub x_px: u32,
    /// First row.
    pub y_px: u32,
    /// Columns.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
}

/// Which part of an image a detector looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// All but what is black to the edge, as it is around the disc of a fisheye lens: nothing is
    /// lost, and up to half of the work is saved.
    #[default]
    Lit,
    /// All of it.
    Whole,
    /// A part, to whole strides of the network. What of it is outside the image does not count; if all
    /// of it is, all of the image is looked at.
    Region(Region),
}

impl Part {
    /// Where the workspace is on an eye's image of a size (width, height); what is lit of it where the
    /// head looks elsewhere, or the image is not one of these cameras.
    pub fn of_workspace(cameras: &StereoCameras, workspace: &Workspace, eye: Eye, image: (u32, u32)) -> Self {
        let of_these = cameras.camera(eye).size_px() == image;
        let region = of_these.then(|| Region::of_workspace(cameras, workspace, eye)).flatten();
        region.map_or(Self::Lit, Self::Region)
    }
}

impl Region {
    /// All of an image of a size (width, height).
    pub fn whole((width_px, height_px): (u32, u32)) -> Self {
        Self { x_px: 0, y_px: 0, width_px, height_px }
    }

    /// What of it is on an image of a size (width, height); `None` if nothing is.
    pub fn on_image(self, (width_px, height_px): (u32, u32)) -> Option<Self> {
        let right_px = self.x_px.saturating_add(self.width_px).min(width_px);
        let below_px = self.y_px.saturating_add(self.height_px).min(height_px);
        let width_px = right_px.checked_sub(self.x_px).filter(|width| *width > 0)?;
        let height_px = below_px.checked_sub(self.y_px).filter(|height| *height > 0)?;
        Some(Self { width_px, height_px, ..self })
    }

    /// The smallest one that holds both, with all of a box and some pixels around it, on an image of
    /// a size (width, height).
    #[must_use]
    pub fn with(self, area: &PixelBox, around_px: f32, (width, height): (u32, u32)) -> Self {
        let along = |first: u32, length: u32, [low, high]: [f32; 2], end: u32| {
            let within = |at: f32| at.clamp(0.0, end as f32) as u32;
            let begin = first.min(within((low - around_px).floor()));
            let last = (first + length).max(within((high + around_px).ceil()));
            (begin, last - begin)
        };
        let (x_px, width_px) = along(self.x_px, self.width_px, [area.x0_px, area.x1_px], width);
        let (y_px, height_px) = along(self.y_px, self.height_px, [area.y0_px, area.y1_px], height);
        Self { x_px, y_px, width_px, height_px }
    }

    /// Whether all of a box is in it.
    pub fn holds(self, area: &PixelBox) -> bool {
        let (x0, y0) = (self.x_px as f32, self.y_px as f32);
        let (x1, y1) = (x0 + self.width_px as f32, y0 + self.height_px as f32);
        area.x0_px >= x0 && area.y0_px >= y0 && area.x1_px <= x1 && area.y1_px <= y1
    }

    /// Share of an image of a size (width, height) that it takes up, 0–1.
    pub fn share_of(self, (width, height): (u32, u32)) -> f64 {
        let area = |width: u32, height: u32| f64::from(width) * f64::from(height);
        self.on_image((width, height))
            .map_or(0.0, |part| area(part.width_px, part.height_px) / area(width, height))
    }

    /// Where an eye's raw image shows the workspace, up to its headroom, and what hangs over its
    /// edges. `None` where the head looks elsewhere: then all of the image is worth looking at.
    pub fn of_workspace(cameras: &StereoCameras, workspace: &Workspace, eye: Eye) -> Option<Self> {
        let camera = cameras.camera(eye);
        let (width, height) = camera.size_px();
        let mut seen = Extent::default();
        let (mut places, mut in_view) = (0.0, 0.0);
        for place in places_of(workspace) {
            places += 1.0;
            let in_left = workspace.robot_from_left.inverse() * place;
            let point = match eye {
                Eye::Left => in_left.coords.coords,
                Eye::Right => (cameras.right_from_left * in_left).coords.coords,
            };
            let Ok(pixel) = camera.project(&point) else { continue };
            seen.add(pixel);
            in_view += f64::from(u8::from(pixel.is_inside((width, height))));
        }
        if in_view < LEAST_IN_VIEW * places {
            return None;
        }
        seen.region((width, height))
    }

    /// All but what is black to the edge; all of the image if it is black. `columns` is memory.
    pub(super) fn lit(image: &RgbImage, columns: &mut Vec<u8>) -> Self {
        let (width, height) = image.dimensions();
        let whole = Self::whole((width, height));
        let row_length = 3 * width as usize;
        if row_length == 0 {
            return whole;
        }
        columns.clear();
        columns.resize(row_length, 0);
        let (mut first, mut last) = (None, 0);
        for (y, row) in (0..height).zip(image.as_raw().chunks_exact(row_length)) {
            let mut brightest = 0;
            for (column, value) in columns.iter_mut().zip(row) {
                *column = (*column).max(*value);
                brightest = brightest.max(*value);
            }
            if brightest > BLACK {
                first = first.or(Some(y));
                last = y;
            }
        }
        let is_lit = |column: &[u8]| column.iter().any(|value| *value > BLACK);
        let left = columns.chunks_exact(3).position(is_lit);
        let right = columns.chunks_exact(3).rposition(is_lit);
        let (Some(top), Some(left), Some(right)) = (first, left, right) else { return whole };
        let [x_px, end_x] = stepped([left as u32, right as u32], width);
        let [y_px, end_y] = stepped([top, last], height);
        Self { x_px, y_px, width_px: end_x - x_px, height_px: end_y - y_px }
    }
}

/// First and last pixel to begin and end on whole steps.
fn stepped([first, last]: [u32; 2], length: u32) -> [u32; 2] {
    [first / STEP_PX * STEP_PX, ((last / STEP_PX + 1) * STEP_PX).min(length)]
}

/// Places on the bottom and on the top of the workspace and what hangs over its edges.
fn places_of(workspace: &Workspace) -> impl Iterator<Item = plumbline_model::Point<plumbline_model::Robot>> {
    let at = |[low, high]: [f64; 2], step: u32| {
        let share = f64::from(step) / f64::from(PLACES);
        low - BEYOND_M + share * (high - low + 2.0 * BEYOND_M)
    };
    let (x_range_m, y_range_m) = (workspace.x_range_m, workspace.y_range_m);
    let heights_m = [0.0, workspace.headroom_m].map(|height_m| workspace.table_height_m + height_m);
    heights_m.into_iter().flat_map(move |z| {
        (0..=PLACES).flat_map(move |i| {
            (0..=PLACES).map(move |j| plumbline_model::Point::new(at(x_range_m, i), at(y_range_m, j), z))
        })
    })
}

/// What pixels span.
struct Extent {
    u_px: [f64; 2],
    v_px: [f64; 2],
}

impl Default for Extent {
    fn default() -> Self {
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        Self { u_px: nothing, v_px: nothing }
    }
}

impl Extent {
    fn add(&mut self, pixel: Pixel<Raw>) {
        let grown = |[low, high]: [f64; 2], at: f64| [low.min(at), high.max(at)];
        self.u_px = grown(self.u_px, pixel.u_px);
        self.v_px = grown(self.v_px, pixel.v_px);
    }

    /// With some pixels around, on an image of a size (width, height).
    fn region(&self, (width, height): (u32, u32)) -> Option<Region> {
        let side = |[low, high]: [f64; 2], length: u32| {
            let within = |at: f64| at.clamp(0.0, f64::from(length)) as u32;
            (low <= high).then(|| [within(low - AROUND_PX), within(high + 1.0 + AROUND_PX)])
        };
        let ([x_px, right], [y_px, below]) = (side(self.u_px, width)?, side(self.v_px, height)?);
        let region = Region { x_px, y_px, width_px: right - x_px, height_px: below - y_px };
        region.on_image((width, height))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
    use plumbline_model::{Point, Pose};

    use super::*;
    use crate::synthetic::nico_like_eyes;

    /// The left eye 0.6 m above the robot's origin; its axis leans down by so much.
    fn workspace(down_rad: f64) -> Workspace {
        // Camera axes from the robot's: x to its right, y down, z ahead.
        let ahead = nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
            0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0,
        ));
        let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), down_rad);
        let turned = down * UnitQuaternion::from_rotation_matrix(&ahead);
        let place = Isometry3::from_parts(Translation3::new(0.08, 0.035, 0.6), turned);
        Workspace {
            robot_from_left: Pose::new(place),
            table_height_m: 0.054,
            x_range_m: [0.2, 0.6],
            y_range_m: [-0.45, 0.45],
            headroom_m: 0.15,
        }
    }

    #[test]
    fn all_that_is_done_on_the_table_is_in_the_region_of_both_eyes() {
        let cameras = nico_like_eyes();
        for down_rad in [0.0, 0.4, 0.8] {
            let workspace = workspace(down_rad);
            for eye in Eye::BOTH {
                let region = Region::of_workspace(&cameras, &workspace, eye).expect("in view");
                for (x, y, z) in [(0.2, -0.45, 0.054), (0.6, 0.45, 0.204), (0.4, 0.0, 0.1), (0.2, 0.45, 0.2)]
                {
                    let in_left = workspace.robot_from_left.inverse() * Point::new(x, y, z);
                    let point = match eye {
                        Eye::Left => in_left.coords.coords,
                        Eye::Right => (cameras.right_from_left * in_left).coords.coords,
                    };
                    let pixel = cameras.camera(eye).project(&point).expect("in view");
                    let (u, v) = (pixel.u_px - f64::from(region.x_px), pixel.v_px - f64::from(region.y_px));
                    assert!(u >= 0.0 && v >= 0.0, "{down_rad} {eye}: {region:?} {pixel:?}");
                    assert!(u < f64::from(region.width_px) && v < f64::from(region.height_px));
                }
                let share = f64::from(region.width_px * region.height_px) / (640.0 * 480.0);
                assert!(share < 0.5, "{share}");
            }
        }
    }

    #[test]
    fn a_head_that_looks_away_from_the_table_has_no_region() {
        let (cameras, up) = (nico_like_eyes(), workspace(-2.2));
        assert_eq!(Region::of_workspace(&cameras, &up, Eye::Left), None);
        assert_eq!(Part::of_workspace(&cameras, &up, Eye::Left, (640, 480)), Part::Lit);
    }

    #[test]
    fn images_of_other_cameras_have_no_workspace() {
        let (cameras, workspace) = (nico_like_eyes(), workspace(0.4));
        let part = |image| Part::of_workspace(&cameras, &workspace, Eye::Right, image);
        assert!(matches!(part((640, 480)), Part::Region(_)));
        assert_eq!(part((1280, 960)), Part::Lit);
    }

    #[test]
    fn the_disc_of_a_fisheye_is_lit_and_what_is_around_it_is_not() {
        let disc = RgbImage::from_fn(640, 480, |x, y| {
            let (dx, dy) = (f64::from(x) - 330.0, f64::from(y) - 240.0);
            image::Rgb(if dx.hypot(dy) < 200.0 { [90, 40, 10] } else { [12, 20, 9] })
        });
        let lit = Region::lit(&disc, &mut vec![]);
        assert_eq!(lit, Region { x_px: 128, y_px: 40, width_px: 408, height_px: 400 });
    }

    #[test]
    fn images_without_a_black_edge_and_black_ones_are_whole() {
        let whole = Region::whole((64, 48));
        for value in [0, 255] {
            let image = RgbImage::from_pixel(64, 48, image::Rgb([value; 3]));
            assert_eq!(Region::lit(&image, &mut vec![]), whole);
        }
        assert_eq!(Region::lit(&RgbImage::new(0, 3), &mut vec![]), Region::whole((0, 3)));
    }

    #[test]
    fn a_region_grows_around_what_it_is_to_hold_and_stays_on_the_image() {
        let region = Region { x_px: 100, y_px: 200, width_px: 300, height_px: 150 };
        let inside = PixelBox::new(120.0, 220.0, 140.0, 240.0);
        assert!(region.holds(&inside) && region.with(&inside, 8.0, (640, 480)) == region);
        let over = PixelBox::new(390.5, 340.0, 420.5, 370.0);
        assert!(!region.holds(&over));
        let grown = region.with(&over, 8.0, (640, 480));
        assert_eq!(grown, Region { width_px: 329, height_px: 178, ..region });
        assert!(grown.holds(&over));
        let corner = PixelBox::new(600.0, 0.0, 640.0, 10.0);
        let grown = region.with(&corner, 50.0, (640, 480));
        assert_eq!(grown, Region { x_px: 100, y_px: 0, width_px: 540, height_px: 350 });
        assert!((Region::whole((64, 48)).share_of((128, 48)) - 0.5).abs() < 1e-12);
        assert_eq!(region.share_of((50, 50)), 0.0);
    }

    #[test]
    fn what_lies_outside_an_image_does_not_count() {
        let region = Region { x_px: 600, y_px: 470, width_px: 100, height_px: 4 };
        assert_eq!(region.on_image((640, 480)), Some(Region { width_px: 40, ..region }));
        assert_eq!(Region { x_px: 640, ..region }.on_image((640, 480)), None);
        assert_eq!(Region { width_px: 0, ..region }.on_image((640, 480)), None);
        assert_eq!(Region { width_px: u32::MAX, ..region }.on_image((600, 480)), None);
    }
}

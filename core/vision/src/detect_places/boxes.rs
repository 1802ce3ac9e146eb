//! A box in coordinates that follow the epipolar geometry.

use plumbline_model::{Eye, Pixel, PixelBox, Raw};

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

use super::options::PlaceOptions;

/// A box of one eye as angles. Planes are the same for both eyes, so the planes of the top and the
/// bottom of one object are too; its along angles differ by the disparity.
#[derive(Clone, Copy, Debug)]
pub(super) struct EpipolarBox {
    /// The part of the box on the image.
    pub area: PixelBox,
    /// Ray of its middle.
    pub middle: EpipolarRay,
    /// Plane angles of the middles of its top and bottom edge, rad.
    pub planes_rad: [f64; 2],
    /// Along angles of the middles of its left and right edge, rad.
    pub alongs_rad: [f64; 2],
    /// Standard deviations of the left, top, right and bottom edge, raw px.
    pub edge_sigma_px: [f64; 4],
}

/// An edge this near to the border of the image is cut off by it, px.
const AT_BORDER_PX: f32 = 1.5;
/// Standard deviation of an edge that is cut off: the object may go on, as a share of the box.
const CUT_OFF_SHARE: f64 = 0.3;

/// Why a box has no place among the rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoBox {
    NotABox,
    OutsideLens,
}

impl EpipolarBox {
    pub fn new(
        geometry: &EpipolarGeometry,
        eye: Eye,
        area: &PixelBox,
        options: &PlaceOptions,
    ) -> Result<Self, NoBox> {
        let size_px = geometry.cameras.camera(eye).size_px();
        let finite = [area.x0_px, area.y0_px, area.x1_px, area.y1_px].iter().all(|edge| edge.is_finite());
        let area = area.on_image(size_px).filter(|_| finite).ok_or(NoBox::NotABox)?;
        let middle = area.middle::<Raw>();
        let ray =
            |u_px: f64, v_px: f64| geometry.ray(eye, Pixel::new(u_px, v_px)).map_err(|_| NoBox::OutsideLens);
        // Edges count from the corner of a pixel, rays from its middle.
        let edge = |value: f32| f64::from(value) - 0.5;
        let (left, right) = (ray(edge(area.x0_px), middle.v_px)?, ray(edge(area.x1_px), middle.v_px)?);
        let (top, bottom) = (ray(middle.u_px, edge(area.y0_px))?, ray(middle.u_px, edge(area.y1_px))?);
        Ok(Self {
            area,
            middle: ray(middle.u_px, middle.v_px)?,
            planes_rad: [top.plane_rad, bottom.plane_rad],
            alongs_rad: [left.along_rad, right.along_rad],
            edge_sigma_px: edge_sigmas(&area, size_px, options),
        })
    }

    /// Standard deviation of the middle along rows and along columns, raw px.
    pub fn middle_sigma_px(&self) -> [f64; 2] {
        let [x0, y0, x1, y1] = self.edge_sigma_px;
        [0.5 * x0.hypot(x1), 0.5 * y0.hypot(y1)]
    }

    /// Width as an angle, rad.
    pub fn width_rad(&self) -> f64 {
        (self.alongs_rad[1] - self.alongs_rad[0]).abs()
    }

    /// Height as an angle as the eye sees it, rad.
    pub fn height_rad(&self) -> f64 {
        (self.planes_rad[1] - self.planes_rad[0]).abs() * self.middle.along_rad.cos()
    }
}

fn edge_sigmas(area: &PixelBox, (width_px, height_px): (u32, u32), options: &PlaceOptions) -> [f64; 4] {
    let one = |size_px: f32, to_border_px: f32| {
        let size_px = f64::from(size_px);
        let share = if to_border_px < AT_BORDER_PX { CUT_OFF_SHARE } else { options.edge_share };
        options.edge_sigma_px.hypot(share * size_px)
    };
    [
        one(area.width_px(), area.x0_px),
        one(area.height_px(), area.y0_px),
        one(area.width_px(), width_px as f32 - area.x1_px),
        one(area.height_px(), height_px as f32 - area.y1_px),
    ]
}

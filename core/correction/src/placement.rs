//! M1: where the screen lies, and how high.

use nalgebra::{Matrix2, Vector2};
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::{Pixel, Point, Robot};
use serde::{Deserialize, Serialize};

use crate::data::TouchData;
use crate::heights::HeightGrid;

/// How M1 gets the placement of the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlacementFrom {
    /// From the touches: the session's screen is turned and shifted in the plane until they fit
    /// best; its pixels keep their size.
    #[default]
    Touches,
    /// The placement that the session states, which may have been measured by itself.
    Session,
}

/// From touch pixel to x and y: `x = x[0] u + x[1] v + x[2]`, the same for y; robot frame, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Factors of u and v (m/px), and x at the center of the first pixel (m).
    pub x: [f64; 3],
    /// The same for y.
    pub y: [f64; 3],
}

impl Placement {
    /// As the session states it.
    pub fn of_screen(screen: &Touchscreen) -> Self {
        let along_u = screen.u_axis.vector().xy() * (screen.width_m / f64::from(screen.width_px));
        let along_v = screen.v_axis.vector().xy() * (screen.height_m / f64::from(screen.height_px));
        // The origin is the corner of the first pixel, pixels count from its center.
        let first = screen.origin.coords.coords.xy() + 0.5 * (along_u + along_v);
        Self { x: [along_u.x, along_v.x, first.x], y: [along_u.y, along_v.y, first.y] }
    }

    /// The session's screen, turned about the vertical and shifted so that the squared distances
    /// between touches and points sent are least (Procrustes, no scaling).
    pub fn of_touches(data: &TouchData) -> Self {
        let stated = Self::of_screen(&data.screen);
        let pairs = data.touches.iter().map(|touch| (stated.xy(touch.pixel), touch.sent.coords.coords.xy()));
        let count = data.touches.len().max(1) as f64;
        let from: Vector2<f64> = pairs.clone().map(|(from, _)| from).sum::<Vector2<f64>>() / count;
        let to: Vector2<f64> = pairs.clone().map(|(_, to)| to).sum::<Vector2<f64>>() / count;
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (a, b) in pairs.map(|(a, b)| (a - from, b - to)) {
            cosine += a.dot(&b);
            sine += a.perp(&b);
        }
        let yaw = sine.atan2(cosine);
        let turn = Matrix2::new(yaw.cos(), -yaw.sin(), yaw.sin(), yaw.cos());
        let column = |index: usize| turn * Vector2::new(stated.x[index], stated.y[index]);
        let first = turn * (Vector2::new(stated.x[2], stated.y[2]) - from) + to;
        let (u, v) = (column(0), column(1));
        Self { x: [u.x, v.x, first.x], y: [u.y, v.y, first.y] }
    }

    /// The published placement of a screen of 1920 × 1080 pixels (of 2026):
    /// x = 0.28 + 0.27 (1 − v/1080), y = −0.24 + 0.48 (1 − u/1920).
    pub fn published() -> Self {
        Self { x: [0.0, -0.27 / 1080.0, 0.28 + 0.27], y: [-0.48 / 1920.0, 0.0, -0.24 + 0.48] }
    }

    /// x and y of a pixel, m.
    pub fn xy(&self, pixel: Pixel<Screen>) -> Vector2<f64> {
        let of = |row: &[f64; 3]| row[0] * pixel.u_px + row[1] * pixel.v_px + row[2];
        Vector2::new(of(&self.x), of(&self.y))
    }
}

/// M1: the placement of the screen, and measured heights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct M1 {
    /// For x and y.
    pub placement: Placement,
    /// For z.
    pub heights: HeightGrid,
}

impl M1 {
    /// From touches.
    pub fn of_touches(data: &TouchData, from: PlacementFrom) -> Self {
        let placement = match from {
            PlacementFrom::Touches => Placement::of_touches(data),
            PlacementFrom::Session => Placement::of_screen(&data.screen),
        };
        Self { placement, heights: HeightGrid::of_touches(data) }
    }

    /// As published: placement of 2026 and the table of heights. The published software reads x
    /// and y of the table off the placement, as [`Self::at`] does.
    pub fn published() -> Self {
        Self { placement: Placement::published(), heights: HeightGrid::published() }
    }

    /// The point to send for a pixel.
    pub fn at(&self, pixel: Pixel<Screen>) -> Point<Robot> {
        let xy = self.placement.xy(pixel);
        Point::new(xy.x, xy.y, self.heights.at(xy.x, xy.y))
    }

    /// Why it cannot be used; `None` when it can.
    pub fn fault(&self) -> Option<String> {
        let numbers = self.placement.x.iter().chain(&self.placement.y);
        if numbers.into_iter().any(|number| !number.is_finite()) {
            return Some("a number of the screen's placement is not finite".to_owned());
        }
        self.heights.fault()
    }
}

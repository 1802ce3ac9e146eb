//! A model over the table: residuals of its touches, its border, how sure it is and how far it
//! shifts, also around the screen.

use nalgebra::Point3;
use plumbline_correction::{CorrectionModel, TrainedTouch};
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::{Pixel, Point, Robot};

use super::view::{Field, MapTouch, ModelMap};

/// Values of a field along x and along y.
const FIELD: (usize, usize) = (25, 40);
/// Shown around the screen, m.
const MARGIN_M: f64 = 0.08;
/// A glass that stands nearly upright has no place over the table (sine of its slope).
const LEAST_LEVEL: f64 = 0.2;

/// Draws a model over a screen that lies there.
pub fn model_map(model: &CorrectionModel, screen: &Touchscreen, proposed: bool) -> ModelMap {
    let corners = screen.corners().map(|corner| [corner.coords.x, corner.coords.y]);
    let range = |axis: usize| {
        let values = corners.iter().map(|corner| corner[axis]);
        let least = values.clone().fold(f64::INFINITY, f64::min);
        [least - MARGIN_M, values.fold(f64::NEG_INFINITY, f64::max) + MARGIN_M]
    };
    let (x_m, y_m) = (range(0), range(1));
    let at = |x_m: f64, y_m: f64| Some(Asked::of(model, screen, pixel_under(screen, x_m, y_m)?));
    let sd = Field::fill(x_m, y_m, FIELD, |x_m, y_m| at(x_m, y_m)?.sd_m);
    let mut shifts = (Mean::default(), Mean::default());
    let shift = Field::fill(x_m, y_m, FIELD, |x_m, y_m| {
        let asked = at(x_m, y_m)?;
        if asked.inside {
            shifts.0.add(asked.shift_m)
        } else {
            shifts.1.add(asked.shift_m)
        }
        Some(asked.shift_m)
    });
    let on_table = |pixel: &Pixel<Screen>| {
        let point = screen.point_at(*pixel).coords;
        [point.x, point.y]
    };
    let touches = touches(model, screen);
    ModelMap {
        method: Some(model.method()),
        proposed,
        without_m: model.provenance().without.map(|errors| errors.mean_2d_m).or_else(|| without_m(&touches)),
        touches,
        border_m: model
            .border()
            .map(|border| border.rings().iter().map(|ring| ring.iter().map(on_table).collect()).collect())
            .unwrap_or_default(),
        screen_m: corners.to_vec(),
        sd,
        shift,
        mean_shift_m: (shifts.0.mean(), shifts.1.mean()),
    }
}

/// What a model answers for a pixel.
struct Asked {
    inside: bool,
    /// In the plane; `None` where nothing is known of it.
    sd_m: Option<f64>,
    shift_m: f64,
}

impl Asked {
    fn of(model: &CorrectionModel, screen: &Touchscreen, pixel: Pixel<Screen>) -> Self {
        let answer = model.correct(pixel);
        let shift = answer.target.coords.xy() - screen.point_at(pixel).coords.xy();
        let sd_m = answer.sd_m[0].hypot(answer.sd_m[1]);
        Self { inside: answer.inside, sd_m: sd_m.is_finite().then_some(sd_m), shift_m: shift.norm() }
    }
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// The pixel whose place on the glass, or on its plane beside it, is right above or below (x, y).
fn pixel_under(screen: &Touchscreen, x_m: f64, y_m: f64) -> Option<Pixel<Screen>> {
    let (normal, origin) = (screen.normal().vector(), screen.origin.coords);
    if normal.z.abs() < LEAST_LEVEL {
        return None;
    }
    let z_m = origin.z - (normal.x * (x_m - origin.x) + normal.y * (y_m - origin.y)) / normal.z;
    Some(screen.pixel_at(Point::<Robot>::from(Point3::new(x_m, y_m, z_m))))
}

/// The touches that a model was trained on, each as it came out when it was held out.
fn touches(model: &CorrectionModel, screen: &Touchscreen) -> Vec<MapTouch> {
    let provenance = model.provenance();
    let Some(held_out) = &provenance.cross_validation else { return Vec::new() };
    let arrow = |(touch, after_m): (&TrainedTouch, &[f64; 3])| {
        let place = screen.point_at(Pixel::new(touch.pixel[0], touch.pixel[1])).coords;
        MapTouch {
            at_m: [place.x, place.y],
            before_m: (place - Point3::from(touch.sent_m)).into(),
            after_m: *after_m,
        }
    };
    provenance.touches.iter().zip(&held_out.residuals_m).map(arrow).collect()
}

/// Mean length in the plane of the errors without a model.
fn without_m(touches: &[MapTouch]) -> Option<f64> {
    let sum_m: f64 = touches.iter().map(|touch| touch.before_m[0].hypot(touch.before_m[1])).sum();
    (!touches.is_empty()).then(|| sum_m / touches.len() as f64)
}

impl Field {
    /// Asks for a value at every node; `along` are the numbers of nodes along x and along y.
    pub fn fill(
        x_m: [f64; 2],
        y_m: [f64; 2],
        along: (usize, usize),
        mut value: impl FnMut(f64, f64) -> Option<f64>,
    ) -> Self {
        let at = |[low, high]: [f64; 2], i: usize, count: usize| {
            low + (high - low) * i as f64 / (count.max(2) - 1) as f64
        };
        let mut values_m = Vec::with_capacity(along.0 * along.1);
        for i in 0..along.0 {
            for j in 0..along.1 {
                values_m.push(value(at(x_m, i, along.0), at(y_m, j, along.1)));
            }
        }
        Self { x_m, y_m, columns: along.1, values_m }
    }
}

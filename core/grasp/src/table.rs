//! How high the table is, and the glass on it, by the model of the robot in use.

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_model::Point;

/// The touchscreen's glass lies so much higher than the table on which it stands, where nobody measured
/// it, m.
const GLASS_OVER_TABLE_M: f64 = 0.002;

/// Height of what things stand on at a place: the glass where the touchscreen lies, the table
/// beside it, in the plane in which the screen was found to lie, m.
pub fn support_m(model: &RobotModel, x_m: f64, y_m: f64) -> f64 {
    let screen = model.touchscreen();
    let glass_m = glass_m(model, x_m, y_m);
    let on_glass = screen.contains(screen.pixel_at(Point::new(x_m, y_m, glass_m)));
    if on_glass {
        return glass_m;
    }
    glass_m - model.glass_over_table_m().unwrap_or(GLASS_OVER_TABLE_M)
}

/// Height of the glass at a place, or of its plane beside it, m.
pub fn glass_m(model: &RobotModel, x_m: f64, y_m: f64) -> f64 {
    let screen = model.touchscreen();
    let normal: Vector3<f64> = screen.normal().vector();
    let origin = screen.origin.coords.coords;
    origin.z - (normal.x * (x_m - origin.x) + normal.y * (y_m - origin.y)) / normal.z
}

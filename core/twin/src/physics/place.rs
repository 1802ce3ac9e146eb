//! Where table and touchscreen truly are.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::Rig;

use crate::scenario::Scenario;

/// True places of what stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places {
    /// Middle of the table's top, axes of the robot when nothing is displaced.
    pub robot_from_table: Isometry3<f64>,
    /// Half of the table's extents along x and y, m.
    pub table_half_m: [f64; 2],
    /// Middle of the image on the touchscreen: x along u, y along v, z into the glass.
    pub robot_from_screen: Isometry3<f64>,
    /// True size of the image along u and v, m.
    pub screen_size_m: [f64; 2],
    /// Pixels along u and v.
    pub screen_px: [u32; 2],
}

impl Places {
    /// From the nominal rig and what is different.
    pub(crate) fn of(rig: &Rig, scenario: &Scenario) -> Self {
        let (x, y) = (rig.table.x_range_m, rig.table.y_range_m);
        let table_half_m = [0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])];
        let nominal_table =
            Isometry3::translation(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), rig.table.height_m);
        let moved = |turn: [f64; 3], shift: [f64; 3], about: Vector3<f64>| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let shift = about + Vector3::from(shift) - turn * about;
            Isometry3::from_parts(Translation3::from(shift), turn)
        };
        let middle = nominal_table.translation.vector;
        let table = moved(scenario.table.rotation_rad, scenario.table.translation_m, middle);
        let nominal = nominal_screen(rig);
        let reality = &scenario.touchscreen;
        let screen = moved(reality.rotation_rad, reality.translation_m, nominal.translation.vector);
        let size = [rig.touchscreen.width_m, rig.touchscreen.height_m];
        Self {
            robot_from_table: table * nominal_table,
            table_half_m,
            robot_from_screen: table * screen * nominal,
            screen_size_m: [size[0] * reality.scale[0], size[1] * reality.scale[1]],
            screen_px: [rig.touchscreen.width_px, rig.touchscreen.height_px],
        }
    }

    /// Moves the touchscreen straight up.
    pub(crate) fn raise_screen(&mut self, by_m: f64) {
        self.robot_from_screen.translation.vector.z += by_m;
    }

    /// The pixel at a point of the robot frame, ignoring its height over the glass; `None` beside
    /// the image.
    pub fn pixel(&self, point: Vector3<f64>) -> Option<[u32; 2]> {
        let on_screen = self.robot_from_screen.inverse() * nalgebra::Point3::from(point);
        let part = |along_m: f64, i: usize| {
            let px = (along_m / self.screen_size_m[i] + 0.5) * f64::from(self.screen_px[i]);
            // Truncation is the number of the pixel; beside the image there is none.
            (px >= 0.0 && px < f64::from(self.screen_px[i])).then_some(px as u32)
        };
        Some([part(on_screen.x, 0)?, part(on_screen.y, 1)?])
    }

    /// Height of the table's top at a place of the robot frame, m.
    pub(crate) fn table_height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let normal = self.robot_from_table.rotation * Vector3::z();
        let middle = self.robot_from_table.translation.vector;
        middle.z - (normal.x * (x_m - middle.x) + normal.y * (y_m - middle.y)) / normal.z
    }

    /// Whether a place of the robot frame lies on the table.
    pub(crate) fn on_table(&self, x_m: f64, y_m: f64) -> bool {
        let z = self.table_height_m(x_m, y_m);
        let p = self.robot_from_table.inverse() * nalgebra::Point3::new(x_m, y_m, z);
        p.x.abs() <= self.table_half_m[0] && p.y.abs() <= self.table_half_m[1]
    }
}

/// Nominal middle of the touchscreen's image.
fn nominal_screen(rig: &Rig) -> Isometry3<f64> {
    let screen = &rig.touchscreen;
    let (u, v) = (screen.u_axis.vector(), screen.v_axis.vector());
    let into = u.cross(&v).normalize();
    let turn = Rotation3::from_matrix(&Matrix3::from_columns(&[u, into.cross(&u), into]));
    let middle = screen.origin.coords.coords + 0.5 * (u * screen.width_m + v * screen.height_m);
    Isometry3::from_parts(Translation3::from(middle), UnitQuaternion::from_rotation_matrix(&turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        Rig::built_in("nico").expect("valid")
    }

    #[test]
    fn the_nominal_corners_are_the_first_and_last_pixel() {
        let rig = rig();
        let places = Places::of(&rig, &Scenario::built_in("perfect").expect("valid"));
        let screen = &rig.touchscreen;
        let at = |u: f64, v: f64| {
            screen.origin.coords.coords + screen.u_axis.vector() * u + screen.v_axis.vector() * v
        };
        assert_eq!(places.pixel(at(1e-5, 1e-5)), Some([0, 0]));
        assert_eq!(places.pixel(at(screen.width_m - 1e-5, screen.height_m - 1e-5)), Some([1919, 1079]));
        assert_eq!(places.pixel(at(-1e-4, 0.1)), None);
    }

    #[test]
    fn a_displaced_table_carries_the_screen() {
        let text = "format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\n[table]\ntranslation_m = [0.0, 0.0, -0.01]\nrotation_rad = [0.02, 0.0, 0.0]";
        let rig = rig();
        let tilted = Places::of(&rig, &Scenario::from_toml("x", text).expect("valid"));
        let level = Places::of(&rig, &Scenario::built_in("perfect").expect("valid"));
        let screen = level.robot_from_screen.translation.vector;
        let glass = tilted.robot_from_screen.translation.vector;
        let over = |places: &Places, p: Vector3<f64>| p.z - places.table_height_m(p.x, p.y);
        assert!((over(&level, screen) - over(&tilted, glass)).abs() < 1e-5);
        assert!(
            (tilted.table_height_m(0.26, 0.2) - tilted.table_height_m(0.26, 0.0) - 0.2 * 0.02f64.tan()).abs()
                < 1e-6
        );
        assert!(tilted.on_table(0.3, 0.0) && !tilted.on_table(0.9, 0.0));
    }
}

//! Where table and touchscreen truly are.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::Chessboard;
use plumbline_model::robot::Rig;

use crate::scenario::Scenario;

/// The picture of a board is so much above what it lies on, m: its own thickness.
const BOARD_OVER_M: f64 = 0.003;
/// The touchscreen is wider than its image by so much on each side, m.
const FRAME_M: f64 = 0.02;

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

    /// How much higher a board has to be held so that it reaches into neither table nor screen, m: what a person
    /// lays down lies on what is there.
    pub(crate) fn lift_m(&self, robot_from_board: &Isometry3<f64>, board: &Chessboard) -> f64 {
        const SAMPLES: usize = 8;
        let side = |inner: u32, k: usize| {
            board.square_m * ((f64::from(inner) + 1.0) * k as f64 / SAMPLES as f64 - 1.0)
        };
        let each = (0..=SAMPLES).flat_map(|i| (0..=SAMPLES).map(move |j| (i, j)));
        let missing = each.map(|(i, j)| {
            let on_board = Point3::new(side(board.inner_columns, i), side(board.inner_rows, j), 0.0);
            let point = robot_from_board * on_board;
            self.surface_m(point.x, point.y) + BOARD_OVER_M - point.z
        });
        missing.fold(0.0, f64::max)
    }

    /// Height of what is there at a place of the robot frame: the glass, or the table, m.
    pub(crate) fn surface_m(&self, x_m: f64, y_m: f64) -> f64 {
        let table_m = self.table_height_m(x_m, y_m);
        let on_screen = self.robot_from_screen.inverse() * Point3::new(x_m, y_m, table_m);
        let [half_u, half_v] = self.screen_size_m.map(|size_m| 0.5 * size_m + FRAME_M);
        if on_screen.x.abs() > half_u || on_screen.y.abs() > half_v {
            return table_m;
        }
        let (normal, middle) =
            (self.robot_from_screen.rotation * Vector3::z(), self.robot_from_screen.translation.vector);
        let glass_m = middle.z - (normal.x * (x_m - middle.x) + normal.y * (y_m - middle.y)) / normal.z;
        glass_m.max(table_m)
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
    fn a_board_that_is_laid_down_lies_on_what_is_there() {
        let rig = rig();
        let board = plumbline_model::default_board();
        let flat = |height_m: f64| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
            Isometry3::from_parts(Translation3::new(0.25, 0.07, height_m), turn)
        };
        let over = |places: &Places, height_m: f64| places.lift_m(&flat(height_m), &board);
        let perfect = Places::of(&rig, &Scenario::built_in("perfect").expect("valid"));
        assert!(over(&perfect, rig.table.height_m + 0.05).abs() < 1e-12, "held in the air it stays");
        let text = "format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\n[table]\n\
                    translation_m = [0.0, 0.0, 0.008]\nrotation_rad = [0.0, 0.01, 0.0]";
        let high = Places::of(&rig, &Scenario::from_toml("x", text).expect("valid"));
        let (flat_m, high_m) = (over(&perfect, rig.table.height_m), over(&high, rig.table.height_m));
        assert!(high_m > flat_m + 0.006 && high_m < 0.03, "{flat_m} {high_m}");
        let laid = over(&high, rig.table.height_m + high_m);
        assert!(laid.abs() < 1e-9, "{laid}");
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

//! Where to hold a chessboard so that both eyes see it well, from all sides of their images.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::frame::LeftCamera;
use plumbline_model::robot::Rig;
use plumbline_model::{Board, Chessboard, Pose, Robot};

/// Distance (m) of the board's middle, direction to it (to the right and down, degrees), turns
/// out of facing the eyes: about its columns, its rows, and in its plane (degrees).
const HELD: [[f64; 6]; 22] = [
    [0.20, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.20, 0.0, 0.0, 30.0, 0.0, 0.0],
    [0.20, 0.0, 0.0, -30.0, 0.0, 5.0],
    [0.20, 0.0, 0.0, 0.0, 30.0, -5.0],
    [0.20, 0.0, 0.0, 0.0, -30.0, 10.0],
    [0.18, 28.0, 0.0, 10.0, -15.0, 0.0],
    [0.18, -28.0, 0.0, -10.0, 15.0, 0.0],
    [0.18, 0.0, -28.0, 15.0, 0.0, 0.0],
    [0.18, 0.0, 22.0, -15.0, 10.0, 0.0],
    [0.20, 24.0, -20.0, 0.0, -20.0, 12.0],
    [0.20, -24.0, -20.0, 0.0, 20.0, -12.0],
    [0.20, 28.0, 18.0, -15.0, 10.0, -15.0],
    [0.20, -28.0, 18.0, -15.0, -10.0, 15.0],
    [0.24, 40.0, -8.0, 0.0, 0.0, 0.0],
    [0.24, -40.0, -8.0, 0.0, 0.0, 0.0],
    [0.28, 0.0, -12.0, 25.0, 15.0, 45.0],
    [0.28, 18.0, 4.0, -20.0, -25.0, -30.0],
    [0.28, -18.0, 4.0, -20.0, 25.0, 30.0],
    [0.36, 8.0, -18.0, 20.0, -20.0, 15.0],
    [0.36, -8.0, -6.0, -25.0, 20.0, 90.0],
    [0.16, 0.0, -4.0, 0.0, 0.0, 90.0],
    [0.40, 22.0, -20.0, 15.0, 25.0, 0.0],
];

/// Those of [`HELD`] that suffice where the board is then looked at once more as it lies on the table: tilted in
/// the middle, at all borders of the images, and far away.
const FEW: [usize; 12] = [1, 2, 3, 4, 5, 6, 7, 8, 13, 14, 18, 21];

/// Board of the laboratory: 9×6 squares of 30 mm.
pub fn default_board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}

/// Good places of the laboratory's board for calibrating the eyes, computed from the nominal
/// geometry: the head in the rig's first pose.
pub fn board_presets(rig: &Rig) -> Vec<Pose<Robot, Board>> {
    let robot_from_left = rig.robot_from_left(&rig.home());
    let half_baseline_m = 0.5 * rig.eyes.cameras.baseline_m();
    HELD.iter().map(|held| robot_from_left * left_from_board(held, half_baseline_m)).collect()
}

/// The few of them that suffice where the board is then looked at as it lies on the table.
pub fn few_board_presets(rig: &Rig) -> Vec<Pose<Robot, Board>> {
    let all = board_presets(rig);
    FEW.iter().filter_map(|place| all.get(*place).copied()).collect()
}

fn left_from_board(held: &[f64; 6], half_baseline_m: f64) -> Pose<LeftCamera, Board> {
    let [distance_m, right, down, columns, rows, plane] = *held;
    let [right, down, columns, rows, plane] = [right, down, columns, rows, plane].map(f64::to_radians);
    let about = UnitQuaternion::from_axis_angle;
    // y of the camera points down, so looking down is a negative turn about x.
    let direction = about(&Vector3::y_axis(), right) * about(&Vector3::x_axis(), -down);
    let tilt = about(&Vector3::x_axis(), columns) * about(&Vector3::y_axis(), rows);
    let turn = direction * tilt * about(&Vector3::z_axis(), plane);
    let board = default_board();
    let middle = Vector3::new(
        0.5 * f64::from(board.inner_columns - 1) * board.square_m,
        0.5 * f64::from(board.inner_rows - 1) * board.square_m,
        0.0,
    );
    let center = Vector3::x() * half_baseline_m + direction * Vector3::z() * distance_m;
    Pose::new(Isometry3::from_parts(Translation3::from(center - turn * middle), turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_eyes_see_every_corner_and_no_corner_is_in_the_table() {
        let rig = Rig::built_in("nico").expect("valid");
        let robot_from_left = rig.robot_from_left(&rig.home());
        let cameras = &rig.eyes.cameras;
        let board = default_board();
        for (i, robot_from_board) in board_presets(&rig).iter().enumerate() {
            for corner in 0..board.corner_count() {
                let in_robot = *robot_from_board * board.corner(corner);
                assert!(in_robot.coords.z > rig.table.height_m + 0.03, "{i}: {in_robot:?}");
                let in_left = robot_from_left.inverse() * in_robot;
                let in_right = cameras.right_from_left * in_left;
                let seen = [(&cameras.left, in_left.coords), (&cameras.right, in_right.coords)];
                for (camera, point) in seen {
                    let off_axis = point.coords.angle(&Vector3::z());
                    assert!(off_axis < 75f64.to_radians(), "{i}: {off_axis} rad off the axis");
                    let pixel = camera.project(&point.coords).expect("in front");
                    assert!(
                        (10.0..630.0).contains(&pixel.u_px) && (10.0..470.0).contains(&pixel.v_px),
                        "{i}: {pixel:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn together_they_cover_the_image() {
        let rig = Rig::built_in("nico").expect("valid");
        assert_eq!(few_board_presets(&rig).len(), FEW.len());
        cover_the_image(&rig, &board_presets(&rig));
        cover_the_image(&rig, &few_board_presets(&rig));
    }

    fn cover_the_image(rig: &Rig, places: &[Pose<Robot, Board>]) {
        let left_from_robot = rig.robot_from_left(&rig.home()).inverse();
        let (mut least, mut most) = ([f64::MAX; 2], [f64::MIN; 2]);
        for robot_from_board in places {
            for corner in 0..default_board().corner_count() {
                let point = left_from_robot * (*robot_from_board * default_board().corner(corner));
                let pixel = rig.eyes.cameras.left.project(&point.coords.coords).expect("in front");
                for (k, value) in [pixel.u_px, pixel.v_px].into_iter().enumerate() {
                    least[k] = least[k].min(value);
                    most[k] = most[k].max(value);
                }
            }
        }
        assert!(
            least[0] < 180.0 && most[0] > 460.0 && least[1] < 130.0 && most[1] > 330.0,
            "{least:?} {most:?}"
        );
    }
}

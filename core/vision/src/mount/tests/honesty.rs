//! Truth recovered, and errors of the stated size.

use nalgebra::Vector6;

use super::world::World;
use crate::mount::{MountCalibration, MountChange};
use plumbline_model::Pose;
use plumbline_model::frame::{Head, LeftCamera};

/// True minus solved, in the order of the covariance.
pub fn error(truth: &Pose<Head, LeftCamera>, solved: &MountCalibration) -> Vector6<f64> {
    let change = MountChange::between(&solved.head_from_left, truth);
    let (r, t) = (change.turned_rad, change.moved_m);
    Vector6::new(r.x, r.y, r.z, t.x, t.y, t.z)
}

#[test]
fn perfect_views_give_the_mount_and_the_board_exactly() {
    let mut world = World::perfect(1);
    let views = world.board_views(8);
    let solved = world.solve(&views).expect("solvable");
    assert!(error(&world.mount(), &solved).amax() < 1e-7, "{}", error(&world.mount(), &solved));
    let board = solved.robot_from_board.expect("solved for").isometry;
    assert!((board.translation.vector - world.robot_from_board.translation.vector).norm() < 1e-7);
    assert!(solved.not_seen.is_empty() && solved.rejected.is_empty(), "{:?}", solved.not_seen);
}

/// Runs worlds and returns the mean squared error in units of the stated covariance (6 expected),
/// the share of single errors within 2.5 standard deviations, and the sigmas' mean.
pub fn coverage(
    worlds: u64,
    make: impl Fn(u64) -> (World, Result<MountCalibration, crate::mount::MountError>),
) -> (f64, f64) {
    let (mut squares, mut within, mut all) = (0.0, 0.0, 0.0);
    let mut sigma = Vector6::zeros();
    for seed in 0..worlds {
        let (world, solved) = make(seed);
        let solved = solved.expect("solvable");
        assert!(solved.rejected.is_empty(), "{:?}", solved.rejected);
        let error = error(&world.mount(), &solved);
        let inverse = solved.covariance.try_inverse().expect("positive");
        squares += (error.transpose() * inverse * error)[0];
        for k in 0..6 {
            let sd = solved.covariance[(k, k)].sqrt();
            sigma[k] += sd;
            within += f64::from(u8::from(error[k].abs() < 2.5 * sd));
            all += 1.0;
        }
    }
    let n = worlds as f64;
    sigma /= n;
    println!(
        "{worlds} worlds: mean chi-square {:.2} of 6, {:.1} % within 2.5 sigma; sigma {:.3} {:.3} {:.3} deg, {:.2} {:.2} {:.2} mm",
        squares / n,
        100.0 * within / all,
        sigma[0].to_degrees(),
        sigma[1].to_degrees(),
        sigma[2].to_degrees(),
        sigma[3] * 1e3,
        sigma[4] * 1e3,
        sigma[5] * 1e3
    );
    (squares / n, within / all)
}

#[test]
fn errors_have_the_stated_size() {
    let (chi_square, within) = coverage(40, |seed| {
        let mut world = World::new(seed);
        let views = world.board_views(12);
        let solved = world.solve(&views);
        (world, solved)
    });
    // 40 worlds: the mean of 240 squares of normals is within ±1.3 of 6 in 99 of 100 runs.
    assert!((4.5..7.5).contains(&chi_square), "{chi_square}");
    assert!(within >= 0.95, "{within}");
}

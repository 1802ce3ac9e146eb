//! From rendered images to the mount: render, find corners, calibrate, compare with the truth.

use nalgebra::Isometry3;
use plumbline_model::frame::Board;
use plumbline_model::{Pose, Robot};

use super::honesty::error;
use super::world::{World, board};
use crate::chessboard;
use crate::mount::{HeadView, place_of_board};
use crate::synthetic::{Plane, Scene, chessboard_texture};

/// Both images of the board on the table, and what is found in them.
fn rendered_view(world: &mut World, name: &str, pan_tilt: (f64, f64), seed: u64) -> HeadView {
    let (encoder, truth) = world.stand(pan_tilt.0, pan_tilt.1);
    let head = world.rig.description.forward(&truth).of(world.rig.eyes.link).isometry;
    let left_from_robot = (head * world.head_from_left).inverse();
    let table = Isometry3::translation(0.3, 0.0, 0.0535);
    let mut scene = Scene { background: 90.0, ..Scene::default() };
    scene.planes.push(Plane::new(
        left_from_robot * table,
        Box::new(|x, y| Some(120.0 + 20.0 * (60.0 * x).sin() * (45.0 * y).cos())),
    ));
    scene.planes.push(Plane::new(left_from_robot * world.robot_from_board, chessboard_texture(&board())));
    let (left, right) = scene.render_pair(&world.rig.eyes.cameras, 2.0, seed);
    let sighting = chessboard::find_in_pair(name, &left, &right, &board());
    HeadView::new(sighting.observation, encoder)
}

#[test]
fn rendered_boards_give_the_planted_mount_within_its_uncertainty() {
    let mut world = World::new(41);
    let poses = world.planned(7);
    let views: Vec<HeadView> = poses
        .into_iter()
        .enumerate()
        .map(|(i, pose)| rendered_view(&mut world, &format!("view {i}"), pose, 1000 + i as u64))
        .collect();
    let seen = views.iter().filter(|view| view.left.is_some() && view.right.is_some()).count();
    assert!(seen >= 6, "both eyes find the board in {seen} of 7 views");

    let glimpse = views.iter().find(|view| view.left.is_some()).expect("seen");
    let cameras = world.rig.eyes.cameras;
    let place: Pose<Robot, Board> = place_of_board(&world.rig, &cameras, glimpse, &board()).expect("seen");
    let off = place.translation_m() - world.robot_from_board.translation.vector;
    assert!(off.norm() < 0.08, "by the nominal mount {off:?}");

    let start = std::time::Instant::now();
    let solved = world.solve(&views).expect("solvable");
    println!("solved in {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    let error = error(&world.mount(), &solved);
    let (turned, moved) = (solved.turned_sigma_rad(), solved.moved_sigma_m());
    println!(
        "{seen} of 7 views, rms {:.3} px; error {:.3} {:.3} {:.3} deg, {:.2} {:.2} {:.2} mm; sigma {:.3} {:.3} {:.3} deg, {:.2} {:.2} {:.2} mm",
        solved.rms_px,
        error[0].to_degrees(),
        error[1].to_degrees(),
        error[2].to_degrees(),
        error[3] * 1e3,
        error[4] * 1e3,
        error[5] * 1e3,
        turned.x.to_degrees(),
        turned.y.to_degrees(),
        turned.z.to_degrees(),
        moved.x * 1e3,
        moved.y * 1e3,
        moved.z * 1e3
    );
    assert!(solved.rejected.len() == 7 - seen || solved.rejected.is_empty(), "{:?}", solved.rejected);
    assert!(solved.rms_px < 0.2, "{}", solved.rms_px);
    for k in 0..6 {
        let sigma = solved.covariance[(k, k)].sqrt();
        assert!(error[k].abs() < 4.0 * sigma, "{k}: {} of {sigma}", error[k]);
    }
}

//! A made-up lab: chessboard pairs and a table with toys, seen by eyes like NICO's. For trying the
//! program without a camera and for pictures of it; nothing measured comes from here.

use std::path::Path;

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::files::{self, FileError};
use plumbline_model::workspace::Workspace;
use plumbline_model::{Cancelled, Chessboard, Eye, JobContext};

use super::{Ball, Noise, Plane, Scene, Texture, chessboard_texture, granite_texture, nico_like_eyes};

/// Why the pairs were not written.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    /// Stopped on request.
    #[error("cancelled")]
    Cancelled(#[from] Cancelled),
    /// A folder or file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// The sample's chessboard: 9×6 squares of 30 mm.
pub fn board() -> Chessboard {
    Chessboard { inner_columns: 8, inner_rows: 5, square_m: 0.03 }
}

/// Writes `pairs` chessboard pairs into `folder/board/left` and `right`, and three pairs of a table
/// with toys into `folder/table/left` and `right`.
pub fn write(folder: &Path, pairs: usize, seed: u64, context: &dyn JobContext) -> Result<(), SampleError> {
    let tables = 3;
    let total = (pairs + tables) as f64;
    let mut noise = Noise::new(seed);
    for i in 0..pairs {
        context.checkpoint()?;
        context.report(i as f64 / total, &format!("rendering chessboard pair {} of {pairs}", i + 1));
        let mut scene = lab();
        scene.planes.push(held_board(&mut noise));
        save(&scene, &folder.join("board"), &format!("pair_{i:02}.png"), seed + i as u64)?;
    }
    for i in 0..tables {
        context.checkpoint()?;
        context.report((pairs + i) as f64 / total, &format!("rendering the table, {} of {tables}", i + 1));
        let mut scene = lab();
        scene.balls = toys(i);
        save(&scene, &folder.join("table"), &format!("table_{i:02}.png"), seed + 1000 + i as u64)?;
    }
    Ok(())
}

fn save(scene: &Scene, folder: &Path, name: &str, seed: u64) -> Result<(), SampleError> {
    for eye in Eye::BOTH {
        let folder = folder.join(eye.to_string());
        let path = folder.join(name);
        let sharp = scene.render_rgb(&nico_like_eyes(), eye, 1.5, seed);
        // The blur of a cheap lens.
        let image = image::imageops::blur(&sharp, 0.6);
        files::make_folder(&folder)?;
        files::write_png(&path, &image.into())?;
    }
    Ok(())
}

/// Pose of something in the robot frame, as the left eye has it.
fn left_from(robot_from_thing: Isometry3<f64>) -> Isometry3<f64> {
    Workspace::default().robot_from_left.isometry.inverse() * robot_from_thing
}

/// A rectangle of a texture, centered, `width` along x and `height` along y.
fn rectangle(width: f64, height: f64, inner: Texture) -> Texture {
    Box::new(move |x, y| if x.abs() < 0.5 * width && y.abs() < 0.5 * height { inner(x, y) } else { None })
}

/// Table, tablet, walls, floor and ceiling, in the proportions of the real place.
fn lab() -> Scene {
    let top_m = Workspace::default().table_height_m;
    let flat = |brightness: f64| -> Texture { Box::new(move |_, _| Some(brightness)) };
    let level = |x: f64, y: f64, z: f64| left_from(Isometry3::translation(x, y, z));
    let upright = |x: f64, y: f64, yaw: f64| {
        let stand = Isometry3::rotation(Vector3::z() * yaw)
            * Isometry3::rotation(Vector3::y() * std::f64::consts::FRAC_PI_2);
        left_from(Isometry3::translation(x, y, 0.3) * stand)
    };
    let planes = vec![
        Plane::new(level(0.46, 0.0, top_m), rectangle(0.72, 1.3, granite_texture(0.006, 21))),
        Plane::new(level(0.395, 0.0, top_m + 0.002), rectangle(0.33, 0.534, flat(26.0)))
            .tinted([0.9, 0.95, 1.1]),
        Plane::new(level(1.3, 0.0, top_m - 0.01), rectangle(0.95, 1.5, boards())).tinted([1.0, 0.72, 0.45]),
        Plane::new(level(0.0, 0.0, -0.7), flat(120.0)).tinted([0.9, 0.86, 0.8]),
        Plane::new(level(0.0, 0.0, 1.9), flat(200.0)),
        Plane::new(upright(2.6, 0.0, 0.0), curtains()),
        Plane::new(upright(0.0, 1.7, std::f64::consts::FRAC_PI_2), flat(190.0)),
        Plane::new(upright(0.0, -1.7, std::f64::consts::FRAC_PI_2), flat(175.0)),
    ];
    Scene { planes, ..Scene::default() }
}

/// A wooden table top.
fn boards() -> Texture {
    Box::new(|x, y| Some(150.0 + 25.0 * (40.0 * x + 3.0 * (9.0 * y).sin()).sin()))
}

/// Dark curtains between light walls.
fn curtains() -> Texture {
    Box::new(|_, y| Some(if y.abs() < 0.9 { 30.0 + 12.0 * (55.0 * y).sin() } else { 195.0 }))
}

/// A chessboard somewhere a person would hold it: all over the view, near and far, tilted, and
/// above the table.
fn held_board(noise: &mut Noise) -> Plane {
    let lowest_m = Workspace::default().table_height_m + 0.02;
    let robot_from_left = Workspace::default().robot_from_left.isometry;
    loop {
        let left_from_board = anywhere(noise);
        // The print and its margin of one square.
        let margin = board().square_m * 2.0;
        let far = board().corner(board().corner_count() - 1).coords;
        let above_table = [
            (-margin, -margin),
            (far.x + margin, -margin),
            (-margin, far.y + margin),
            (far.x + margin, far.y + margin),
        ]
        .iter()
        .all(|&(x, y)| (robot_from_left * (left_from_board * Point3::new(x, y, 0.0))).z > lowest_m);
        if above_table {
            return Plane::new(left_from_board, chessboard_texture(&board())).tinted([1.0, 0.99, 0.96]);
        }
    }
}

/// A board pose in view of the left eye, roughly facing it.
fn anywhere(noise: &mut Noise) -> Isometry3<f64> {
    let range_m = noise.between(0.17, 0.36);
    let place =
        Vector3::new(noise.between(-0.75, 0.75) * range_m, noise.between(-0.6, 0.5) * range_m, range_m);
    let facing = Vector3::new(-place.y / range_m, place.x / range_m, 0.0) * 0.8;
    let tilt = Vector3::new(noise.between(-0.55, 0.55), noise.between(-0.55, 0.55), noise.between(-0.7, 0.7));
    let turn = Isometry3::rotation(facing) * Isometry3::rotation(tilt);
    let center = board().corner(board().corner_count() - 1).coords.coords * 0.5;
    Isometry3::translation(place.x, place.y, place.z)
        * turn
        * Isometry3::translation(-center.x, -center.y, 0.0)
}

/// Balls on the table: tomato, orange, lemon.
fn toys(arrangement: usize) -> Vec<Ball> {
    const PLACES: [[[f64; 2]; 3]; 3] = [
        [[0.36, -0.12], [0.45, 0.10], [0.30, 0.24]],
        [[0.42, 0.02], [0.30, -0.25], [0.52, -0.16]],
        [[0.27, 0.08], [0.50, 0.22], [0.40, -0.20]],
    ];
    const TINTS: [[f64; 3]; 3] = [[1.0, 0.16, 0.12], [1.0, 0.55, 0.1], [1.0, 0.9, 0.2]];
    const RADII_M: [f64; 3] = [0.032, 0.024, 0.027];
    let to_lamp = left_from(Isometry3::identity()).rotation * Vector3::new(0.3, 0.4, 1.0);
    (0..3)
        .map(|k| {
            let [x, y] = PLACES[arrangement % PLACES.len()][k];
            let z = Workspace::default().table_height_m + RADII_M[k];
            let center_in_left = left_from(Isometry3::identity()) * Point3::new(x, y, z);
            Ball { center_in_left, radius_m: RADII_M[k], to_lamp, tint: TINTS[k] }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Unattended;

    #[test]
    fn boards_of_the_sample_are_seen_by_both_eyes() {
        let mut noise = Noise::new(1);
        let mut seen = 0;
        for _ in 0..3 {
            let mut scene = lab();
            scene.planes.push(held_board(&mut noise));
            let (left, right) = scene.render_pair(&nico_like_eyes(), 1.5, 3);
            let sighting = crate::chessboard::find_in_pair("pair", &left, &right, &board());
            seen += usize::from(sighting.observation.left.is_some() && sighting.observation.right.is_some());
        }
        assert!(seen >= 2, "only {seen} of 3 boards are seen by both eyes");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let file = tempfile::NamedTempFile::new().expect("a file");
        let error = write(file.path(), 1, 1, &Unattended).expect_err("a file is no folder");
        assert!(error.to_string().contains("left"), "{error}");
    }
}

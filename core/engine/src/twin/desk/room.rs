//! Toys make room for the board that lies on the table and for the hand at the screen, and come back.

use plumbline_model::Point;
use plumbline_model::frame::{Board, Pose, Robot};
use plumbline_model::robot::Rig;
use plumbline_twin::Toy;

use super::TwinDesk;
use crate::ground::notice::NoticeLevel;
use crate::twin::unable::TwinUnable;

/// So much around the touchscreen is kept free of toys while it is touched: a hand is broad, m.
const BESIDE_SCREEN_M: f64 = 0.06;
/// The printed side lies this high above the table, m; the touchscreen's glass is lower.
const BOARD_THICKNESS_M: f64 = 0.006;

impl TwinDesk {
    /// Puts toys away that lie on the touchscreen or near it: a finger would land on them.
    pub fn free_screen(&mut self, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let mut away = vec![];
        for (toy, place) in &twin.state().toys {
            let Some(place) = place.filter(|place| is_on_screen(*place, rig)) else { continue };
            twin.send(plumbline_twin::TwinCommand::RemoveObject { toy: *toy });
            away.push((*toy, [place.x, place.y]));
        }
        // One that was put away just now may still be seen.
        away.retain(|(toy, _)| !self.off_screen.iter().any(|(known, _)| known == toy));
        if !away.is_empty() {
            let names: Vec<&str> = away.iter().map(|(toy, _)| toy.name()).collect();
            let text = format!(
                "Put away, so that the screen can be touched, and back where they stood once the run is over and no hand is there: {}.",
                names.join(", ")
            );
            self.notes.push((NoticeLevel::Info, text));
            self.off_screen.extend(away);
        }
    }

    /// Nobody touches the screen any more. Where the board is out, toys come back once it is put away.
    pub(super) fn leave_screen(&mut self, rig: &Rig) {
        let is_board_out = self.twin.as_ref().is_some_and(|twin| twin.state().board.is_some());
        self.made_room.append(&mut self.off_screen);
        if !is_board_out {
            self.put_back(rig);
        }
    }

    /// Puts toys away that stand where the board is to lie: they would hide its corners. Those that made
    /// room for it elsewhere come back.
    pub(super) fn make_room(&mut self, robot_from_board: &Pose<Robot, Board>, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let hides = |toy: Toy, at_m: [f64; 2]| is_on_board(toy, at_m, robot_from_board, rig);
        let before = std::mem::take(&mut self.made_room);
        let (stay_away, back): (Vec<_>, Vec<_>) = before.into_iter().partition(|(toy, at)| hides(*toy, *at));
        let mut away = vec![];
        for (toy, place) in &twin.state().toys {
            let Some(at_m) = place.map(|place| [place.x, place.y]).filter(|at_m| hides(*toy, *at_m)) else {
                continue;
            };
            twin.send(plumbline_twin::TwinCommand::RemoveObject { toy: *toy });
            away.push((*toy, at_m));
        }
        if !away.is_empty() {
            let names: Vec<&str> = away.iter().map(|(toy, _)| toy.name()).collect();
            let text = format!(
                "Put away to make room for the board, and back where they stood once it is gone: {}.",
                names.join(", ")
            );
            self.notes.push((NoticeLevel::Info, text));
        }
        self.made_room = back;
        self.put_back(rig);
        self.made_room = [stay_away, away].concat();
    }

    /// Toys that made room stand where they stood.
    pub(super) fn put_back(&mut self, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let mut back = vec![];
        for (toy, [x_m, y_m]) in std::mem::take(&mut self.made_room) {
            // One that was at the very edge, or had been pushed off the table, cannot be put there.
            let on = |range: [f64; 2], value: f64| value >= range[0] && value <= range[1];
            if on(rig.table.x_range_m, x_m) && on(rig.table.y_range_m, y_m) {
                twin.send(plumbline_twin::TwinCommand::PlaceObject { toy, x_m, y_m });
                back.push(toy.name());
            }
        }
        if !back.is_empty() {
            let text = format!("Back where they stood: {}.", back.join(", "));
            self.notes.push((NoticeLevel::Info, text));
        }
    }
}

/// The board flat on the table, its center at a place.
pub(super) fn lying(rig: &Rig, x_m: f64, y_m: f64, yaw_rad: f64) -> Result<Pose<Robot, Board>, TwinUnable> {
    if ![x_m, y_m, yaw_rad].iter().all(|value| value.is_finite()) {
        return Err(TwinUnable::NotNumbers);
    }
    let board = plumbline_model::default_board();
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::z() * yaw_rad)
        // z goes into the board, which is down; its columns then run to the robot's right.
        * nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::x() * std::f64::consts::PI);
    let half = nalgebra::Vector3::new(
        0.5 * f64::from(board.inner_columns - 1) * board.square_m,
        0.5 * f64::from(board.inner_rows - 1) * board.square_m,
        0.0,
    );
    let center = nalgebra::Vector3::new(x_m, y_m, rig.table.height_m + BOARD_THICKNESS_M);
    let origin = center - turn * half;
    Ok(Pose::new(nalgebra::Isometry3::from_parts(origin.into(), turn)))
}

/// Whether a toy at a place stands on the touchscreen, or so near that a hand would meet it.
pub(super) fn is_on_screen(place: nalgebra::Vector3<f64>, rig: &Rig) -> bool {
    let screen = &rig.touchscreen;
    let pixel = screen.pixel_at(Point::from(nalgebra::Point3::from(place)));
    let near = |at_px: f64, count: u32, size_m: f64| {
        let at_m = at_px * size_m / f64::from(count);
        at_m > -BESIDE_SCREEN_M && at_m < size_m + BESIDE_SCREEN_M
    };
    near(pixel.u_px, screen.width_px, screen.width_m) && near(pixel.v_px, screen.height_px, screen.height_m)
}

/// Whether a toy at a place of the table would hide some of a lying board.
fn is_on_board(toy: Toy, [x_m, y_m]: [f64; 2], robot_from_board: &Pose<Robot, Board>, rig: &Rig) -> bool {
    let board = plumbline_model::default_board();
    let size = |corners: u32| f64::from(corners - 1) * board.square_m;
    let place = nalgebra::Point3::new(x_m, y_m, rig.table.height_m);
    let on_board = robot_from_board.isometry.inverse() * place;
    // The eyes look from the side, so what stands near hides something too.
    let reach_m = 2.0 * board.square_m + 2.0 * toy.radius_m();
    let inside = |value: f64, size_m: f64| value > -reach_m && value < size_m + reach_m;
    inside(on_board.x, size(board.inner_columns)) && inside(on_board.y, size(board.inner_rows))
}

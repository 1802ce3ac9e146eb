//! What turned eyes cost on the table: how far off places come out near, in the middle and far.

use nalgebra::{Matrix3, Rotation3, Vector3};
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::robot::Posture;
use plumbline_model::{Point, Robot};

/// Places across the table, shares of its half width.
const ACROSS: [f64; 3] = [-0.6, 0.0, 0.6];

/// Which part of the table, seen from the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Row {
    /// The end at the robot.
    Near,
    /// The middle.
    Middle,
    /// The other end.
    Far,
}

impl Row {
    /// All of them, from near to far.
    pub const ALL: [Self; 3] = [Self::Near, Self::Middle, Self::Far];

    /// Its name, inside a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Near => "near",
            Self::Middle => "middle",
            Self::Far => "far",
        }
    }
}

/// A place on the table, and how far off it comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceError {
    /// The place, robot frame, m.
    pub at_m: Vector3<f64>,
    /// Where it comes out now, minus where it came out at first, robot frame, m.
    pub error_m: Vector3<f64>,
    /// The part along the line of sight, away from the eyes, in the plane of the table, m.
    pub along_m: f64,
    /// The part across it, to the robot's left, in the plane of the table, m.
    pub across_m: f64,
}

/// Errors over the table: for each row three places, from the robot's right to its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableError {
    /// By row, in the order of [`Row::ALL`].
    pub rows: [[PlaceError; 3]; 3],
}

impl TableError {
    /// Mean length of the errors of a row, m.
    pub fn size_m(&self, row: Row) -> f64 {
        self.mean(row, |place| place.error_m.norm())
    }

    /// Mean of the parts along the line of sight, m; positive: places come out too far away.
    pub fn along_m(&self, row: Row) -> f64 {
        self.mean(row, |place| place.along_m)
    }

    /// Mean of the parts across the line of sight, m; positive: places come out too far to the left.
    pub fn across_m(&self, row: Row) -> f64 {
        self.mean(row, |place| place.across_m)
    }

    /// Mean length by row, m.
    pub fn sizes_m(&self) -> [f64; 3] {
        Row::ALL.map(|row| self.size_m(row))
    }

    /// How far two states lie apart, mean length by row, m.
    pub fn apart_m(&self, other: &Self) -> [f64; 3] {
        Row::ALL.map(|row| {
            let both = self.rows[row as usize].iter().zip(&other.rows[row as usize]);
            both.map(|(a, b)| (a.error_m - b.error_m).norm()).sum::<f64>() / 3.0
        })
    }

    fn mean(&self, row: Row, of: impl Fn(&PlaceError) -> f64) -> f64 {
        self.rows[row as usize].iter().map(of).sum::<f64>() / 3.0
    }
}

/// How far off places on the table come out when each eye has turned (rad, own axes, as
/// [`plumbline_vision::follow::EyeTurn`]) since a first look, and the robot localizes with `model`, which
/// corrects by what it knows of the time since the eyes were switched on. `None`: an eye does not see one
/// of the places.
pub fn errors(
    model: &RobotModel,
    posture: &Posture,
    turns_rad: [Vector3<f64>; 2],
    first: &SeenUnder,
    now: &SeenUnder,
) -> Option<TableError> {
    let rig = model.rig();
    let robot_from_left = rig.robot_from_left(posture);
    let left_from_robot = robot_from_left.inverse();
    let eye_m = robot_from_left.translation_m();
    let still = [Vector3::zeros(); 2];
    let put = |at: Point<Robot>, turns_rad: [Vector3<f64>; 2], seen: &SeenUnder| {
        let cameras = &rig.eyes.cameras;
        let in_left = left_from_robot * at;
        let in_right = cameras.right_from_left * in_left;
        let [left, right] = turns_rad.map(Rotation3::new);
        let left = cameras.left.project(&(left * in_left.coords.coords)).ok()?;
        let right = cameras.right.project(&(right * in_right.coords.coords)).ok()?;
        let seen_at = cameras.triangulate(left, right)?;
        Some(model.place(&seen_at, &Matrix3::zeros(), posture, seen)?.point.coords.coords)
    };
    let [near_m, far_m] = rig.work_patch.x_range_m;
    let [right_m, left_m] = rig.work_patch.y_range_m;
    let place = |x_m: f64, share: f64| {
        let y_m = 0.5 * (right_m + left_m) + share * 0.5 * (left_m - right_m);
        let at = Point::new(x_m, y_m, rig.table.height_m);
        let error_m = put(at, turns_rad, now)? - put(at, still, first)?;
        let sight = Vector3::new(x_m - eye_m.x, y_m - eye_m.y, 0.0).try_normalize(1e-6)?;
        let to_left = Vector3::z().cross(&sight);
        let (along_m, across_m) = (error_m.dot(&sight), error_m.dot(&to_left));
        Some(PlaceError { at_m: at.coords.coords, error_m, along_m, across_m })
    };
    let row = |x_m: f64| {
        let [a, b, c] = ACROSS.map(|share| place(x_m, share));
        Some([a?, b?, c?])
    };
    let [near, middle, far] = [near_m, 0.5 * (near_m + far_m), far_m].map(row);
    Some(TableError { rows: [near?, middle?, far?] })
}

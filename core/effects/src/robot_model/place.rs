//! From what the eyes see to places in the robot's frame, and back.

use nalgebra::{Matrix3, Point3, Vector3};
use plumbline_model::decompose;
use plumbline_model::robot::Posture;
use plumbline_model::{LeftCamera, Pixel, Point, Pose, Raw, Robot};

use super::RobotModel;
use super::uncertainty::{of_values, slope};
use crate::eyes::EyesDeviation;
use crate::library::Present;
use crate::looking::Looking;
use crate::observation::{Observation, What};

/// Step of differences of a place, m.
const STEP_M: f64 = 1e-4;

/// What effects on the eyes depend on besides the posture. What is not known takes no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenUnder {
    /// Time since the eyes were switched on, s.
    pub t_secs: Option<f64>,
    /// Distance of what lies behind, m.
    pub background_m: Option<f64>,
    /// How far the right eye was seen to have turned against the left one since both were calibrated, rad; 0: nobody has
    /// seen that. It moves no place, but places are no better known than that.
    pub apart_rad: f64,
}

/// Where something is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceInRobot {
    /// Robot frame.
    pub point: Point<Robot>,
    /// Covariance in the robot's axes, m²: that of what was seen, that of the effects' values with what they
    /// leave of the rows that they were found in, that of mount and lenses, or how far those usually are off where
    /// nobody measured them, and how far eyes usually have turned since they were calibrated colder or warmer,
    /// or were seen to have.
    pub covariance_m2: Matrix3<f64>,
    /// The part of it by how both eyes sit in the head, m²: it moves all that is seen alike, and nothing nearer to the eyes or
    /// farther away.
    pub by_mount_m2: Matrix3<f64>,
}

impl PlaceInRobot {
    /// One standard deviation along the worst direction, m; infinite where the covariance holds what
    /// is no number.
    pub fn sigma_m(&self) -> f64 {
        worst_sigma_m(&self.covariance_m2)
    }

    /// How far it is from an eye at `eye_m` (robot frame, m), and one standard deviation of that, m; infinite where it
    /// is no number.
    pub fn range_m(&self, eye_m: &Vector3<f64>) -> (f64, f64) {
        let from_eye_m = self.point.coords.coords - eye_m;
        let along = from_eye_m.try_normalize(0.0).unwrap_or_default();
        let variance_m2 = (along.transpose() * (self.covariance_m2 - self.by_mount_m2) * along).x;
        let sigma_m = if variance_m2.is_nan() { f64::INFINITY } else { variance_m2.max(0.0).sqrt() };
        (from_eye_m.norm(), sigma_m)
    }
}

/// One standard deviation along the worst direction (m) of a covariance (m²); infinite where it holds
/// what is no number.
pub fn worst_sigma_m(covariance_m2: &Matrix3<f64>) -> f64 {
    let largest = decompose::symmetric_eigenvalues(*covariance_m2).map(|variances| variances.max());
    largest.filter(|variance| variance.is_finite()).map_or(f64::INFINITY, |m2| m2.max(0.0).sqrt())
}

impl RobotModel {
    /// Place of the left eye, with the effects of the neck's joints and of the mount that hold
    /// whenever and whatever it looks at.
    pub fn robot_from_left(&self, posture: &Posture) -> Pose<Robot, LeftCamera> {
        if self.of_eyes.present.is_empty() {
            return self.rig.robot_from_left(posture);
        }
        let row = self.row(posture, &SeenUnder::default());
        let nominal = self.eyes.robot_from_left(&row.neck_rad, &EyesDeviation::none(self.eyes.neck.len()));
        // Neck and mount deviate the same way whatever is looked at: something on the axis will do.
        let situation = self.eyes.situation(&row, nominal * Point3::new(0.0, 0.0, 0.5));
        let mut deviation = EyesDeviation::none(self.eyes.neck.len());
        for present in &self.of_eyes.present {
            present.effect.deviate_eyes(&situation, &present.values, &mut deviation);
        }
        Pose::new(self.eyes.robot_from_left(&row.neck_rad, &deviation))
    }

    /// Angles of the head (pan, tilt; rad) at which the left eye looks at a point, limits not
    /// considered, see [`plumbline_model::robot::Rig::look_at`].
    pub fn look_at(&self, point: Point<Robot>, posture: &Posture) -> (f64, f64) {
        self.rig.look_at_by(point, posture, |posture| self.robot_from_left(posture))
    }

    /// Where something is that stereo with the calibrated eyes puts at `in_left` (left camera, m;
    /// covariance in its axes, m²): the effects of head and eyes are undone. `None`: there is no such
    /// place.
    pub fn place(
        &self,
        in_left: &Point<LeftCamera>,
        covariance_m2: &Matrix3<f64>,
        posture: &Posture,
        seen: &SeenUnder,
    ) -> Option<PlaceInRobot> {
        let robot_from_left = self.rig.robot_from_left(posture);
        let seen_at = in_left.coords.coords;
        let (mounted, lenses) = (self.mounted.or(self.prior.mounted), self.prior.lenses);
        let by_mount_m2 = mounted.map(|mounted| mounted.covariance_m2(&self.rig, posture, &seen_at));
        // A mount as it usually is holds the zeros of the neck.
        let is_usual = self.mounted.is_none() && self.prior.mounted.is_some();
        let by_neck_m2 = self
            .prior
            .neck
            .filter(|_| !is_usual)
            .map(|neck| neck.covariance_m2(&self.rig, posture, &seen_at));
        let by_lenses_m2 = lenses.map(|lenses| lenses.covariance_m2(&self.rig.eyes.cameras, &seen_at));
        let [by_mount_m2, by_lenses_m2] = [by_mount_m2, by_lenses_m2].map(Option::unwrap_or_default);
        let turned = self.turned_since(seen).covariances_m2(&self.rig.eyes.cameras, &seen_at);
        let turn = robot_from_left.rotation();
        let by_lenses_m2 = by_lenses_m2 + turned[0];
        let by_mount_m2 = by_mount_m2 + by_neck_m2.unwrap_or_default() + turn * turned[1] * turn.transpose();
        if self.of_eyes.present.is_empty() {
            let covariance_m2 = turn * (covariance_m2 + by_lenses_m2) * turn.transpose() + by_mount_m2;
            return Some(PlaceInRobot { point: robot_from_left * *in_left, covariance_m2, by_mount_m2 });
        }
        let row = self.row(posture, seen);
        let present = &self.of_eyes.present;
        let undone = |in_left: &Vector3<f64>, effects: &[Present]| -> Option<Vector3<f64>> {
            let apparent: Point<Robot> = robot_from_left * Point::new(in_left.x, in_left.y, in_left.z);
            let looking = Looking { eyes: &self.eyes, row: &row, effects };
            Some(looking.place_of(apparent)?.coords.coords)
        };
        let here = undone(&seen_at, present)?;
        let mut slopes = Matrix3::zeros();
        for k in 0..3 {
            let mut at = |step: f64| undone(&(seen_at + Vector3::ith(k, step)), present);
            slopes.set_column(k, &slope(&mut at, &here, STEP_M)?);
        }
        // What the effects leave is not known of what is seen.
        let left_m2 = self
            .added
            .contents
            .eyes_left
            .map_or_else(Matrix3::zeros, |left| left.covariance_m2(&seen_at, &self.eyes.cameras));
        let by_sight = slopes * (covariance_m2 + by_lenses_m2 + left_m2) * slopes.transpose();
        let by_values = of_values(&self.of_eyes, |effects| undone(&seen_at, effects))?;
        let covariance_m2 = by_sight + by_values + by_mount_m2;
        Some(PlaceInRobot { point: Point::new(here.x, here.y, here.z), covariance_m2, by_mount_m2 })
    }

    /// Where both eyes see a point of the robot frame, with the effects, raw px: left, right. `None`:
    /// one of them does not see it.
    pub fn project(
        &self,
        point: &Point<Robot>,
        posture: &Posture,
        seen: &SeenUnder,
    ) -> Option<(Pixel<Raw>, Pixel<Raw>)> {
        if self.of_eyes.present.is_empty() {
            let in_left = self.rig.robot_from_left(posture).inverse() * *point;
            let cameras = &self.rig.eyes.cameras;
            let in_right = cameras.right_from_left * in_left;
            let left = cameras.left.project(&in_left.coords.coords).ok()?;
            return Some((left, cameras.right.project(&in_right.coords.coords).ok()?));
        }
        let row = self.row(posture, seen);
        let present = &self.of_eyes.present;
        Looking { eyes: &self.eyes, row: &row, effects: present }.pixels(*point)
    }

    fn row(&self, posture: &Posture, seen: &SeenUnder) -> Observation {
        Observation {
            neck_rad: self
                .eyes
                .neck
                .parts
                .iter()
                .map(|part| part.index.map_or(0.0, |index| posture[index]))
                .collect(),
            t_secs: seen.t_secs,
            background_m: seen.background_m,
            ..Observation::imagined(What::Place)
        }
    }
}

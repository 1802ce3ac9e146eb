//! A robot whose true mount is known, looking at things.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_model::frame::{Board, Head, LeftCamera};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Chessboard, Corners, Eye, Pixel, Point, Pose, Robot, Unattended};

use crate::mount::{
    HeadView, MountCalibration, MountError, MountOptions, PlannedTarget, Target, calibrate_mount,
    plan_head_views,
};
use crate::synthetic::Noise;

pub const TICK_RAD: f64 = std::f64::consts::TAU / 4096.0;

pub fn board() -> Chessboard {
    Chessboard::new(8, 5, 0.03).expect("usable")
}

/// Truth and noise of one world.
pub struct World {
    pub rig: Rig,
    pub head_from_left: Isometry3<f64>,
    pub robot_from_board: Isometry3<f64>,
    /// Standard deviation of one coordinate of a pixel.
    pub pixel_px: f64,
    /// Encoders round to this; 0: exact.
    pub tick_rad: f64,
    /// Further angle error, standard deviation.
    pub slack_rad: f64,
    /// True angle minus encoder, pan and tilt.
    pub zeros_rad: [f64; 2],
    pub noise: Noise,
}

impl World {
    /// A mount off by some degrees and 10 to 20 mm, a board on the table about 0.4 m away.
    pub fn new(seed: u64) -> Self {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let mut noise = Noise::new(0xbeef ^ (seed << 8));
        let mut vector = |low: f64, high: f64| {
            let direction = Vector3::new(noise.normal(), noise.normal(), noise.normal()).normalize();
            direction * noise.between(low, high)
        };
        let (turn, shift) = (vector(0.02, 0.09), vector(0.010, 0.020));
        let nominal = rig.eyes.head_from_left.isometry;
        let rotation = UnitQuaternion::from_scaled_axis(turn) * nominal.rotation;
        let head_from_left = Isometry3::from_parts((nominal.translation.vector + shift).into(), rotation);
        let robot_from_board = on_table(0.4, noise.between(-0.05, 0.05), noise.between(-0.4, 0.4));
        Self {
            rig,
            head_from_left,
            robot_from_board,
            pixel_px: noise.between(0.1, 0.2),
            tick_rad: TICK_RAD,
            slack_rad: 0.0,
            zeros_rad: [0.0; 2],
            noise,
        }
    }

    pub fn perfect(seed: u64) -> Self {
        Self { pixel_px: 0.0, tick_rad: 0.0, ..Self::new(seed) }
    }

    pub fn planned(&self, n: usize) -> Vec<(f64, f64)> {
        let what = PlannedTarget::board(&board(), &Pose::<Robot, Board>::new(self.robot_from_board));
        plan_head_views(&self.rig, &self.rig.eyes.cameras, &self.rig.home(), &what, n).expect("in view")
    }

    /// What the encoders say when the head stands near (pan, tilt), and the true posture.
    pub fn stand(&mut self, pan_rad: f64, tilt_rad: f64) -> (Posture, Posture) {
        let joints = [self.rig.eyes.pan, self.rig.eyes.tilt];
        let mut truth = self.rig.home();
        let mut encoder = truth.clone();
        for ((joint, angle_rad), zero) in joints.into_iter().zip([pan_rad, tilt_rad]).zip(self.zeros_rad) {
            // A real head stops somewhere between two ticks.
            let stands = angle_rad + 0.01 * (self.noise.uniform() - 0.5);
            truth[joint] = stands + zero;
            let read = stands + self.slack_rad * self.noise.normal();
            encoder[joint] =
                if self.tick_rad > 0.0 { (read / self.tick_rad).round() * self.tick_rad } else { read };
        }
        (encoder, truth)
    }

    /// Pixels of points of the robot frame for the true posture.
    pub fn pixels(&mut self, truth: &Posture, points: &[Point<Robot>], eye: Eye) -> Corners {
        let head = self.rig.description.forward(truth).of(self.rig.eyes.link).isometry;
        let left_from_robot = (head * self.head_from_left).inverse();
        let cameras = self.rig.eyes.cameras;
        points
            .iter()
            .map(|point| {
                let in_left = left_from_robot * point.coords;
                let in_eye = match eye {
                    Eye::Left => in_left,
                    Eye::Right => cameras.right_from_left.isometry * in_left,
                };
                let pixel = cameras.camera(eye).project(&in_eye.coords).ok()?;
                let (du, dv) = (self.noise.normal() * self.pixel_px, self.noise.normal() * self.pixel_px);
                Some(Pixel::new(pixel.u_px + du, pixel.v_px + dv))
            })
            .collect()
    }

    pub fn view(&mut self, name: &str, pan_tilt: (f64, f64), points: &[Point<Robot>]) -> HeadView {
        let (encoder, truth) = self.stand(pan_tilt.0, pan_tilt.1);
        let [left, right] = Eye::BOTH.map(|eye| Some(self.pixels(&truth, points, eye)));
        HeadView { name: name.to_owned(), posture: encoder, left, right }
    }

    pub fn corners(&self) -> Vec<Point<Robot>> {
        let place = Pose::<Robot, Board>::new(self.robot_from_board);
        board().corners().into_iter().map(|corner| place * corner).collect()
    }

    /// Views of the board from planned head poses.
    pub fn board_views(&mut self, n: usize) -> Vec<HeadView> {
        let corners = self.corners();
        let poses = self.planned(n);
        poses.iter().enumerate().map(|(i, pose)| self.view(&format!("view {i}"), *pose, &corners)).collect()
    }

    pub fn solve_with(
        &self,
        views: &[HeadView],
        target: &Target,
        options: &MountOptions,
    ) -> Result<MountCalibration, MountError> {
        calibrate_mount(&self.rig, &self.rig.eyes.cameras, views, target, options, &Unattended)
    }

    pub fn solve(&self, views: &[HeadView]) -> Result<MountCalibration, MountError> {
        self.solve_with(views, &Target::UnknownBoard(board()), &MountOptions::default())
    }

    pub fn mount(&self) -> Pose<Head, LeftCamera> {
        Pose::new(self.head_from_left)
    }
}

/// A board flat on the table, its middle at x ahead and y to the left, turned by yaw.
pub fn on_table(x_m: f64, y_m: f64, yaw_rad: f64) -> Isometry3<f64> {
    let height_m = 0.054;
    // Its z points down into the table; its x to the robot's right.
    let facing = UnitQuaternion::from_scaled_axis(Vector3::z() * (yaw_rad - std::f64::consts::FRAC_PI_2))
        * UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
    let middle = Vector3::new(0.105, 0.06, 0.0);
    let place = Vector3::new(x_m, y_m, height_m) - facing * middle;
    Isometry3::from_parts(place.into(), facing)
}

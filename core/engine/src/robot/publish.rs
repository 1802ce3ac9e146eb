//! What the window shows of the robot.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::rig_model::Conditions;
use plumbline_effects::robot_model::worst_sigma_m;
use plumbline_hardware::joints::{HoldReason, JointReading, JointState, Motion};
use plumbline_model::robot::{JointIndex, Posture, Servo};

use super::view::{BusView, JointView, MotionState, RobotView, TipPlace};
use super::worker::{News, Worker};
use crate::ground::text::sentence;
use crate::twin::view::TwinView;

impl Worker {
    /// What is new since the last call, if anything. What the operator did or has to know comes at
    /// once; readings that merely flicker come a few times a second, for the window is drawn anew
    /// each time.
    pub fn take_news(&mut self) -> Option<News> {
        let robot = self.robot_view();
        let twin = self.desk.view();
        if let Some(told) = &self.told {
            let same_state = told.robot.is_same_state(&robot)
                && told.twin.is_same_state(&twin)
                && told.twins_started == self.twins_started;
            let moves = matches!(robot.motion, MotionState::Moving { .. });
            let every = if moves || twin.warm_up_pace > 1.0 { MOVING } else { STANDING };
            let soon = self.told_at.is_some_and(|at| at.elapsed() < every);
            if same_state && (soon || (*told.twin == twin && told.robot.has_same_readings(&robot))) {
                return None;
            }
        }
        let news = News { robot: Arc::new(robot), twin: Arc::new(twin), twins_started: self.twins_started };
        self.told = Some(news.clone());
        self.told_at = Some(Instant::now());
        Some(news)
    }

    fn robot_view(&self) -> RobotView {
        let state = self.arm.as_ref().and_then(|arm| arm.state());
        let state = state.as_deref();
        let measured = state.and_then(|state| state.measured.clone());
        RobotView {
            rig: Some(self.rig.clone()),
            connection: self.connection.clone(),
            motion: state.map_or(MotionState::Unknown, |state| self.motion(state)),
            rests_on_the_way: state.is_some_and(|state| self.leading.rests(&state.motion)),
            stopped: self.switches.stop.is_pressed(),
            joints: self.joints(state, measured.as_ref()),
            commanded: state.and_then(|state| state.commanded.clone()),
            tip: self.tip.clone(),
            tip_place: measured
                .as_ref()
                .filter(|_| state.is_some_and(|state| self.chain.joints().iter().all(|j| state.knows(*j))))
                .map(|posture| self.tip_place(posture)),
            model: self.title.clone(),
            unknown: state.map_or_else(Default::default, |state| state.unknown.clone()),
            late: state.map_or_else(Default::default, |state| state.late.clone()),
            measured,
            trail: self.trail.iter().map(|(_, place)| *place).collect(),
            preview: self.preview.as_ref().map(|(_, preview)| preview.clone()),
            refusal: self.refusal.clone(),
            is_unheard: self.is_unheard && self.refusal.is_some(),
            refused: self.refused,
            poses: self.poses.all(&self.rig).into(),
            bus: self.bus(state),
            ports: self.ports.clone(),
            speed: self.speed,
        }
    }

    fn motion(&self, state: &JointState) -> MotionState {
        if let Some(what) = self.touching.title().or_else(|| self.leading.moving_title()) {
            return MotionState::Moving { what, fraction: None, remaining: None };
        }
        match &state.motion {
            Motion::Unknown => MotionState::Unknown,
            Motion::Limp => MotionState::Limp,
            // These are how it should be; anything else is worth a word.
            Motion::Holding(
                HoldReason::Connected | HoldReason::Arrived | HoldReason::JogEnded | HoldReason::Asked,
            ) => MotionState::Holding { why: None },
            Motion::Holding(reason) => MotionState::Holding { why: Some(sentence(&reason.to_string())) },
            Motion::Moving { fraction, remaining, .. } => MotionState::Moving {
                what: self.running.as_ref().map_or_else(String::new, |running| running.title.clone()),
                fraction: Some(*fraction),
                remaining: Some(*remaining),
            },
            Motion::Following => {
                MotionState::Moving { what: "jogging".to_owned(), fraction: None, remaining: None }
            }
        }
    }

    fn joints(&self, state: Option<&JointState>, measured: Option<&Posture>) -> Arc<[JointView]> {
        let row = |(i, servo): (usize, &Servo)| {
            let reading = state.and_then(|s| Some((s.of(servo.joint)?, s.knows(servo.joint))));
            self.joint(i, servo, reading, measured)
        };
        self.rig.servos.iter().enumerate().map(row).collect()
    }

    fn joint(
        &self,
        place: usize,
        servo: &Servo,
        reading: Option<(&JointReading, bool)>,
        measured: Option<&Posture>,
    ) -> JointView {
        let limits = self.rig.limits(servo.joint);
        let is_known = reading.is_some_and(|(_, is_known)| is_known);
        let reading = reading.map(|(reading, _)| reading);
        JointView {
            joint: servo.joint,
            name: servo.joint_name.clone(),
            title: servo.title.clone(),
            servo: servo.id,
            model: servo.model.clone(),
            limits,
            limits_now: measured.map_or(limits, |posture| self.rig.limits_in(servo.joint, posture)),
            angle_rad: reading.and_then(|r| r.angle_rad).filter(|_| is_known),
            goal_rad: reading.and_then(|r| r.goal_rad),
            speed_rad_s: reading.and_then(|r| r.speed_rad_s),
            load: reading.and_then(|r| r.load),
            current_a: reading.and_then(|r| r.current_a),
            temperature_c: reading.and_then(|r| r.temperature_c),
            voltage_v: reading.and_then(|r| r.voltage_v),
            torque_on: reading.and_then(|r| r.torque_on),
            let_go: reading.is_some_and(|r| r.let_go),
            force: reading.and_then(|r| r.force),
            no_force: reading.is_some_and(|r| r.torque_on == Some(true) && r.force == Some(0.0)),
            age: reading.and_then(|r| r.age),
            problem: reading.and_then(|r| r.problem.clone()),
            history: self.histories.of(place),
        }
    }

    fn tip_place(&self, encoders: &Posture) -> TipPlace {
        let place = self.tip_by_encoders(encoders);
        let x_axis = place.isometry.rotation * nalgebra::Vector3::x();
        let sigma_m = self.arm_model.as_ref().map_or(0.0, |arm| {
            worst_sigma_m(&arm.covariance_by_encoders_m2(encoders, &Conditions::default()))
        });
        TipPlace {
            point: plumbline_model::Point::from(nalgebra::Point3::from(place.translation_m())),
            yaw_rad: x_axis.y.atan2(x_axis.x),
            sigma_m,
        }
    }

    fn bus(&self, state: Option<&JointState>) -> BusView {
        let census = self.arm.as_ref().map(|arm| arm.census()).unwrap_or_default();
        let Some(state) = state else { return BusView::default() };
        let counts = &state.bus.counts;
        let servo = |joint: &JointIndex| Some(self.rig.servo_of(*joint)?.id);
        let silent = state.unknown.iter().filter(|joint| !state.late.contains(joint)).filter_map(servo);
        let is_board = |id: &u8| self.rig.boards.iter().any(|board| board.id == *id);
        let boards = census.missing.iter().copied().filter(is_board);
        BusView {
            cycles_per_s: state.bus.complete_per_s,
            cycles: state.bus.complete_cycles,
            faults: super::connect::faults(counts),
            retries: super::connect::retries(counts),
            missing: silent.chain(boards).collect(),
            late: state.late.iter().filter_map(servo).collect(),
            slow_answers: state.slow_answers,
            unexpected: census.unexpected,
            warnings: census.warnings.into_iter().chain(state.warnings.iter().cloned()).collect(),
        }
    }
}

/// Readings are shown this often while something moves or a clock runs fast, and while nothing does.
const MOVING: Duration = Duration::from_millis(66);
const STANDING: Duration = Duration::from_millis(500);
/// Smaller changes than these are not worth drawing the window again.
const ANGLE_RAD: f64 = 2e-4;
const RATE: f64 = 1.0;

impl RobotView {
    /// Whether what is connected, what it does and what is shown is the same.
    fn is_same_state(&self, other: &Self) -> bool {
        self.connection == other.connection
            && self.motion.is_same_kind(&other.motion)
            && self.rests_on_the_way == other.rests_on_the_way
            && self.stopped == other.stopped
            && self.preview == other.preview
            && self.refusal == other.refusal
            && self.refused == other.refused
            && self.poses == other.poses
            && self.ports == other.ports
            && self.tip == other.tip
            && self.model == other.model
            && (self.speed - other.speed).abs() < f64::EPSILON
            && self.measured.is_some() == other.measured.is_some()
            && self.unknown == other.unknown
            && self.late == other.late
            && self.joints.len() == other.joints.len()
            && self.joints.iter().zip(other.joints.iter()).all(|(a, b)| {
                a.torque_on == b.torque_on
                    && a.let_go == b.let_go
                    && a.problem.is_some() == b.problem.is_some()
            })
    }

    /// Whether no number that can be read has changed; ages and cycle counts do not count.
    fn has_same_readings(&self, other: &Self) -> bool {
        let close = |a: Option<f64>, b: Option<f64>, by: f64| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < by,
            (None, None) => true,
            _ => false,
        };
        let same_joint = |a: &JointView, b: &JointView| {
            close(a.angle_rad, b.angle_rad, ANGLE_RAD)
                && close(a.goal_rad, b.goal_rad, ANGLE_RAD)
                && close(a.load, b.load, 0.02)
                && close(a.temperature_c, b.temperature_c, 0.5)
                && a.problem == b.problem
                && Arc::ptr_eq(&a.history, &b.history)
                && stale(a.age) == stale(b.age)
        };
        self.motion == other.motion
            && self.trail.len() == other.trail.len()
            && close(self.bus.cycles_per_s, other.bus.cycles_per_s, RATE)
            && self.bus.faults == other.bus.faults
            && self.bus.warnings == other.bus.warnings
            && self.bus.missing == other.bus.missing
            && self.joints.iter().zip(other.joints.iter()).all(|(a, b)| same_joint(a, b))
    }
}

impl MotionState {
    /// Whether it differs by how far a move is at most.
    fn is_same_kind(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Moving { what: a, .. }, Self::Moving { what: b, .. }) => a == b,
            (a, b) => a == b,
        }
    }
}

impl TwinView {
    /// Whether only clocks have moved on, or toys.
    fn is_same_state(&self, other: &Self) -> bool {
        self.running == other.running
            && self.failed == other.failed
            && self.scenario == other.scenario
            && self.board == other.board
            && self.board_tour == other.board_tour
            && self.board_places_left == other.board_places_left
            && self.made_room == other.made_room
            && (self.warm_up_pace - other.warm_up_pace).abs() < f64::EPSILON
            && self.faults == other.faults
            && self.toys.len() == other.toys.len()
            && self.toys.iter().zip(&other.toys).all(|(a, b)| a.place.is_some() == b.place.is_some())
    }
}

/// Whether an angle is so old that the window has to say so.
fn stale(age: Option<Duration>) -> bool {
    age.is_some_and(|age| age > Duration::from_secs(1))
}

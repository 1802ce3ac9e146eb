//! The twin without a clock: time passes only while somebody moves or waits, so that the same rig,
//! scenario, seed and orders give the same course on every machine, however busy.
//!
//! What moves, moves as the servo bus would have it: along a line of minimal jerk in joint space, goals
//! in whole ticks, one per cycle, angles read in whole ticks. What the scenario hides stays hidden.

use std::sync::Arc;

use plumbline_hardware::dynamixel::ControlTable;
use plumbline_model::robot::{JointIndex, Posture, Rig};
use plumbline_model::{Board, Pose, Robot};

use crate::board_presets::default_board;
use crate::course::{Course, CoursePoint};
use crate::error::TwinError;
use crate::eyes::{EyeOptions, EyeRenderer, RenderError, RenderedPair, Sensor};
use crate::physics::{Contact, Reading, World};
use crate::scenario::Scenario;
use crate::scene::Scenery;
use crate::scenery::scenery;
use crate::toys::Toy;
use crate::truth::Truth;

/// Physics between two goals of a servo: 20 ms, as the bus of this robot manages.
const CYCLE_STEPS: usize = 10;
/// Peak speed over mean speed of a line of minimal jerk.
const PEAK_OVER_MEAN: f64 = 1.875;
/// After the last goal the joints get this long to come to rest, s.
const SETTLE_S: f64 = 0.5;
/// They are looked at no sooner than this, s.
const LEAST_SETTLE_S: f64 = 0.1;
/// A joint slower than this is at rest, rad/s.
const AT_REST_RAD_S: f64 = 0.02;
/// Seeds of the noise of pairs and of the world are kept apart.
const NOISE_SEED: u64 = 0x6579_6573;

/// A joint as its servo has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoState {
    /// Which.
    pub joint: JointIndex,
    /// By the encoder, rad of the joint, in whole ticks.
    pub angle_rad: f64,
    /// Share of the full torque in the joint's sense, −1 to 1.
    pub load: f64,
    /// °C.
    pub temperature_c: f64,
}

/// A finger on the glass, and the arm at that moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Touched {
    /// The contact.
    pub contact: Contact,
    /// What was commanded.
    pub commanded: Posture,
    /// What the encoders said.
    pub encoders: Posture,
}

/// A twin that waits for nobody and for whom nobody waits.
pub struct Lockstep {
    world: World,
    commanded: Posture,
    eyes: Option<EyeRenderer>,
    sensor: Sensor,
    scenery: Scenery,
    /// What of the movable things is out; the scenery changes with it.
    out: Vec<bool>,
    seed: u64,
    pairs: u64,
    course: Option<Course>,
}

impl Lockstep {
    /// The robot in its first pose, the toys on the table, the eyes cold.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn new(rig: Arc<Rig>, scenario: &Scenario, seed: u64) -> Result<Self, TwinError> {
        let commanded = rig.home();
        let world = World::new(rig, scenario, seed)?;
        let scenery = scenery(&world, default_board(), 0);
        let out = visible(&world);
        let sensor = Sensor::default();
        Ok(Self { world, commanded, eyes: None, sensor, scenery, out, seed, pairs: 0, course: None })
    }

    /// The robot as described.
    pub fn rig(&self) -> &Arc<Rig> {
        self.world.rig()
    }

    /// Simulated time, s.
    pub fn now_s(&self) -> f64 {
        self.world.time_s()
    }

    /// What was commanded last.
    pub fn commanded(&self) -> &Posture {
        &self.commanded
    }

    /// All joint angles by the encoders, in whole ticks.
    pub fn encoders(&self) -> Posture {
        self.in_ticks(&self.world.encoders())
    }

    /// All servos, in the order of the rig.
    pub fn servos(&self) -> Vec<ServoState> {
        let encoders = self.encoders();
        let state = |(i, joint): (usize, JointIndex)| {
            let Reading { load, temperature_c, .. } = self.world.reading(i);
            ServoState { joint, angle_rad: encoders[joint], load, temperature_c }
        };
        self.rig().servos.iter().map(|servo| servo.joint).enumerate().map(state).collect()
    }

    /// Moves through postures one after another with this peak speed (rad/s), each in a straight line in
    /// joint space, until the joints have come to rest at the last one.
    pub fn follow(&mut self, way: &[Posture], speed_rad_s: f64) {
        for end in way {
            self.line(end, speed_rad_s, |_| false);
        }
        self.settle();
    }

    /// Moves through postures until a finger meets the glass. It stops there.
    pub fn follow_until_touched(&mut self, way: &[Posture], speed_rad_s: f64) -> Option<Touched> {
        self.world.take_touches();
        let mut touched = None;
        for end in way {
            self.line(end, speed_rad_s, |lockstep| {
                touched = lockstep.world.take_touches().first().map(|contact| Touched {
                    contact: *contact,
                    commanded: lockstep.commanded.clone(),
                    encoders: lockstep.encoders(),
                });
                touched.is_some()
            });
            if touched.is_some() {
                break;
            }
        }
        touched
    }

    /// The servo of a joint may use no more than this share of its torque from now on, 0–1.
    pub fn limit(&mut self, joint: JointIndex, torque: f64) {
        if let Some(servo) = self.rig().servos.iter().position(|servo| servo.joint == joint) {
            self.world.limit(servo, torque);
        }
    }

    /// Time passes while everything holds.
    pub fn wait(&mut self, duration_s: f64) {
        for _ in 0..(duration_s / World::STEP_S).round() as usize {
            self.step();
        }
    }

    /// From now on keeps what the joints do, a point this often (s), beginning with this moment.
    pub fn keep_course(&mut self, every_s: f64) {
        self.course = Some(Course::new(every_s, self.course_point()));
    }

    /// What the joints did since this was asked last, oldest first; nothing while nobody keeps it.
    pub fn take_course(&mut self) -> Vec<CoursePoint> {
        self.course.as_mut().map(Course::take).unwrap_or_default()
    }

    /// Keeps it no longer; what was not taken is gone.
    pub fn end_course(&mut self) {
        self.course = None;
    }

    /// What both eyes see now.
    ///
    /// # Errors
    /// When nothing can be drawn on this machine.
    pub fn look(&mut self) -> Result<RenderedPair, RenderError> {
        let eyes = match &mut self.eyes {
            Some(eyes) => eyes,
            none => none.insert(EyeRenderer::new(EyeOptions::default())?),
        };
        let out = visible(&self.world);
        if out != self.out {
            self.scenery = scenery(&self.world, default_board(), self.scenery.revision + 1);
            self.out = out;
        }
        self.pairs += 1;
        let noise = (self.seed ^ NOISE_SEED).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(self.pairs);
        eyes.render(&self.scenery, &self.world.snapshot(), &self.sensor, noise)
    }

    /// Puts a toy on the table.
    ///
    /// # Errors
    /// When the place is not on the table.
    pub fn place_toy(&mut self, toy: Toy, x_m: f64, y_m: f64) -> Result<(), TwinError> {
        self.world.place_toy(toy, x_m, y_m)
    }

    /// Puts a toy away.
    pub fn remove_toy(&mut self, toy: Toy) {
        self.world.remove_toy(toy);
    }

    /// Holds the chessboard somewhere, or puts it away.
    pub fn hold_board(&mut self, robot_from_board: Option<Pose<Robot, Board>>) {
        self.world.hold_board(robot_from_board);
    }

    /// Lets the clock of the eyes' warming up run ahead.
    pub fn advance_warm_up(&mut self, duration_s: f64) {
        self.world.advance_warm_up(duration_s);
    }

    /// For how long the eyes have been on, s.
    pub fn eyes_on_s(&self) -> f64 {
        self.world.eyes_on_s()
    }

    /// Switches the eyes off until they are cold, and on again.
    pub fn cool_eyes(&mut self) {
        self.world.cool_eyes();
    }

    /// The renderer, so that another twin of this machine need not open the device again.
    pub fn take_eyes(&mut self) -> Option<EyeRenderer> {
        self.eyes.take()
    }

    /// Draws with a renderer that is open already.
    pub fn with_eyes(mut self, eyes: Option<EyeRenderer>) -> Self {
        self.eyes = eyes;
        self
    }

    /// What is really so. For judges and tests only.
    pub fn truth_for_judging(&mut self) -> Truth {
        self.world.truth_for_judging()
    }

    /// A straight line from what was commanded last; `stop` is asked after every cycle.
    fn line(&mut self, end: &Posture, speed_rad_s: f64, mut stop: impl FnMut(&mut Self) -> bool) {
        let start = self.commanded.clone();
        let duration_s = PEAK_OVER_MEAN * start.distance_rad(end) / speed_rad_s.max(1e-3);
        let cycle_s = CYCLE_STEPS as f64 * World::STEP_S;
        let cycles = (duration_s / cycle_s).ceil().max(1.0) as usize;
        for cycle in 1..=cycles {
            let t = cycle as f64 / cycles as f64;
            self.command(start.toward(end, t * t * t * (10.0 + t * (6.0 * t - 15.0))));
            for _ in 0..CYCLE_STEPS {
                self.step();
            }
            if stop(self) {
                break;
            }
        }
    }

    /// Physics goes on. To look at it changes nothing.
    fn step(&mut self) {
        self.world.step();
        if self.course.as_mut().is_some_and(Course::is_due) {
            let point = self.course_point();
            self.course.iter_mut().for_each(|course| course.add(point.clone()));
        }
    }

    fn course_point(&self) -> CoursePoint {
        CoursePoint { at_s: self.now_s(), commanded: self.commanded.clone(), encoders: self.encoders() }
    }

    fn command(&mut self, posture: Posture) {
        let goals = self.in_ticks(&posture);
        self.world.send(&goals, None);
        self.commanded = posture;
    }

    fn settle(&mut self) {
        self.wait(LEAST_SETTLE_S);
        let until_s = self.now_s() + SETTLE_S - LEAST_SETTLE_S;
        while self.now_s() < until_s && self.is_moving() {
            self.wait(World::STEP_S * CYCLE_STEPS as f64);
        }
    }

    fn is_moving(&self) -> bool {
        (0..self.rig().servos.len()).any(|i| self.world.reading(i).speed_rad_s.abs() > AT_REST_RAD_S)
    }

    /// As the registers can say it.
    fn in_ticks(&self, posture: &Posture) -> Posture {
        let mut rounded = posture.clone();
        for servo in &self.rig().servos {
            let table = ControlTable::of_model(&servo.model);
            let ticks = table.and_then(|table| table.ticks(servo.motor_rad(posture[servo.joint])));
            if let Some(motor_rad) = table.zip(ticks).and_then(|(table, ticks)| table.motor_rad(ticks)) {
                rounded[servo.joint] = servo.joint_rad(motor_rad);
            }
        }
        rounded
    }
}

fn visible(world: &World) -> Vec<bool> {
    let toys = Toy::ALL.into_iter().map(|toy| world.toy(toy).is_some());
    toys.chain([world.board().is_some()]).collect()
}

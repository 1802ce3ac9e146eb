//! The world: built once, stepped, read.

mod look;
mod names;
mod things;

use std::sync::Arc;

use mujoco_rs::prelude::*;
use plumbline_model::frame::{Head, LeftCamera, RightCamera};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Board, Pose, Robot};

use self::names::{check_names, find, find_rub, find_toy, watch};
use super::mjcf;
use super::motor::Motor;
use super::place::Places;
use super::servo::{Drive, Reading, ServoMotor};
use super::touch::{Contact, TouchWatch};
use crate::error::TwinError;
use crate::scenario::{Holding, Scenario};
use crate::toys::Toy;
use crate::warm_up::WarmUp;

/// Temperatures change slowly: every so many steps is enough.
const HEAT_EVERY: u64 = 50;

/// The simulated world. Same rig, scenario, seed and commands: same course, step by step.
pub struct World {
    rig: Arc<Rig>,
    places: Places,
    /// The same with the touchscreen on the table.
    level: Places,
    data: MjData<Box<MjModel>>,
    /// A second copy of the model: friction changes with every step, and a model can only be
    /// changed while it is not in use.
    spare: Option<Box<MjModel>>,
    holding: Holding,
    servos: Vec<ServoMotor>,
    /// Where the friction of each servo goes.
    rubs: Vec<Rub>,
    toys: Vec<ToyState>,
    /// Size of toys, times that of the usual ones.
    toy_size: f64,
    board: Option<Pose<Robot, Board>>,
    eyes: EyePlaces,
    warm_up: WarmUp,
    /// Seconds that the eyes warm up in a simulated second.
    warm_up_pace: f64,
    eyes_body: usize,
    board_body: usize,
    screen_body: usize,
    touch: TouchWatch,
    /// Height of the block under the touchscreen.
    raised_m: f64,
    /// Weight in the right hand.
    load_kg: f64,
    seed: u64,
    steps: u64,
}

#[derive(Clone, Copy, Debug)]
enum Rub {
    /// A degree of freedom.
    Dof(usize),
    /// A tendon.
    Tendon(usize),
}

#[derive(Clone, Copy, Debug)]
struct ToyState {
    out: bool,
    /// First of its seven coordinates, first of its six speeds.
    qpos: usize,
    dof: usize,
}

/// True places of the eyes in the head while they are cold.
#[derive(Clone, Copy, Debug)]
struct EyePlaces {
    head_from_left: Pose<Head, LeftCamera>,
    left_from_right: Pose<LeftCamera, RightCamera>,
}

impl World {
    /// Builds the world: the robot in its first pose, the toys on the table, the eyes cold.
    ///
    /// # Errors
    /// When the scenario speaks of parts that the robot does not have, when nothing is known
    /// about a servo's motor, or when MuJoCo does not accept the result.
    pub fn new(rig: Arc<Rig>, scenario: &Scenario, seed: u64) -> Result<Self, TwinError> {
        check_names(&rig, scenario)?;
        let places = Places::of(&rig, scenario);
        let xml = mjcf::write(&rig, scenario, &places)?;
        let model = MjModel::from_xml_string(&xml)
            .map_err(|error| TwinError::Physics { reason: error.to_string() })?;
        let model = Box::new(model);
        let spare = Some(model.clone());
        let data = MjData::new(model);
        let holding = scenario.servo.holding;
        let home = rig.home();
        let servos = rig
            .servos
            .iter()
            .map(|s| Ok(ServoMotor::at(Motor::of(&s.model)?, s.ratio, holding, home[s.joint])))
            .collect::<Result<Vec<_>, TwinError>>()?;
        let rubs = rig
            .servos
            .iter()
            .map(|servo| find_rub(data.model(), &rig, servo.joint))
            .collect::<Result<_, _>>()?;
        let toys = Toy::ALL.into_iter().map(|toy| find_toy(data.model(), toy)).collect::<Result<_, _>>()?;
        let eyes_link = &rig.description.links()[rig.eyes.link.0].name;
        let touch = watch(data.model(), &rig, scenario.contact.touch_threshold_n)?;
        let mut world = Self {
            eyes_body: find(data.model(), MjtObjBase::mjOBJ_BODY, eyes_link)?,
            board_body: find(data.model(), MjtObjBase::mjOBJ_BODY, "board")?,
            screen_body: find(data.model(), MjtObjBase::mjOBJ_BODY, "screen")?,
            eyes: EyePlaces::of(&rig, scenario),
            warm_up: WarmUp::cold(scenario.eyes.heat),
            warm_up_pace: 1.0,
            toy_size: scenario.contact.toy_size,
            rig,
            places,
            level: places,
            data,
            spare,
            holding,
            servos,
            rubs,
            toys,
            board: None,
            touch,
            raised_m: 0.0,
            load_kg: 0.0,
            seed,
            steps: 0,
        };
        world.reset();
        Ok(world)
    }

    /// Everything as at the start.
    pub fn reset(&mut self) {
        self.data.reset();
        self.places = self.level;
        (self.raised_m, self.load_kg) = (0.0, 0.0);
        self.steps = 0;
        self.warm_up.reset();
        self.warm_up_pace = 1.0;
        self.servos.iter_mut().for_each(ServoMotor::cool);
        self.touch.forget();
        self.board = None;
        self.stand(&self.rig.home());
        for toy in Toy::ALL {
            let [x_m, y_m] = toy.first_place_m();
            // These places are on every table that a scenario may have.
            let _ = self.place_toy(toy, x_m, y_m);
        }
        self.data.forward();
    }

    /// Puts the robot into a posture, at rest, holding it. For tests and the start: it jumps.
    pub fn stand(&mut self, posture: &Posture) {
        let rig = self.rig.clone();
        for (servo, motor) in rig.servos.iter().zip(&mut self.servos) {
            motor.put(posture[servo.joint]);
        }
        for joint in rig.description.joints() {
            let angle_rad = match &joint.kind {
                plumbline_model::robot::JointKind::Fixed => continue,
                plumbline_model::robot::JointKind::Revolute { index, .. } => posture[*index],
                plumbline_model::robot::JointKind::Coupled { mimic, .. } => {
                    mimic.ratio * posture[mimic.source] + mimic.offset_rad
                }
            };
            if let Some(info) = self.data.joint(&joint.name) {
                info.view_mut(&mut self.data).qpos[0] = angle_rad;
            }
        }
        self.data.qvel_mut().fill(0.0);
        self.data.forward();
    }

    /// One step of [`World::STEP_S`].
    pub fn step(&mut self) {
        self.drive_motors();
        self.pin_shelf();
        self.data.step();
        self.steps += 1;
        self.touch.look(&self.data, &self.places);
        if self.steps.is_multiple_of(HEAT_EVERY) {
            let dt_s = HEAT_EVERY as f64 * Self::STEP_S;
            self.warm_up.pass(dt_s * self.warm_up_pace);
            self.servos.iter_mut().for_each(|servo| servo.warm(dt_s));
        }
    }

    /// Length of a step, s.
    pub const STEP_S: f64 = mjcf::STEP_S;

    /// Steps until `duration_s` has passed.
    pub fn run(&mut self, duration_s: f64) {
        for _ in 0..(duration_s / Self::STEP_S).round() as usize {
            self.step();
        }
    }

    fn drive_motors(&mut self) {
        let mut friction = vec![0.0; self.servos.len()];
        for (i, servo) in self.servos.iter_mut().enumerate() {
            let torque_nm = servo.control(Self::STEP_S, self.data.actuator_length()[i]);
            self.data.ctrl_mut()[i] = torque_nm;
            let speed_rad_s = self.data.actuator_velocity()[i];
            let outside_nm = match self.rubs[i] {
                Rub::Dof(dof) => -self.data.qfrc_bias()[dof],
                Rub::Tendon(_) => 0.0,
            };
            friction[i] = servo.friction_nm(speed_rad_s, outside_nm);
        }
        if self.holding == Holding::Exact {
            return;
        }
        let Some(mut model) = self.spare.take() else { return };
        for (rub, friction_nm) in self.rubs.iter().zip(&friction) {
            match *rub {
                Rub::Dof(dof) => model.dof_frictionloss_mut()[dof] = *friction_nm,
                Rub::Tendon(tendon) => model.tendon_frictionloss_mut()[tendon] = *friction_nm,
            }
        }
        self.spare = Some(self.data.swap_model(model));
    }

    /// Tells a servo (by its place in the rig) what to do.
    pub fn drive(&mut self, servo: usize, drive: Drive) {
        self.servos[servo].drive = drive;
    }

    /// Sends all joints to a posture at a speed (rad/s; `None`: as fast as they can).
    pub fn send(&mut self, posture: &Posture, speed_rad_s: Option<f64>) {
        let rig = self.rig.clone();
        for (servo, motor) in rig.servos.iter().zip(&mut self.servos) {
            let goal_rad = posture[servo.joint];
            motor.drive = Drive { torque_on: true, goal_rad, speed_rad_s, gain: 1.0, ..motor.drive };
        }
    }

    /// Largest share of its torque that a servo may use from now on, 0–1.
    pub fn limit(&mut self, servo: usize, torque_limit: f64) {
        self.servos[servo].drive.torque_limit = torque_limit;
    }

    /// What a servo reads.
    pub fn reading(&self, servo: usize) -> Reading {
        self.servos[servo].reading(self.data.actuator_length()[servo], self.data.actuator_velocity()[servo])
    }

    /// All joint angles as the encoders have them.
    pub fn encoders(&self) -> Posture {
        let mut posture = self.rig.home();
        for (i, servo) in self.rig.servos.iter().enumerate() {
            posture[servo.joint] = self.data.actuator_length()[i];
        }
        posture
    }

    /// Heats a servo's motor from now on, K/s; zero ends it.
    pub fn heat_servo(&mut self, servo: usize, extra_k_per_s: f64) {
        self.servos[servo].heat.extra_k_per_s = extra_k_per_s;
    }

    /// Touches since they were last taken.
    pub fn take_touches(&mut self) -> Vec<Contact> {
        self.touch.take()
    }

    /// Whether a finger is on the glass.
    pub fn is_touched(&self) -> bool {
        self.touch.is_down(self.data.time())
    }

    /// Simulated time, s.
    pub fn time_s(&self) -> f64 {
        self.data.time()
    }

    /// The robot.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Nothing of what is hidden.
        f.debug_struct("World").field("time_s", &self.time_s()).finish_non_exhaustive()
    }
}

//! The world: built once, stepped, read.

use std::sync::Arc;

use mujoco_rs::mujoco_c::mjtEnableBit;
use mujoco_rs::prelude::*;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use plumbline_model::frame::{Head, LeftCamera, RightCamera};
use plumbline_model::robot::{JointIndex, LinkIndex, Posture, Rig};
use plumbline_model::{Board, Pose, Robot};
use rand::{Rng, SeedableRng, rngs::StdRng};

use super::mjcf;
use super::motor::Motor;
use super::parts;
use super::place::Places;
use super::servo::{Drive, Reading, ServoMotor};
use super::touch::{Contact, TouchWatch};
use crate::error::TwinError;
use crate::scenario::{Holding, Scenario};
use crate::scene::{Snapshot, TrueEyes};
use crate::toys::Toy;
use crate::warm_up::WarmUp;

/// Temperatures change slowly: every so many steps is enough.
const HEAT_EVERY: u64 = 50;
/// The body that is moved by hand: the board.
const BOARD_MOCAP: usize = 0;
/// Blocks under the touchscreen may be this high, m.
const HIGHEST_BLOCK_M: f64 = 0.2;
/// The hand may carry this much, kg.
const HEAVIEST_KG: f64 = 0.5;
/// Where toys are that were put away.
const SHELF_M: [f64; 3] = [-3.0, 0.0, 0.4];

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

    /// Toys that were put away stay where they are.
    fn pin_shelf(&mut self) {
        for (i, toy) in self.toys.iter().enumerate().filter(|(_, toy)| !toy.out) {
            let at = [SHELF_M[0], SHELF_M[1] + 0.3 * i as f64, SHELF_M[2], 1.0, 0.0, 0.0, 0.0];
            self.data.qpos_mut()[toy.qpos..toy.qpos + 7].copy_from_slice(&at);
            self.data.qvel_mut()[toy.dof..toy.dof + 6].fill(0.0);
        }
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

    /// Puts the touchscreen on a block of this height (0: back on the table), straight up.
    ///
    /// # Errors
    /// When the block is too high or not a number.
    pub fn raise_screen(&mut self, by_m: f64) -> Result<(), TwinError> {
        if !(0.0..=HIGHEST_BLOCK_M).contains(&by_m) {
            return Err(TwinError::Value {
                what: "the height of the block under the touchscreen",
                value: format!("{by_m} m"),
                remedy: "give 0 to 0.2 m",
            });
        }
        let before = self.places;
        self.places = self.level;
        self.places.raise_screen(by_m);
        self.raised_m = by_m;
        self.move_screen(&before);
        Ok(())
    }

    /// Puts the touchscreen where it belongs. It is a part of the world and no body that could move, for what
    /// lies on such a one never sleeps, and what never sleeps creeps.
    /// What stands on it goes with it; `before`: where all was.
    fn move_screen(&mut self, before: &Places) {
        let at_m: [f64; 3] = self.places.robot_from_screen.translation.vector.into();
        // Where parts of the world are is computed anew only while nothing may sleep.
        for may_sleep in [false, true] {
            let Some(mut model) = self.spare.take() else { return };
            model.body_pos_mut()[self.screen_body] = at_m;
            let sleep = mjtEnableBit::mjENBL_SLEEP as i32;
            let flags = &mut model.opt_mut().enableflags;
            *flags = if may_sleep { *flags | sleep } else { *flags & !sleep };
            self.spare = Some(self.data.swap_model(model));
            self.data.forward();
        }
        if let Some(model) = &mut self.spare {
            model.opt_mut().enableflags |= mjtEnableBit::mjENBL_SLEEP as i32;
        }
        for toy in Toy::ALL {
            let Some(mut place) = self.toy(toy) else { continue };
            let at_m = place.translation.vector;
            let height_m = |places: &Places| places.surface_m(at_m.x, at_m.y);
            let rise_m = height_m(&self.places) - height_m(before);
            if rise_m != 0.0 {
                place.translation.vector.z += rise_m;
                self.put_toy(toy, place);
            }
        }
    }

    /// Height of the block under the touchscreen, m.
    pub fn screen_raised_m(&self) -> f64 {
        self.raised_m
    }

    /// Hangs a weight into the right palm (0: takes it off). It pulls; it has no inertia.
    ///
    /// # Errors
    /// When it is too heavy or not a number.
    pub fn load_hand(&mut self, mass_kg: f64) -> Result<(), TwinError> {
        if !(0.0..=HEAVIEST_KG).contains(&mass_kg) {
            return Err(TwinError::Value {
                what: "the weight in the hand",
                value: format!("{mass_kg} kg"),
                remedy: "give 0 to 0.5 kg",
            });
        }
        let palm = self.rig.arm("right").and_then(|arm| arm.joints.last().copied());
        let palm = palm.and_then(|joint| {
            let child = self.rig.description.joint(joint).child;
            self.body_of_link(child)
        });
        if let Some(body) = palm {
            self.data.xfrc_applied_mut()[body] = [0.0, 0.0, -9.81 * mass_kg, 0.0, 0.0, 0.0];
            self.load_kg = mass_kg;
        }
        Ok(())
    }

    /// The weight in the right hand, kg.
    pub fn hand_load_kg(&self) -> f64 {
        self.load_kg
    }

    /// Puts a toy on the table (or on what stands there).
    ///
    /// # Errors
    /// When the place is not on the table.
    pub fn place_toy(&mut self, toy: Toy, x_m: f64, y_m: f64) -> Result<(), TwinError> {
        if !self.places.on_table(x_m, y_m) {
            return Err(TwinError::Value {
                what: "the place of a toy",
                value: format!("({x_m:.3}, {y_m:.3}) m"),
                remedy: "choose a place on the table",
            });
        }
        // The glass on the table is thin: a toy is put down from above it anyway.
        let below_m = match self.raised_m {
            0.0 => self.places.table_height_m(x_m, y_m),
            _ => self.places.surface_m(x_m, y_m),
        };
        let z_m = below_m + self.toy_size * toy.rest_height_m() + 0.004;
        let mut random = StdRng::seed_from_u64(self.seed.wrapping_mul(31).wrapping_add(toy as u64));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), random.random_range(-0.6..0.6));
        self.put_toy(toy, Isometry3::from_parts(Translation3::new(x_m, y_m, z_m), turn));
        Ok(())
    }

    /// Size of toys, times that of the usual ones.
    pub(crate) fn toy_size(&self) -> f64 {
        self.toy_size
    }

    /// Puts a toy anywhere, also into the air.
    pub fn put_toy(&mut self, toy: Toy, robot_from_toy: Isometry3<f64>) {
        let state = &mut self.toys[toy as usize];
        state.out = true;
        let (qpos, dof) = (state.qpos, state.dof);
        let (p, q) = (robot_from_toy.translation.vector, robot_from_toy.rotation.quaternion());
        let at = [p.x, p.y, p.z, q.w, q.i, q.j, q.k];
        self.data.qpos_mut()[qpos..qpos + 7].copy_from_slice(&at);
        self.data.qvel_mut()[dof..dof + 6].fill(0.0);
        self.data.forward();
    }

    /// Puts a toy away.
    pub fn remove_toy(&mut self, toy: Toy) {
        self.toys[toy as usize].out = false;
        self.pin_shelf();
        self.data.forward();
    }

    /// Where a toy is; `None` when it was put away.
    pub fn toy(&self, toy: Toy) -> Option<Isometry3<f64>> {
        let state = &self.toys[toy as usize];
        let q = &self.data.qpos()[state.qpos..state.qpos + 7];
        state.out.then(|| isometry([q[0], q[1], q[2]], [q[3], q[4], q[5], q[6]]))
    }

    /// Holds the chessboard somewhere, or puts it away.
    pub fn hold_board(&mut self, robot_from_board: Option<Pose<Robot, Board>>) {
        // What a person lays down lies on what is there.
        let robot_from_board = robot_from_board.map(|mut pose| {
            let lift_m = self.places.lift_m(&pose.isometry, &plumbline_model::default_board());
            pose.isometry.translation.vector.z += lift_m;
            pose
        });
        self.board = robot_from_board;
        let place = robot_from_board.map_or(Isometry3::translation(0.0, 0.0, -2.0), |pose| pose.isometry);
        let q = place.rotation.quaternion();
        self.data.mocap_pos_mut()[BOARD_MOCAP] = place.translation.vector.into();
        self.data.mocap_quat_mut()[BOARD_MOCAP] = [q.w, q.i, q.j, q.k];
        self.data.forward();
    }

    /// Where the chessboard is held.
    pub fn board(&self) -> Option<Pose<Robot, Board>> {
        self.board
    }

    /// Lets the eyes' clock run ahead.
    pub fn advance_warm_up(&mut self, duration_s: f64) {
        self.warm_up.pass(duration_s);
    }

    /// Lets the eyes' clock run so many times faster than everything else; their warming up goes with it.
    pub fn set_warm_up_pace(&mut self, times: f64) {
        self.warm_up_pace = times;
    }

    /// How many times faster than everything else the eyes' clock runs.
    pub fn warm_up_pace(&self) -> f64 {
        self.warm_up_pace
    }

    /// The eyes are cold again.
    pub fn cool_eyes(&mut self) {
        self.warm_up.reset();
    }

    /// Since when the eyes are on, s.
    pub fn eyes_on_s(&self) -> f64 {
        self.warm_up.on_s()
    }

    /// True places of table and touchscreen. For judging only.
    pub(crate) fn places(&self) -> &Places {
        &self.places
    }

    /// True place of a link, or of a mark on one. For judging only.
    pub(crate) fn true_link(&self, link: LinkIndex) -> Option<Isometry3<f64>> {
        let name = &self.rig.description.links()[link.0].name;
        let (position, turn) = if let Some(body) = self.data.body(name) {
            let view = body.view(&self.data);
            let q = view.xquat;
            return Some(isometry([view.xpos[0], view.xpos[1], view.xpos[2]], [q[0], q[1], q[2], q[3]]));
        } else {
            let site = self.data.site(name)?;
            let view = site.view(&self.data);
            let mut turn = [0.0; 9];
            turn.copy_from_slice(&view.xmat[..]);
            ([view.xpos[0], view.xpos[1], view.xpos[2]], turn)
        };
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_row_slice(&turn));
        let turn = UnitQuaternion::from_rotation_matrix(&rotation);
        Some(Isometry3::from_parts(Translation3::from(position), turn))
    }

    /// Brings all places up to date with the joint angles; a step leaves them one step behind.
    pub(crate) fn refresh(&mut self) {
        self.data.forward();
    }

    /// Where everything is now, for drawing.
    pub fn snapshot(&self) -> Snapshot {
        let bodies = self.data.xpos().iter().zip(self.data.xquat());
        Snapshot {
            time_s: self.data.time(),
            robot_from_body: bodies.map(|(p, q)| isometry(*p, *q)).collect(),
            eyes: self.true_eyes(),
        }
    }

    /// The eyes as they are now.
    pub(crate) fn true_eyes(&self) -> TrueEyes {
        let body = self.eyes_body;
        let head = Pose::<Robot, Head>::new(isometry(self.data.xpos()[body], self.data.xquat()[body]));
        let (left_turn, right_turn) = self.warm_up.turns();
        let robot_from_cold_left = head * self.eyes.head_from_left;
        let robot_from_cold_right = robot_from_cold_left * self.eyes.left_from_right;
        let cameras = &self.rig.eyes.cameras;
        TrueEyes {
            robot_from_left: Pose::new(robot_from_cold_left.isometry * left_turn),
            robot_from_right: Pose::new(robot_from_cold_right.isometry * right_turn),
            left: cameras.left,
            right: cameras.right,
        }
    }

    /// Number of the body of a link in a [`Snapshot`]; `None` for mere marks.
    pub(crate) fn body_of_link(&self, link: LinkIndex) -> Option<usize> {
        self.body_named(&self.rig.description.links()[link.0].name)
    }

    /// Number of a body in a [`Snapshot`].
    pub(crate) fn body_named(&self, name: &str) -> Option<usize> {
        self.data.model().name_to_id(MjtObjBase::mjOBJ_BODY, name)
    }

    /// Number of the chessboard's body.
    pub(crate) fn board_body(&self) -> usize {
        self.board_body
    }
}

impl EyePlaces {
    fn of(rig: &Rig, scenario: &Scenario) -> Self {
        let reality = &scenario.eyes;
        let nominal = rig.eyes.head_from_left.isometry;
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(reality.rotation_rad));
        let place = nominal.translation.vector + Vector3::from(reality.translation_m);
        let left = Isometry3::from_parts(Translation3::from(place), turn * nominal.rotation);
        let right_turn = UnitQuaternion::from_scaled_axis(Vector3::from(reality.right_rotation_rad));
        let right = rig.eyes.cameras.right_from_left.inverse().isometry * right_turn;
        Self { head_from_left: Pose::new(left), left_from_right: Pose::new(right) }
    }
}

fn isometry(position: [f64; 3], [w, i, j, k]: [f64; 4]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::from(position), turn)
}

fn find(model: &MjModel, kind: MjtObjBase, name: &str) -> Result<usize, TwinError> {
    let missing = || TwinError::Physics { reason: format!("the part {name} got lost on the way") };
    model.name_to_id(kind, name).ok_or_else(missing)
}

fn find_rub(model: &MjModel, rig: &Rig, joint: JointIndex) -> Result<Rub, TwinError> {
    let described = rig.description.joint(joint);
    if parts::finger(rig, described.child).is_some() {
        return find(model, MjtObjBase::mjOBJ_TENDON, &described.name).map(Rub::Tendon);
    }
    let id = find(model, MjtObjBase::mjOBJ_JOINT, &described.name)?;
    Ok(Rub::Dof(model.jnt_dofadr()[id] as usize))
}

fn find_toy(model: &MjModel, toy: Toy) -> Result<ToyState, TwinError> {
    let id = find(model, MjtObjBase::mjOBJ_JOINT, &format!("toy.{}", toy.name()))?;
    let (qpos, dof) = (model.jnt_qposadr()[id] as usize, model.jnt_dofadr()[id] as usize);
    Ok(ToyState { out: true, qpos, dof })
}

fn watch(model: &MjModel, rig: &Rig, threshold_n: f64) -> Result<TouchWatch, TwinError> {
    let glass = find(model, MjtObjBase::mjOBJ_GEOM, "glass")? as i32;
    let links = rig.description.links().iter().enumerate();
    let fingers = links
        .filter(|(i, _)| parts::finger(rig, LinkIndex(*i)).is_some())
        .map(|(_, link)| {
            find(model, MjtObjBase::mjOBJ_GEOM, &format!("{}.tip", link.name)).map(|id| id as i32)
        })
        .collect::<Result<_, _>>()?;
    Ok(TouchWatch::new(glass, fingers, threshold_n))
}

fn check_names(rig: &Rig, scenario: &Scenario) -> Result<(), TwinError> {
    let unknown = |what, name: &String| TwinError::UnknownPart {
        scenario: scenario.name.clone(),
        what,
        name: name.clone(),
        robot: rig.name.clone(),
    };
    if let Some(name) = scenario.joint.keys().find(|name| rig.description.find_joint(name).is_err()) {
        return Err(unknown("joint", name));
    }
    let is_finger =
        |name: &String| rig.description.find_link(name).is_ok_and(|link| parts::finger(rig, link).is_some());
    match scenario.fingertip.keys().find(|name| !is_finger(name)) {
        Some(name) => Err(unknown("finger", name)),
        None => Ok(()),
    }
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Nothing of what is hidden.
        f.debug_struct("World").field("time_s", &self.time_s()).finish_non_exhaustive()
    }
}

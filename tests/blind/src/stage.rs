//! The physics of a case, touch by touch.

use mujoco_rs::prelude::*;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::bench::Bench;
use crate::error::BlindError;
use crate::heat;
use crate::physics::{Physics, Servo};
use crate::secret::{Kind, Secret};
use crate::world::{self, STEP_S};

/// Descent per step of the physics, m.
const DESCENT_M: f64 = 1.2e-4;
/// Steps to come to rest before the descent begins.
const SETTLING: usize = 40;
/// Where the descent begins over the expected contact, m; higher when the finger was in the glass.
const STARTS_M: [f64; 3] = [0.016, 0.032, 0.06];
/// The descent is given up so far below it, m.
const END_M: f64 = 0.045;
/// Spread of the disturbed place near metal, m.
const MAGNET_M: f64 = 0.05;
/// Angle over which a joint forgets where it came from, rad.
const MEMORY_RAD: f64 = 0.04;

/// A pose that is touched, and how the arm comes there.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Which, from 0.
    pub number: usize,
    /// Joints at contact, as planned, rad.
    pub angles_rad: Vec<f64>,
    /// How they change per meter of descent, rad/m.
    pub way_rad_per_m: Vec<f64>,
    /// Label of the side.
    pub approach: &'static str,
    /// Height of the block under the screen, m.
    pub height_m: f64,
    /// Weight in the palm, kg.
    pub payload_kg: f64,
    /// Block of cross-validation.
    pub set: String,
}

/// What a touch gave, without noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Met {
    /// Commanded, rad.
    pub commanded_rad: Vec<f64>,
    /// Encoders, rad.
    pub encoder_rad: Vec<f64>,
    /// Place on the image, as its pixels say, in the frame of the nominal screen, m.
    pub at_m: [f64; 2],
    /// Duration of the descent, s.
    pub move_secs: f64,
    /// Temperature of the motors, °C.
    pub temperature_c: f64,
}

/// A world with one weight in the palm.
struct World {
    payload_kg: f64,
    data: MjData<Box<MjModel>>,
    tip: i32,
    servo: Vec<Hinge>,
    play: Vec<Option<(usize, bool, f64)>>,
    dial: Vec<Option<(usize, f64)>>,
    give: Vec<Option<Hinge>>,
    torso: Option<[usize; 2]>,
}

#[derive(Clone, Copy)]
struct Hinge {
    qpos: usize,
    dof: usize,
}

/// The physics of a case.
pub struct Stage<'a> {
    bench: &'a Bench,
    physics: &'a Physics,
    secrets: Vec<Secret>,
    worlds: Vec<World>,
    /// Where the screen stands against the rig file: nobody knows.
    screen_moved: Isometry3<f64>,
    /// Length of the session, s.
    duration_s: f64,
    /// What joints remember.
    memory: Vec<(f64, f64)>,
}

impl<'a> Stage<'a> {
    /// Builds the worlds.
    ///
    /// # Errors
    /// When MuJoCo does not accept them.
    pub fn new(
        (bench, physics): (&'a Bench, &'a Physics),
        secrets: &[Secret],
        payloads_kg: &[f64],
        screen_moved: Isometry3<f64>,
        duration_s: f64,
    ) -> Result<Self, BlindError> {
        let worlds = payloads_kg
            .iter()
            .map(|payload_kg| World::new(bench, physics, secrets, *payload_kg))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            bench,
            physics,
            worlds,
            screen_moved,
            duration_s,
            memory: vec![(0.0, 0.0); secrets.len()],
            secrets: secrets.to_vec(),
        })
    }

    /// Touches a cell; `chances` (0–1, one per joint, and one more) say how much each servo rubs,
    /// and where within a step the descent begins. `None` when the finger never met the glass.
    pub fn touch(&mut self, cell: &Cell, t_secs: f64, chances: &[f64]) -> Option<Met> {
        STARTS_M.iter().find_map(|start_m| self.try_touch(cell, t_secs, *start_m, chances)).flatten()
    }

    /// `None`: in the glass from the beginning. `Some(None)`: never met it.
    fn try_touch(&mut self, cell: &Cell, t_secs: f64, start_m: f64, chances: &[f64]) -> Option<Option<Met>> {
        let start_m = start_m + chances.last().copied().unwrap_or_default() * DESCENT_M;
        let place = self.place_of_glass(cell, t_secs);
        let (temperature_c, warm) = heat::after(t_secs);
        let w = self.worlds.iter().position(|world| world.payload_kg == cell.payload_kg)?;
        let planned = |left_m: f64| -> Vec<f64> {
            cell.angles_rad.iter().zip(&cell.way_rad_per_m).map(|(angle, way)| angle - way * left_m).collect()
        };
        let world = &mut self.worlds[w];
        world.put_glass(&place);
        world.stand(&planned(start_m), &cell.way_rad_per_m, &self.secrets);
        let mut hold = world.hold(self.physics, &self.secrets, &planned(start_m), &cell.way_rad_per_m);
        let sums = sums_per_s(self.physics, &self.secrets, world.servo.len());
        let is_fed = self.physics.servo == Servo::Fed;
        let integrating = self.secrets.iter().any(|s| s.kind == Kind::EarlyLog);
        let early = self.secrets.iter().filter(|s| s.kind == Kind::EarlyLog);
        let early_steps = (early.map(|s| s.amount.abs()).sum::<f64>() / STEP_S).round() as usize;
        let mut logged: Vec<Vec<f64>> = vec![];
        let mut first: Option<(Vec<f64>, Vec<f64>, usize)> = None;
        let mut late_steps = 0;
        let mut at = None;
        let steps = SETTLING + ((start_m + END_M) / DESCENT_M) as usize;
        for step in 0..steps {
            let left_m = start_m - DESCENT_M * step.saturating_sub(SETTLING) as f64;
            let plan = planned(left_m);
            if !is_fed {
                let off = plan.iter().zip(world.motors()).map(|(plan, motor)| plan - motor);
                hold.iter_mut()
                    .zip(off)
                    .zip(&sums)
                    .for_each(|((hold, off), per_s)| *hold += STEP_S * per_s * off);
            }
            for (k, ctrl) in world.data.ctrl_mut().iter_mut().enumerate() {
                *ctrl = plan[k] + hold[k];
            }
            world.push(&self.secrets, cell, warm);
            world.rub(self.physics, &self.secrets, &cell.way_rad_per_m, chances);
            world.data.step();
            if early_steps > 0 {
                logged.push(world.motors());
            }
            if let Some(contact) = world.contact(self.physics.threshold_n) {
                if step < SETTLING {
                    return None;
                }
                at = Some(place.inverse() * contact);
                if first.is_none() {
                    late_steps = (late_s(&self.secrets, contact) / STEP_S).round() as usize;
                    let commanded = if integrating || !is_fed { plan } else { world.data.ctrl().to_vec() };
                    let motors = if early_steps > 0 {
                        logged[logged.len().saturating_sub(1 + early_steps)].clone()
                    } else {
                        world.motors()
                    };
                    first = Some((commanded, motors, step));
                }
            }
            if first.as_ref().is_some_and(|(_, _, met)| step >= met + late_steps) {
                break;
            }
        }
        let (Some((mut commanded_rad, motors, step)), Some(at)) = (first, at) else { return Some(None) };
        let true_m =
            (self.bench.robot_from_screen().inverse() * (place * Point3::new(at.x, at.y, 0.0))).coords;
        let encoder_rad = self.readings(&motors, t_secs, warm, [true_m.x, true_m.y]);
        // A servo follows its encoder, so what is wrong with the reading is in the command, too.
        for ((commanded, encoder), motor) in commanded_rad.iter_mut().zip(&encoder_rad).zip(&motors) {
            *commanded += encoder - motor;
        }
        let scale =
            self.secrets.iter().filter(|s| s.kind == Kind::ScreenScale).fold([1.0, 1.0], |scale, s| {
                [scale[0] * (1.0 + s.shape[0] * s.amount), scale[1] * (1.0 + s.shape[1] * s.amount)]
            });
        Some(Some(Met {
            commanded_rad,
            encoder_rad,
            at_m: [at.x / scale[0], at.y / scale[1]],
            move_secs: STEP_S * (step - SETTLING) as f64,
            temperature_c,
        }))
    }

    fn place_of_glass(&self, cell: &Cell, t_secs: f64) -> Isometry3<f64> {
        let mut place = self.bench.robot_from_screen() * self.screen_moved;
        for secret in self.secrets.iter().filter(|s| s.kind == Kind::ScreenBumped) {
            if t_secs >= secret.when * self.duration_s {
                let [x, y, yaw] = secret.shape.map(|share| share * secret.amount);
                place *= Isometry3::from_parts(
                    Translation3::new(x, y, 0.0),
                    UnitQuaternion::from_scaled_axis(Vector3::z() * yaw * 8.0),
                );
            }
        }
        place.translation.vector.z += cell.height_m;
        place
    }

    /// What encoders read when motors stand so.
    fn readings(&mut self, motors: &[f64], t_secs: f64, warm: f64, at_m: [f64; 2]) -> Vec<f64> {
        let mut read = motors.to_vec();
        for (i, secret) in self.secrets.iter().enumerate() {
            let j = secret.joint;
            let (angle, amount, [a, b, _]) = (motors[j.min(motors.len() - 1)], secret.amount, secret.shape);
            let ahead = match secret.kind {
                Kind::JointEccentricity => (angle.sin() + amount * b).atan2(angle.cos() + amount * a) - angle,
                Kind::SlippedHorn if t_secs >= secret.when * self.duration_s => -amount,
                Kind::ServoWarmUp => -amount * warm,
                Kind::GearTrain => -amount * (7.3 * angle + 3.0 * a).sin(),
                Kind::CableStep => -amount * ((angle - a) / 0.01).tanh(),
                Kind::Magnet => {
                    let away = (at_m[0] - a).powi(2) + (at_m[1] - b).powi(2);
                    -amount * (-0.5 * away / MAGNET_M.powi(2)).exp()
                }
                Kind::Hysteresis => {
                    let (before, mut z) = self.memory[i];
                    // Small steps of the way from where the joint was.
                    let turn = (angle - before) / 100.0 / MEMORY_RAD;
                    for _ in 0..100 {
                        z += turn - 0.5 * (turn.abs() * z + turn * z.abs());
                    }
                    self.memory[i] = (angle, z);
                    -amount * z
                }
                _ => 0.0,
            };
            if ahead != 0.0 {
                read[j] += ahead;
            }
        }
        read
    }
}

/// How long the finger slides on until the panel answers, when it met the glass there (robot frame, m), s. A finger that sticks
/// on dry patches and slips between them is told where it touched on the former.
fn late_s(secrets: &[Secret], contact: Point3<f64>) -> f64 {
    let late = |secret: &Secret| match secret.kind {
        Kind::TouchDrag => secret.amount.abs(),
        Kind::StickSlip if !secret.sticks_at([contact.x, contact.y]) => secret.amount.abs(),
        _ => 0.0,
    };
    secrets.iter().map(late).sum()
}

/// How fast each servo sums up what is left, 1/s; one that gives way or sticks does not.
fn sums_per_s(physics: &Physics, secrets: &[Secret], joints: usize) -> Vec<f64> {
    let idle = |j: usize| secrets.iter().any(|s| s.joint == j && s.kind.is_of_servo());
    (0..joints).map(|j| if idle(j) { 0.0 } else { physics.integral_per_s() }).collect()
}

impl World {
    fn new(
        bench: &Bench,
        physics: &Physics,
        secrets: &[Secret],
        payload_kg: f64,
    ) -> Result<Self, BlindError> {
        let xml = world::write(bench, physics, secrets, payload_kg);
        let model = MjModel::from_xml_string(&xml)
            .map_err(|error| BlindError::Physics { reason: format!("{error} in\n{xml}") })?;
        let model = Box::new(model);
        let hinge = |name: &str| -> Option<Hinge> {
            let id = model.name_to_id(MjtObjBase::mjOBJ_JOINT, name)?;
            Some(Hinge { qpos: model.jnt_qposadr()[id] as usize, dof: model.jnt_dofadr()[id] as usize })
        };
        let lost = |what: &str| BlindError::Physics { reason: format!("{what} got lost on the way") };
        let names = bench.joints();
        let servo =
            names.iter().map(|name| hinge(name).ok_or_else(|| lost(name))).collect::<Result<_, _>>()?;
        let of = |j: usize, kind: Kind| secrets.iter().find(|s| s.kind == kind && s.joint == j);
        let play = (0..names.len())
            .map(|j| {
                let hinge = hinge(&format!("{}.play", names[j]))?;
                let rubs = of(j, Kind::Backlash).filter(|s| s.amount < 0.0);
                let width = rubs.or(of(j, Kind::GravityBacklash))?.amount.abs();
                Some((hinge.qpos, rubs.is_some(), 0.5 * width))
            })
            .collect();
        let dial = (0..names.len())
            .map(|j| {
                let hinge = hinge(&format!("{}.dial", names[j]))?;
                Some((hinge.qpos, 0.5 * of(j, Kind::Backlash)?.amount))
            })
            .collect();
        let give = names.iter().map(|name| hinge(&format!("{name}.give"))).collect();
        let torso = hinge("torso.x").zip(hinge("torso.y")).map(|(x, y)| [x.dof, y.dof]);
        let tip =
            model.name_to_id(MjtObjBase::mjOBJ_GEOM, "tip").ok_or_else(|| lost("the fingertip"))? as i32;
        Ok(Self { payload_kg, data: MjData::new(model), tip, servo, play, dial, give, torso })
    }

    fn put_glass(&mut self, place: &Isometry3<f64>) {
        let q = place.rotation.quaternion();
        self.data.mocap_pos_mut()[0] = place.translation.vector.into();
        self.data.mocap_quat_mut()[0] = [q.w, q.i, q.j, q.k];
    }

    /// At rest in a posture of the motors, with all play as a long way in this direction leaves it.
    fn stand(&mut self, motors: &[f64], way: &[f64], secrets: &[Secret]) {
        self.data.qpos_mut().fill(0.0);
        self.data.qvel_mut().fill(0.0);
        self.data.qacc_warmstart_mut().fill(0.0);
        for j in 0..motors.len() {
            let mut angle = motors[j];
            for secret in secrets.iter().filter(|s| s.joint == j) {
                match secret.kind {
                    Kind::JointScale => angle *= 1.0 + secret.amount,
                    Kind::JointCoupling => angle += secret.amount * motors[j - 1],
                    _ => {}
                }
            }
            self.data.qpos_mut()[self.servo[j].qpos] = angle;
            if let Some((qpos, rubs, half)) = self.play[j] {
                self.data.qpos_mut()[qpos] = if rubs { -half * way[j].signum() } else { 0.0 };
            }
            if let Some((qpos, half)) = self.dial[j] {
                self.data.qpos_mut()[qpos] = angle - half * way[j].signum();
            }
        }
        self.data.forward();
    }

    /// What pushes on joints from outside: springs that soften, and the other arm.
    fn push(&mut self, secrets: &[Secret], cell: &Cell, warm: f64) {
        for secret in secrets {
            match (secret.kind, self.torso, self.give.get(secret.joint).copied().flatten()) {
                (Kind::SoftWhenWarm, _, Some(hinge)) => {
                    let stiffness = 1.0 / secret.amount.abs().max(1e-9);
                    let more = stiffness * (1.0 / warm.max(0.1) - 1.0);
                    let bent = self.data.qpos()[hinge.qpos];
                    self.data.qfrc_applied_mut()[hinge.dof] = -more * bent;
                }
                (Kind::OtherArm, Some(torso), _) => {
                    // Each pose is another place for the other arm, told to nobody.
                    let heading = (cell.number as f64 * 12.9898).sin() * 43758.5453;
                    let lean_nm = secret.amount / 0.002;
                    self.data.qfrc_applied_mut()[torso[0]] = lean_nm * heading.sin();
                    self.data.qfrc_applied_mut()[torso[1]] = lean_nm * heading.cos();
                }
                _ => {}
            }
        }
    }

    /// What is added to the goals from the start, rad: the load where it is known or has been summed up.
    /// Servos that give way stand below their goals then.
    fn hold(&mut self, physics: &Physics, secrets: &[Secret], goals: &[f64], way: &[f64]) -> Vec<f64> {
        let (mut hold, mut stands) = (vec![], goals.to_vec());
        for (j, hinge) in self.servo.iter().enumerate() {
            let of = |s: &&Secret| s.joint == j;
            let stiffness = world::stiffness_nm_per_rad(physics, secrets.iter().filter(of));
            let load_rad = self.data.qfrc_bias()[hinge.dof] / stiffness;
            let droops = secrets.iter().any(|s| s.kind == Kind::ServoDroop && s.joint == j);
            let gives = droops || physics.servo == Servo::Proportional;
            hold.push(if gives { 0.0 } else { load_rad });
            stands[j] -= if gives { load_rad } else { 0.0 };
        }
        if stands != goals {
            self.stand(&stands, way, secrets);
        }
        hold
    }

    /// Friction holds every servo back.
    fn rub(&mut self, physics: &Physics, secrets: &[Secret], way: &[f64], chances: &[f64]) {
        for (j, hinge) in self.servo.iter().enumerate() {
            let [least, most] = physics.friction_shares;
            let share = least + (most - least) * chances.get(j).copied().unwrap_or(0.5);
            let sticks = secrets.iter().find(|s| s.kind == Kind::Stiction && s.joint == j);
            let friction_nm =
                sticks.map_or(share * physics.friction_nm, |s| 0.5 * s.amount * physics.servo_nm_per_rad);
            self.data.qfrc_applied_mut()[hinge.dof] = -way[j].signum() * friction_nm;
        }
    }

    /// Encoders before what is wrong with their reading.
    fn motors(&self) -> Vec<f64> {
        let lengths = self.data.actuator_length();
        (0..self.servo.len())
            .map(|j| self.dial[j].map_or(lengths[j], |(qpos, _)| self.data.qpos()[qpos]))
            .collect()
    }

    fn contact(&self, threshold_n: f64) -> Option<Point3<f64>> {
        self.data.contact().iter().enumerate().find_map(|(i, contact)| {
            if !contact.geom.contains(&self.tip) {
                return None;
            }
            let force = self.data.try_contact_force(i).ok()?;
            (force[0] >= threshold_n).then(|| Point3::from(contact.pos))
        })
    }
}

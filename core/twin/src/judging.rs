//! How much a twin misses: measured with the nominal model against what really happens. For
//! judges and tests only; it reads the truth.

use std::sync::Arc;

use nalgebra::{Point3, Vector2, Vector3};
use plumbline_hardware::dynamixel::ControlTable;
use plumbline_model::Point;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::robot::{Posture, Rig};

use crate::error::TwinError;
use crate::physics::World;
use crate::scenario::Scenario;
use crate::scene::TrueEyes;

/// A touch of the right index finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedTouch {
    /// Where it was sent: pixel (u, v) of the nominal touchscreen.
    pub target_px: [f64; 2],
    /// Where it touched, if it did.
    pub touched_px: Option<[u32; 2]>,
    /// Touched minus sent, m along u and v.
    pub error_m: Option<Vector2<f64>>,
    /// Cosine of the finger's inclination, 1 when it points straight down.
    pub upright: f64,
}

/// Sends the fingertip to `columns` × `rows` places of the part of the touchscreen that is in
/// reach: from above, down until the glass feels it, with the nominal inverse kinematics.
///
/// # Errors
/// When the twin cannot be built.
pub fn touches(
    rig: &Arc<Rig>,
    scenario: &Scenario,
    seed: u64,
    columns: usize,
    rows: usize,
) -> Result<Vec<JudgedTouch>, TwinError> {
    let mut world = World::new(rig.clone(), scenario, seed)?;
    crate::Toy::ALL.into_iter().for_each(|toy| world.remove_toy(toy));
    let Some(ready) = rig.pose("touch-ready").map(|pose| pose.applied_to(&rig.home())) else {
        return Ok(vec![]);
    };
    // The left arm stays up, out of the way.
    let right =
        rig.arm("right").map(|arm| [arm.joints.clone(), arm.hand.clone()].concat()).unwrap_or_default();
    let ready = rig.home().with(&right, &ready.of(&right));
    let wrong = |error: &dyn std::fmt::Display| TwinError::Physics { reason: error.to_string() };
    let solver = Solver::of_rig(rig, "right_index_tip").map_err(|error| wrong(&error))?;
    let mut judged = vec![];
    for column in 0..columns {
        for row in 0..rows {
            let part = |i: usize, n: usize| i as f64 / (n.max(2) - 1) as f64;
            // The touches logged on the real robot span this part of the image.
            let target_px = [200.0 + 1500.0 * part(column, columns), 350.0 + 680.0 * part(row, rows)];
            judged.push(touch(&mut world, &solver, &ready, target_px));
        }
    }
    Ok(judged)
}

fn touch(world: &mut World, solver: &Solver, ready: &Posture, target_px: [f64; 2]) -> JudgedTouch {
    let rig = world.rig().clone();
    let screen = &rig.touchscreen;
    let pitch_m =
        [screen.width_m / f64::from(screen.width_px), screen.height_m / f64::from(screen.height_px)];
    let on_glass = screen.origin.coords.coords
        + screen.u_axis.vector() * (target_px[0] + 0.5) * pitch_m[0]
        + screen.v_axis.vector() * (target_px[1] + 0.5) * pitch_m[1];
    let mut judged = JudgedTouch { target_px, touched_px: None, error_m: None, upright: 0.0 };
    let mut posture = ready.clone();
    let reach = |height_m: f64, yaw_rad: f64, from: &Posture| {
        let above = on_glass + Vector3::z() * height_m;
        let target = Target::PositionYaw { point: Point::from(Point3::from(above)), yaw_rad };
        let answer = solver.solve_from(&target, from, &Options::upright()).ok()?;
        answer.is_reached().then(|| from.with(solver.joints(), &answer.best().joints))
    };
    // The heading in which the finger points down best.
    let Ok(chain) = rig.chain(solver.tip()) else { return judged };
    let upright = |posture: &Posture| (chain.robot_from_tip_in(posture).isometry * Vector3::z()).z;
    let headings = (-9..9).map(|i| f64::from(i) * std::f64::consts::PI / 9.0);
    let best = headings
        .filter_map(|yaw_rad| reach(0.06, yaw_rad, &posture).map(|over| (yaw_rad, over)))
        .max_by(|a, b| upright(&a.1).total_cmp(&upright(&b.1)));
    let Some((yaw_rad, over)) = best else { return judged };
    posture = over;
    judged.upright = upright(&posture);
    send(world, &posture, 1.0);
    world.run(2.0);
    world.take_touches();
    // 2 mm every 40 ms.
    for step in 0..60 {
        let Some(next) = reach(0.06 - 0.002 * f64::from(step), yaw_rad, &posture) else { break };
        posture = next;
        send(world, &posture, 1.0);
        world.run(0.04);
        if let Some(contact) = world.take_touches().first() {
            let error_px = [0, 1].map(|k| f64::from(contact.pixel[k]) - target_px[k]);
            judged.touched_px = Some(contact.pixel);
            judged.error_m = Some(Vector2::new(error_px[0] * pitch_m[0], error_px[1] * pitch_m[1]));
            break;
        }
    }
    // Up again before the next.
    if let Some(up) = reach(0.06, yaw_rad, &posture) {
        send(world, &up, 1.0);
        world.run(0.5);
    }
    judged
}

/// Goals as the bus can say them: in whole ticks of the motors.
fn send(world: &mut World, posture: &Posture, speed_rad_s: f64) {
    let rig = world.rig().clone();
    let mut rounded = posture.clone();
    for servo in &rig.servos {
        let table = ControlTable::of_model(&servo.model);
        let ticks = table.and_then(|table| table.ticks(servo.motor_rad(posture[servo.joint])));
        if let Some(motor_rad) = table.zip(ticks).and_then(|(table, ticks)| table.motor_rad(ticks)) {
            rounded[servo.joint] = servo.joint_rad(motor_rad);
        }
    }
    world.send(&rounded, Some(speed_rad_s));
}

/// How the place of a thing seems to move while the eyes warm up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedDrift {
    /// Where the thing is, robot frame.
    pub point: Vector3<f64>,
    /// Where it seems to be with cold eyes, minus where it is, m.
    pub cold_error_m: Vector3<f64>,
    /// Where it seems to be later, minus where it seemed to be cold, m.
    pub drift_m: Vector3<f64>,
}

/// Localizes points with nominal eyes on a nominal head (angles by the encoders), cold and after
/// `minutes`.
///
/// # Errors
/// When the twin cannot be built.
pub fn drift(
    rig: &Arc<Rig>,
    scenario: &Scenario,
    points: &[Vector3<f64>],
    minutes: f64,
) -> Result<Vec<JudgedDrift>, TwinError> {
    let mut world = World::new(rig.clone(), scenario, 1)?;
    world.run(1.0);
    world.cool_eyes();
    let cold = world.truth_for_judging();
    world.advance_warm_up(minutes * 60.0);
    let warm = world.truth_for_judging();
    let locate = |eyes: &TrueEyes, point: &Vector3<f64>| {
        let seen = |from_robot: nalgebra::Isometry3<f64>| (from_robot * Point3::from(*point)).coords;
        let left = eyes.left.project(&seen(eyes.robot_from_left.isometry.inverse())).ok()?;
        let right = eyes.right.project(&seen(eyes.robot_from_right.isometry.inverse())).ok()?;
        let in_left = rig.eyes.cameras.triangulate(left, right)?;
        Some((rig.robot_from_left(&cold.encoders) * in_left).coords.coords)
    };
    Ok(points
        .iter()
        .filter_map(|point| {
            let (first, later) = (locate(&cold.eyes, point)?, locate(&warm.eyes, point)?);
            Some(JudgedDrift { point: *point, cold_error_m: first - point, drift_m: later - first })
        })
        .collect())
}

//! The world of a case in MuJoCo's own format: a lean arm over a glass, with what is hidden built
//! as bodies, joints, springs, stops and places.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::bench::Bench;
use crate::physics::Physics;
use crate::secret::{Kind, Secret};

/// Step of the physics, s.
pub const STEP_S: f64 = 0.002;
/// Gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// Stops of steel: at the edge of what the step can follow (stiffness 1/s², damping 1/s).
const STEEL: &str = r#"solreflimit="-200000 -480" solimplimit="0.999 0.9999 0.0001""#;
const STEEL_TENDON: &str = r#"solreflimit="-200000 -480" solimplimit="0.999 0.9999 0.0001""#;

/// The world of a case; `payload_kg` hangs in the palm.
pub fn write(bench: &Bench, physics: &Physics, secrets: &[Secret], payload_kg: f64) -> String {
    let mut text = format!(
        r#"<mujoco>
  <compiler angle="radian" autolimits="true" inertiafromgeom="false" balanceinertia="true" boundmass="1e-6" boundinertia="1e-8"/>
  <option timestep="{STEP_S}" integrator="implicitfast" gravity="0 0 -{GRAVITY}" cone="elliptic" iterations="20"/>
  <worldbody>
    <body name="glass" mocap="true">{}</body>
    <body name="torso"><inertial pos="0 0 0" mass="0.01" diaginertia="0.01 0.01 0.01"/>
"#,
        glass(physics, secrets)
    );
    for secret in secrets.iter().filter(|s| matches!(s.kind, Kind::TorsoLean | Kind::OtherArm)) {
        let compliance = if secret.kind == Kind::OtherArm { 0.002 } else { secret.amount.abs().max(1e-9) };
        for (axis, name) in [("1 0 0", "x"), ("0 1 0", "y")] {
            spring(&mut text, &format!("torso.{name}"), axis, compliance);
        }
    }
    let mut tail = Tail::default();
    for j in 0..bench.parts.len() {
        part(&mut text, &mut tail, (bench, physics), secrets, j, payload_kg);
    }
    text.push_str(&"    </body>\n".repeat(bench.parts.len() + 1));
    let _ = write!(
        text,
        "  </worldbody>\n  <tendon>\n{}  </tendon>\n  <actuator>\n{}  </actuator>\n</mujoco>\n",
        tail.tendons, tail.actuators
    );
    text
}

#[derive(Default)]
struct Tail {
    tendons: String,
    actuators: String,
}

fn glass(physics: &Physics, secrets: &[Secret]) -> String {
    let slip = physics.glass;
    match secrets.iter().find(|s| s.kind == Kind::ScreenBow && s.amount > 1e-6) {
        // A flat arch that is highest along the middle row: a very large drum.
        Some(secret) => {
            let radius_m = 0.5 / secret.amount;
            format!(
                r#"<geom name="glass" type="cylinder" size="{radius_m} 2" pos="0 0 -{radius_m}" euler="0 1.5707963267948966 0" {slip}/>"#
            )
        }
        None => format!(r#"<geom name="glass" type="plane" size="2 2 0.1" {slip}/>"#),
    }
}

fn part(
    text: &mut String,
    tail: &mut Tail,
    (bench, physics): (&Bench, &Physics),
    secrets: &[Secret],
    j: usize,
    payload_kg: f64,
) {
    let part = &bench.parts[j];
    let here: Vec<&Secret> = secrets.iter().filter(|s| s.joint == j && !s.kind.joints().is_empty()).collect();
    let mut place = part.place;
    for secret in &here {
        match secret.kind {
            Kind::LinkLength => {
                let along = part.place.translation.vector.try_normalize(1e-6).unwrap_or_default();
                place.translation.vector += along * secret.amount;
            }
            Kind::AxisSkew => place.rotation *= UnitQuaternion::from_scaled_axis(secret.skew(&part.axis)),
            Kind::JointZero => {
                place.rotation *= UnitQuaternion::from_scaled_axis(part.axis * secret.amount);
            }
            _ => {}
        }
    }
    let name = &part.joint;
    // The drive of the encoder where it has play: a little wheel beside the joint.
    for secret in here.iter().filter(|s| s.kind == Kind::Backlash && s.amount > 0.0) {
        let half = 0.5 * secret.amount;
        let _ = writeln!(
            text,
            r#"    <body {}><inertial pos="0 0 0" mass="1e-6" diaginertia="1e-6 1e-6 1e-6"/><joint name="{name}.dial" type="hinge" axis="{}" armature="0.0005" damping="0.002" frictionloss="0.01"/></body>"#,
            pose(&place),
            list(&part.axis)
        );
        let _ = writeln!(
            tail.tendons,
            r#"    <fixed name="{name}.dial" limited="true" range="{} {half}" {STEEL_TENDON}><joint joint="{name}.dial" coef="1"/><joint joint="{name}" coef="-1"/></fixed>"#,
            -half
        );
    }
    let _ = writeln!(text, r#"    <body name="{}" {}>"#, part.link, pose(&place));
    inertia(text, bench, physics, j, payload_kg);
    for secret in here.iter().filter(|s| s.kind == Kind::SidewaysGive) {
        let a = part.axis.cross(&Vector3::ith(part.axis.iamin(), 1.0)).normalize();
        for (k, across) in [a, part.axis.cross(&a)].iter().enumerate() {
            spring(text, &format!("{name}.across{k}"), &list(across), secret.amount.abs().max(1e-9));
        }
    }
    servo(text, tail, (bench, physics), &here, j);
    for secret in &here {
        match secret.kind {
            Kind::JointSag | Kind::SoftWhenWarm => {
                spring(text, &format!("{name}.give"), &list(&part.axis), secret.amount.abs().max(1e-9));
            }
            Kind::GravityBacklash => play(text, name, &list(&part.axis), secret.amount.abs()),
            Kind::Backlash if secret.amount < 0.0 => {
                play(text, name, &list(&part.axis), -secret.amount);
                // The link's own bearing rubs against the part that carries it.
                let _ = writeln!(
                    tail.tendons,
                    r#"    <fixed name="{name}.bearing" frictionloss="0.6"><joint joint="{name}" coef="1"/><joint joint="{name}.play" coef="1"/></fixed>"#
                );
            }
            _ => {}
        }
    }
    if j + 1 == bench.parts.len() {
        fingertip(text, bench, physics.point_m, secrets);
    }
}

fn servo(
    text: &mut String,
    tail: &mut Tail,
    (bench, physics): (&Bench, &Physics),
    here: &[&Secret],
    j: usize,
) {
    let part = &bench.parts[j];
    let name = &part.joint;
    let (armature, damping) = if j < 4 { (0.02, 1.0) } else { (0.01, 0.5) };
    let _ = writeln!(
        text,
        r#"      <joint name="{name}" type="hinge" axis="{}" armature="{armature}" damping="{damping}"/>"#,
        list(&part.axis)
    );
    let gear: f64 =
        here.iter().filter(|s| s.kind == Kind::JointScale).map(|s| 1.0 / (1.0 + s.amount)).product();
    let servo = format!(r#"kp="{}""#, stiffness_nm_per_rad(physics, here.iter().copied()));
    // A cable that runs over the joint before: what the motor winds is this joint less a share of
    // that one.
    if let Some(secret) = here.iter().find(|s| s.kind == Kind::JointCoupling && j > 0) {
        let before = &bench.parts[j - 1].joint;
        let _ = writeln!(
            tail.tendons,
            r#"    <fixed name="{name}.cable"><joint joint="{name}" coef="1"/><joint joint="{before}" coef="{}"/></fixed>"#,
            -secret.amount
        );
        let _ = writeln!(tail.actuators, r#"    <position tendon="{name}.cable" gear="{gear}" {servo}/>"#);
    } else {
        let _ = writeln!(tail.actuators, r#"    <position joint="{name}" gear="{gear}" {servo}/>"#);
    }
}

/// Stiffness of the servo of a joint, with what is wrong there.
pub fn stiffness_nm_per_rad<'a>(physics: &Physics, mut here: impl Iterator<Item = &'a Secret>) -> f64 {
    let droops = here.find(|secret| secret.kind == Kind::ServoDroop);
    droops.map_or(physics.servo_nm_per_rad, |secret| 1.0 / secret.amount.abs().max(1e-3))
}

/// A spring that rings off within a few hundredths of a second.
fn spring(text: &mut String, name: &str, axis: &str, compliance: f64) {
    let stiffness = 1.0 / compliance;
    let _ = writeln!(
        text,
        r#"      <joint name="{name}" type="hinge" axis="{axis}" stiffness="{stiffness}" damping="{}" armature="0.0005"/>"#,
        0.01 * stiffness
    );
}

fn play(text: &mut String, name: &str, axis: &str, width: f64) {
    let half = 0.5 * width;
    let _ = writeln!(
        text,
        r#"      <joint name="{name}.play" type="hinge" axis="{axis}" range="{} {half}" {STEEL} damping="0.01" armature="0.01"/>"#,
        -half
    );
}

/// What hangs on a link, as one body: fingers and weight included.
fn inertia(text: &mut String, bench: &Bench, physics: &Physics, j: usize, payload_kg: f64) {
    let factor = physics.mass_factors.get(j).copied().unwrap_or(1.0);
    let mut masses: Vec<_> = bench.parts[j].masses.iter().map(|(at, mass)| (*at, mass * factor)).collect();
    if j + 1 == bench.parts.len() && payload_kg > 0.0 {
        masses.push((bench.palm_m, payload_kg));
    }
    let mass: f64 = masses.iter().map(|(_, m)| m).sum::<f64>().max(1e-5);
    let center = masses.iter().map(|(at, m)| at * *m).sum::<Vector3<f64>>() / mass;
    let moment = 1e-4 + masses.iter().map(|(at, m)| (at - center).norm_squared() * m).sum::<f64>();
    let _ = writeln!(
        text,
        r#"      <inertial pos="{}" mass="{mass}" diaginertia="{moment} {moment} {moment}"/>"#,
        list(&center)
    );
}

fn fingertip(text: &mut String, bench: &Bench, point_m: f64, secrets: &[Secret]) {
    let mut tip = bench.last_from_tip;
    let mut radius_m = point_m;
    for secret in secrets {
        match secret.kind {
            Kind::TipOffset => tip *= Translation3::from(Vector3::from(secret.shape) * secret.amount),
            Kind::FingerRoll => radius_m = secret.amount.abs().max(point_m),
            _ => {}
        }
    }
    let finger = (bench.last_from_tip.translation.vector - bench.knuckle_m).normalize();
    // The pad's front is where the model has the tip.
    let center = tip.translation.vector - finger * radius_m;
    let _ =
        writeln!(text, r#"      <geom name="tip" type="sphere" size="{radius_m}" pos="{}"/>"#, list(&center));
}

fn pose(place: &Isometry3<f64>) -> String {
    let q = place.rotation.quaternion();
    format!(r#"pos="{}" quat="{} {} {} {}""#, list(&place.translation.vector), q.w, q.i, q.j, q.k)
}

fn list(vector: &Vector3<f64>) -> String {
    format!("{} {} {}", vector.x, vector.y, vector.z)
}

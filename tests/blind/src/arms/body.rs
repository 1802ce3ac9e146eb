//! Where the marker of an arm is when things are wrong: places of bodies, and springs in balance with gravity by
//! virtual work.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::robot::Robot;
use super::secret::{Kind, Secret};

/// Gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// A link that bends is so many stiff pieces with hinges between them.
const PIECES: usize = 6;
/// Step of a virtual turn, rad.
const VIRTUAL_RAD: f64 = 1e-5;
/// Less than this does not close any play, N m.
const LEAST_LOAD_NM: f64 = 0.03;
/// A balance is found when nothing turns further than this, rad.
const BALANCED_RAD: f64 = 1e-9;
/// Waves of a gear train per turn: not whole.
const WAVES: f64 = 3.4;
/// A joint that remembers has forgotten nothing of a way as long as this, rad.
const REMEMBERED_RAD: f64 = 1.5;

/// What an arm does at a moment.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Angles of the motors as perfect encoders would see them, rad.
    pub motors_rad: Vec<f64>,
    /// Sign of the last motion of each.
    pub way: Vec<f64>,
    /// Angles in the pose before, rad.
    pub from_rad: Vec<f64>,
    /// Share of the session that is over.
    pub over: f64,
    /// How warm brackets are, 0–1.
    pub warm: f64,
    /// Mass that hangs at the marker, kg.
    pub payload_kg: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Seat {
    Base,
    /// Along the link into a joint, at this share of it.
    Along(usize, f64),
    /// Before a joint's own turn.
    Before(usize),
    /// Behind it.
    Behind(usize),
}

struct Spring {
    seat: Seat,
    axis: Vector3<f64>,
    /// rad/(N m).
    compliance: f64,
}

/// An arm with what is wrong with it.
pub struct Body<'a> {
    robot: &'a Robot,
    secrets: &'a [Secret],
    places: Vec<Isometry3<f64>>,
    last_from_marker: Isometry3<f64>,
    masses_kg: Vec<f64>,
}

impl<'a> Body<'a> {
    /// Of a robot whose links weigh so many times what the description says, with a marker that sits `mount` beside
    /// its described place.
    pub fn new(
        robot: &'a Robot,
        secrets: &'a [Secret],
        mass_factors: &[f64],
        mount: &Isometry3<f64>,
    ) -> Self {
        let mut places: Vec<Isometry3<f64>> = robot.parts.iter().map(super::robot::Part::place).collect();
        let mut last_from_marker = robot.last_from_marker() * mount;
        for secret in secrets {
            let j = secret.joint;
            match secret.kind {
                Kind::LinkLength => {
                    let along = robot.parts[j].shift_m.try_normalize(1e-9).unwrap_or_default();
                    places[j].translation.vector += along * secret.amount;
                }
                Kind::AxisSkew => {
                    places[j].rotation *= UnitQuaternion::from_scaled_axis(secret.skew(&robot.parts[j].axis));
                }
                Kind::TipOffset => {
                    let shift = Translation3::from(Vector3::from(secret.shape) * secret.amount);
                    last_from_marker = robot.last_from_marker() * shift * mount;
                }
                _ => {}
            }
        }
        let masses_kg =
            robot.parts.iter().zip(mass_factors).map(|(part, factor)| part.mass_kg * factor).collect();
        Self { robot, secrets, places, last_from_marker, masses_kg }
    }

    /// The marker in the frame of the base.
    pub fn base_from_marker(&self, moment: &Moment) -> Isometry3<f64> {
        let springs = self.springs(moment);
        let mut angles = self.angles(moment);
        for secret in self.secrets.iter().filter(|secret| secret.kind == Kind::GravityBacklash) {
            let height = |turn_rad: f64| {
                let mut turned = angles.clone();
                turned[secret.joint] += turn_rad;
                self.energy(&turned, &springs, &vec![0.0; springs.len()], moment.payload_kg)
            };
            let torque_nm = (height(-VIRTUAL_RAD) - height(VIRTUAL_RAD)) / (2.0 * VIRTUAL_RAD);
            // It falls to the side on which the arm hangs lower; what hardly weighs anything stays in the middle.
            let side = if torque_nm.abs() > LEAST_LOAD_NM { torque_nm.signum() } else { 0.0 };
            angles[secret.joint] += 0.5 * secret.amount * side;
        }
        let bent = self.balance(&angles, &springs, moment.payload_kg);
        self.walk(&angles, &springs, &bent).1
    }

    /// Angles of the links against each other, before anything gives way.
    fn angles(&self, moment: &Moment) -> Vec<f64> {
        let mut angles = moment.motors_rad.clone();
        for secret in self.secrets {
            let (j, amount) = (secret.joint, secret.amount);
            let motor = moment.motors_rad.get(j).copied().unwrap_or_default();
            let turn = match secret.kind {
                Kind::JointZero => amount,
                Kind::JointScale => amount * motor,
                // The encoder sees the sum of the joint's direction and of the magnet's place: a triangle.
                Kind::JointEccentricity => (amount * (motor - secret.magnet_rad()).sin()).asin(),
                Kind::JointCoupling => amount * moment.motors_rad[secret.puller(self.robot.len())],
                Kind::Backlash => -0.5 * amount * moment.way[j],
                Kind::SlippedHorn if moment.over >= secret.when => amount,
                Kind::ServoWarmUp => amount * moment.warm,
                Kind::GearTrain => amount * (WAVES * motor + secret.shape[0] * 3.0).sin(),
                Kind::CableStep if motor > 0.5 * secret.shape[0] => amount,
                Kind::Hysteresis => {
                    -amount * ((motor - moment.from_rad[j]) / REMEMBERED_RAD).clamp(-1.0, 1.0)
                }
                Kind::FarCable => amount * moment.motors_rad[secret.far_joint(self.robot.len())].powi(2),
                _ => 0.0,
            };
            if secret.kind.is_of_joint() {
                angles[j] += turn;
            }
        }
        angles
    }

    fn springs(&self, moment: &Moment) -> Vec<Spring> {
        let mut springs = vec![];
        for secret in self.secrets {
            let j = secret.joint;
            let axis = self.robot.parts.get(j).map_or_else(Vector3::x, |part| part.axis);
            let mut seat = |seat, axis, compliance| springs.push(Spring { seat, axis, compliance });
            match secret.kind {
                Kind::JointSag => seat(Seat::Behind(j), axis, secret.amount),
                Kind::SoftWhenWarm => seat(Seat::Behind(j), axis, secret.amount * moment.warm),
                Kind::SidewaysGive => {
                    across(&axis).into_iter().for_each(|side| seat(Seat::Before(j), side, secret.amount));
                }
                Kind::TorsoLean => {
                    [Vector3::x(), Vector3::y()]
                        .into_iter()
                        .for_each(|side| seat(Seat::Base, side, secret.amount));
                }
                Kind::LinkBending => {
                    let way = self.places[j].translation.vector;
                    let share = 1.0 / PIECES as f64;
                    // A beam whose end goes by `amount` per newton turns by so much per newton meter and piece.
                    let compliance = 3.0 * secret.amount / way.norm_squared() * share;
                    for piece in 0..PIECES {
                        let at = (piece as f64 + 0.5) * share;
                        across(&way.normalize())
                            .into_iter()
                            .for_each(|side| seat(Seat::Along(j, at), side, compliance));
                    }
                }
                _ => {}
            }
        }
        springs
    }

    /// How far springs turn under gravity, rad.
    fn balance(&self, angles: &[f64], springs: &[Spring], payload_kg: f64) -> Vec<f64> {
        let mut bent = vec![0.0; springs.len()];
        for _ in 0..60 {
            let mut moved: f64 = 0.0;
            for i in 0..springs.len() {
                let energy = |turn_rad: f64| {
                    let mut turned = bent.clone();
                    turned[i] += turn_rad;
                    self.energy(angles, springs, &turned, payload_kg)
                };
                let torque_nm = -(energy(VIRTUAL_RAD) - energy(-VIRTUAL_RAD)) / (2.0 * VIRTUAL_RAD);
                let turned = springs[i].compliance * torque_nm;
                moved = moved.max((turned - bent[i]).abs());
                bent[i] = turned;
            }
            if moved < BALANCED_RAD {
                break;
            }
        }
        bent
    }

    /// Energy of height, J.
    fn energy(&self, angles: &[f64], springs: &[Spring], bent: &[f64], payload_kg: f64) -> f64 {
        let (centers, marker) = self.walk(angles, springs, bent);
        let links: f64 =
            centers.iter().zip(&self.masses_kg).map(|(center, mass_kg)| mass_kg * center.z).sum();
        GRAVITY * (links + payload_kg * marker.translation.z)
    }

    /// Centers of the links, and the marker.
    fn walk(&self, angles: &[f64], springs: &[Spring], bent: &[f64]) -> (Vec<Point3<f64>>, Isometry3<f64>) {
        let turned = |at: Isometry3<f64>, seated: &dyn Fn(Seat) -> bool| {
            springs
                .iter()
                .zip(bent)
                .filter(|(spring, _)| seated(spring.seat))
                .fold(at, |at, (spring, bent)| at * UnitQuaternion::from_scaled_axis(spring.axis * *bent))
        };
        let mut at = turned(Isometry3::identity(), &|seat| seat == Seat::Base);
        let mut centers = vec![];
        for (j, (part, place)) in self.robot.parts.iter().zip(&self.places).enumerate() {
            let way = place.translation.vector;
            let mut gone = 0.0;
            for (spring, bent) in springs.iter().zip(bent) {
                let Seat::Along(of, share) = spring.seat else { continue };
                if of == j {
                    at *= Translation3::from(way * (share - gone));
                    at *= UnitQuaternion::from_scaled_axis(spring.axis * *bent);
                    gone = share;
                }
            }
            at *= Translation3::from(way * (1.0 - gone));
            at *= place.rotation;
            at = turned(at, &|seat| seat == Seat::Before(j));
            at *= part.moved(angles[j]);
            at = turned(at, &|seat| seat == Seat::Behind(j));
            centers.push(at * Point3::from(part.center_m));
        }
        (centers, at * self.last_from_marker)
    }
}

/// Two directions across one.
fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let a = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    [a, axis.cross(&a)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arms::robot::Part;

    /// A bar along x on a joint about y: held level, its end sinks.
    fn bar(secret: Secret) -> f64 {
        let part = |x: f64, mass_kg: f64| Part {
            shift_m: Vector3::new(x, 0.0, 0.0),
            turn_rad: [0.0; 3],
            axis: Vector3::y(),
            center_m: Vector3::zeros(),
            mass_kg,
            slides: false,
        };
        let robot =
            Robot { parts: vec![part(0.0, 0.0), part(0.5, 0.0)], marker: (Vector3::zeros(), [0.0; 3]) };
        let moment = Moment {
            motors_rad: vec![0.0; 2],
            way: vec![1.0; 2],
            from_rad: vec![0.0; 2],
            over: 0.5,
            warm: 1.0,
            payload_kg: 1.0 / GRAVITY,
        };
        let body = Body::new(&robot, std::slice::from_ref(&secret), &[1.0; 2], &Isometry3::identity());
        body.base_from_marker(&moment).translation.z
    }

    fn secret(kind: Kind, joint: usize, amount: f64) -> Secret {
        Secret { kind, joint, amount, shape: [1.0, 0.0, 0.0], when: 0.4 }
    }

    #[test]
    fn one_newton_at_half_a_meter_bends_as_beams_and_springs_do() {
        let sag = bar(secret(Kind::JointSag, 0, 0.01));
        assert!((sag + 0.5 * 0.005).abs() < 1e-6, "{sag}");
        // L³/3EI, up to what six pieces are coarser than a beam (one part in four times their square).
        let bend = bar(secret(Kind::LinkBending, 1, 1e-4));
        assert!((bend / -1e-4 - 1.0).abs() < 0.01, "{bend}");
        let fall = bar(secret(Kind::GravityBacklash, 0, 0.01));
        assert!((fall + 0.5 * 0.005).abs() < 1e-6, "{fall}");
    }

    #[test]
    fn a_magnet_beside_the_axis_swings_once_per_turn_as_the_answer_says() {
        let secret = Secret { shape: [0.6, 0.8, 0.0], ..secret(Kind::JointEccentricity, 0, -0.02) };
        let robot = Robot {
            parts: vec![Part {
                shift_m: Vector3::zeros(),
                turn_rad: [0.0; 3],
                axis: Vector3::z(),
                center_m: Vector3::zeros(),
                mass_kg: 0.0,
                slides: false,
            }],
            marker: (Vector3::x(), [0.0; 3]),
        };
        let told = secret.told(&robot, 1.0).parameters;
        let body = Body::new(&robot, std::slice::from_ref(&secret), &[1.0], &Isometry3::identity());
        for motor in [-2.0, -0.5, 0.3, 1.7] {
            let moment = Moment {
                motors_rad: vec![motor],
                way: vec![1.0],
                from_rad: vec![0.0],
                over: 0.0,
                warm: 0.0,
                payload_kg: 0.0,
            };
            let at = body.base_from_marker(&moment).translation.vector;
            let said = motor + told["amplitude_rad"] * (motor + told["phase_rad"]).sin();
            assert!((at.y.atan2(at.x) - said).abs() < 1e-5, "{motor}");
        }
    }
}

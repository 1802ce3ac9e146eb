//! A session of poses: where the arm goes, what encoders and tracker say.

use nalgebra::{DMatrix, DVector, Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use plumbline_model::Point;
use plumbline_model::session::PoseRow;
use rand::Rng;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;

use super::body::{Body, Moment};
use super::robot::Robot;
use super::secret::{Kind, Secret};
use crate::answer::Plan;
use crate::heat;
use crate::physics::normal;

/// From one pose to the next, s.
pub(super) const PACE_S: f64 = 7.0;
/// The robot has been on for so long at the first pose, s.
const START_S: f64 = 30.0;
/// Poses are drawn so far to either side of zero, rad.
pub(super) const SWING_RAD: f64 = 1.7;
/// Friction stops servos short of their goals by at most this, and encoders see it, rad.
const SHORT_RAD: f64 = 6e-4;
/// Spread of a joint about what its encoder says, rad.
const JOINT_RAD: f64 = 2e-4;
/// A step of an encoder, rad.
const TICK_RAD: f64 = std::f64::consts::TAU / 16384.0;
/// A weight on some poses of the rich plan, kg.
const PAYLOAD_KG: f64 = 0.5;

/// A pose that is measured once or several times.
#[derive(Clone, Debug)]
pub struct Cell {
    pub goals_rad: Vec<f64>,
    /// Speed at the end of the motion, rad/s of each joint (m/s of what slides).
    pub speed_rad_s: Vec<f64>,
    /// Side from which all joints arrive; none: wherever they were.
    pub side: Option<f64>,
    pub payload_kg: f64,
    /// Encoders are read once more when the joints have arrived.
    pub later: bool,
    pub set: String,
}

/// A visit to a cell.
#[derive(Clone, Debug)]
pub struct Visit {
    pub cell: usize,
    /// The cell before.
    pub from: usize,
    pub t_secs: f64,
    /// Share of the first session that is over; more than one in a later one.
    pub over: f64,
}

/// All that is the same whether something is hidden or not.
#[derive(Clone)]
pub struct Setup {
    pub robot: Robot,
    pub cells: Vec<Cell>,
    pub visits: Vec<Visit>,
    pub mass_factors: Vec<f64>,
    /// Whether orientations are measured.
    pub oriented: bool,
    /// Where the marker sits beside its described place, if nobody knows it.
    pub unknown_mount: Option<Isometry3<f64>>,
    pub external_from_base: Isometry3<f64>,
    /// Noise of the tracker, m and rad.
    pub noise: [f64; 2],
    pub is_repeated: bool,
    /// Before the names of repeated poses: those of another session are others.
    pub label: String,
    /// The first session is over, s.
    pub end_s: f64,
}

/// What one visit gives: what was sent, read and measured.
pub struct Met {
    pub cell: usize,
    pub encoder_rad: Vec<f64>,
    /// The marker in the frame of the base.
    pub base_from_marker: Isometry3<f64>,
    pub t_secs: f64,
}

/// What chance does in a visit; nothing where there is none.
pub type Chance<'a> = Option<&'a mut StdRng>;

impl Setup {
    /// Drawn by chance.
    pub fn drawn(plan: Plan, is_repeated: bool, random: &mut StdRng) -> Self {
        let robot = Robot::drawn(random);
        let is_rich = plan == Plan::Rich;
        let poses = if is_rich { 50 } else { 60 };
        let mut cells = vec![];
        for pose in 0..poses {
            let mut drawn =
                |low: f64, high: f64| (0..robot.len()).map(|_| random.random_range(low..high)).collect();
            let (mut goals_rad, mut speed_rad_s): (Vec<f64>, Vec<f64>) =
                (drawn(-SWING_RAD, SWING_RAD), drawn(0.2, 1.0));
            for (j, part) in robot.parts.iter().enumerate() {
                goals_rad[j] *= part.stroke();
                speed_rad_s[j] *= part.stroke();
            }
            let payload_kg = if is_rich && random.random_bool(0.3) { PAYLOAD_KG } else { 0.0 };
            let set = format!("part {}", 1 + pose % 5);
            let sides: &[Option<f64>] = if is_rich { &[Some(1.0), Some(-1.0)] } else { &[None] };
            cells.extend(sides.iter().map(|side| Cell {
                goals_rad: goals_rad.clone(),
                speed_rad_s: speed_rad_s.clone(),
                side: *side,
                payload_kg,
                later: false,
                set: set.clone(),
            }));
        }
        let mut visits = visits(cells.len(), if is_repeated { 3 } else { 1 }, START_S, random);
        let end_s = visits.last().map_or(1.0, |visit| visit.t_secs);
        visits.iter_mut().for_each(|visit| visit.over = visit.t_secs / end_s);
        let mut within = |most: f64| random.random_range(-most..most);
        let external_from_base = Isometry3::from_parts(
            Translation3::new(within(2.0), within(2.0), within(1.0)),
            UnitQuaternion::from_scaled_axis(Vector3::new(within(1.8), within(1.8), within(1.8))),
        );
        let beside = Isometry3::from_parts(
            Translation3::new(within(0.03), within(0.03), within(0.03)),
            UnitQuaternion::from_scaled_axis(Vector3::new(within(0.3), within(0.3), within(0.3))),
        );
        let mass_factors = robot.parts.iter().map(|_| random.random_range(0.85..1.2)).collect();
        Self {
            cells,
            mass_factors,
            oriented: random.random_bool(0.5),
            unknown_mount: random.random_bool(0.5).then_some(beside),
            external_from_base,
            noise: [random.random_range(1.5e-4..6e-4), random.random_range(4e-4..1.5e-3)],
            is_repeated,
            label: String::new(),
            end_s,
            visits,
            robot,
        }
    }

    /// Where the marker sits beside its described place.
    pub fn mount(&self) -> Isometry3<f64> {
        self.unknown_mount.unwrap_or_else(Isometry3::identity)
    }

    /// All visits, or those that are given, with these secrets.
    pub fn measure(&self, secrets: &[Secret], visits: &[Visit], mut chance: Chance<'_>) -> Vec<Met> {
        let body = Body::new(&self.robot, secrets, &self.mass_factors, &self.mount());
        visits
            .iter()
            .map(|visit| {
                let (cell, from) = (&self.cells[visit.cell], &self.cells[visit.from]);
                let mut draw = || chance.as_mut().map_or(0.0, |random| normal(random));
                let way: Vec<f64> = cell
                    .goals_rad
                    .iter()
                    .zip(&from.goals_rad)
                    .map(|(to, from)| cell.side.unwrap_or_else(|| (to - from).signum()))
                    .collect();
                let early_s: f64 = secrets
                    .iter()
                    .filter(|secret| secret.kind == Kind::EarlyLog && !cell.later)
                    .map(|secret| secret.amount)
                    .sum();
                let (mut motors_rad, mut encoder_rad) = (vec![], vec![]);
                for (j, way) in way.iter().enumerate() {
                    let stroke = self.robot.parts[j].stroke();
                    let short_rad = stroke * SHORT_RAD * (0.5 + 0.25 * draw()).clamp(0.0, 1.0);
                    let stands = cell.goals_rad[j] - way * short_rad;
                    motors_rad.push(stands + stroke * JOINT_RAD * draw());
                    let left_rad = early_s * cell.speed_rad_s[j] * (1.0 + 0.08 * draw());
                    let tick_rad = stroke * TICK_RAD;
                    encoder_rad.push(((stands - way * left_rad) / tick_rad).round() * tick_rad);
                }
                let moment = Moment {
                    motors_rad,
                    way,
                    from_rad: from.goals_rad.clone(),
                    over: visit.over,
                    warm: heat::after(visit.t_secs).1,
                    payload_kg: cell.payload_kg,
                };
                let base_from_marker = sway(secrets, moment.over) * body.base_from_marker(&moment);
                let noisy = Isometry3::from_parts(
                    Translation3::from(Vector3::from_fn(|_, _| self.noise[0] * draw())),
                    UnitQuaternion::from_scaled_axis(Vector3::from_fn(|_, _| self.noise[1] * draw())),
                );
                let base_from_marker = Isometry3::from_parts(
                    Translation3::from(base_from_marker.translation.vector + noisy.translation.vector),
                    noisy.rotation * base_from_marker.rotation,
                );
                Met { cell: visit.cell, encoder_rad, base_from_marker, t_secs: visit.t_secs }
            })
            .collect()
    }

    /// What the tracker says beyond the description: place, and turn where it is measured, frame of the base.
    pub fn residual(&self, met: &Met) -> Vec<f64> {
        let described = self.described(&met.encoder_rad);
        let off_m = met.base_from_marker.translation.vector - described.translation.vector;
        let turn = (met.base_from_marker.rotation * described.rotation.inverse()).scaled_axis();
        if self.oriented { [off_m.as_slice(), turn.as_slice()].concat() } else { off_m.as_slice().to_vec() }
    }

    /// The marker as described, mounted as it is.
    fn described(&self, angles_rad: &[f64]) -> Isometry3<f64> {
        let last = self
            .robot
            .parts
            .iter()
            .zip(angles_rad)
            .fold(Isometry3::identity(), |at, (part, angle)| at * part.place() * part.moved(*angle));
        last * self.robot.last_from_marker() * self.mount()
    }

    /// What changes with the frame of the tracker, and with the place of a marker that nobody knows: a column each.
    pub fn unknown(&self, met: &[Met], sigma: &[f64]) -> DMatrix<f64> {
        let each = sigma.len();
        let columns = 6 + if self.unknown_mount.is_none() { 0 } else { each };
        let mut unknown = DMatrix::zeros(each * met.len(), columns);
        for (row, met) in met.iter().enumerate() {
            let at = self.described(&met.encoder_rad);
            for k in 0..columns {
                let axis = Vector3::ith(k % 3, 1.0);
                let turned = at.rotation * axis;
                let (shift, turn) = match k / 3 {
                    0 => (axis, Vector3::zeros()),
                    1 => (axis.cross(&at.translation.vector), axis),
                    2 => (turned, Vector3::zeros()),
                    _ => (Vector3::zeros(), turned),
                };
                for (c, value) in shift.iter().chain(&turn).take(each).enumerate() {
                    unknown[(each * row + c, k)] = value / sigma[c];
                }
            }
        }
        unknown
    }

    /// What two sets of visits differ by, in sigmas.
    pub fn moved(&self, with: &[Met], without: &[Met], sigma: &[f64]) -> DVector<f64> {
        let pairs = with.iter().zip(without);
        let moved = pairs.flat_map(|(with, without)| {
            let (a, b) = (self.residual(with), self.residual(without));
            (0..sigma.len()).map(|c| (a[c] - b[c]) / sigma[c]).collect::<Vec<_>>()
        });
        DVector::from_iterator(sigma.len() * with.len(), moved)
    }

    /// As it is written.
    pub fn row(&self, met: &Met) -> PoseRow {
        let cell = &self.cells[met.cell];
        let measured = self.external_from_base * met.base_from_marker;
        let at: Point3<f64> = measured.translation.vector.into();
        // Devices give either sign of a quaternion.
        let sign = if met.cell.is_multiple_of(2) { 1.0 } else { -1.0 };
        let turn = UnitQuaternion::new_unchecked(Quaternion::from(measured.rotation.coords * sign));
        let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        PoseRow {
            commanded_rad: some(&cell.goals_rad),
            encoder_rad: some(&met.encoder_rad),
            measured: Some(Point::new(at.x, at.y, at.z)),
            orientation: self.oriented.then_some(turn),
            payload_kg: Some(cell.payload_kg),
            t_secs: Some((met.t_secs * 10.0).round() / 10.0),
            group: self.is_repeated.then(|| format!("{}pose {}", self.label, met.cell + 1)),
            approach: cell.side.map(|side| if side > 0.0 { "plus" } else { "minus" }.to_owned()),
            set: Some(cell.set.clone()),
            ..PoseRow::default()
        }
    }
}

/// An order drawn by chance, so that time goes with nothing else, from a moment on; how much of the session is over is
/// not known yet.
pub(super) fn visits(cells: usize, repeats: usize, start_s: f64, random: &mut StdRng) -> Vec<Visit> {
    let mut order: Vec<usize> = (0..cells).flat_map(|cell| vec![cell; repeats]).collect();
    order.shuffle(random);
    let mut t_secs = start_s;
    (0..order.len())
        .map(|i| {
            t_secs += PACE_S * random.random_range(0.8..1.2);
            Visit { cell: order[i], from: order[i.saturating_sub(1)], t_secs, over: 0.0 }
        })
        .collect()
}

/// How a tripod that gives moves what the tracker says, frame of the base.
fn sway(secrets: &[Secret], over: f64) -> Isometry3<f64> {
    secrets.iter().filter(|secret| secret.kind == Kind::Tripod).fold(Isometry3::identity(), |at, secret| {
        let phase = std::f64::consts::TAU * (over * (1.4 + secret.when) + secret.shape[2]);
        let shift = Vector3::new(secret.shape[0], secret.shape[1], 0.0) * (secret.amount * phase.sin());
        let turn =
            UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, secret.amount * (1.7 * phase).sin()));
        Isometry3::from_parts(Translation3::from(shift), turn) * at
    })
}

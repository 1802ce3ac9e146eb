//! Sessions made with the own forward model.

use nalgebra::{DVector, Vector3};
use plumbline_effects::measurements::{Apparatus, Measurements, Observation, What};
use plumbline_effects::{Assumed, Effect, Kind, Present, Surface};
use plumbline_model::Unattended;
use plumbline_model::robot::Rig;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use crate::floor::{Floor, KindFloor};
use crate::options::Options;
use crate::search::field::Framed;
use crate::search::library::Library;
use crate::search::linear::Linear;

const TIP: &str = "right_index_tip";
const START: [f64; 6] = [-0.2, 1.1, 0.5, 1.7, -0.3, 0.2];
/// Noise of one touch: along the glass and in height, m.
const NOISE_M: [f64; 3] = [1.0e-3, 1.0e-3, 0.7e-3];
const PIXEL_M: f64 = 0.475 / 1920.0;
const TICK_RAD: f64 = std::f64::consts::TAU / 4096.0;

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plan {
    /// 40 places, four times, one side, one height.
    Plain,
    /// 60 places, three times, two sides, three heights, varied posture, with and without weight.
    Rich,
}

/// What is wrong.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Sizes of effects of the library, floors.
    pub sizes: Vec<f64>,
    /// Something else of this size.
    pub other: Option<(Other, f64)>,
    /// Small effects of everything.
    pub dirt: bool,
}

/// Something that is in no library.
#[derive(Clone, Copy, Debug)]
pub enum Other {
    /// A joint jumps at an angle.
    Step,
    /// A joint ripples, a few times per turn.
    Ripple,
    /// A joint turns with something that was not logged, slowly changing.
    Hidden,
    /// A joint lags by its direction, more in the middle of its range.
    Loop,
}

impl Truth {
    pub fn null() -> Self {
        Self { sizes: vec![], other: None, dirt: true }
    }
    fn of(sizes: &[f64]) -> Self {
        Self { sizes: sizes.to_vec(), other: None, dirt: true }
    }
    fn other(other: Other, size: f64) -> Self {
        Self { sizes: vec![], other: Some((other, size)), dirt: true }
    }
}

pub fn menu() -> Vec<(&'static str, Truth)> {
    vec![
        ("null", Truth::null()),
        ("single 0.5", Truth::of(&[0.5])),
        ("single 1", Truth::of(&[1.0])),
        ("single 2", Truth::of(&[2.0])),
        ("single 5", Truth::of(&[5.0])),
        ("pair 2", Truth::of(&[2.0, 2.0])),
        ("pair 4 1", Truth::of(&[4.0, 1.0])),
        ("triple", Truth::of(&[4.0, 2.0, 2.0])),
        ("off step", Truth::other(Other::Step, 2.0)),
        ("off ripple", Truth::other(Other::Ripple, 2.0)),
        ("off hidden", Truth::other(Other::Hidden, 2.0)),
        ("off loop", Truth::other(Other::Loop, 2.0)),
    ]
}

/// A plan with its nominal rows.
pub struct Bench {
    nominal: Measurements,
    library: Library,
    framed: Framed,
}

impl Bench {
    pub fn new(plan: Plan) -> Self {
        let nominal = nominal(plan);
        let library = Library::of(&nominal, &Options::default());
        let linear =
            Linear::of(&nominal, &floor(), &Assumed::nominal(&nominal), &library.effects, &Unattended)
                .expect("never cancelled");
        let sums = linear.sums(&vec![1.0; nominal.rows.len()]);
        let framed = Framed::of(&sums, 0.0, &DVector::zeros(library.columns)).expect("frames can be fitted");
        Self { nominal, library, framed }
    }

    /// A case: rows, their floor as repeats show it, and the effects that are in it. `None` when
    /// such an effect would have to be implausibly large.
    pub fn case(&self, truth: &Truth, seed: u64) -> Option<(Measurements, Floor, Vec<Effect>)> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut present: Vec<Present> = vec![];
        let mut answer: Vec<Effect> = vec![];
        for size in &truth.sizes {
            let chosen = self.draw(*size, &present, &mut random)?;
            answer.push(chosen.effect.clone());
            present.push(chosen);
        }
        if truth.dirt {
            for _ in 0..6 {
                let size = random.random_range(0.02..0.2);
                present.extend(self.draw(size, &present, &mut random));
            }
        }
        self.made(present, answer, truth.other, &mut random)
    }

    /// A case with one effect of this value.
    pub fn certain(
        &self,
        id: &str,
        site: &str,
        value: f64,
        seed: u64,
    ) -> Option<(Measurements, Floor, Vec<Effect>)> {
        let effect =
            self.library.effects.iter().find(|effect| effect.id() == id && effect.site == site)?.clone();
        let present = vec![Present { effect: effect.clone(), values: vec![value] }];
        self.made(present, vec![effect], None, &mut StdRng::seed_from_u64(seed))
    }

    /// Gives each cell the residuals of another one.
    pub fn permute(&self, measurements: &mut Measurements, seed: u64) {
        let mut random = StdRng::seed_from_u64(seed);
        let assumed = Assumed::nominal(measurements);
        let repeats = measurements.rows.iter().filter(|row| row.cell == 0).count();
        let residuals: Vec<Vec<f64>> = measurements
            .rows
            .iter()
            .map(|row| {
                let predicted = measurements.predict(row, &assumed).expect("predictable");
                row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect()
            })
            .collect();
        let cells = residuals.len() / repeats;
        let mut order: Vec<usize> = (0..cells).collect();
        for k in (1..cells).rev() {
            order.swap(k, random.random_range(0..=k));
        }
        for i in 0..residuals.len() {
            let predicted = measurements.predict(&measurements.rows[i], &assumed).expect("predictable");
            let from = &residuals[order[i / repeats] * repeats + i % repeats];
            for c in 0..3 {
                measurements.rows[i].measured[c] = predicted[c] + from[c];
            }
        }
    }

    /// An effect at random, by kind first, of this size (floors).
    fn draw(&self, size: f64, present: &[Present], random: &mut StdRng) -> Option<Present> {
        for _ in 0..200 {
            let kinds: std::collections::BTreeSet<Kind> =
                self.library.effects.iter().map(|effect| effect.kind).collect();
            let kind = *kinds.iter().nth(random.random_range(0..kinds.len()))?;
            let own: Vec<usize> =
                (0..self.library.effects.len()).filter(|&i| self.library.effects[i].kind == kind).collect();
            let place = own[random.random_range(0..own.len())];
            let effect = &self.library.effects[place];
            if present.iter().any(|other| other.effect.name() == effect.name())
                || matches!(kind, Kind::BaseTilt | Kind::ScreenTilt)
            {
                continue;
            }
            let block = &self.library.blocks[place];
            let values = DVector::from_fn(block.len, |_, _| normal(random));
            let a = self.framed.a.view((block.start, block.start), (block.len, block.len));
            let lines = 3.0 * self.nominal.rows.len() as f64;
            let now = (values.dot(&(a * &values)).max(0.0) / lines).sqrt();
            if now < 1e-6 {
                continue;
            }
            let values = values * (size / now);
            if values.amax() > 3.0 {
                continue;
            }
            let values = values.iter().zip(effect.parameters()).map(|(v, p)| v * p.typical).collect();
            return Some(Present { effect: effect.clone(), values });
        }
        None
    }

    fn made(
        &self,
        effects: Vec<Present>,
        answer: Vec<Effect>,
        other: Option<(Other, f64)>,
        random: &mut StdRng,
    ) -> Option<(Measurements, Floor, Vec<Effect>)> {
        let mut made = self.nominal.clone();
        let moved = random_place(random);
        let truth = Assumed { effects, placements: vec![moved; 1] };
        let joint = random.random_range(1..5);
        let (mut wander, mut phase) = (0.0, random.random_range(0.0..6.0));
        let angles: Vec<f64> = made.rows.iter().map(|row| row.angles_rad()[joint]).collect();
        let (low, high) = angles.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        // A floor is about 1 mm, a joint moves the tip by about 0.35 m/rad.
        let turn_rad = other.map_or(0.0, |(_, size)| size * 1.2e-3 / 0.3);
        for i in 0..made.rows.len() {
            if i % 4 == 0 {
                wander = 0.7 * wander + 0.7 * normal(random);
            }
            phase += 0.0;
            let mut row = made.rows[i].clone();
            let share = (row.angles_rad()[joint] - low) / (high - low);
            let extra = match other.map(|(other, _)| other) {
                None => 0.0,
                Some(Other::Step) => 2.0 * f64::from(u8::from(share > 0.55)),
                Some(Other::Ripple) => 1.6 * (row.angles_rad()[joint] * 17.0 + phase).sin(),
                Some(Other::Hidden) => wander * 1.4,
                Some(Other::Loop) => {
                    2.0 * row.direction[joint] * (1.0 - (2.0 * share - 1.0).powi(2)) - share * share
                }
            } * turn_rad;
            let height = NOISE_M[2] * normal(random);
            let seen = touch(&made, &mut row, &truth, (joint, extra), height)?;
            for c in 0..2 {
                let noisy = seen[c] + NOISE_M[c] * normal(random);
                row.measured[c] = (noisy / PIXEL_M).round() * PIXEL_M;
            }
            made.rows[i] = row;
        }
        let floor = repeats(&made);
        Some((made, floor, answer))
    }
}

/// Moves the arm until the true tip is on the glass; angles are logged in ticks.
fn touch(
    made: &Measurements,
    row: &mut Observation,
    truth: &Assumed,
    (joint, extra): (usize, f64),
    height_m: f64,
) -> Option<Vec<f64>> {
    let mut angles = row.angles_rad().to_vec();
    let mut seen = vec![];
    for _ in 0..4 {
        let at = |angles: &[f64]| {
            let mut shifted = row.clone();
            let mut angles = angles.to_vec();
            angles[joint] += extra;
            shifted.encoder_rad = Some(angles);
            made.predict(&shifted, truth)
        };
        seen = at(&angles)?;
        let gradient: Vec<f64> = (0..angles.len())
            .map(|j| {
                let mut ahead = angles.clone();
                ahead[j] += 1e-4;
                Some((at(&ahead)?[2] - seen[2]) / 1e-4)
            })
            .collect::<Option<_>>()?;
        let square: f64 = gradient.iter().map(|g| g * g).sum();
        let step = (height_m - seen[2]) / square;
        angles.iter_mut().zip(&gradient).for_each(|(angle, g)| *angle += step * g);
    }
    row.commanded_rad = Some(row.angles_rad().to_vec());
    row.encoder_rad = Some(angles.iter().map(|angle| (angle / TICK_RAD).round() * TICK_RAD).collect());
    row.commanded_rad = row.encoder_rad.clone();
    Some(seen)
}

fn random_place(random: &mut StdRng) -> nalgebra::Isometry3<f64> {
    let mut vector = |scale: f64| Vector3::from_fn(|_, _| scale * normal(random));
    nalgebra::Isometry3::new(vector(0.005), vector(0.01))
}

fn normal(random: &mut StdRng) -> f64 {
    let (a, b): (f64, f64) = (random.random_range(f64::MIN_POSITIVE..1.0), random.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

fn floor() -> Floor {
    let kind = KindFloor { what: What::Touch, sd: NOISE_M.to_vec(), degrees_of_freedom: 120.0 };
    Floor { kinds: vec![kind], from_repeats: true }
}

/// Spread of residuals about the mean of their cell.
fn repeats(made: &Measurements) -> Floor {
    let assumed = Assumed::nominal(made);
    let mut cells = std::collections::HashMap::<usize, Vec<Vec<f64>>>::new();
    for row in &made.rows {
        let predicted = made.predict(row, &assumed).expect("predictable");
        let residual = row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
        cells.entry(row.cell).or_default().push(residual);
    }
    let free = (made.rows.len() - cells.len()) as f64;
    let mut sums = [0.0; 3];
    for rows in cells.values() {
        for (c, sum) in sums.iter_mut().enumerate() {
            let mean = rows.iter().map(|row| row[c]).sum::<f64>() / rows.len() as f64;
            *sum += rows.iter().map(|row| (row[c] - mean).powi(2)).sum::<f64>();
        }
    }
    let sd = sums.iter().map(|sum| (sum / free).sqrt()).collect();
    Floor { kinds: vec![KindFloor { what: What::Touch, sd, degrees_of_freedom: free }], from_repeats: true }
}

/// Rows that touch where the nominal model says.
fn nominal(plan: Plan) -> Measurements {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let arm = plumbline_effects::arm::Arm::of_rig(&rig, TIP).expect("a tip of the rig");
    let surface = Surface::of(&rig.touchscreen);
    let apparatus = Apparatus {
        title: "made".to_owned(),
        tip: None,
        arm: Some(arm.clone()),
        surface: Some(surface.clone()),
        eyes: None,
    };
    let mut random = StdRng::seed_from_u64(42);
    let (cells, repeats) = match plan {
        Plan::Plain => (40, 4),
        Plan::Rich => (60, 3),
    };
    let mut rows = vec![];
    for cell in 0..cells {
        let rich = plan == Plan::Rich;
        let height_m = if rich { 0.06 * (cell % 3) as f64 } else { 0.0 };
        let payload_kg = if rich && (cell / 3) % 2 == 1 { 0.25 } else { 0.0 };
        let side = if rich && (cell / 6) % 2 == 1 { -1.0 } else { 1.0 };
        let angles = loop {
            let goal = [random.random_range(-0.19..0.1), random.random_range(-0.11..0.11)];
            let spread = if rich { 0.35 } else { 0.02 };
            let start = START.map(|angle| angle + spread * normal(&mut random));
            if let Some(angles) = reach(&arm, &surface, goal, height_m, &start) {
                break angles;
            }
        };
        for _ in 0..repeats {
            rows.push(Observation {
                session: 0,
                row: rows.len(),
                what: What::Touch,
                measured: vec![0.0; 3],
                commanded_rad: Some(angles.clone()),
                encoder_rad: Some(angles.clone()),
                direction: vec![side; 6],
                payload_kg,
                screen_height_m: height_m,
                t_secs: None,
                move_secs: None,
                hold_secs: None,
                speed_rad_s: None,
                torque_nm: None,
                temperature_c: None,
                neck_rad: vec![],
                truth_m: None,
                background_m: None,
                object: None,
                cell,
                set: None,
                approach: Some(if side > 0.0 { "plus" } else { "minus" }.to_owned()),
            });
        }
    }
    Measurements {
        rig: "nico".to_owned(),
        apparatuses: vec![apparatus],
        rows,
        left_out: vec![],
        present: vec![],
    }
}

/// Angles near `start` that put the tip on the glass.
fn reach(
    arm: &plumbline_effects::arm::Arm,
    surface: &Surface,
    goal_m: [f64; 2],
    height_m: f64,
    start: &[f64; 6],
) -> Option<Vec<f64>> {
    let none = plumbline_effects::arm::Deviation::none(6);
    let at = |angles: &[f64]| surface.touch_m(arm.tip_m(angles, &none), height_m, &none);
    let goal = Vector3::new(goal_m[0], goal_m[1], 0.0);
    let mut angles = start.to_vec();
    for _ in 0..60 {
        let now = at(&angles);
        let miss = goal - now;
        if miss.norm() < 1e-7 {
            let near = angles.iter().zip(start).all(|(a, b)| (a - b).abs() < 1.0);
            return near.then_some(angles);
        }
        let jacobian = nalgebra::Matrix3xX::from_fn(6, |r, c| {
            let mut ahead = angles.clone();
            ahead[c] += 1e-5;
            (at(&ahead) - now)[r] / 1e-5
        });
        let inner = &jacobian * jacobian.transpose() + nalgebra::Matrix3::identity() * 1e-4;
        let step = jacobian.transpose() * (inner.try_inverse()? * miss);
        angles.iter_mut().zip(step.iter()).for_each(|(angle, step)| *angle += step.clamp(-0.3, 0.3));
    }
    None
}

//! Sessions made with the own forward model.

use nalgebra::{DVector, Vector3};
use plumbline_effects::measurements::{Apparatus, Measurements, Observation, What};
use plumbline_effects::{Assumed, Kind, Present, Surface};
use plumbline_model::Unattended;
use plumbline_model::robot::Rig;
use plumbline_model::robot::servo::TICK_RAD;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use crate::finding::FloorSource;
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

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plan {
    /// 40 places, four times, one side, one height.
    Plain,
    /// 60 places, three times, two sides, three heights, varied posture, with and without weight.
    Rich,
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
        let library = Library::of(&nominal, &floor(), &Options::default());
        let linear =
            Linear::of(&nominal, &floor(), &Assumed::nominal(&nominal), &library.effects, &Unattended)
                .expect("never cancelled");
        let sums = linear.sums(&vec![1.0; nominal.rows.len()], &Unattended).expect("never cancelled");
        let framed = Framed::of(&sums, 0.0, &DVector::zeros(library.columns), &Unattended)
            .expect("never cancelled")
            .expect("frames can be fitted");
        Self { nominal, library, framed }
    }

    /// A case with small effects of everything: rows, and their floor as repeats show it.
    pub fn case(&self, seed: u64) -> Option<(Measurements, Floor)> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut present: Vec<Present> = vec![];
        for _ in 0..6 {
            let size = random.random_range(0.02..0.2);
            present.extend(self.draw(size, &present, &mut random));
        }
        self.made(present, &mut random)
    }

    /// A case with one effect of this value.
    pub fn certain(&self, id: &str, site: &str, value: f64, seed: u64) -> Option<(Measurements, Floor)> {
        let effect =
            self.library.effects.iter().find(|effect| effect.id() == id && effect.site == site)?.clone();
        self.made(vec![Present { effect, values: vec![value] }], &mut StdRng::seed_from_u64(seed))
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

    fn made(&self, effects: Vec<Present>, random: &mut StdRng) -> Option<(Measurements, Floor)> {
        let mut made = self.nominal.clone();
        let truth = Assumed { effects, placements: vec![random_place(random)], ..Assumed::default() };
        for i in 0..made.rows.len() {
            let mut row = made.rows[i].clone();
            let seen = touch(&made, &mut row, &truth, NOISE_M[2] * normal(random))?;
            for c in 0..2 {
                let noisy = seen[c] + NOISE_M[c] * normal(random);
                row.measured[c] = (noisy / PIXEL_M).round() * PIXEL_M;
            }
            made.rows[i] = row;
        }
        let floor = repeats(&made);
        Some((made, floor))
    }
}

/// Moves the arm until the true tip is on the glass; angles are logged in ticks.
fn touch(made: &Measurements, row: &mut Observation, truth: &Assumed, height_m: f64) -> Option<Vec<f64>> {
    let mut angles = row.angles_rad().to_vec();
    let mut seen = vec![];
    for _ in 0..4 {
        let at = |angles: &[f64]| {
            let mut shifted = row.clone();
            shifted.encoder_rad = Some(angles.to_vec());
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
    let kind =
        KindFloor { what: What::Touch, sd: NOISE_M.to_vec(), degrees_of_freedom: 120.0, sigma_m: None };
    Floor { kinds: vec![kind], source: FloorSource::Repeats }
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
    Floor {
        kinds: vec![KindFloor { what: What::Touch, sd, degrees_of_freedom: free, sigma_m: None }],
        source: FloorSource::Repeats,
    }
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
        ..Apparatus::default()
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
                row: rows.len(),
                commanded_rad: Some(angles.clone()),
                encoder_rad: Some(angles.clone()),
                direction: vec![side; 6],
                payload_kg,
                screen_height_m: height_m,
                t_secs: None,
                cell,
                approach: Some(if side > 0.0 { "plus" } else { "minus" }.to_owned()),
                ..Observation::imagined(What::Touch)
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

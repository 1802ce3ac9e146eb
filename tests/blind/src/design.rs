//! Plans of touches: a plain one, as labs make it, and a rich one.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_model::frame::Point;
use plumbline_model::robot::Posture;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::touch_plan::TouchArea;
use rand::Rng;
use rand::rngs::StdRng;
use serde::{Deserialize, Serialize};

use crate::bench::{Bench, TIP};
use crate::error::BlindError;
use crate::physics::Plans;
use crate::stage::Cell;

/// Which plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Design {
    /// Some 40 places, straight from above, one height.
    Plain,
    /// Some 20 places at several heights from two sides in many postures, a weight on some.
    Rich,
}

impl Design {
    /// How often every pose is touched.
    pub fn repeats(self, plans: &Plans) -> usize {
        plans.repeats[self as usize]
    }

    /// Weights that hang in the palm, kg.
    pub fn payloads_kg(self, plans: &Plans) -> &'static [f64] {
        plans.payloads_kg[self as usize]
    }
}

/// Least descent for every meter along the glass.
const LEAST_SLOPE: f64 = 0.45;

/// Plans poses on a bench.
pub struct Planner<'a> {
    bench: &'a Bench,
    solver: Solver,
    ready: Posture,
    area: TouchArea,
}

impl<'a> Planner<'a> {
    /// Of a bench.
    ///
    /// # Errors
    /// When the arm does not reach the screen.
    pub fn new(bench: &'a Bench) -> Result<Self, BlindError> {
        let solver = Solver::of_rig(&bench.rig, TIP)?;
        let area = TouchArea::reached_by(&bench.rig, TIP)?.ok_or(BlindError::Plan { found: 0, wanted: 1 })?;
        let home = bench.rig.home();
        let ready = bench.rig.pose("touch-ready").map_or_else(|| home.clone(), |pose| pose.applied_to(&home));
        Ok(Self { bench, solver, ready, area })
    }

    /// The poses of a plan.
    ///
    /// # Errors
    /// When too few can be reached.
    pub fn cells(&self, design: Design, plans: &Plans, random: &mut StdRng) -> Result<Vec<Cell>, BlindError> {
        match design {
            Design::Plain => self.plain(plans, random),
            Design::Rich => self.rich(plans, random),
        }
    }

    /// A place of the reached area (0–1 across and down) at a height, robot frame.
    fn place(&self, across: f64, down: f64, height_m: f64) -> Point<plumbline_model::Robot> {
        // Room for what is hidden to move the touch.
        let inside = |part: f64| 0.08 + 0.84 * part;
        let pixel = self.area.at(inside(across), inside(down));
        self.bench.screen().raised(height_m).point_at(pixel)
    }

    fn plain(&self, plans: &Plans, random: &mut StdRng) -> Result<Vec<Cell>, BlindError> {
        let [columns, rows] = plans.grid;
        let mut cells = vec![];
        let mut from = self.ready.clone();
        for row in 0..rows {
            for column in 0..columns {
                let mut part = |i: usize, n: usize| {
                    if plans.scattered {
                        return random.random_range(0.0..1.0);
                    }
                    ((i as f64 + 0.5 + random.random_range(-0.3..0.3)) / n as f64).clamp(0.0, 1.0)
                };
                let point = self.place(part(column, columns), part(row, rows), 0.0);
                let Some(angles_rad) = self.solve(&Target::Position(point), &mut from) else { continue };
                let way_rad_per_m = self.straight_down(&angles_rad);
                let set = format!("row {}", row + 1);
                cells.push(Cell {
                    number: cells.len(),
                    angles_rad,
                    way_rad_per_m,
                    approach: "above",
                    height_m: 0.0,
                    payload_kg: 0.0,
                    set,
                });
            }
        }
        let wanted = columns * rows;
        if cells.len() < wanted * 3 / 4 {
            return Err(BlindError::Plan { found: cells.len(), wanted });
        }
        Ok(cells)
    }

    fn rich(&self, plans: &Plans, random: &mut StdRng) -> Result<Vec<Cell>, BlindError> {
        let mut cells = vec![];
        let mut places = 0;
        for trial in 0..plans.places * 3 {
            if places == plans.places {
                break;
            }
            let (across, down) = (random.random::<f64>(), random.random::<f64>());
            let set = format!("place {}", 1 + trial % 7);
            let before = cells.len();
            for &height_m in plans.heights_m {
                // One posture for both sides, so that only the side differs.
                let Some(angles_rad) = self.varied(self.place(across, down, height_m), random) else {
                    continue;
                };
                let heaviest_kg = Design::Rich.payloads_kg(plans).last().copied().unwrap_or(0.0);
                let payload_kg = if random.random_bool(0.3) { heaviest_kg } else { 0.0 };
                for (approach, sign) in [("plus", 1.0), ("minus", -1.0)] {
                    let Some(way_rad_per_m) = self.all_joints(&angles_rad, sign) else { continue };
                    cells.push(Cell {
                        number: cells.len(),
                        angles_rad: angles_rad.clone(),
                        way_rad_per_m,
                        approach,
                        height_m,
                        payload_kg,
                        set: set.clone(),
                    });
                }
            }
            places += usize::from(cells.len() > before);
        }
        let wanted = 2 * plans.places * plans.heights_m.len();
        if cells.len() < wanted / 2 {
            return Err(BlindError::Plan { found: cells.len(), wanted });
        }
        Ok(cells)
    }

    fn solve(&self, target: &Target, from: &mut Posture) -> Option<Vec<f64>> {
        let answer = self.solver.solve_from(target, from, &Options::upright()).ok()?;
        if !answer.is_reached() {
            return None;
        }
        let angles = answer.best().joints.to_vec();
        *from = from.with(self.solver.joints(), &angles);
        Some(angles)
    }

    /// One of many postures in which the tip reaches a point.
    fn varied(&self, point: Point<plumbline_model::Robot>, random: &mut StdRng) -> Option<Vec<f64>> {
        for _ in 0..10 {
            let yaw_rad = random.random_range(-std::f64::consts::PI..std::f64::consts::PI);
            let target = Target::PositionYaw { point, yaw_rad };
            let options = Options { other_starts: 4, ..Options::default() };
            let Ok(answer) = self.solver.solve_from(&target, &self.ready, &options) else { continue };
            let angles = answer.best().joints.to_vec();
            if answer.is_reached() && self.points_down(&angles) {
                return Some(angles);
            }
        }
        self.solve(&Target::Position(point), &mut self.ready.clone())
    }

    /// Whether the finger comes from above the glass.
    fn points_down(&self, angles_rad: &[f64]) -> bool {
        let tip = self.bench.chain.robot_from_tip(angles_rad).isometry;
        let finger = self.bench.last_from_tip.translation.vector - self.bench.knuckle_m;
        let finger = tip.rotation * (self.bench.last_from_tip.rotation.inverse() * finger.normalize());
        finger.z < -0.5
    }

    fn jacobian(&self, angles_rad: &[f64]) -> DMatrix<f64> {
        let (_, full) = self.bench.chain.jacobian(angles_rad);
        DMatrix::from_fn(3, angles_rad.len(), |row, column| full[(row, column)])
    }

    /// Joint rates (rad per meter) that move the tip straight down.
    fn straight_down(&self, angles_rad: &[f64]) -> Vec<f64> {
        let jacobian = self.jacobian(angles_rad);
        let square = &jacobian * jacobian.transpose() + DMatrix::identity(3, 3) * 1e-5;
        let down = DVector::from_column_slice(&[0.0, 0.0, -1.0]);
        let rates = square.lu().solve(&down).map(|force| jacobian.transpose() * force);
        rates.map_or_else(|| vec![0.0; angles_rad.len()], |rates| rates.as_slice().to_vec())
    }

    /// Joint rates of one sign that bring the tip down, as nearly equal as they can be; `None`
    /// when the tip would hardly come down.
    fn all_joints(&self, angles_rad: &[f64], sign: f64) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(angles_rad);
        let sinks: Vec<f64> = (0..angles_rad.len()).map(|j| -sign * jacobian[(2, j)]).collect();
        let most = sinks.iter().copied().fold(0.0, f64::max);
        for preference in 0..16 {
            let rates: Vec<f64> = sinks
                .iter()
                .map(|sink| sign * (1.0 + 0.5 * f64::from(preference) * (sink / most).max(0.0)))
                .collect();
            let velocity = &jacobian * DVector::from_column_slice(&rates);
            let velocity = Vector3::new(velocity[0], velocity[1], velocity[2]);
            if -velocity.z > LEAST_SLOPE * velocity.xy().norm() {
                return Some(rates.iter().map(|rate| rate / -velocity.z).collect());
            }
        }
        None
    }
}

//! A joint that jumps where it passes an angle: what catches there is in no library.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_model::JobContext;

use super::linear::Linear;
use crate::error::GapError;

/// Of all angles between two poses so many of the likeliest are looked at. The others are not less probable for it
/// beforehand: each has its share of what a jump somewhere has.
const LOOKED_AT: usize = 5;
/// Angles (rad, m) closer than this are the same pose again.
const SAME_ANGLE: f64 = 5e-3;
/// So many poses on either side at least.
const FEWEST_BESIDE: usize = 4;
/// Fewer angles tell no jump.
const FEWEST: usize = 20;
/// Keeps columns that are alike from being solved for, share of the largest.
const RIDGE: f64 = 1e-9;

/// Columns of one where a joint is beyond the angle, times what its turn does (`base`, one per line), and how many angles
/// there are. Which are likeliest is seen beside frames and all that goes smoothly with the joint's own angle: its zero, its
/// ratio, an encoder off its axis.
///
/// # Errors
/// Cancelled.
pub(super) fn steps(
    measurements: &Measurements,
    linear: &Linear,
    base: &[f64],
    joint: usize,
    context: &dyn JobContext,
) -> Result<(Vec<Vec<f64>>, usize), GapError> {
    let angle = |row: usize| measurements.rows[row].angles_rad().get(joint).copied();
    let mut known: Vec<f64> = (0..measurements.rows.len()).filter_map(angle).collect();
    known.sort_by(f64::total_cmp);
    known.dedup_by(|a, b| (*a - *b).abs() < SAME_ANGLE);
    if known.len() < FEWEST {
        return Ok((vec![], 0));
    }
    let edges: Vec<f64> = known[FEWEST_BESIDE - 1..=known.len() - FEWEST_BESIDE]
        .windows(2)
        .map(|pair| 0.5 * (pair[0] + pair[1]))
        .collect();
    let of_line = |line: usize| angle(linear.row[line]);
    let column = |edge: f64| -> Vec<f64> {
        let is_beyond = |line: usize| of_line(line).is_some_and(|angle| angle > edge);
        (0..base.len()).map(|line| if is_beyond(line) { base[line] } else { 0.0 }).collect()
    };
    let Some(smooth) = Smooth::of(linear, base, &of_line) else { return Ok((vec![], 0)) };
    let left = smooth.left_of(linear.lines.column(linear.lines.ncols() - 1).clone_owned());
    let mut tried: Vec<(f64, f64)> = Vec::with_capacity(edges.len());
    for &edge in &edges {
        context.checkpoint()?;
        let beside = smooth.left_of(DVector::from_column_slice(&column(edge)));
        let square = beside.norm_squared();
        tried.push((if square > 0.0 { beside.dot(&left).powi(2) / square } else { 0.0 }, edge));
    }
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    tried.truncate(LOOKED_AT);
    Ok((tried.into_iter().map(|(_, edge)| column(edge)).collect(), edges.len()))
}

/// What frames do and what goes smoothly with the angle of a joint.
struct Smooth {
    columns: DMatrix<f64>,
    normal: Cholesky<f64, nalgebra::Dyn>,
}

impl Smooth {
    fn of(linear: &Linear, base: &[f64], angle: &dyn Fn(usize) -> Option<f64>) -> Option<Self> {
        let laws: [fn(f64) -> f64; 4] = [|_| 1.0, |angle| angle, f64::sin, f64::cos];
        let gauge = linear.gauge;
        let columns =
            DMatrix::from_fn(base.len(), gauge + laws.len(), |line, k| match k.checked_sub(gauge) {
                None => linear.lines[(line, k)],
                Some(law) => base[line] * angle(line).map_or(0.0, laws[law]),
            });
        let mut normal = columns.tr_mul(&columns);
        let ridge = RIDGE * normal.diagonal().max();
        for k in 0..normal.ncols() {
            normal[(k, k)] += ridge;
        }
        Some(Self { normal: Cholesky::new(normal)?, columns })
    }

    /// What they leave of a column.
    fn left_of(&self, column: DVector<f64>) -> DVector<f64> {
        let fitted = &self.columns * self.normal.solve(&self.columns.tr_mul(&column));
        column - fitted
    }
}

#[cfg(test)]
mod tests {
    use plumbline_effects::measurements::What;
    use plumbline_effects::{Assumed, Effect, Present};
    use plumbline_model::robot::Rig;
    use plumbline_model::{Session, Unattended};
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;
    use crate::finding::FloorSource;
    use crate::floor::{Floor, KindFloor};

    const JOINTS: [&str; 6] =
        ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
    const BASE_RAD: [f64; 6] = [-0.03, 0.31, 0.44, 1.25, 0.5, 0.3];
    const ELBOW: usize = 3;
    const JUMPS_AT_RAD: f64 = 1.32;

    /// Poses drawn by chance, seen from outside; the elbow is off by `turn_rad` where it stands beyond an angle.
    fn made(turn_rad: f64, law: impl Fn(f64) -> f64) -> Measurements {
        let mut random = StdRng::seed_from_u64(5);
        let mut text =
            JOINTS.map(|joint| format!("cmd_{joint}_rad,")).concat() + "meas_x_m,meas_y_m,meas_z_m\n";
        for _ in 0..50 {
            text += &BASE_RAD.map(|angle| format!("{},", angle + random.random_range(-0.5..0.5))).concat();
            text += "0,0,0\n";
        }
        let manifest = format!(
            "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n[chain]\ntip = \"right_index_tip\"\njoints = {JOINTS:?}\n"
        );
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("session.toml"), manifest).expect("writable");
        std::fs::write(folder.path().join("poses.csv"), text).expect("writable");
        let session = Session::read(folder.path()).expect("well formed");
        let rig = Rig::built_in("nico").expect("comes along");
        let mut made = Measurements::of_sessions(&[("made".to_owned(), session)], &rig).expect("usable");
        let arm = made.apparatuses[0].arm.clone();
        let zero = Effect::find("joint-zero", "r_elbow_y", None, arm.as_ref(), None).expect("of the library");
        for row in 0..made.rows.len() {
            let value = turn_rad * law(made.rows[row].angles_rad()[ELBOW]);
            let effects = vec![Present { effect: zero.clone(), values: vec![value] }];
            let truth = Assumed { effects, ..Assumed::nominal(&made) };
            let exact = made.predict(&made.rows[row], &truth).expect("predictable");
            made.rows[row].measured =
                exact.iter().map(|at| at + 2e-4 * random.random_range(-1.7..1.7)).collect();
        }
        made
    }

    /// The columns of steps of the elbow, and the share of what smooth laws leave that the first one explains.
    fn first(made: &Measurements) -> (Vec<f64>, f64, usize) {
        let kind = KindFloor { what: What::Pose, sd: vec![2e-4; 3], degrees_of_freedom: 50.0, sigma_m: None };
        let floor = Floor { kinds: vec![kind], source: FloorSource::Fitted };
        let arm = made.apparatuses[0].arm.as_ref();
        let zero = Effect::find("joint-zero", "r_elbow_y", None, arm, None).expect("of the library");
        let linear = Linear::of(made, &floor, &Assumed::nominal(made), &[zero], &Unattended).expect("linear");
        let base: Vec<f64> = linear.lines.column(linear.gauge).iter().copied().collect();
        let (columns, among) = steps(made, &linear, &base, ELBOW, &Unattended).expect("not cancelled");
        let angle = |line: usize| made.rows[linear.row[line]].angles_rad().get(ELBOW).copied();
        let smooth = Smooth::of(&linear, &base, &angle).expect("solvable");
        let left = smooth.left_of(linear.lines.column(linear.lines.ncols() - 1).clone_owned());
        let own = smooth.left_of(DVector::from_column_slice(&columns[0]));
        let share = own.dot(&left).powi(2) / (own.norm_squared() * left.norm_squared());
        let beyond = (0..base.len()).filter(|&line| columns[0][line] != 0.0).filter_map(angle);
        (beyond.collect(), share, among)
    }

    #[test]
    fn the_angle_at_which_a_joint_jumps_is_found_beside_what_goes_smoothly() {
        let made = made(0.02, |angle| f64::from(u8::from(angle > JUMPS_AT_RAD)));
        let (beyond, share, among) = first(&made);
        let edge = beyond.iter().copied().fold(f64::MAX, f64::min);
        let angles = made.rows.iter().map(|row| row.angles_rad()[ELBOW]);
        let wrong = angles.filter(|angle| (*angle > JUMPS_AT_RAD) != (*angle >= edge)).count();
        assert_eq!(wrong, 0, "from {edge}");
        assert!(share > 0.9, "{share}");
        assert!(among > 30, "{among}");
    }

    #[test]
    fn a_wrong_ratio_is_no_jump() {
        let (_, share, _) = first(&made(0.02, |angle| angle - 1.2));
        assert!(share < 0.3, "{share}");
    }
}

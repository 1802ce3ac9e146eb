//! Repeats of an arm that was measured from outside: what each joint's turn does to a row depends on the pose, so what a
//! joint leaves by how it came is not the same along x, y and z everywhere. Here it is fitted as a turn of the joint.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Effect, Kind};

use super::spread::{SIGNIFICANT, Spread};
use super::structure::{LEAST_WITHIN, Repeat, SIDE_RAD, Structure};
use crate::statistics::f_tail;

/// A joint remembers about so far, rad: between the side that it came from and the way that it came.
const REMEMBERED_RAD: f64 = 1.0;
/// Keeps columns that are alike from being solved for.
const RIDGE: f64 = 1e-9;

/// What the turn of each joint does to the coordinates of a row, per usual zero of it; empty where none is told.
pub fn levers(measurements: &Measurements, assumed: &Assumed, row: usize) -> Vec<Vec<f64>> {
    let row = &measurements.rows[row];
    let Some(arm) = measurements.apparatus(row).arm.as_ref().filter(|_| row.what.is_pose()) else {
        return vec![];
    };
    let zeros = Effect::sites(Kind::JointZero, Some(arm), None);
    let zeros: Vec<Effect> = zeros.into_iter().filter(|zero| !zero.is_of_every_site()).collect();
    if zeros.len() != arm.len() {
        return vec![];
    }
    let Some(tangents) = measurements.tangents(row, assumed, &zeros) else { return vec![] };
    tangents.effects.column_iter().map(|column| column.iter().copied().collect()).collect()
}

/// What it does to the coordinates of a row that its joints lag as they do, were the angles logged too early; empty where they
/// lag alike in all repeats, or no encoder is logged.
pub fn lagged(measurements: &Measurements, assumed: &Assumed, row: usize) -> Vec<f64> {
    let row = &measurements.rows[row];
    let Some(arm) = measurements.apparatus(row).arm.as_ref().filter(|_| row.has_own_lag) else {
        return vec![];
    };
    let early = Effect::sites(Kind::EarlyLog, Some(arm), None);
    let Some(of_all) = early.into_iter().find(|one| one.site.is_empty()) else { return vec![] };
    let tangents = measurements.tangents(row, assumed, &[of_all]);
    tangents.map_or(vec![], |tangents| tangents.effects.column(0).iter().copied().collect())
}

/// What repeats depend on where angles were logged too early.
pub const HOW_FAR_SHORT: &str = "how far joints stop short of their goals";

/// How far the joints lagged: where that differs between repeats, angles that were logged too early go with it.
pub fn by_lag(rows: &[Repeat], spread: &Spread, fits: usize) -> Option<Structure> {
    if rows.iter().any(|row| row.lagged.is_empty()) {
        return None;
    }
    // That it differs is known; however large what is the same in all repeats.
    let column = column(rows, spread, 0.0, &|row, c| row.lagged[c])?;
    let off = spread.whitened();
    let rest = rest_of(&off, &[&column])?;
    // What joints lag the other way by is no early log.
    if off.dot(&column) <= 0.0 {
        return None;
    }
    let free = (spread.free() * spread.counted.len() as f64 - 1.0).max(1.0);
    let lost = off.norm_squared() - rest.norm_squared();
    let p_value = f_tail(lost / (rest.norm_squared() / free).max(1e-300), 1.0, free) * fits as f64;
    let shares = spread.shares_of(&rest, 1.0 / spread.counted.len() as f64);
    (p_value <= SIGNIFICANT).then(|| Structure::new(HOW_FAR_SHORT.to_owned(), p_value, shares))
}

/// How the joints came, the one that tells most first, as long as each is beyond doubt. `fits`: all that is tried.
pub fn by_levers(rows: &[Repeat], spread: &Spread, joints: &[String], fits: usize) -> Option<Structure> {
    let counted = &spread.counted;
    let off = spread.whitened();
    let free = spread.free() * counted.len() as f64;
    let candidates: Vec<Option<Vec<DVector<f64>>>> =
        (0..joints.len()).map(|joint| columns(rows, joint, spread)).collect();
    let mut chosen: Vec<usize> = vec![];
    let (mut columns, mut left) = (vec![], off.clone());
    let mut first: Option<f64> = None;
    loop {
        let mut best: Option<(f64, usize, DVector<f64>)> = None;
        for (joint, own) in candidates.iter().enumerate().filter(|(joint, _)| !chosen.contains(joint)) {
            let Some(own) = own else { continue };
            let all: Vec<&DVector<f64>> = columns.iter().copied().chain(own).collect();
            let Some(rest) = rest_of(&off, &all) else { continue };
            let (used, free) = (own.len() as f64, (free - all.len() as f64).max(1.0));
            let lost = (left.norm_squared() - rest.norm_squared()) / used;
            let by_chance = f_tail(lost / (rest.norm_squared() / free).max(1e-300), used, free);
            let p_value = by_chance * fits as f64;
            if p_value <= SIGNIFICANT && best.as_ref().is_none_or(|(known, ..)| p_value < *known) {
                best = Some((p_value, joint, rest));
            }
        }
        let Some((p_value, joint, rest)) = best else { break };
        first.get_or_insert(p_value);
        chosen.push(joint);
        columns.extend(candidates[joint].iter().flatten());
        left = rest;
    }
    let shares = spread.shares_of(&left, columns.len() as f64 / counted.len() as f64);
    Some(Structure::new(format!("where {} came from", joints[*chosen.first()?]), first?, shares))
}

/// By the side that a joint came from and by the way that it came: coordinates that spread one after the other, less
/// their means in cells, in units of their spread. `None` where repeats hardly differ in it.
fn columns(rows: &[Repeat], joint: usize, spread: &Spread) -> Option<Vec<DVector<f64>>> {
    let by_side = |turned_rad: f64| (turned_rad / SIDE_RAD).tanh();
    let by_way = |turned_rad: f64| (turned_rad / REMEMBERED_RAD).tanh();
    let laws: [&dyn Fn(f64) -> f64; 2] = [&by_side, &by_way];
    let of = |law: &dyn Fn(f64) -> f64| {
        column(rows, spread, LEAST_WITHIN, &|row, c| {
            let turned_rad = row.turned_rad.get(joint).copied().unwrap_or(0.0);
            row.levers.get(joint).map_or(0.0, |lever| lever[c]) * law(turned_rad)
        })
    };
    let all: Vec<DVector<f64>> = laws.into_iter().filter_map(of).collect();
    (!all.is_empty()).then_some(all)
}

/// What a row may depend on, as [`columns`] has it. `least`: share of its variance that repeats have to differ in.
pub(super) fn column(
    rows: &[Repeat],
    spread: &Spread,
    least: f64,
    value: &dyn Fn(&Repeat, usize) -> f64,
) -> Option<DVector<f64>> {
    let counted = &spread.counted;
    let mut means = std::collections::BTreeMap::<usize, (Vec<f64>, f64)>::new();
    for row in rows {
        let (sums, count) = means.entry(row.cell).or_insert_with(|| (vec![0.0; counted.len()], 0.0));
        sums.iter_mut().zip(counted).for_each(|(sum, &c)| *sum += value(row, c));
        *count += 1.0;
    }
    let scale = spread.scales();
    let mut column = DVector::zeros(rows.len() * counted.len());
    let mut whole = 0.0;
    for (r, row) in rows.iter().enumerate() {
        let (sums, count) = &means[&row.cell];
        for (k, &c) in counted.iter().enumerate() {
            let own = value(row, c);
            column[k * rows.len() + r] = (own - sums[k] / count) / scale[c];
            whole += (own / scale[c]).powi(2);
        }
    }
    let within = column.norm_squared();
    (within > least * whole && within > 0.0).then(|| column / within.sqrt())
}

/// What these columns leave.
pub(super) fn rest_of(off: &DVector<f64>, columns: &[&DVector<f64>]) -> Option<DVector<f64>> {
    let design = DMatrix::from_fn(off.len(), columns.len(), |r, c| columns[c][r]);
    let normal = design.tr_mul(&design) + DMatrix::identity(columns.len(), columns.len()) * RIDGE;
    Some(off - &design * Cholesky::new(normal)?.solve(&design.tr_mul(off)))
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::super::structure::structure;
    use super::*;

    /// Fifty poses three times, visited in an order drawn by chance; what the joint does goes along another direction in
    /// each. `of`: what the turn of the joint is off by.
    fn rows(seed: u64, of: impl Fn(f64) -> f64) -> Vec<Repeat> {
        let mut random = StdRng::seed_from_u64(seed);
        let directions: Vec<f64> = (0..50).map(|_| random.random_range(0.0..std::f64::consts::TAU)).collect();
        let mut all: Vec<Repeat> = (0..150)
            .map(|i| {
                let cell = i % 50;
                let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                let (x, y) = (noise(), noise());
                let turned_rad = random.random_range(-2.0..2.0);
                let lever = vec![directions[cell].cos(), directions[cell].sin()];
                let turn = of(turned_rad);
                let off = vec![x + turn * lever[0], y + turn * lever[1]];
                Repeat {
                    cell,
                    when: i as f64,
                    turned_rad: vec![turned_rad],
                    temperature_c: None,
                    at: None,
                    off,
                    levers: vec![lever],
                    lagged: vec![],
                }
            })
            .collect();
        for cell in 0..50 {
            for c in 0..2 {
                let own: Vec<usize> = (0..all.len()).filter(|&r| all[r].cell == cell).collect();
                let mean = own.iter().map(|&r| all[r].off[c]).sum::<f64>() / own.len() as f64;
                own.iter().for_each(|&r| all[r].off[c] -= mean);
            }
        }
        all
    }

    fn found(rows: &[Repeat]) -> Option<Structure> {
        structure(rows, 100.0, "time", &["the elbow".to_owned()])
    }

    #[test]
    fn what_joints_lag_by_is_found_beside_much_that_is_the_same_in_all_repeats() {
        let lagging = |seed: u64, share: f64| {
            let mut all = rows(seed, |_| 0.0);
            for row in &mut all {
                // It stops as far short of its goal as its last way was long: as good as chance.
                let stops_short = row.turned_rad[0];
                let lever = &row.levers[0];
                row.lagged = lever.iter().map(|lever| lever * (20.0 + stops_short)).collect();
                row.off.iter_mut().zip(lever).for_each(|(off, lever)| *off += share * lever * stops_short);
                row.turned_rad = vec![0.0];
            }
            found(&all)
        };
        for seed in 0..10 {
            let structure = lagging(seed, 1.5).expect("nearly two standard deviations");
            assert!(structure.on.starts_with("how far joints stop short"), "{}", structure.on);
            assert!(lagging(20 + seed, -1.5).is_none(), "no early log goes the other way");
            assert!(lagging(40 + seed, 0.0).is_none());
        }
    }

    #[test]
    fn what_a_joint_remembers_is_found_whatever_direction_it_shows_in() {
        for seed in 0..10 {
            let remembers = rows(seed, |turned| 2.0 * (turned / 1.5).clamp(-1.0, 1.0));
            let structure = found(&remembers).expect("two standard deviations");
            assert_eq!(structure.on, "where the elbow came from");
            // What it leaves is the noise alone.
            let spread: f64 = remembers.iter().map(|row| row.off[0] * row.off[0]).sum();
            let noise = (spread * structure.left[0] / 100.0).sqrt();
            assert!((noise - 1.0).abs() < 0.35, "{noise}");
            // Along x, y and z alone it hides, since it goes here this way and there that way.
            let blind: Vec<Repeat> =
                remembers.into_iter().map(|row| Repeat { levers: vec![], ..row }).collect();
            assert!(found(&blind).is_none_or(|blind| blind.size_sigmas < 0.5 * structure.size_sigmas));
        }
    }

    #[test]
    fn noise_does_not_depend_on_how_joints_came() {
        let alarms = (0..200).filter(|seed| found(&rows(1000 + seed, |_| 0.0)).is_some()).count();
        assert_eq!(alarms, 0);
    }
}

//! Means of cells: what each joint lags by, from which side it came, and the torque of every link.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use plumbline_effects::Situation;
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Measurements, Observation};

/// The mean of the rows of a cell, per joint.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Encoder less command, rad.
    pub lag_rad: Vec<f64>,
    /// Half of the direction of motion, the other way: what friction does.
    pub back: Vec<f64>,
    /// Torque of gravity as the description has the masses (or as it was measured), N m.
    pub torque_nm: Vec<f64>,
    /// Of that what each link adds, joint by joint: `[joint][link]`, N m. Empty where torques were measured.
    pub of_links_nm: Vec<Vec<f64>>,
}

/// From where rows come, and with what.
pub(super) struct Sides {
    /// From both sides.
    pub both: bool,
    /// With several weights.
    pub weights: bool,
}

impl Sides {
    pub fn of(rows: &[&Observation]) -> Self {
        let from = |side: &str| rows.iter().any(|row| row.approach.as_deref() == Some(side));
        let weights = rows.iter().map(|row| (row.payload_kg * 1e3).round() as i64);
        let weights = weights.collect::<std::collections::BTreeSet<_>>().len() > 1;
        Self { both: from("plus") && from("minus"), weights }
    }

    /// A torque goes with the posture, and so does how fast a joint moves.
    pub fn are_one(&self) -> bool {
        !self.both && !self.weights
    }
}

/// Rows of the arm that have both command and encoder.
pub(super) fn logged(measurements: &Measurements, session: usize) -> impl Iterator<Item = &Observation> {
    let both = |row: &&Observation| row.commanded_rad.is_some() && row.encoder_rad.is_some();
    measurements.rows.iter().filter(move |row| row.session == session && row.what.is_placed()).filter(both)
}

/// Means of all cells.
pub(super) fn cells(arm: &Arm, rows: &[&Observation]) -> Vec<Cell> {
    let joints = arm.len();
    let measured = rows.iter().any(|row| row.torque_nm.is_some());
    let alone: Vec<Arm> = if measured || arm.masses_made_up {
        vec![]
    } else {
        (0..joints).map(|l| with_only(arm, l)).collect()
    };
    let mut sums: BTreeMap<usize, (Cell, f64)> = BTreeMap::new();
    for row in rows {
        let Some(lag_rad) = row.lag_rad().filter(|lag| lag.len() == joints) else { continue };
        let torques = |arm: &Arm, payload_kg: f64| -> Vec<f64> {
            let up = Vector3::z();
            let at = Situation::new(arm, row.angles_rad(), &row.direction, payload_kg, &up);
            at.torques_nm().to_vec()
        };
        let torque_nm = row.torque_nm.clone().unwrap_or_else(|| torques(arm, row.payload_kg));
        if torque_nm.len() != joints {
            continue;
        }
        let of_links: Vec<Vec<f64>> = alone.iter().map(|arm| torques(arm, 0.0)).collect();
        let of_links_nm: Vec<Vec<f64>> =
            (0..joints).map(|j| of_links.iter().map(|torques| torques[j]).collect()).collect();
        let own = Cell {
            lag_rad: lag_rad.iter().map(|lag| -lag).collect(),
            back: (0..joints).map(|j| -0.5 * row.direction.get(j).copied().unwrap_or_default()).collect(),
            torque_nm,
            of_links_nm,
        };
        match sums.get_mut(&row.cell) {
            Some((sum, count)) => {
                sum.add(&own);
                *count += 1.0;
            }
            None => {
                sums.insert(row.cell, (own, 1.0));
            }
        }
    }
    sums.into_values().map(|(sum, count)| sum.scaled(1.0 / count)).collect()
}

impl Cell {
    fn add(&mut self, other: &Self) {
        let add =
            |to: &mut Vec<f64>, from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        add(&mut self.lag_rad, &other.lag_rad);
        add(&mut self.back, &other.back);
        add(&mut self.torque_nm, &other.torque_nm);
        self.of_links_nm.iter_mut().zip(&other.of_links_nm).for_each(|(to, from)| add(to, from));
    }

    fn scaled(mut self, by: f64) -> Self {
        let lists = [&mut self.lag_rad, &mut self.back, &mut self.torque_nm];
        lists.into_iter().chain(&mut self.of_links_nm).flatten().for_each(|value| *value *= by);
        self
    }
}

/// The arm with the mass of one part alone.
pub(super) fn with_only(arm: &Arm, part: usize) -> Arm {
    let mut alone = arm.clone();
    for (l, other) in alone.parts.iter_mut().enumerate() {
        if l != part {
            other.mass_kg = 0.0;
        }
    }
    alone
}

//! What follows from the order and the times of rows: how long a pose was held, how fast it was
//! reached; how far servos lag; and the sign of measured torques.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::{Apparatus, Observation, copies, lags};
use crate::library::Situation;

/// Less than this is no motion, rad.
const LEAST_MOTION_RAD: f64 = 2e-3;

/// Fills in what follows from several rows together.
pub(super) fn complete(rows: &mut [Observation], apparatuses: &[Apparatus]) {
    // Rows of one session and one kind stand in the order of their table.
    let mut tables: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.what.is_placed()) {
        tables.entry((row.session, row.what.table())).or_default().push(i);
    }
    for order in tables.values() {
        holds(rows, order);
        speeds(rows, order);
        if rows[order[0]].what.is_pose() {
            directions(rows, order);
        }
        torques(rows, order, apparatuses);
    }
    copies::complete(rows, apparatuses.len());
    lags::complete(rows, apparatuses);
}

/// Rows of the same cell that follow each other in time without another pose in between are held.
fn holds(rows: &mut [Observation], order: &[usize]) {
    let mut by_time: Vec<(f64, usize)> = order.iter().filter_map(|&i| Some((rows[i].t_secs?, i))).collect();
    by_time.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut since: Option<(usize, f64)> = None;
    for (t_secs, i) in by_time {
        let cell = rows[i].cell;
        let start = since.filter(|(held, _)| *held == cell).map_or(t_secs, |(_, start)| start);
        since = Some((cell, start));
        rows[i].hold_secs = Some(t_secs - start);
    }
}

/// An arm that is measured from outside goes from pose to pose: where no row says from which side
/// it came, the order of the rows does. A joint that rests keeps the side of its last motion.
fn directions(rows: &mut [Observation], order: &[usize]) {
    if order.iter().any(|i| rows[*i].approach.is_some()) {
        return;
    }
    for pair in order.windows(2) {
        let before = rows[pair[0]].direction.clone();
        let (from, to) = (rows[pair[0]].angles_rad(), rows[pair[1]].angles_rad());
        let side = |(k, side): (usize, &f64)| {
            let turned_rad = to[k] - from[k];
            if turned_rad.abs() < LEAST_MOTION_RAD { *side } else { turned_rad.signum() }
        };
        let after = before.iter().enumerate().map(side).collect();
        rows[pair[1]].direction = after;
    }
}

fn speeds(rows: &mut [Observation], order: &[usize]) {
    for pair in order.windows(2) {
        let (before, now) = (&rows[pair[0]], &rows[pair[1]]);
        let duration = now.move_secs.filter(|secs| *secs > 0.0);
        let commands = before.commanded_rad.as_ref().zip(now.commanded_rad.as_ref());
        let speed = duration
            .zip(commands)
            .map(|(secs, (from, to))| from.iter().zip(to).map(|(a, b)| (b - a) / secs).collect());
        rows[pair[1]].speed_rad_s = speed;
    }
}

/// Devices report the torque that a joint gives or the one that it bears. Told apart by the
/// weights of the links, whose scale does not matter.
fn torques(rows: &mut [Observation], order: &[usize], apparatuses: &[Apparatus]) {
    let mut agreement = 0.0;
    for row in order.iter().map(|i| &rows[*i]) {
        let arm = apparatuses.get(row.session).and_then(|apparatus| apparatus.arm.as_ref());
        let (Some(arm), Some(measured)) = (arm, &row.torque_nm) else { continue };
        let situation = Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &Vector3::z());
        agreement += situation.torques_nm().iter().zip(measured).map(|(a, b)| a * b).sum::<f64>();
    }
    if agreement < 0.0 {
        for i in order {
            if let Some(torque_nm) = &mut rows[*i].torque_nm {
                torque_nm.iter_mut().for_each(|torque| *torque = -*torque);
            }
        }
    }
}

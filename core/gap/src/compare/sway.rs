//! A tracker that sways on its tripod, seen where no pose is repeated: what the model leaves goes along over time.
//!
//! Where nothing tells the noise, whatever the model leaves passes for it. But noise does not know the time. A wave of one turn
//! or more over the session, common to all poses, is looked for as where one thing is watched. An arm that goes from
//! place to place in small steps would show what it errs by as such a wave; poses that come in any order do not.

use nalgebra::Vector3;
use plumbline_effects::measurements::{Measurements, What};

use super::structure::{Repeat, Structure, wobble};
use crate::statistics::median;

/// From one pose to the next an arm goes at least this share of what lies between any two of its poses, else place and time go
/// together.
const ANY_ORDER: f64 = 0.7;
/// Fewer poses than this say nothing.
const FEWEST: usize = 30;

/// What of poses of one kind goes with the time under a model with these residuals, with what is said of it.
pub fn sway(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Option<Structure> {
    let session = measurements.rows.iter().find(|row| row.what == what)?.session;
    let mut timed: Vec<(f64, Vector3<f64>, &Vec<f64>)> = vec![];
    for (row, residual) in measurements.rows.iter().zip(residuals) {
        if row.what == what && row.session == session {
            let at = Vector3::from_column_slice(row.measured.get(..3)?);
            timed.push((row.t_secs?, at, residual.as_ref()?));
        }
    }
    if timed.len() < FEWEST || !what.is_pose() {
        return None;
    }
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    if !come_in_any_order(&timed.iter().map(|(_, at, _)| *at).collect::<Vec<_>>()) {
        return None;
    }
    let count = timed.len() as f64;
    let mean = |c: usize| timed.iter().map(|(.., residual)| residual[c]).sum::<f64>() / count;
    let means: Vec<f64> = (0..what.len()).map(mean).collect();
    let rows: Vec<Repeat> = timed
        .iter()
        .map(|(t_secs, _, residual)| Repeat {
            cell: 0,
            when: *t_secs,
            turned_rad: vec![],
            temperature_c: None,
            at: None,
            off: residual.iter().zip(&means).map(|(value, mean)| value - mean).collect(),
            levers: vec![],
        })
        .collect();
    wobble(&rows, count - 1.0).map(|found| Structure { of: "all that was measured", ..found })
}

fn come_in_any_order(at: &[Vector3<f64>]) -> bool {
    let steps = median(at.windows(2).map(|pair| (pair[1] - pair[0]).norm()));
    let half = at.len() / 2;
    let apart = median((0..at.len()).map(|i| (at[i] - at[(i + half) % at.len()]).norm()));
    steps.zip(apart).is_some_and(|(steps, apart)| steps > ANY_ORDER * apart)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(order: impl Fn(usize) -> usize) -> Vec<Vector3<f64>> {
        // A golden-angle spiral: neighbors in number are far apart, sorted ones near.
        let mut all: Vec<Vector3<f64>> = (0..60)
            .map(|i| {
                let (angle, radius) = (2.399_963 * f64::from(i), (f64::from(i) / 60.0).sqrt());
                Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
            })
            .collect();
        all.sort_by(|a, b| a.x.total_cmp(&b.x));
        (0..60).map(|i| all[order(i)]).collect()
    }

    #[test]
    fn poses_in_any_order_are_told_from_those_that_go_on_in_small_steps() {
        assert!(come_in_any_order(&places(|i| (i * 37) % 60)));
        assert!(!come_in_any_order(&places(|i| i)));
        assert!(!come_in_any_order(&[]));
    }
}

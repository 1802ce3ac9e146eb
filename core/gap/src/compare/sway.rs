//! A tracker that sways on its tripod, seen where no pose is repeated: what the model leaves goes along over time.
//!
//! Where nothing tells the noise, whatever the model leaves passes for it. But noise does not know the time. A wave of one turn
//! or more over the session, common to all poses, is looked for as where one thing is watched. An arm that goes from
//! place to place in small steps would show what it errs by as such a wave; poses that come in any order do not.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use plumbline_effects::measurements::{Measurements, What};

use super::structure::{Repeat, Structure, wobble};
use crate::statistics::median;

/// From one pose to the next an arm goes at least this share of what lies between any two of its poses, else place and time go
/// together.
const ANY_ORDER: f64 = 0.7;
/// So many poses say how far any two of them lie apart: pairs of thousands would fill the memory.
const MOST_COMPARED: usize = 300;
/// What is said to go with the time.
const OF_ALL: &str = "all that was measured";
/// Fewer poses than this say nothing.
const FEWEST: usize = 30;

/// What of poses of one kind goes with the time under a model with these residuals, in the session with most of them.
pub fn sway(measurements: &Measurements, residuals: &[Option<Vec<f64>>], what: What) -> Option<Structure> {
    if !what.is_pose() {
        return None;
    }
    let mut sessions = BTreeMap::<usize, Vec<(f64, Vector3<f64>, &Vec<f64>)>>::new();
    for (row, residual) in measurements.rows.iter().zip(residuals).filter(|(row, _)| row.what == what) {
        if let (Some(t_secs), [x, y, z, ..], Some(residual)) = (row.t_secs, &row.measured[..], residual) {
            sessions.entry(row.session).or_default().push((t_secs, Vector3::new(*x, *y, *z), residual));
        }
    }
    let mut timed = sessions.into_values().max_by_key(Vec::len).filter(|timed| timed.len() >= FEWEST)?;
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    if !come_in_any_order(&timed.iter().map(|(_, at, _)| *at).collect::<Vec<_>>()) {
        return None;
    }
    let count = timed.len() as f64;
    let mean = |c: usize| timed.iter().map(|(.., residual)| residual[c]).sum::<f64>() / count;
    let means: Vec<f64> = (0..what.len()).map(mean).collect();
    let one = |(t_secs, _, residual): &(f64, Vector3<f64>, &Vec<f64>)| Repeat {
        cell: 0,
        when: *t_secs,
        turned_rad: vec![],
        temperature_c: None,
        at: None,
        off: residual.iter().zip(&means).map(|(value, mean)| value - mean).collect(),
        levers: vec![],
        lagged: vec![],
    };
    let rows: Vec<Repeat> = timed.iter().map(one).collect();
    wobble(&rows, count - 1.0).map(|found| Structure { of: OF_ALL, ..found })
}

/// Whether an arm goes nearly as far from one pose to the next as between any two.
fn come_in_any_order(at: &[Vector3<f64>]) -> bool {
    let steps = median(at.windows(2).map(|pair| (pair[1] - pair[0]).norm()));
    let some: Vec<_> = at.iter().step_by(at.len().div_ceil(MOST_COMPARED).max(1)).collect();
    let apart = median(
        (0..some.len())
            .flat_map(|i| some[..i].iter().map(|other| (some[i] - *other).norm()).collect::<Vec<_>>()),
    );
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
        // A way that is gone twice, and a raster whose columns are far apart.
        let twice: Vec<Vector3<f64>> = [places(|i| i), places(|i| i)].concat();
        assert!(!come_in_any_order(&twice));
        let raster = (0..40).map(|i| Vector3::new(0.08 * f64::from(i % 5), 0.025 * f64::from(i / 5), 0.0));
        assert!(!come_in_any_order(&raster.collect::<Vec<_>>()));
    }
}

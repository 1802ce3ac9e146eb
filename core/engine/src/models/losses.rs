//! Loss curves while they grow: bounded, whatever the number of steps.

use std::sync::{Arc, Mutex, PoisonError};

use plumbline_correction::{LossPoint, Method};

/// Most points that are kept, of all methods together.
pub const MOST: usize = 500;

/// Loss points that training adds to and the view reads.
#[derive(Clone, Debug, Default)]
pub struct Losses {
    curves: Arc<Mutex<[Curve; Method::ALL.len()]>>,
}

/// Every so many points of one method.
#[derive(Debug, Default)]
struct Curve {
    points: Vec<LossPoint>,
    /// One of so many is kept; 0 before the first.
    every: usize,
    seen: usize,
}

impl Losses {
    /// Adds a point; when there are too many, every other one of its method goes.
    pub fn add(&self, point: LossPoint) {
        let mut curves = self.curves.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(place) = Method::ALL.iter().position(|method| *method == point.method) else { return };
        curves[place].add(point);
    }

    /// The points that are kept, method by method, oldest first.
    pub fn points(&self) -> Arc<[LossPoint]> {
        let curves = self.curves.lock().unwrap_or_else(PoisonError::into_inner);
        curves.iter().flat_map(|curve| curve.points.iter().copied()).collect()
    }
}

impl Curve {
    fn add(&mut self, point: LossPoint) {
        self.every = self.every.max(1);
        if self.seen.is_multiple_of(self.every) {
            if self.points.len() >= MOST / Method::ALL.len() {
                let mut kept = 0;
                self.points.retain(|_| {
                    kept += 1;
                    kept % 2 == 1
                });
                self.every *= 2;
            }
            if self.seen.is_multiple_of(self.every) {
                self.points.push(point);
            }
        }
        self.seen += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_stay_short_and_keep_their_beginning_and_their_shape() {
        let losses = Losses::default();
        for iteration in 1..=10_000 {
            for method in [Method::M2, Method::M3] {
                losses.add(LossPoint {
                    method,
                    member: 0,
                    iteration,
                    train_rms_m: 1.0 / iteration as f64,
                    held_out_rms_m: None,
                });
            }
        }
        let points = losses.points();
        assert!(points.len() <= MOST, "{}", points.len());
        let of_m3: Vec<usize> =
            points.iter().filter(|p| p.method == Method::M3).map(|p| p.iteration).collect();
        assert!(of_m3.len() > MOST / 8 && of_m3[0] == 1 && of_m3[of_m3.len() - 1] > 9_800);
        assert!(of_m3.windows(2).all(|pair| pair[1] - pair[0] == of_m3[1] - of_m3[0]), "evenly spaced");
    }
}

//! How far looks scatter while nothing moves.

use nalgebra::Vector3;

use super::Sample;
use super::mover::{since, turns};
use crate::cost::{PlaceError, TableError};
use crate::watch::Look;

/// A look that is farther off than so many standard deviations is out of the band.
const SIGMAS: f64 = 6.0;
/// The band is no narrower than this near, in the middle and far, m: less is worth no word.
const LEAST_M: [f64; 3] = [0.0015, 0.002, 0.003];
/// And no wider, m: what a hand that grasps bears.
const MOST_M: f64 = 0.008;
/// Two single looks are apart beyond so many half widths: both of them scatter.
const OF_TWO: f64 = 1.8;
/// The same of turns, rad: about 0.1 and 0.3 degrees. A nod of one eye costs little, but no calibration knows it.
const LEAST_RAD: f64 = 0.0017;
const MOST_RAD: f64 = 0.004;

/// Where places come out in the first minutes, and how far single looks lie from that.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The middle of it.
    center: TableError,
    /// How the eyes stood then: left, right, right against left, rad.
    turns_rad: [Vector3<f64>; 3],
    /// Its half width near, in the middle and far, m.
    pub half_m: [f64; 3],
    /// The same for turns of the left eye, of the right one, and against each other, rad.
    pub half_rad: [f64; 3],
    /// When the last look of it was, s.
    pub until_s: f64,
}

impl Band {
    /// It is learned from so many looks.
    pub const LOOKS: usize = 15;

    /// `None`: there were too few looks.
    ///
    /// Scatter is how far a look lies from between the one before and the one after it, which a slow drift does not
    /// widen. The middle is where places came out before they had drifted out of that.
    pub(super) fn learned(samples: &[Sample]) -> Option<Self> {
        let learned = samples.get(..Self::LOOKS)?;
        let half_m = [0, 1, 2].map(|row: usize| {
            let sigma_m = scatter(learned, |between| between.table_m[row]);
            (SIGMAS * sigma_m).clamp(LEAST_M[row], MOST_M)
        });
        let half_rad = [0, 1, 2].map(|k: usize| {
            let sigma_rad = scatter(learned, |between| between.turns_rad[k]);
            (SIGMAS * sigma_rad).clamp(LEAST_RAD, MOST_RAD)
        });
        let begun = &learned[0].look.table;
        let stays = |sample: &&Sample| {
            let off_m = sample.look.table.apart_m(begun);
            (0..3).all(|row| off_m[row] <= half_m[row])
        };
        let first: Vec<&Sample> = learned.iter().take_while(stays).collect();
        let count = first.len().max(1) as f64;
        let mut center = *begun;
        for (r, row) in center.rows.iter_mut().enumerate() {
            for (p, place) in row.iter_mut().enumerate() {
                let all = || first.iter().map(|sample| &sample.look.table.rows[r][p]);
                let mean = |of: fn(&PlaceError) -> f64| all().map(of).sum::<f64>() / count;
                place.error_m = all().map(|place| place.error_m).sum::<Vector3<f64>>() / count;
                (place.along_m, place.across_m) = (mean(|p| p.along_m), mean(|p| p.across_m));
            }
        }
        let mut turns_rad = [Vector3::zeros(); 3];
        for sample in &first {
            for (sum, turn) in turns_rad.iter_mut().zip(turns(&sample.look)) {
                *sum += turn / count;
            }
        }
        let until_s = learned.last().map_or(0.0, |sample| sample.at_s);
        Some(Self { center, turns_rad, half_m, half_rad, until_s })
    }

    /// Whether two looks lie farther apart than looks scatter; a band that is not learned yet is the widest.
    pub(super) fn are_apart(band: Option<&Self>, a: &Look, b: &Look) -> bool {
        let (limits_m, limits_rad) =
            band.map_or(([MOST_M; 3], [MOST_RAD; 3]), |band| (band.half_m, band.half_rad));
        let apart_m = a.table.apart_m(&b.table);
        let (a, b) = (turns(a), turns(b));
        (0..3).any(|k| apart_m[k] > OF_TWO * limits_m[k] || (a[k] - b[k]).norm() > OF_TWO * limits_rad[k])
    }

    /// How far a look is from its middle near, in the middle and far, m.
    pub(super) fn off_m(&self, look: &Look) -> [f64; 3] {
        look.table.apart_m(&self.center)
    }

    /// Whether a look is out of it anywhere.
    pub(super) fn is_out(&self, look: &Look) -> bool {
        let turned = self.turns_since(look);
        let off_m = self.off_m(look);
        (0..3).any(|k| off_m[k] > self.half_m[k] || turned[k].norm() > self.half_rad[k])
    }

    /// Whether places come out of it anywhere: what the eyes turn slowly counts by what it costs, since an
    /// accepted law of their warming up takes it off.
    pub(super) fn costs(&self, look: &Look) -> bool {
        let off_m = self.off_m(look);
        (0..3).any(|k| off_m[k] > self.half_m[k])
    }

    /// How the eyes turned since then.
    pub(super) fn turns_since(&self, look: &Look) -> [Vector3<f64>; 3] {
        since(&self.turns_rad, look)
    }
}

/// How far a look lies from the line between its neighbors in time.
struct Between {
    /// Mean over the places of a row, near, in the middle and far, m.
    table_m: [f64; 3],
    /// Of the turns of the left eye, of the right one, and against each other, rad.
    turns_rad: [f64; 3],
}

impl Between {
    /// In standard deviations of one look: the line scatters, too.
    fn of(before: &Sample, at: &Sample, after: &Sample) -> Self {
        let span_s = after.at_s - before.at_s;
        let late = if span_s > 0.0 { ((at.at_s - before.at_s) / span_s).clamp(0.0, 1.0) } else { 0.5 };
        let early = 1.0 - late;
        let inflate = (1.0 + late * late + early * early).sqrt();
        let off = |at: Vector3<f64>, before: Vector3<f64>, after: Vector3<f64>| {
            (at - before * early - after * late).norm() / inflate
        };
        let table_m = [0, 1, 2].map(|row: usize| {
            let error_m = |sample: &Sample, place: usize| sample.look.table.rows[row][place].error_m;
            let place = |p: usize| off(error_m(at, p), error_m(before, p), error_m(after, p));
            (0..3).map(place).sum::<f64>() / 3.0
        });
        let [before, at, after] = [before, at, after].map(|sample| turns(&sample.look));
        Self { table_m, turns_rad: [0, 1, 2].map(|k: usize| off(at[k], before[k], after[k])) }
    }
}

/// Root mean square of what looks lie off their neighbors.
fn scatter(looks: &[Sample], of: impl Fn(&Between) -> f64) -> f64 {
    let squares: Vec<f64> =
        looks.windows(3).map(|three| of(&Between::of(&three[0], &three[1], &three[2])).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

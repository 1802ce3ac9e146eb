//! Places on a grid of known targets: how far off they come out, and what the published correction makes of
//! them.
//!
//! The published one moves places in the plane of the table toward a pivot that was chosen by hand, by a
//! polynomial of the distance from the eyes that was fitted to such a grid. It is here to compare with: what
//! it learned at one height and one temperature is not so at others.

use nalgebra::{Matrix3, Point2, Vector2, Vector3};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::{LocalizationRow, LocalizationTable};
use plumbline_model::{Point, Robot};

/// Where places are moved toward, robot frame, m.
const PIVOT_M: [f64; 2] = [0.10, -0.20];
/// Farther from the eyes than this places are drawn toward the pivot by a factor, m.
const FAR_M: f64 = 0.720;
/// Fewer places on a side of that do not tell its parameters.
const LEAST_NEAR: usize = 4;
const LEAST_FAR: usize = 2;

/// A target and where it came out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPlace {
    /// Where it is, robot frame.
    pub target: Point<Robot>,
    /// Where it came out, robot frame.
    pub estimate: Point<Robot>,
    /// How far from the left eye it came out, m.
    pub range_m: f64,
}

impl GridPlace {
    /// Estimate minus target in the plane of the table, m.
    pub fn error_m(&self) -> Vector2<f64> {
        self.estimate.coords.coords.xy() - self.target.coords.coords.xy()
    }
}

/// Places of a session with target and estimate that count; a head whose angles are not told stands as usual.
/// Rows of one group are looks at one place: their mean counts.
pub fn grid_places(table: &LocalizationTable, rig: &Rig) -> Vec<GridPlace> {
    places_by(table, rig, |row, _| row.estimate)
}

/// The same with estimates of one's own: `estimate` says where a row comes out as the robot stands in it.
pub(crate) fn places_by(
    table: &LocalizationTable,
    rig: &Rig,
    estimate: impl Fn(&LocalizationRow, &Posture) -> Option<Point<Robot>>,
) -> Vec<GridPlace> {
    let joints: Vec<_> =
        table.head_joints().iter().map(|name| rig.description.find_joint(name).ok()).collect();
    let mut all: Vec<Looks> = Vec::new();
    for row in table.rows().filter(|row| row.valid) {
        let mut posture = rig.home();
        for (joint, angle_rad) in joints.iter().zip(&row.head_rad) {
            if let (Some(joint), Some(angle_rad)) = (joint, angle_rad) {
                posture[*joint] = *angle_rad;
            }
        }
        let (Some(target), Some(seen)) = (row.truth, estimate(&row, &posture)) else { continue };
        let seen_m = seen.coords.coords;
        let again =
            |looks: &&mut Looks| looks.group.is_some() && looks.group == row.group && looks.target == target;
        match all.iter_mut().find(again) {
            Some(looks) => looks.seen_m.push(seen_m),
            None => all.push(Looks { group: row.group.clone(), target, posture, seen_m: vec![seen_m] }),
        }
    }
    let place = |looks: Looks| {
        let mean_m = looks.seen_m.iter().sum::<Vector3<f64>>() / looks.seen_m.len() as f64;
        let estimate = Point::new(mean_m.x, mean_m.y, mean_m.z);
        let range_m = (rig.robot_from_left(&looks.posture).inverse() * estimate).range_m();
        GridPlace { target: looks.target, estimate, range_m }
    };
    all.into_iter().map(place).collect()
}

/// Looks at one place.
struct Looks {
    group: Option<String>,
    target: Point<Robot>,
    posture: Posture,
    /// Where it came out each time, robot frame.
    seen_m: Vec<Vector3<f64>>,
}

/// Mean, median and largest error in the plane of the table, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridErrors {
    /// Mean.
    pub mean_m: f64,
    /// Median.
    pub median_m: f64,
    /// Largest.
    pub worst_m: f64,
}

impl GridErrors {
    /// Of these places; `None`: there are none.
    pub fn of(places: &[GridPlace]) -> Option<Self> {
        let mut sizes_m: Vec<f64> = places.iter().map(|place| place.error_m().norm()).collect();
        sizes_m.sort_by(f64::total_cmp);
        let worst_m = *sizes_m.last()?;
        let half = sizes_m.len() / 2;
        let median_m =
            if sizes_m.len() % 2 == 1 { sizes_m[half] } else { 0.5 * (sizes_m[half - 1] + sizes_m[half]) };
        Some(Self { mean_m: sizes_m.iter().sum::<f64>() / sizes_m.len() as f64, median_m, worst_m })
    }
}

/// The published correction toward a pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PivotCorrection {
    /// Coefficients of the shift toward the pivot (m) at a distance d (m): a d² + b d + c.
    pub shift: [f64; 3],
    /// What the distance to the pivot is multiplied by beyond [`FAR_M`].
    pub far_factor: f64,
}

impl PivotCorrection {
    /// As published for the head as it stands at first.
    pub const PUBLISHED: Self = Self { shift: [0.320_849, -0.163_687, 0.032_437], far_factor: 0.8 };

    /// Fitted as it was published: least squares of the shift that is missing along the way to the pivot.
    /// Where too few places are far the factor for those is the published one. `None`: the places do not tell
    /// the shift.
    pub fn fitted(places: &[GridPlace]) -> Option<Self> {
        let (near, far): (Vec<&GridPlace>, Vec<&GridPlace>) =
            places.iter().partition(|place| place.range_m <= FAR_M);
        if near.len() < LEAST_NEAR {
            return None;
        }
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for place in near {
            let d = place.range_m;
            let row = Vector3::new(d * d, d, 1.0);
            let missing_m = -place.error_m().dot(&to_pivot(place).try_normalize(1e-9)?);
            normal += row * row.transpose();
            right += row * missing_m;
        }
        let [a, b, c] = normal.cholesky()?.solve(&right).into();
        if far.len() < LEAST_FAR {
            return Some(Self { shift: [a, b, c], far_factor: Self::PUBLISHED.far_factor });
        }
        let (mut sum, mut square) = (0.0, 0.0);
        for place in far {
            let out = -to_pivot(place);
            let wanted = place.target.coords.coords.xy() - pivot().coords;
            sum += out.dot(&wanted);
            square += out.norm_squared();
        }
        Some(Self { shift: [a, b, c], far_factor: sum / square })
    }

    /// Where it puts a place.
    pub fn applied(&self, place: &GridPlace) -> GridPlace {
        let to_pivot = to_pivot(place);
        let d = place.range_m;
        let by_m = if d <= FAR_M {
            let [a, b, c] = self.shift;
            to_pivot.try_normalize(1e-9).unwrap_or_default() * (a * d * d + b * d + c)
        } else {
            to_pivot * (1.0 - self.far_factor)
        };
        let at = place.estimate.coords.coords;
        GridPlace { estimate: Point::new(at.x + by_m.x, at.y + by_m.y, at.z), ..*place }
    }

    /// Each place corrected by what was fitted to all others. `None`: the others do not tell it.
    pub fn leave_one_out(places: &[GridPlace]) -> Option<Vec<GridPlace>> {
        let one = |k: usize| {
            let others: Vec<GridPlace> =
                places.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, place)| *place).collect();
            Some(Self::fitted(&others)?.applied(&places[k]))
        };
        (0..places.len()).map(one).collect()
    }
}

fn pivot() -> Point2<f64> {
    Point2::from(PIVOT_M)
}

fn to_pivot(place: &GridPlace) -> Vector2<f64> {
    pivot().coords - place.estimate.coords.coords.xy()
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    /// A grid that the published correction brings to its targets exactly.
    fn made_up() -> Vec<GridPlace> {
        let rig = default_rig();
        let eye = rig.robot_from_left(&rig.home()).inverse();
        let mut places = vec![];
        for x in 0..4 {
            for y in 0..9 {
                let estimate = Point::new(0.2 + 0.18 * f64::from(x), -0.4 + 0.1 * f64::from(y), 0.05);
                let range_m = (eye * estimate).range_m();
                let place = GridPlace { target: estimate, estimate, range_m };
                places
                    .push(GridPlace { target: PivotCorrection::PUBLISHED.applied(&place).estimate, ..place });
            }
        }
        places
    }

    #[test]
    fn its_fit_finds_the_published_one_again() {
        let places = made_up();
        let found = PivotCorrection::fitted(&places).expect("told");
        for (found, published) in found.shift.iter().zip(PivotCorrection::PUBLISHED.shift) {
            assert!((found - published).abs() < 1e-9, "{found} {published}");
        }
        assert!((found.far_factor - 0.8).abs() < 1e-9, "{found:?}");
        let left = PivotCorrection::leave_one_out(&places).expect("told");
        assert!(GridErrors::of(&left).expect("places").worst_m < 1e-9);
    }

    #[test]
    fn few_places_tell_nothing_and_none_have_no_error() {
        assert_eq!(PivotCorrection::fitted(&made_up()[..3]), None);
        assert_eq!(GridErrors::of(&[]), None);
        let errors = GridErrors::of(&made_up()).expect("places");
        assert!(
            errors.median_m > 0.0 && errors.median_m <= errors.worst_m && errors.mean_m <= errors.worst_m
        );
    }
}

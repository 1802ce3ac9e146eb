//! Eyes with effects: where they see a place, and which place it is that they mistake for another.

use nalgebra::{Isometry3, Matrix3, Vector3};
use plumbline_model::{Pixel, Point, Raw, Robot};

use crate::eyes::{EyeSituation, Eyes, EyesDeviation};
use crate::library::Present;
use crate::observation::Observation;

/// Steps of Newton's method from a measurement to the place that it means.
const STEPS: usize = 30;
/// Where it has converged, in natural coordinates (rad; a micrometer at 1 m is a millionth).
const CONVERGED_RAD: f64 = 1e-9;
/// Step of its differences, rad.
const DIFFERENCE_RAD: f64 = 1e-5;

/// Eyes with effects in the situation of a row.
pub(crate) struct Looking<'a> {
    pub eyes: &'a Eyes,
    pub row: &'a Observation,
    pub effects: &'a [Present],
}

impl Looking<'_> {
    fn deviation(&self, situation: &EyeSituation) -> EyesDeviation {
        let mut deviation = EyesDeviation::none(self.eyes.neck.len());
        for present in self.effects {
            present.effect.deviate_eyes(situation, &present.values, &mut deviation);
        }
        deviation
    }

    /// Where the left eye is nominally.
    fn robot_from_left(&self) -> Isometry3<f64> {
        self.eyes.robot_from_left(&self.row.neck_rad, &EyesDeviation::none(self.eyes.neck.len()))
    }

    /// Where both eyes see a place, raw px.
    pub fn pixels(&self, truth: Point<Robot>) -> Option<(Pixel<Raw>, Pixel<Raw>)> {
        let situation = self.eyes.situation(self.row, truth.coords);
        let seen = self.eyes.image_points(&situation, &self.deviation(&situation))?;
        Some((Pixel::new(seen[0], seen[1]), Pixel::new(seen[2], seen[3])))
    }

    /// What stereo with the nominal eyes makes of a place, in their natural coordinates.
    fn natural(&self, truth: Point<Robot>) -> Option<Vector3<f64>> {
        let situation = self.eyes.situation(self.row, truth.coords);
        let seen = self.eyes.estimate(self.row, &situation, &self.deviation(&situation))?;
        Some(Vector3::new(seen[0], seen[1], seen[2]))
    }

    fn place(&self, natural: &Vector3<f64>) -> Option<Point<Robot>> {
        Some(Point::from(self.robot_from_left() * self.eyes.place(natural.as_slice())?))
    }

    /// What stereo with the nominal eyes makes of a place.
    pub fn estimate(&self, truth: Point<Robot>) -> Option<Point<Robot>> {
        self.place(&self.natural(truth)?)
    }

    /// The other way: the place that stereo with the nominal eyes makes `inferred` of. Newton's method
    /// in natural coordinates, where effects are nearly shifts. `None` when there is no such place.
    pub fn place_of(&self, inferred: Point<Robot>) -> Option<Point<Robot>> {
        let in_left = self.robot_from_left().inverse() * inferred.coords;
        if in_left.z <= 0.0 {
            return None;
        }
        let wanted = Vector3::from(self.eyes.natural(&in_left));
        let off = |natural: &Vector3<f64>| Some(self.natural(self.place(natural)?)? - wanted);
        let mut natural = wanted;
        for _ in 0..STEPS {
            let left = off(&natural)?;
            if left.norm() < CONVERGED_RAD {
                return self.place(&natural);
            }
            let mut slope = Matrix3::zeros();
            for k in 0..3 {
                let step = Vector3::ith(k, DIFFERENCE_RAD);
                slope.set_column(
                    k,
                    &((off(&(natural + step))? - off(&(natural - step))?) / (2.0 * DIFFERENCE_RAD)),
                );
            }
            natural -= slope.lu().solve(&left)?;
        }
        None
    }
}

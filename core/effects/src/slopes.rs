//! How a predicted row changes with each part of a deviation, worked out once per row: what an
//! effect does to the row is then a sum over the few parts that it touches.

use nalgebra::{Isometry3, Matrix3, Matrix3x2, Translation3, UnitQuaternion, Vector2, Vector3};

use crate::arm::{Arm, Deviation};
use crate::eyes::{EyeSituation, Eyes, EyesDeviation};
use crate::library::Surface;
use crate::observation::{Observation, What};

/// Half of a difference over the parts of the surface, m or rad or as a share.
const STEP: f64 = 1e-5;

/// Of the place of the arm's tip, or of its touch, by the parts of the arm's deviation.
pub(crate) struct ArmSlopes {
    /// The coordinates themselves.
    pub predicted: Vector3<f64>,
    /// By shifts along and turns about x, y, z of the robot's frame, the latter about a pivot.
    pub shifts: Matrix3<f64>,
    pub turns: Matrix3<f64>,
    joints: Vec<Vector3<f64>>,
    skews: Vec<Matrix3<f64>>,
    places: Vec<Matrix3<f64>>,
    /// By shifts along the axes of the tip's frame.
    pub tip: Matrix3<f64>,
    /// Of the turn against the measured orientation, where one was measured.
    pub turned: Option<TurnSlopes>,
    base_turn: Matrix3<f64>,
    base: Matrix3<f64>,
    scale: Matrix3x2<f64>,
    bow: Matrix3x2<f64>,
    edge: Vector3<f64>,
    screen: Matrix3<f64>,
    screen_turn: Matrix3<f64>,
}

/// Where the arm's points are measured, and which orientation was.
pub(crate) struct At<'a> {
    /// From the robot to where it is measured.
    pub placement: &'a Isometry3<f64>,
    /// `tip_from_marker`.
    pub mount: &'a Isometry3<f64>,
    /// `external_from_tip` as measured.
    pub orientation: Option<UnitQuaternion<f64>>,
}

/// Of the turn from the measured orientation to the predicted one, by the parts of the arm's deviation.
pub(crate) struct TurnSlopes {
    /// The rotation vector itself, external frame, rad.
    pub predicted: Vector3<f64>,
    /// By turns of the external frame about x, y, z.
    pub frame: Matrix3<f64>,
    /// By turns about x, y, z of the marker.
    pub mount: Matrix3<f64>,
    joints: Vec<Vector3<f64>>,
    skews: Vec<Matrix3<f64>>,
    base_turn: Matrix3<f64>,
}

impl TurnSlopes {
    /// `steps`: rotation of each joint once its axis is skewed; `marker`: of what was measured, robot
    /// frame.
    fn of(
        arm: &Arm,
        steps: &[UnitQuaternion<f64>],
        deviation: &Deviation,
        at: &At<'_>,
        marker: UnitQuaternion<f64>,
    ) -> Option<Self> {
        let orientation = at.orientation?;
        let predicted = (at.placement.rotation * marker * orientation.inverse()).scaled_axis();
        let frame = inverse_left_jacobian(&predicted);
        let from_robot = frame * at.placement.rotation.to_rotation_matrix().into_inner();
        let left = right_jacobian(&-deviation.base_rad);
        Some(Self {
            predicted,
            frame,
            mount: from_robot * marker.to_rotation_matrix().into_inner(),
            joints: steps
                .iter()
                .zip(&arm.parts)
                .map(
                    |(turned, part)| {
                        if part.slides { Vector3::zeros() } else { from_robot * (turned * *part.axis) }
                    },
                )
                .collect(),
            skews: steps
                .iter()
                .zip(&deviation.skew_rad)
                .map(|(turned, skew)| {
                    from_robot * turned.to_rotation_matrix().into_inner() * right_jacobian(skew)
                })
                .collect(),
            base_turn: from_robot * left,
        })
    }

    /// What a small further deviation changes.
    pub fn along(&self, deviation: &Deviation) -> Vector3<f64> {
        let mut sum = self.base_turn * deviation.base_rad;
        for (slope, angle) in self.joints.iter().zip(&deviation.joint_rad).filter(|(_, a)| **a != 0.0) {
            sum += slope * *angle;
        }
        for (slope, turn) in
            self.skews.iter().zip(&deviation.skew_rad).filter(|(_, t)| **t != Vector3::zeros())
        {
            sum += slope * turn;
        }
        sum
    }
}

impl ArmSlopes {
    /// Around a deviation; `pivot` as placed. Without a surface: of the tip's place itself.
    pub fn of(
        arm: &Arm,
        surface: Option<(&Surface, f64)>,
        angles_rad: &[f64],
        deviation: &Deviation,
        measured: &At<'_>,
        pivot: &Vector3<f64>,
    ) -> Self {
        let placement = measured.placement;
        // Down the chain, remembering what each part turns about.
        let mut place = Isometry3::from_parts(
            Translation3::from(deviation.base_m),
            UnitQuaternion::from_scaled_axis(deviation.base_rad),
        );
        let mut steps = Vec::with_capacity(arm.len());
        for (i, (part, angle_rad)) in arm.parts.iter().zip(angles_rad).enumerate() {
            let before = place.rotation;
            let shift = part.before.translation.vector + deviation.shift_m[i];
            place *= Isometry3::from_parts(Translation3::from(shift), part.before.rotation);
            place.rotation *= UnitQuaternion::from_scaled_axis(deviation.skew_rad[i]);
            steps.push((place.translation.vector, before, place.rotation));
            place *= part.motion(angle_rad + deviation.joint_rad[i]);
        }
        let last = place * arm.last_from_tip;
        let marker = last * Translation3::from(deviation.tip_m) * measured.mount;
        let free = marker.translation.vector;
        let turns: Vec<UnitQuaternion<f64>> = steps.iter().map(|(_, _, turned)| *turned).collect();
        let tip = placement * nalgebra::Point3::from(free + deviation.contact_m);
        // From the placed tip to what is measured.
        let seen = |tip: nalgebra::Point3<f64>, deviation: &Deviation| match surface {
            Some((surface, raised_m)) => surface.touch_m(tip, raised_m, deviation),
            None => tip.coords,
        };
        let by = |change: &dyn Fn(f64) -> Vector3<f64>| (change(STEP) - change(-STEP)) / (2.0 * STEP);
        let shifts = match surface {
            Some(_) => columns(|k| by(&|step| seen(tip + Vector3::ith(k, step), deviation))),
            None => Matrix3::identity(),
        };
        let changed = |change: &dyn Fn(&mut Deviation, f64)| {
            if surface.is_none() {
                return Vector3::zeros();
            }
            by(&|step| {
                let mut other =
                    Deviation { joint_rad: vec![], skew_rad: vec![], shift_m: vec![], ..*deviation };
                change(&mut other, step);
                seen(tip, &other)
            })
        };
        let from_robot = shifts * placement.rotation.to_rotation_matrix().into_inner();
        let lever = |about: &Vector3<f64>| free - about;
        let joints = steps.iter().zip(&arm.parts);
        Self {
            turned: TurnSlopes::of(arm, &turns, deviation, measured, marker.rotation),
            predicted: seen(tip, deviation),
            shifts,
            turns: columns(|k| shifts * Vector3::ith(k, 1.0).cross(&(tip.coords - pivot))),
            joints: joints
                .map(|((at, _, turned), part)| {
                    let axis = turned * *part.axis;
                    from_robot * if part.slides { axis } else { axis.cross(&lever(at)) }
                })
                .collect(),
            skews: steps
                .iter()
                .enumerate()
                .map(|(i, (at, _, turned))| {
                    let right = right_jacobian(&deviation.skew_rad[i]);
                    columns(|k| from_robot * (turned * right.column(k).into_owned()).cross(&lever(at)))
                })
                .collect(),
            places: steps
                .iter()
                .map(|(_, before, _)| from_robot * before.to_rotation_matrix().into_inner())
                .collect(),
            tip: from_robot * last.rotation.to_rotation_matrix().into_inner(),
            base_turn: {
                let left = right_jacobian(&-deviation.base_rad);
                columns(|k| from_robot * left.column(k).cross(&lever(&deviation.base_m)))
            },
            base: from_robot,
            scale: Matrix3x2::from_columns(&[0, 1].map(|k| changed(&|d, step| d.screen_scale[k] += step))),
            bow: Matrix3x2::from_columns(&[0, 1].map(|k| changed(&|d, step| d.screen_bow_per_m[k] += step))),
            edge: changed(&|d, step| d.screen_edge_m += step),
            screen: columns(|k| changed(&|d, step| d.screen_m[k] += step)),
            screen_turn: columns(|k| changed(&|d, step| d.screen_rad[k] += step)),
        }
    }

    /// What a small further deviation changes.
    pub fn along(&self, deviation: &Deviation) -> Vector3<f64> {
        let mut sum = self.base * (deviation.base_m + deviation.contact_m) + self.tip * deviation.tip_m;
        for (slope, angle) in self.joints.iter().zip(&deviation.joint_rad).filter(|(_, a)| **a != 0.0) {
            sum += slope * *angle;
        }
        for (slope, turn) in
            self.skews.iter().zip(&deviation.skew_rad).filter(|(_, t)| **t != Vector3::zeros())
        {
            sum += slope * turn;
        }
        for (slope, shift) in
            self.places.iter().zip(&deviation.shift_m).filter(|(_, s)| **s != Vector3::zeros())
        {
            sum += slope * shift;
        }
        sum += self.base_turn * deviation.base_rad;
        sum += self.scale * Vector2::from(deviation.screen_scale);
        sum += self.bow * Vector2::from(deviation.screen_bow_per_m);
        sum += self.edge * deviation.screen_edge_m;
        sum + self.screen * deviation.screen_m + self.screen_turn * deviation.screen_rad
    }
}

fn columns(of: impl Fn(usize) -> Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[of(0), of(1), of(2)])
}

/// J with exp(ω + δ) = exp(ω) exp(J δ) for small δ.
fn right_jacobian(turn: &Vector3<f64>) -> Matrix3<f64> {
    let angle = turn.norm();
    let cross = turn.cross_matrix();
    if angle < 1e-4 {
        return Matrix3::identity() - cross * 0.5 + cross * cross / 6.0;
    }
    let square = angle * angle;
    Matrix3::identity() - cross * ((1.0 - angle.cos()) / square)
        + cross * cross * ((angle - angle.sin()) / (square * angle))
}

/// J with log(exp(δ) exp(ω)) = ω + J δ for small δ.
fn inverse_left_jacobian(turn: &Vector3<f64>) -> Matrix3<f64> {
    let angle = turn.norm();
    let cross = turn.cross_matrix();
    let second = if angle < 1e-4 {
        1.0 / 12.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half * half.cos() / half.sin()) / (angle * angle)
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * second
}

/// Of what the eyes see or estimate, by the parts of their deviation.
pub(crate) struct EyesSlopes {
    /// The coordinates themselves.
    pub predicted: Vec<f64>,
    /// One per part of [`EyesDeviation::parts`].
    parts: Vec<Vec<f64>>,
}

impl EyesSlopes {
    /// Around a deviation; `None` where the eyes do not see the place.
    pub fn of(
        eyes: &Eyes,
        row: &Observation,
        situation: &EyeSituation,
        deviation: &EyesDeviation,
    ) -> Option<Self> {
        let seen = |deviation: &EyesDeviation| match row.what {
            What::EyePoints => eyes.image_points(situation, deviation),
            _ => eyes.estimate(row, situation, deviation),
        };
        let predicted = seen(deviation)?;
        let parts = deviation.parts();
        let mut slopes = Vec::with_capacity(parts.len());
        for (k, (_, step)) in parts.iter().enumerate() {
            let at = |side: f64| {
                let mut other = deviation.clone();
                *other.parts_mut()[k] += side * step;
                seen(&other)
            };
            let (ahead, behind) = (at(1.0)?, at(-1.0)?);
            slopes.push(ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * step)).collect());
        }
        Some(Self { predicted, parts: slopes })
    }

    /// What a small further deviation changes, appended to `column`.
    pub fn along(&self, deviation: &EyesDeviation, column: &mut Vec<f64>) {
        let start = column.len();
        column.resize(start + self.predicted.len(), 0.0);
        for ((value, _), slope) in deviation.parts().iter().zip(&self.parts) {
            if *value != 0.0 {
                for (sum, slope) in column[start..].iter_mut().zip(slope) {
                    *sum += slope * value;
                }
            }
        }
    }
}

//! Predicts a row with effects, and how it changes with each of them.

use nalgebra::{DMatrix, Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::arm::Deviation;
use crate::eyes::{EyeSituation, EyesDeviation};
use crate::library::{Effect, Situation};
use crate::measurements::{Measurements, Observation, What};

/// Difference step, in usual sizes of a parameter (see `observability`).
const STEP: f64 = 0.01;

/// An effect with the values of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Present {
    /// The effect at its site.
    pub effect: Effect,
    /// One value per parameter of [`Effect::parameters`].
    pub values: Vec<f64>,
}

/// What predictions are made with.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Assumed {
    /// Effects that are in the model.
    pub effects: Vec<Present>,
    /// Per session: moves the robot's points before they are measured, robot frame. For touches it
    /// is the screen that lies elsewhere (the other way), for poses it leads into the external
    /// frame. Identity: where the session says.
    pub placements: Vec<Isometry3<f64>>,
}

impl Assumed {
    /// The nominal model.
    pub fn nominal(measurements: &Measurements) -> Self {
        Self { effects: vec![], placements: measurements.nominal_placements() }
    }
}

/// A prediction and how it changes.
#[derive(Clone, Debug)]
pub struct Tangents {
    /// Predicted natural coordinates.
    pub predicted: Vec<f64>,
    /// Per shift (m) along x, y, z and per turn (rad) about x, y, z of the session's frame; turns
    /// about [`Measurements::pivot`]. One row per coordinate. All zero where nothing is placed.
    pub gauge: DMatrix<f64>,
    /// Per parameter of every candidate in turn, per usual size of the parameter; one row per
    /// coordinate.
    pub effects: DMatrix<f64>,
}

impl Measurements {
    /// What a row should have measured; `None` when the model's eyes cannot see the place.
    pub fn predict(&self, row: &Observation, assumed: &Assumed) -> Option<Vec<f64>> {
        let scene = Scene::of(self, row);
        let (mut arm, mut eyes) = scene.none();
        for present in &assumed.effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        scene.predict(&arm, &eyes, &assumed.placements[row.session])
    }

    /// The prediction, and its change with the session's frame and with each candidate, by central
    /// differences around what is assumed.
    pub fn tangents(&self, row: &Observation, assumed: &Assumed, candidates: &[Effect]) -> Option<Tangents> {
        let scene = Scene::of(self, row);
        let (mut arm, mut eyes) = scene.none();
        for present in &assumed.effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        let placement = &assumed.placements[row.session];
        let predicted = scene.predict(&arm, &eyes, placement)?;
        let size = predicted.len();
        let mut columns = Vec::with_capacity(candidates.len() * 2 * size);
        for candidate in candidates {
            let parameters = candidate.parameters();
            for (k, parameter) in parameters.iter().enumerate() {
                let mut values = vec![0.0; parameters.len()];
                let mut at = |sign: f64| {
                    values[k] = sign * STEP * parameter.typical;
                    let (mut arm, mut eyes) = (arm.clone(), eyes.clone());
                    scene.add(candidate, &values, &mut arm, &mut eyes);
                    scene.predict(&arm, &eyes, placement)
                };
                let (ahead, behind) = (at(1.0)?, at(-1.0)?);
                columns.extend(ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * STEP)));
            }
        }
        let effects = DMatrix::from_vec(size, columns.len() / size.max(1), columns);
        let mut gauge = DMatrix::zeros(size, 6);
        if row.what.is_placed() {
            let step = 1e-4;
            for k in 0..6 {
                let moved = |sign: f64| {
                    let mut twist = [0.0; 6];
                    twist[k] = sign * step;
                    scene.predict(&arm, &eyes, &self.moved(row.session, placement, &twist))
                };
                let (ahead, behind) = (moved(1.0)?, moved(-1.0)?);
                for (i, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                    gauge[(i, k)] = (a - b) / (2.0 * step);
                }
            }
        }
        Some(Tangents { predicted, gauge, effects })
    }

    /// A placement moved by a shift (m) and a turn (rad, rotation vector) about [`Self::pivot`].
    pub fn moved(&self, session: usize, placement: &Isometry3<f64>, twist: &[f64; 6]) -> Isometry3<f64> {
        let pivot = placement * self.pivot(session);
        let shift = Vector3::new(twist[0], twist[1], twist[2]);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(twist[3], twist[4], twist[5]));
        let about = Translation3::from(pivot.coords + shift) * turn * Translation3::from(-pivot.coords);
        about * placement
    }

    /// The point that turns of a session's frame go about, robot frame: the middle of the screen,
    /// or the nominal place of the tip at angles zero.
    pub fn pivot(&self, session: usize) -> Point3<f64> {
        let apparatus = &self.apparatuses[session];
        if let Some(surface) = &apparatus.surface {
            return surface.middle_m();
        }
        apparatus
            .arm
            .as_ref()
            .map_or(Point3::origin(), |arm| arm.tip_m(&vec![0.0; arm.len()], &Deviation::none(arm.len())))
    }
}

/// One row with all that its predictions need, worked out once.
struct Scene<'a> {
    row: &'a Observation,
    apparatus: &'a crate::measurements::Apparatus,
    situation: Option<Situation<'a>>,
    eye_situation: Option<EyeSituation>,
}

impl<'a> Scene<'a> {
    fn of(measurements: &'a Measurements, row: &'a Observation) -> Self {
        let apparatus = measurements.apparatus(row);
        let up = Vector3::z();
        let situation = apparatus.arm.as_ref().filter(|_| row.what.is_placed()).map(|arm| {
            let normal = apparatus.surface.as_ref().map_or(&up, |surface| surface.normal());
            Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, normal).during(row)
        });
        let eye_situation = apparatus
            .eyes
            .as_ref()
            .zip(row.truth_m)
            .filter(|_| !row.what.is_placed())
            .map(|(eyes, truth_m)| eyes.situation(row, truth_m));
        Self { row, apparatus, situation, eye_situation }
    }

    fn none(&self) -> (Deviation, EyesDeviation) {
        let joints = self.apparatus.arm.as_ref().map_or(0, |arm| arm.len());
        let neck = self.apparatus.eyes.as_ref().map_or(0, |eyes| eyes.neck.len());
        (Deviation::none(joints), EyesDeviation::none(neck))
    }

    fn add(&self, effect: &Effect, values: &[f64], arm: &mut Deviation, eyes: &mut EyesDeviation) {
        if let Some(situation) = &self.situation {
            effect.deviate(situation, values, arm);
        }
        if let Some(situation) = &self.eye_situation {
            effect.deviate_eyes(situation, values, eyes);
        }
    }

    fn predict(&self, arm: &Deviation, eyes: &EyesDeviation, placement: &Isometry3<f64>) -> Option<Vec<f64>> {
        match self.row.what {
            What::Touch => {
                let tip = placement * self.apparatus.arm.as_ref()?.tip_m(self.row.angles_rad(), arm);
                let surface = self.apparatus.surface.as_ref()?;
                let touch = surface.touch_m(tip, self.row.screen_height_m, arm);
                Some(touch.iter().copied().collect())
            }
            What::Pose => {
                let tip = placement * self.apparatus.arm.as_ref()?.tip_m(self.row.angles_rad(), arm);
                Some(tip.iter().copied().collect())
            }
            What::Place => {
                self.apparatus.eyes.as_ref()?.estimate(self.row, self.eye_situation.as_ref()?, eyes)
            }
            What::EyePoints => self.apparatus.eyes.as_ref()?.image_points(self.eye_situation.as_ref()?, eyes),
        }
    }
}

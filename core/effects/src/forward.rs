//! Predicts a row with effects, and how it changes with each of them.

use nalgebra::{DMatrix, Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::arm::Deviation;
use crate::eyes::{EyeSituation, EyesDeviation};
use crate::library::{Effect, Present, Situation};
use crate::measurements::Measurements;
use crate::observation::{Observation, What};
use crate::slopes::{ArmSlopes, EyesSlopes};

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
        let (mut arm, mut eyes) = scene.begin();
        for present in &assumed.effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        scene.predict(&arm, &eyes, &assumed.placements[row.session])
    }

    /// Place of the arm's tip at the angles of a row, with these effects; `None` without an arm.
    pub(crate) fn robot_from_tip(&self, row: &Observation, effects: &[Present]) -> Option<Isometry3<f64>> {
        let scene = Scene::of(self, row);
        let (mut arm, mut eyes) = scene.begin();
        for present in effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        Some(scene.apparatus.arm.as_ref()?.robot_from_tip(row.angles_rad(), &arm))
    }

    /// The prediction, and its change with the session's frame and with each candidate, around
    /// what is assumed.
    pub fn tangents(&self, row: &Observation, assumed: &Assumed, candidates: &[Effect]) -> Option<Tangents> {
        let scene = Scene::of(self, row);
        let (mut arm, mut eyes) = scene.begin();
        for present in &assumed.effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        let placement = &assumed.placements[row.session];
        if row.what.is_placed() {
            scene.arm_tangents(&arm, placement, &self.pivot(row.session), candidates)
        } else {
            scene.eye_tangents(&eyes, candidates)
        }
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
    /// Effects that the model already has.
    present: &'a [Present],
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
        Self { row, present: &measurements.present, apparatus, situation, eye_situation }
    }

    /// What the model already has; nothing for the nominal robot.
    fn begin(&self) -> (Deviation, EyesDeviation) {
        let joints = self.apparatus.arm.as_ref().map_or(0, |arm| arm.len());
        let neck = self.apparatus.eyes.as_ref().map_or(0, |eyes| eyes.neck.len());
        let (mut arm, mut eyes) = (Deviation::none(joints), EyesDeviation::none(neck));
        for present in self.present {
            self.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        (arm, eyes)
    }

    fn add(&self, effect: &Effect, values: &[f64], arm: &mut Deviation, eyes: &mut EyesDeviation) {
        if let Some(situation) = &self.situation {
            effect.deviate(situation, values, arm);
        }
        if let Some(situation) = &self.eye_situation {
            effect.deviate_eyes(situation, values, eyes);
        }
    }

    fn arm_tangents(
        &self,
        deviation: &Deviation,
        placement: &Isometry3<f64>,
        pivot: &Point3<f64>,
        candidates: &[Effect],
    ) -> Option<Tangents> {
        let (arm, situation) = (self.apparatus.arm.as_ref()?, self.situation.as_ref()?);
        let surface = match self.row.what {
            What::Touch => Some((self.apparatus.surface.as_ref()?, self.row.screen_height_m)),
            _ => None,
        };
        let pivot = (placement * pivot).coords;
        let slopes = ArmSlopes::of(arm, surface, self.row.angles_rad(), deviation, placement, &pivot);
        let mut scratch = Deviation::none(arm.len());
        let mut columns = Vec::with_capacity(candidates.len() * 6);
        for_each_parameter(candidates, |candidate, values| {
            if candidate.kind.is_of_eyes() {
                columns.extend([0.0; 3]);
            } else {
                scratch.clear();
                candidate.deviate(situation, values, &mut scratch);
                columns.extend(slopes.along(&scratch).iter());
            }
        });
        let mut gauge = DMatrix::zeros(3, 6);
        gauge.columns_mut(0, 3).copy_from(&slopes.shifts);
        gauge.columns_mut(3, 3).copy_from(&slopes.turns);
        let effects = DMatrix::from_vec(3, columns.len() / 3, columns);
        Some(Tangents { predicted: slopes.predicted.iter().copied().collect(), gauge, effects })
    }

    fn eye_tangents(&self, deviation: &EyesDeviation, candidates: &[Effect]) -> Option<Tangents> {
        let (eyes, situation) = (self.apparatus.eyes.as_ref()?, self.eye_situation.as_ref()?);
        let slopes = EyesSlopes::of(eyes, self.row, situation, deviation)?;
        let size = slopes.predicted.len();
        let mut columns = Vec::with_capacity(candidates.len() * 2 * size);
        for_each_parameter(candidates, |candidate, values| {
            let mut scratch = EyesDeviation::none(eyes.neck.len());
            candidate.deviate_eyes(situation, values, &mut scratch);
            slopes.along(&scratch, &mut columns);
        });
        let effects = DMatrix::from_vec(size, columns.len() / size.max(1), columns);
        Some(Tangents { predicted: slopes.predicted, gauge: DMatrix::zeros(size, 6), effects })
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

/// One parameter after the other at its usual size, the others of its effect at zero.
fn for_each_parameter(candidates: &[Effect], mut act: impl FnMut(&Effect, &[f64])) {
    // As many as an effect at every site has.
    let mut values = [0.0; 24];
    for candidate in candidates {
        let parameters = candidate.parameters();
        for (k, parameter) in parameters.iter().enumerate() {
            values[k] = parameter.typical;
            act(candidate, &values[..parameters.len()]);
            values[k] = 0.0;
        }
    }
}

//! Predicts a row with effects, and how it changes with each of them.

use nalgebra::{DMatrix, Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::arm::{Arm, Deviation};
use crate::eyes::{EyeSituation, EyesDeviation};
use crate::library::{Effect, Present, Situation};
use crate::measurements::Measurements;
use crate::observation::{Observation, What};
use crate::slopes::{ArmSlopes, At, EyesSlopes};

/// What predictions are made with.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Assumed {
    /// Effects that are in the model.
    pub effects: Vec<Present>,
    /// Per session: moves the robot's points before they are measured, robot frame. For touches it
    /// is the screen that lies elsewhere (the other way), for poses it leads into the external
    /// frame. Identity: where the session says.
    pub placements: Vec<Isometry3<f64>>,
    /// Per session: where the marker sits at the tip's frame, `tip_from_marker`. Sessions without an
    /// entry have it where the description has it.
    pub mounts: Vec<Isometry3<f64>>,
    /// Per stand ([`Observation::stand`]): what is added to each natural coordinate of its rows; pixels
    /// in units of 500 px. Stands without an entry have none.
    pub offsets: Vec<[f64; 4]>,
}

impl Assumed {
    /// The nominal model.
    pub fn nominal(measurements: &Measurements) -> Self {
        Self { placements: measurements.nominal_placements(), ..Self::default() }
    }

    /// Where the marker of a session sits: `tip_from_marker`.
    pub fn mount(&self, session: usize) -> Isometry3<f64> {
        self.mounts.get(session).copied().unwrap_or_default()
    }

    /// Says where the marker of a session sits.
    pub fn set_mount(&mut self, session: usize, tip_from_marker: Isometry3<f64>) {
        if self.mounts.len() <= session {
            self.mounts.resize(session + 1, Isometry3::identity());
        }
        self.mounts[session] = tip_from_marker;
    }

    /// What is constant of a stand, see [`Self::offsets`].
    pub fn offset(&self, stand: usize) -> [f64; 4] {
        self.offsets.get(stand).copied().unwrap_or_default()
    }

    /// Moves what is constant of a stand.
    pub fn shift_offset(&mut self, stand: usize, coordinate: usize, by: f64) {
        if self.offsets.len() <= stand {
            self.offsets.resize(stand + 1, [0.0; 4]);
        }
        self.offsets[stand][coordinate] += by;
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
    /// The same per shift (m) along x, y, z of the tip's frame and per turn (rad) about x, y, z of the
    /// marker of the session's marker at its tip.
    pub mount: DMatrix<f64>,
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
        let mut predicted =
            scene.predict(&arm, &eyes, &assumed.placements[row.session], &self.mount_of(row, assumed))?;
        add_offset(row, assumed, &mut predicted);
        Some(predicted)
    }

    /// Where what a row measured sits at the frame of its marker or tip.
    fn mount_of(&self, row: &Observation, assumed: &Assumed) -> Isometry3<f64> {
        if self.feels_mount(row) { assumed.mount(row.session) } else { Isometry3::identity() }
    }

    /// Where a marker is, `external_from_marker` (for touches: in the robot's frame as the screen lies), at
    /// what is assumed; `None` where nothing of the arm was measured.
    pub fn external_from_tip(&self, row: &Observation, assumed: &Assumed) -> Option<Isometry3<f64>> {
        let scene = Scene::of(self, row);
        scene.situation.as_ref()?;
        let (mut arm, mut eyes) = scene.begin();
        for present in &assumed.effects {
            scene.add(&present.effect, &present.values, &mut arm, &mut eyes);
        }
        let tip = scene.arm?.robot_from_tip(row.angles_rad(), &arm);
        Some(assumed.placements[row.session] * tip * self.mount_of(row, assumed))
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
            let placed = Placed {
                placement,
                mount: &self.mount_of(row, assumed),
                pivot: &self.pivot(self.frame_of(row.session)),
            };
            scene.arm_tangents(&arm, &placed, candidates)
        } else {
            let mut tangents = scene.eye_tangents(&eyes, candidates)?;
            add_offset(row, assumed, &mut tangents.predicted);
            Some(tangents)
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

/// Adds what is constant of the row's stand.
fn add_offset(row: &Observation, assumed: &Assumed, predicted: &mut [f64]) {
    let Some(stand) = row.stand else { return };
    let unit = row.what.offset_unit();
    for (value, offset) in predicted.iter_mut().zip(assumed.offset(stand)) {
        *value += unit * offset;
    }
}

/// One row with all that its predictions need, worked out once.
struct Scene<'a> {
    row: &'a Observation,
    /// Effects that the model already has.
    present: &'a [Present],
    apparatus: &'a crate::measurements::Apparatus,
    /// The arm that ends in what was measured.
    arm: Option<&'a Arm>,
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
        let (present, arm) = (&measurements.present, measurements.arm_of(row));
        Self { row, present, apparatus, arm, situation, eye_situation }
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
            if self.row.marker > 0 {
                // Where the chain's tip sits says nothing of another marker.
                arm.tip_m = Vector3::zeros();
            }
        }
        if let Some(situation) = &self.eye_situation {
            effect.deviate_eyes(situation, values, eyes);
        }
    }

    fn arm_tangents(
        &self,
        deviation: &Deviation,
        placed: &Placed<'_>,
        candidates: &[Effect],
    ) -> Option<Tangents> {
        let (arm, situation) = (self.arm?, self.situation.as_ref()?);
        let surface = match self.row.what {
            What::Touch => Some((self.apparatus.surface.as_ref()?, self.row.screen_height_m)),
            _ => None,
        };
        let pivot = (placed.placement * placed.pivot).coords;
        let at = At { placement: placed.placement, mount: placed.mount, orientation: self.orientation() };
        let slopes = ArmSlopes::of(arm, surface, self.row.angles_rad(), deviation, &at, &pivot);
        let size = self.row.what.len();
        let mut scratch = Deviation::none(deviation.joint_rad.len());
        let mut columns = Vec::with_capacity(candidates.len() * 2 * size);
        for_each_parameter(candidates, |candidate, values| {
            if candidate.kind.is_of_eyes() {
                columns.extend(std::iter::repeat_n(0.0, size));
            } else {
                scratch.clear();
                candidate.deviate(situation, values, &mut scratch);
                if self.row.marker > 0 {
                    scratch.tip_m = Vector3::zeros();
                }
                columns.extend(slopes.along(&scratch).iter());
                if let Some(turns) = &slopes.turned {
                    columns.extend(turns.along(&scratch).iter());
                }
            }
        });
        let (mut gauge, mut mount) = (DMatrix::zeros(size, 6), DMatrix::zeros(size, 6));
        gauge.view_mut((0, 0), (3, 3)).copy_from(&slopes.shifts);
        gauge.view_mut((0, 3), (3, 3)).copy_from(&slopes.turns);
        mount.view_mut((0, 0), (3, 3)).copy_from(&slopes.tip);
        let mut predicted: Vec<f64> = slopes.predicted.iter().copied().collect();
        if let Some(turns) = &slopes.turned {
            predicted.extend(turns.predicted.iter());
            gauge.view_mut((3, 3), (3, 3)).copy_from(&turns.frame);
            mount.view_mut((3, 3), (3, 3)).copy_from(&turns.mount);
        }
        let effects = DMatrix::from_vec(size, columns.len() / size, columns);
        Some(Tangents { predicted, gauge, mount, effects })
    }

    /// What an oriented pose measured.
    fn orientation(&self) -> Option<UnitQuaternion<f64>> {
        self.row.orientation.filter(|_| self.row.what == What::OrientedPose)
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
        Some(Tangents {
            predicted: slopes.predicted,
            gauge: DMatrix::zeros(size, 6),
            mount: DMatrix::zeros(size, 6),
            effects,
        })
    }

    fn predict(
        &self,
        arm: &Deviation,
        eyes: &EyesDeviation,
        placement: &Isometry3<f64>,
        mount: &Isometry3<f64>,
    ) -> Option<Vec<f64>> {
        let tip = || Some(placement * self.arm?.robot_from_tip(self.row.angles_rad(), arm) * mount);
        match self.row.what {
            What::Touch => {
                let surface = self.apparatus.surface.as_ref()?;
                let touch = surface.touch_m(tip()?.translation.vector.into(), self.row.screen_height_m, arm);
                Some(touch.iter().copied().collect())
            }
            What::Pose => Some(tip()?.translation.vector.iter().copied().collect()),
            What::OrientedPose => {
                let tip = tip()?;
                let turn = (tip.rotation * self.row.orientation?.inverse()).scaled_axis();
                Some(tip.translation.vector.iter().chain(turn.iter()).copied().collect())
            }
            What::Place => {
                self.apparatus.eyes.as_ref()?.estimate(self.row, self.eye_situation.as_ref()?, eyes)
            }
            What::EyePoints => self.apparatus.eyes.as_ref()?.image_points(self.eye_situation.as_ref()?, eyes),
        }
    }
}

/// Where things stand that are found along with the effects.
struct Placed<'a> {
    placement: &'a Isometry3<f64>,
    mount: &'a Isometry3<f64>,
    pivot: &'a Point3<f64>,
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

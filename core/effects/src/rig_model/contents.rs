//! What a model holds, as it stands in its file.

use jiff::Timestamp;
use nalgebra::{DMatrix, Isometry3};
use plumbline_model::plausible;
use plumbline_model::robot::{DescriptionError, Rig};
use plumbline_model::session::Touchscreen;
use serde::{Deserialize, Serialize};

use super::eyes_left::EyesLeft;
use super::file::{isometry_part, screen_part};
use super::together::Together;
use crate::arm::Arm;
use crate::eyes::Eyes;
use crate::library::Present;
use crate::library::{Effect, Kind};

/// How far a screen may lie from another one and still be the same, m.
const SAME_SCREEN_M: f64 = 1e-6;

/// No effect is so many times its usual size.
const MOST_TYPICAL: f64 = 100.0;

/// Whether a calibration holds for eyes that were just switched on, as in files of before that was kept.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
fn is_cold(reference_s: &f64) -> bool {
    *reference_s == 0.0
}

/// Refuses a screen that cannot be.
fn usable_screen(screen: &Touchscreen) -> Result<(), String> {
    let sides = plausible::SCREEN_SIDE_M.check_all(&[screen.width_m, screen.height_m]);
    let checked = sides.and_then(|()| plausible::SCREEN_PLACE_M.check_all(screen.origin.coords.iter()));
    checked.map_err(|what| format!("one of its touchscreens cannot be: {what}"))
}

/// What is in force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contents {
    /// The eyes that effects on the eyes were found with ([`super::numbers_of_eyes`]); empty: not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eyes: Vec<f64>,
    /// What those on the eyes leave of the rows that they were found in; `None`: not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eyes_left: Option<EyesLeft>,
    /// Effects, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<ModelEffect>,
    /// How well effects that were fitted together are known together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub together: Vec<Together>,
    /// Where touchscreens lie for a robot with these effects, the newest last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub screens: Vec<PlacedScreen>,
    /// Where external devices that measured poses stand, the newest last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub externals: Vec<PlacedExternal>,
}

/// An effect in force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelEffect {
    /// Its name on the command line.
    pub id: String,
    /// Where it sits; may be empty.
    #[serde(default)]
    pub site: String,
    /// What it is and where, for people.
    #[serde(default)]
    pub title: String,
    /// The tip whose arm it was found on; `None` for effects on the eyes alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// What of it is no matter of degree: an order, a moment, a time constant; see [`Effect::shape`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<f64>,
    /// Time since the eyes were switched on at which the calibration that it corrects holds, s; see
    /// [`Effect::reference_s`].
    #[serde(default, skip_serializing_if = "is_cold")]
    pub reference_s: f64,
    /// One value per parameter of [`Effect::parameters`].
    pub values: Vec<f64>,
    /// Their covariance, row by row; empty when it is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<f64>,
    /// Probability that the name is right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Parameters as the command line names them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<ReportedParameter>,
}

/// A parameter with its 95 % interval, as the command line names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReportedParameter {
    /// Name with the unit.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// A joint that the parameter speaks of, where it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Where a touchscreen lies for a robot with the model's effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacedScreen {
    /// The session whose touches placed it.
    pub session: String,
    /// Where that session takes it to lie.
    #[serde(with = "screen_part")]
    pub nominal: Touchscreen,
    /// Where it lies.
    #[serde(with = "screen_part")]
    pub screen: Touchscreen,
    /// So much higher than the table around it its glass lies, by the eyes, m; `None`: nobody measured it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over_table_m: Option<f64>,
}

/// Where an external device stands that measured poses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacedExternal {
    /// The session it measured.
    pub session: String,
    /// Label of its frame, where sessions share one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<String>,
    /// Takes points of the robot into its frame.
    #[serde(with = "isometry_part")]
    pub external_from_robot: Isometry3<f64>,
    /// Where the marker sat at the tip's frame, which was mounted anew for that session; else nothing is moved.
    #[serde(default, with = "isometry_part", skip_serializing_if = "is_nothing")]
    pub tip_from_marker: Isometry3<f64>,
}

impl PlacedExternal {
    /// Whether the marker was found elsewhere than at the tip's frame.
    pub fn is_mounted_anew(&self) -> bool {
        !is_nothing(&self.tip_from_marker)
    }
}

fn is_nothing(motion: &Isometry3<f64>) -> bool {
    *motion == Isometry3::identity()
}

/// What is to be added.
#[derive(Clone, Debug, PartialEq)]
pub struct Addition {
    /// Effects that were found.
    pub effects: Vec<ModelEffect>,
    /// Screens, fitted together with them.
    pub screens: Vec<PlacedScreen>,
    /// External frames, fitted together with them.
    pub externals: Vec<PlacedExternal>,
    /// The eyes they were found with ([`super::numbers_of_eyes`]); empty: they are not of the eyes.
    pub eyes: Vec<f64>,
    /// Whether the search began with the nominal robot: then what it found replaces all that is in
    /// force. Otherwise it began with this model and comes in addition.
    pub replaces: bool,
    /// When.
    pub at: Timestamp,
    /// How well effects that were fitted together are known together; those of arms with the same tips that
    /// were known before go.
    pub together: Vec<Together>,
    /// What was found, a sentence.
    pub sentence: String,
    /// Sessions that were searched.
    pub sessions: Vec<String>,
    /// Version of the program that searched.
    pub version: String,
    /// How far it closes the gap.
    pub gap: Option<StepGap>,
}

/// A step of the model's history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// What was done.
    pub kind: StepKind,
    /// When.
    pub at: Timestamp,
    /// Effects that it was done to, as `id@site`.
    pub effects: Vec<String>,
    /// What the search said.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sentence: String,
    /// Sessions that were searched.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<String>,
    /// Version of the program that searched.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub version: String,
    /// How far it closed the gap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<StepGap>,
    /// Whether it was taken back later.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub undone: bool,
    /// What was in force before.
    #[serde(default)]
    pub before: Contents,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// Effects were added.
    Added,
    /// One was taken out.
    Removed,
    /// The last step before that was not taken back yet was.
    Undone,
}

/// The gap on rows that were not used to find the effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepGap {
    /// `m` or `px`.
    pub unit: String,
    /// Rows judged.
    pub rows: usize,
    /// Mean error before.
    pub before: f64,
    /// Mean error after.
    pub after: f64,
    /// Mean error that noise alone would leave.
    pub floor: f64,
    /// (before − after) / (before − floor).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closure: Option<f64>,
    /// Its 95 % interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closure_range: Option<[f64; 2]>,
}

impl StepGap {
    /// Whether every number of it is one; else which is not.
    pub(super) fn check(&self) -> Result<(), String> {
        let range = self.closure_range.into_iter().flatten();
        let mut numbers = [self.before, self.after, self.floor].into_iter().chain(self.closure).chain(range);
        match numbers.find(|number| !number.is_finite()) {
            None => Ok(()),
            Some(number) => Err(format!(
                "a gap of its history holds {number}, which is no error: a number was changed or damaged; search the \
                 gap and write the file again"
            )),
        }
    }

    /// Meters of what an older file has in millimeters.
    pub(super) fn make_si(&mut self) {
        if self.unit == "mm" {
            self.unit = "m".to_owned();
            [&mut self.before, &mut self.after, &mut self.floor]
                .into_iter()
                .for_each(|length| *length *= 1e-3);
        }
    }
}

impl Step {
    pub(super) fn plain(kind: StepKind, at: Timestamp, before: Contents) -> Self {
        Self {
            kind,
            at,
            effects: vec![],
            sentence: String::new(),
            sessions: vec![],
            version: String::new(),
            gap: None,
            undone: false,
            before,
        }
    }

    /// Whether it can still be taken back.
    pub fn can_be_undone(&self) -> bool {
        self.kind != StepKind::Undone && !self.undone
    }
}

impl PlacedScreen {
    /// Whether it is this session's or rig's screen: same size, taken to lie at the same place.
    pub fn is_of(&self, nominal: &Touchscreen) -> bool {
        let same_size =
            (self.nominal.width_px, self.nominal.height_px) == (nominal.width_px, nominal.height_px);
        let corners = self.nominal.corners().into_iter().zip(nominal.corners());
        same_size && corners.into_iter().all(|(a, b)| a.distance_m(&b) < SAME_SCREEN_M)
    }

    /// A screen that touches have moved by the inverse of `placement`, which moves the robot's points
    /// as [`crate::Assumed::placements`] does.
    pub fn moved(session: &str, nominal: &Touchscreen, placement: &Isometry3<f64>) -> Self {
        Self {
            session: session.to_owned(),
            nominal: nominal.clone(),
            screen: nominal.moved(&placement.inverse()),
            over_table_m: None,
        }
    }
}

impl ModelEffect {
    /// `id@site`.
    pub fn name(&self) -> String {
        super::name(&self.id, &self.site)
    }

    /// The effect of the library on an arm or on eyes; `None` when it has no place there.
    pub(super) fn on(&self, arm: Option<&Arm>, eyes: Option<&Eyes>) -> Option<Present> {
        let effect = Effect::find(&self.id, &self.site, self.shape, arm, eyes)?;
        (effect.parameters().len() == self.values.len())
            .then(|| Present { effect: effect.with_reference(self.reference_s), values: self.values.clone() })
    }

    /// Covariance of its values; `None` when it is not known.
    pub(super) fn covariance_of_values(&self) -> Option<DMatrix<f64>> {
        let count = self.values.len();
        (count > 0 && self.covariance.len() == count * count)
            .then(|| DMatrix::from_row_slice(count, count, &self.covariance))
    }

    /// Whether it follows the tip and not the arm: another tip of the same hand does not have it.
    pub(super) fn is_of_the_tip(&self) -> bool {
        Kind::of_id(&self.id).is_some_and(Kind::is_of_tip)
    }
}

impl Contents {
    /// Whether an effect was named: see [`super::RigModel::is_named`].
    pub fn is_named(&self, effect: &ModelEffect) -> bool {
        effect.probability.is_some() || self.together.iter().all(|fit| fit.tip != effect.tip)
    }

    /// Whether every effect is one of the library and has a place in the rig; else why not.
    pub(crate) fn check(&self, rig: &Rig) -> Result<(), String> {
        for effect in &self.effects {
            let name = effect.name();
            if Kind::of_id(&effect.id).is_none() {
                return Err(format!(
                    "it has the effect {name}, which this program does not know: use a newer version of the \
                     program, or remove the effect from the file"
                ));
            }
            let misfit = |reason: DescriptionError| {
                format!(
                    "its effect {name} does not fit to the robot {} ({reason}): remove it and search the gap again",
                    rig.name
                )
            };
            let arm = effect
                .tip
                .as_deref()
                .map(|tip| Arm::logged(rig, tip, &rig.description.slides()))
                .transpose()
                .map_err(misfit)?;
            let eyes = Eyes::of_rig(rig).ok();
            let Some(known) =
                Effect::find(&effect.id, &effect.site, effect.shape, arm.as_ref(), eyes.as_ref())
            else {
                return Err(format!(
                    "its effect {name} sits where the robot {} has no such place: the robot's description has \
                     changed since, or the effect names no tip. Remove it and search the gap again",
                    rig.name
                ));
            };
            let (count, needed) = (effect.values.len(), known.parameters().len());
            if count != needed {
                return Err(format!("its effect {name} has {count} values instead of {needed}"));
            }
            let square = effect.covariance.is_empty() || effect.covariance.len() == needed * needed;
            if !square {
                return Err(format!(
                    "its effect {name} has a covariance of {} numbers",
                    effect.covariance.len()
                ));
            }
            let reported = effect.parameters.iter().flat_map(|p| [p.value, p.low, p.high]);
            let numbers = effect.values.iter().chain(&effect.covariance).chain(&effect.shape).copied();
            if let Some(number) = numbers.chain(reported).find(|number| !number.is_finite()) {
                return Err(format!("its effect {name} holds {number}"));
            }
            if !(effect.reference_s.is_finite() && effect.reference_s >= 0.0) {
                return Err(format!(
                    "its effect {name} corrects a calibration of {} s after switching on, which is no such time: a \
                     number was changed or damaged; search the gap and write the file again",
                    effect.reference_s
                ));
            }
            if let Some(share) = effect.probability.filter(|share| !(0.0..=1.0).contains(share)) {
                return Err(format!(
                    "its effect {name} has a probability of {share}, which is none: a number was changed or \
                     damaged; search the gap and write the file again"
                ));
            }
            for (value, parameter) in effect.values.iter().zip(known.parameters()) {
                let most = MOST_TYPICAL * parameter.typical;
                if value.abs() > most {
                    return Err(format!(
                        "its effect {name} has {} = {value:.4e}, where robots have about ±{} and none has more than \
                         {most}: a number was changed or damaged; search the gap and write the file again",
                        parameter.name, parameter.typical
                    ));
                }
            }
        }
        self.eyes_left.iter().try_for_each(EyesLeft::check)?;
        self.together.iter().try_for_each(Together::check)?;
        for placed in &self.screens {
            [&placed.nominal, &placed.screen].into_iter().try_for_each(usable_screen)?;
        }
        for placed in &self.externals {
            let at_m = placed.external_from_robot.translation.vector;
            let of_marker_m = placed.tip_from_marker.translation.vector;
            plausible::EXTERNAL_M
                .check_all(at_m.iter().chain(of_marker_m.iter()))
                .map_err(|what| format!("the frame of the session {} cannot be: {what}", placed.session))?;
        }
        Ok(())
    }
}

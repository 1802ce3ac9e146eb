//! The robot as it is known now: what everything that looks, moves or grasps works with, so that what
//! was accepted is used everywhere, and the same way.
//!
//! Without effects every answer is exactly that of the description: [`Rig::robot_from_left`] and the
//! [`Chain`](plumbline_model::robot::Chain) of a tip.

mod arm;
#[cfg(test)]
mod drawn;
#[cfg(test)]
mod laws;
mod left;
mod mounted;
mod place;
mod uncertainty;
mod unmeasured;
#[cfg(test)]
mod unmeasured_laws;
#[cfg(test)]
mod warm_laws;
mod warming;
#[cfg(test)]
mod warming_laws;

use std::sync::Arc;

use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::SolverError;
use plumbline_model::session::Touchscreen;

use crate::eyes::Eyes;
use crate::library::Kind;
use crate::rig_model::{Measured, ModelEffect, RigModel, RigModelError};

pub use arm::ModelArm;
pub use mounted::Mounted;
pub use place::{PlaceInRobot, SeenUnder, worst_sigma_m};
use unmeasured::Prior;
pub use unmeasured::Unmeasured;
pub use warming::{Turned, WARMING_S, warm_share};

/// The robot as it is known now: its description with what was calibrated (lenses, mount of the
/// eyes, place of the screen), and the effects that were accepted. Cheap to clone.
#[derive(Clone, Debug)]
pub struct RobotModel {
    rig: Arc<Rig>,
    added: Arc<RigModel>,
    eyes: Arc<Eyes>,
    /// Effects on the eyes.
    of_eyes: Arc<Measured>,
    /// How well their mount is known; `None`: nobody measured it.
    mounted: Option<Mounted>,
    /// How far off is what nobody measured of them.
    prior: Prior,
}

impl RobotModel {
    /// The robot as its description has it.
    pub fn nominal(rig: Arc<Rig>) -> Self {
        let added = Arc::new(RigModel::nominal(&rig));
        Self::put_together(rig, added)
    }

    /// With effects that were accepted.
    ///
    /// # Errors
    /// When they are of another rig, or do not fit to this one.
    pub fn new(rig: Arc<Rig>, added: Arc<RigModel>) -> Result<Self, RigModelError> {
        if added.rig != rig.name {
            return Err(RigModelError::OtherRig { found: added.rig.clone(), expected: rig.name.clone() });
        }
        added.contents.check(&rig).map_err(RigModelError::Effect)?;
        Ok(Self::put_together(rig, added))
    }

    fn put_together(rig: Arc<Rig>, added: Arc<RigModel>) -> Self {
        let eyes = Eyes::of_rig(&rig).expect("the link of the eyes is one of the description");
        let of_eyes = added.measured(None, None, Some(&eyes));
        let prior = Prior::default();
        Self { rig, added, eyes: Arc::new(eyes), of_eyes: Arc::new(of_eyes), mounted: None, prior }
    }

    /// The same, with how well the mount of the eyes is known: places are as uncertain by that, too.
    #[must_use]
    pub fn with_mounted(self, mounted: Option<Mounted>) -> Self {
        Self { mounted, ..self }
    }

    /// How well the mount of the eyes is known; `None`: nobody measured it.
    pub fn mounted(&self) -> Option<&Mounted> {
        self.mounted.as_ref()
    }

    /// The same, with what nobody calibrated of the eyes: places are as uncertain by that as it usually is off. What
    /// is not named counts as known.
    #[must_use]
    pub fn with_not_calibrated(self, not_calibrated: Unmeasured) -> Self {
        let prior = Prior::new(not_calibrated, &self.rig, &self.of_eyes);
        Self { prior, ..self }
    }

    /// What nobody calibrated of the eyes, whatever effects in force say of it.
    pub fn not_calibrated(&self) -> Unmeasured {
        self.prior.not_calibrated
    }

    /// What nobody measured of the eyes: neither a calibration nor an effect in force says it.
    pub fn unmeasured(&self) -> Unmeasured {
        let Prior { mounted, lenses, neck, .. } = &self.prior;
        let mount = self.mounted.is_none() && mounted.is_some();
        let neck = neck.is_some_and(|neck| neck.rest_sigma_rad[0] > 0.0);
        Unmeasured { mount, lenses: lenses.is_some(), neck }
    }

    /// The same effects on a rig whose calibrations are others.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_rig(&self, rig: Arc<Rig>) -> Result<Self, RigModelError> {
        let model = Self::new(rig, self.added.clone())?.with_mounted(self.mounted);
        Ok(model.with_not_calibrated(self.not_calibrated()))
    }

    /// The description with what was calibrated.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// The effects that were accepted.
    pub fn added(&self) -> &Arc<RigModel> {
        &self.added
    }

    /// Whether no effect is in force.
    pub fn is_nominal(&self) -> bool {
        self.added.is_nominal()
    }

    /// Whether an effect in force takes off what the eyes turn while they warm up.
    pub fn has_growth_of_eyes(&self) -> bool {
        let is_growth = |effect: &ModelEffect| {
            Kind::of_id(&effect.id).is_some_and(|kind| kind.is_growth_of_eyes(effect.shape))
        };
        self.added.effects().iter().any(is_growth)
    }

    /// Whether an effect in force takes off what they turn against each other, which is where depth comes from: that both nod,
    /// or one rolls, says nothing of it.
    pub fn has_growth_apart(&self) -> bool {
        let is_apart = |effect: &ModelEffect| {
            let kind = Kind::of_id(&effect.id).filter(|kind| kind.is_growth_of_eyes(effect.shape));
            matches!(kind, Some(Kind::EyeYaw | Kind::ImageShift))
        };
        self.added.effects().iter().any(is_apart)
    }

    /// For people, short: "as described", "with 2 effects", "with 2 effects and small shares".
    pub fn title(&self) -> String {
        let effects = |count: usize| plumbline_model::counted(count, "effect");
        match self.added.named_and_shares() {
            (0, 0) => "as described".to_owned(),
            (0, shares) => format!("with small shares of {}", effects(shares)),
            (_, 0) => format!("with {}", self.added.named_in_words()),
            (_, _) => format!("with {} and small shares", self.added.named_in_words()),
        }
    }

    /// The touchscreen where it lies for a robot with these effects.
    pub fn touchscreen(&self) -> &Touchscreen {
        let nominal = &self.rig.touchscreen;
        self.added.screen(nominal).filter(|_| !self.is_nominal()).unwrap_or(nominal)
    }

    /// So much higher than the table around it the glass lies, m; `None`: nobody measured it.
    pub fn glass_over_table_m(&self) -> Option<f64> {
        self.added.glass_over_table_m(&self.rig.touchscreen).filter(|_| !self.is_nominal())
    }

    /// The arm that ends in a tip ("`right_palm_center`", "`right_index_tip`"). Made in milliseconds: make
    /// it once for many targets.
    ///
    /// # Errors
    /// When the rig has no such tip, or its chain cannot be solved.
    pub fn arm(&self, tip: &str) -> Result<ModelArm, SolverError> {
        ModelArm::new(&self.rig, &self.added, tip)
    }
}

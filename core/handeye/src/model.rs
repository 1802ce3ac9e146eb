//! The model that both arms get from touches and from what the eyes saw.
//!
//! The arm that touched is sized by its touches, the screen that the eyes saw, and its hand; the neck's zero is
//! fitted with it. The other arm is sized by its hand alone, with that neck taken for known.

use jiff::Timestamp;
use plumbline_effects::rig_model::{Addition, ModelEffect, StepGap, numbers_of_eyes};
use plumbline_effects::{Kind, Measurements, RigModel};
use plumbline_fit::{
    ArmTouches, Chosen, Known, Name, SeenHands, SizedArm, Which, neck_effect, sized_by_hands,
};
use plumbline_grasp::Hand;
use plumbline_model::JobContext;

use crate::tie::Held;
use crate::{HandEyeError, Start, Tie};

/// Both arms on their way to a model.
pub struct Sizing<'a> {
    start: &'a Start,
    touches: &'a ArmTouches<'a>,
    held: Held,
    glass_over_table_m: Option<f64>,
    names: Vec<Name>,
    chosen: Chosen,
}

impl<'a> Sizing<'a> {
    /// Compares on touches held out what the arm is corrected with, now that the eyes have seen the screen;
    /// `names`: those that a search gave.
    ///
    /// # Errors
    /// When the mount was not measured, or it is cancelled.
    pub fn begin(
        start: &'a Start,
        touches: &'a ArmTouches<'a>,
        tie: &Tie,
        names: Vec<Name>,
        context: &dyn JobContext,
    ) -> Result<Self, HandEyeError> {
        let held = tie.held(start)?;
        let chosen = touches.choose(&names, &held.known(&start.described, 1.0), context)?;
        Self::chosen(start, touches, tie, names, chosen)
    }

    /// With what was chosen before.
    ///
    /// # Errors
    /// When the mount was not measured.
    pub fn chosen(
        start: &'a Start,
        touches: &'a ArmTouches<'a>,
        tie: &Tie,
        names: Vec<Name>,
        chosen: Chosen,
    ) -> Result<Self, HandEyeError> {
        Ok(Self {
            start,
            touches,
            held: tie.held(start)?,
            glass_over_table_m: tie.table.map(|table| table.glass_over_m),
            names,
            chosen,
        })
    }

    /// Names stay although touches held out err no less with them: a person has accepted them.
    #[must_use]
    pub fn keeping_names(mut self) -> Self {
        if self.chosen.which == Which::Nothing && !self.names.is_empty() {
            self.chosen.which = Which::Named;
            let named = self.names.iter().filter_map(|name| name.effect(self.touches.arm));
            self.chosen.effects = named.collect();
        }
        self
    }

    /// The same with the share of the usual sizes that the hand of the arm that touched tells.
    #[must_use]
    pub fn seen_by_hands(&self, hands: &SeenHands) -> Self {
        let known = Known { hands: Some(hands), ..self.held.known(&self.start.described, self.chosen.share) };
        let chosen = self.touches.seen_by_hands(&self.chosen, &known);
        let (held, names) = (self.held.clone(), self.names.clone());
        Self { held, names, chosen, ..*self }
    }

    /// What the arm is corrected with.
    pub fn what(&self) -> &Chosen {
        &self.chosen
    }

    /// The arm that touched; `hands`: what the eyes saw of its hand.
    ///
    /// # Errors
    /// When its touches cannot be predicted.
    pub fn touched(&self, hands: Option<&SeenHands>) -> Result<SizedArm, HandEyeError> {
        let known = Known { hands, ..self.held.known(&self.start.described, self.chosen.share) };
        let sized = self.touches.sized(&self.names, &self.chosen, &known, &self.start.described);
        let mut sized = sized.ok_or(HandEyeError::Touches)?;
        if let Some(screen) = &mut sized.screen {
            screen.over_table_m = self.glass_over_table_m;
        }
        Ok(sized)
    }

    /// The other arm, by what the eyes saw of its hand and by where its servos stopped.
    ///
    /// # Errors
    /// When the robot has no such arm, or its hands cannot be predicted.
    pub fn other(
        &self,
        touched: &SizedArm,
        hand: Hand,
        hands: &SeenHands,
        lags: &Measurements,
    ) -> Result<SizedArm, HandEyeError> {
        let described = &self.start.described;
        let mut known = self.held.known(described, self.chosen.share);
        // The neck was told by touches and body: the arm is tied to the eyes as they are then.
        known.neck_rad = touched.fitted.neck_rad.unwrap_or(known.neck_rad);
        sized_by_hands(described, hand.index_tip(), hands, lags, &known)?.ok_or(HandEyeError::Touches)
    }

    /// The model with both arms in place of what it had of them. `sentence`: what its history says of it.
    ///
    /// # Errors
    /// When it does not fit to the robot.
    pub fn model(
        &self,
        touched: &SizedArm,
        other: Option<(Hand, &SizedArm)>,
        sentence: &str,
        at: Timestamp,
    ) -> Result<RigModel, HandEyeError> {
        let (rig, before) = (self.start.model.rig(), self.start.model.added());
        let neck = neck_effect(rig, &touched.fitted);
        let mut sized: Vec<ModelEffect> = touched.effects.clone();
        let mut together = touched.together.clone();
        if let Some((_, other)) = other {
            sized.extend(other.effects.iter().cloned());
            together.extend(other.together.iter().cloned());
        }
        let other_tip = other.map(|(hand, _)| hand.index_tip());
        let is_of_arms = |tip: &Option<String>| {
            tip.as_deref().is_some_and(|tip| tip == self.touches.tip || Some(tip) == other_tip)
        };
        let stays = |effect: &&ModelEffect| {
            let is_it = |new: &ModelEffect| new.name() == effect.name() && new.tip == effect.tip;
            // What encoders see and nobody sizes here.
            let is_seen = Kind::of_id(&effect.id).is_some_and(Kind::is_seen_by_encoder);
            !sized.iter().chain(&neck).any(is_it) && (is_seen || !is_of_arms(&effect.tip))
        };
        let mut effects: Vec<ModelEffect> = before.effects().iter().filter(stays).cloned().collect();
        effects.extend(sized);
        effects.extend(neck);
        let others = before.contents.together.iter().filter(|known| !is_of_arms(&known.tip));
        together.extend(others.cloned());
        let addition = Addition {
            effects,
            screens: touched.screen.clone().into_iter().collect(),
            externals: before.contents.externals.clone(),
            eyes: numbers_of_eyes(rig),
            together,
            replaces: true,
            at,
            sentence: sentence.to_owned(),
            sessions: vec![self.touches.measurements.apparatuses[0].title.clone()],
            version: env!("CARGO_PKG_VERSION").to_owned(),
            gap: self.gap(),
        };
        let mut next = (**before).clone();
        let eyes_left = next.contents.eyes_left;
        next.add(rig, addition)?;
        next.contents.eyes_left = eyes_left;
        Ok(next)
    }

    /// Rms on touches held out, along the glass and in height.
    fn gap(&self) -> Option<StepGap> {
        let (before, after) = self.chosen.held_out.nothing_m.zip(self.chosen.error_m())?;
        let rows = self.touches.measurements.rows.len();
        let unit = "m".to_owned();
        Some(StepGap { unit, rows, before, after, floor: 0.0, closure: None, closure_range: None })
    }
}

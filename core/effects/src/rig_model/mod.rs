//! The model of a rig with the effects that were found and accepted: what is added to the robot's
//! description, where it comes from, and how it can be taken back.
//!
//! Without effects every prediction is exactly the nominal one.

mod contents;
mod error;
mod export;
mod eyes;
mod eyes_left;
mod file;
mod left_out;
mod predict;
#[cfg(test)]
mod predict_laws;
mod reach;
#[cfg(test)]
mod reach_laws;
#[cfg(test)]
mod tests;
mod tips;
mod together;

use jiff::Timestamp;
use plumbline_model::robot::Rig;

pub use contents::{
    Addition, Contents, ModelEffect, PlacedExternal, PlacedScreen, ReportedParameter, Step, StepGap, StepKind,
};
pub use error::RigModelError;
pub use export::{CAMERA_LINKS, ExportError, Exported};
pub use eyes::numbers_of_eyes;
pub use eyes_left::EyesLeft;
pub use file::{FORMAT, is_rig_model};
pub use left_out::LeftOut;
pub(crate) use predict::Measured;
pub use predict::predict_session_with;
pub use reach::{Conditions, DeviatedArm, Reached, SETTLED_M};
pub use together::Together;

/// A rig's model: effects and placements in force, and how they came to be.
#[derive(Clone, Debug, PartialEq)]
pub struct RigModel {
    /// Short name of the rig it belongs to.
    pub rig: String,
    /// What is in force.
    pub contents: Contents,
    /// Every step that was taken, oldest first.
    pub history: Vec<Step>,
}

impl RigModel {
    /// The model without any effect.
    pub fn nominal(rig: &Rig) -> Self {
        Self { rig: rig.name.clone(), contents: Contents::default(), history: vec![] }
    }

    /// Effects in force, the oldest first.
    pub fn effects(&self) -> &[ModelEffect] {
        &self.contents.effects
    }

    /// Whether an effect was named. Others came with those of their arm for the arm's sake: small shares of
    /// all that usually is wrong with arms, fitted together.
    pub fn is_named(&self, effect: &ModelEffect) -> bool {
        self.contents.is_named(effect)
    }

    /// How many effects were named by a search, and how many came with them for the arm's sake, drawn to zero.
    pub fn named_and_shares(&self) -> (usize, usize) {
        let named = self.contents.effects.iter().filter(|effect| self.is_named(effect)).count();
        (named, self.contents.effects.len() - named)
    }

    /// The named effects, counted for people. A name that was given to every joint is sized joint by joint: "2 effects
    /// (7 joint by joint)".
    pub fn named_in_words(&self) -> String {
        let named = self.contents.effects.iter().filter(|effect| self.is_named(effect));
        let mut kinds: Vec<&str> = named.map(|effect| effect.id.as_str()).collect();
        let count = kinds.len();
        kinds.sort_unstable();
        kinds.dedup();
        let effects = plumbline_model::counted(kinds.len(), "effect");
        if kinds.len() == count { effects } else { format!("{effects} ({count} joint by joint)") }
    }

    /// Whether the errors of a step of the history are rms along the glass and in height, as of all that is usually wrong
    /// with arms, fitted together; else they are means along the glass, as of a search.
    pub fn is_rms(&self, step: usize) -> bool {
        let Some(taken) = self.history.get(step) else { return false };
        let after = self.history.get(step + 1).map_or(&self.contents, |next| &next.before);
        !after.together.is_empty() && after.together != taken.before.together
    }

    /// Whether no effect is in force.
    pub fn is_nominal(&self) -> bool {
        self.contents.effects.is_empty()
    }

    /// Adds effects that were found. The same effect may be added twice, when a later search has
    /// found more of it: both parts are in force. Effects on the eyes that were found with other eyes go as with
    /// [`Self::for_eyes_of`]: what comes was found without them. Placements of the new sessions take the place of
    /// older ones of the same screen or session.
    ///
    /// # Errors
    /// When nothing is to be added, or an effect does not fit to the rig; then nothing is changed.
    pub fn add(&mut self, rig: &Rig, addition: Addition) -> Result<(), RigModelError> {
        if rig.name != self.rig {
            return Err(RigModelError::OtherRig { found: self.rig.clone(), expected: rig.name.clone() });
        }
        if addition.effects.is_empty() {
            return Err(RigModelError::NothingToAdd);
        }
        let before = self.contents.clone();
        let mut contents = if addition.replaces { Contents::default() } else { before.clone() };
        if !addition.eyes.is_empty() {
            if !eyes::are_same(&contents.eyes, &addition.eyes) && !contents.eyes.is_empty() {
                contents.take_to_eyes(&rig.eyes.calibrated_at);
            }
            contents.eyes = addition.eyes;
        }
        let names = addition.effects.iter().map(ModelEffect::name).collect();
        contents.effects.extend(addition.effects);
        for together in addition.together {
            contents.together.retain(|known| known.tip != together.tip);
            contents.together.push(together);
        }
        for screen in addition.screens {
            contents.screens.retain(|known| !known.is_of(&screen.nominal));
            contents.screens.push(screen);
        }
        for external in addition.externals {
            contents.externals.retain(|known| known.session != external.session);
            contents.externals.push(external);
        }
        contents.check(rig).map_err(RigModelError::Effect)?;
        self.contents = contents;
        self.history.push(Step {
            kind: StepKind::Added,
            at: addition.at,
            effects: names,
            sentence: addition.sentence,
            sessions: addition.sessions,
            version: addition.version,
            gap: addition.gap,
            undone: false,
            before,
        });
        Ok(())
    }

    /// Takes an effect out, wherever in the history it was added. Placements stay: they were fitted
    /// together with it, so a new search is due. With the last effect they go, too.
    ///
    /// # Errors
    /// When it is not in force.
    pub fn remove(&mut self, id: &str, site: &str, at: Timestamp) -> Result<(), RigModelError> {
        let before = self.contents.clone();
        self.contents.effects.retain(|effect| effect.id != id || effect.site != site);
        if self.contents.effects.len() == before.effects.len() {
            let present = before.effects.iter().map(ModelEffect::name).collect::<Vec<_>>();
            return Err(RigModelError::NotThere { name: name(id, site), present: present.join(", ") });
        }
        if self.contents.effects.is_empty() {
            self.contents = Contents::default();
        }
        self.history
            .push(Step { effects: vec![name(id, site)], ..Step::plain(StepKind::Removed, at, before) });
        Ok(())
    }

    /// Takes back the last step that was not taken back yet: what was in force before it is in force
    /// again, to the last bit. That it was taken back is a step of the history, too.
    ///
    /// # Errors
    /// When there is none.
    pub fn undo(&mut self, at: Timestamp) -> Result<(), RigModelError> {
        let last = self.history.iter().rposition(Step::can_be_undone).ok_or(RigModelError::NothingToUndo)?;
        self.history[last].undone = true;
        let undone = &self.history[last];
        let effects = undone.effects.clone();
        let before = std::mem::replace(&mut self.contents, undone.before.clone());
        self.history.push(Step { effects, ..Step::plain(StepKind::Undone, at, before) });
        Ok(())
    }

    /// Puts back what was taken back last, to the last bit; nothing may have been changed since.
    ///
    /// # Errors
    /// When nothing was taken back, or something was changed since.
    pub fn redo(&mut self) -> Result<(), RigModelError> {
        let last = self.taken_back_last().ok_or(RigModelError::NothingToRedo)?;
        // Steps are taken back from the end: it was the first one behind those that stand.
        let stands = self.history.iter().rposition(Step::can_be_undone).map_or(0, |last| last + 1);
        let mut taken_back =
            (stands..last).filter(|i| self.history[*i].undone && self.history[*i].kind != StepKind::Undone);
        let step = taken_back.next().ok_or(RigModelError::NothingToRedo)?;
        self.contents = self.history[last].before.clone();
        (self.history[last].undone, self.history[step].undone) = (true, false);
        Ok(())
    }

    /// Whether what was taken back last can be put back.
    pub fn can_redo(&self) -> bool {
        self.taken_back_last().is_some()
    }

    /// The taking back after which nothing was changed, but what was put back since.
    fn taken_back_last(&self) -> Option<usize> {
        let is_taking_back = |step: &Step| step.kind == StepKind::Undone;
        let last = self.history.iter().rposition(|step| !(is_taking_back(step) && step.undone))?;
        is_taking_back(&self.history[last]).then_some(last)
    }

    /// Whether there is a step to take back.
    pub fn can_undo(&self) -> bool {
        self.history.iter().any(Step::can_be_undone)
    }
}

/// `id@site`, or the id alone.
fn name(id: &str, site: &str) -> String {
    if site.is_empty() { id.to_owned() } else { format!("{id}@{site}") }
}

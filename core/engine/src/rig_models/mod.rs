//! The model in use of a world: the robot's description and what was accepted. Effects live in one
//! file; [`in_use`] puts them together with what was calibrated.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_effects::rig_model::{
    Addition, ModelEffect, PlacedExternal, PlacedScreen, ReportedParameter, Step, StepGap, numbers_of_eyes,
};
use plumbline_effects::{Kind, RigModel, RobotModel};
use plumbline_gap::Finding;
use plumbline_gap::finding::{NamedEffect, Shown, ShownUnit};
use plumbline_model::Session;
use plumbline_model::robot::Rig;

use crate::ground::shelf::InUse as Kept;

mod error;
mod in_use;
#[cfg(test)]
pub(crate) mod made_up;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod warm_tests;
mod whole;

pub use error::ModelInUseError;
pub use in_use::{
    Accepted, calibrated_at, in_use, made_at, mount_in, mounted, mounts_in, other_eyes, screen_in, screens_in,
};
pub use whole::{WholeError, name_of, whole};

/// The file, in the folder of a world.
pub const FILE: &str = "rig-model.toml";

/// Where the model in use is kept in the folder of a world.
pub fn file(folder: &Path) -> PathBuf {
    folder.join(FILE)
}

/// The model in use; nominal where nothing was accepted yet.
///
/// # Errors
/// A sentence, when there is a file that cannot be used.
pub fn load(folder: &Path, rig: &Rig) -> Result<RigModel, ModelInUseError> {
    let read = Kept::new(file(folder)).read(|file| RigModel::read(file, rig).map_err(ModelInUseError::from));
    Ok(read?.unwrap_or_else(|| RigModel::nominal(rig)))
}

/// Puts a model in use.
///
/// # Errors
/// A sentence; then what was in use stays so.
pub fn save(folder: &Path, model: &RigModel, rig: &Rig) -> Result<(), ModelInUseError> {
    let no_folder = |error| ModelInUseError::NoFolder { folder: folder.to_owned(), error };
    Kept::new(file(folder)).put(no_folder, |file| Ok(model.write(file, rig)?))
}

/// Accepts effects of a finding, by their places in it, and puts the model in use. `sessions` are
/// those of the finding, in its order.
///
/// # Errors
/// A sentence; then what was in use stays so.
pub fn accept(
    folder: &Path,
    rig: &Rig,
    finding: (&Finding, &[Session]),
    effects: &[usize],
    replaces: bool,
) -> Result<RigModel, ModelInUseError> {
    let model = with(&load(folder, rig)?, rig, finding, effects, replaces, Timestamp::now())?;
    save(folder, &model, rig)?;
    Ok(model)
}

/// Takes the last step back.
///
/// # Errors
/// A sentence; then what was in use stays so.
pub fn undo(folder: &Path, rig: &Rig) -> Result<RigModel, ModelInUseError> {
    let mut model = load(folder, rig)?;
    model.undo(Timestamp::now())?;
    save(folder, &model, rig)?;
    Ok(model)
}

/// Models after each step with their gaps: the mean error on rows that were not used. Steps that were
/// taken back, and that took back, are left out.
pub fn history(model: &RigModel) -> impl Iterator<Item = (&Step, &StepGap)> {
    let in_force = model.history.iter().filter(|step| step.can_be_undone());
    in_force.filter_map(|step| Some((step, step.gap.as_ref()?)))
}

/// A model with effects of a finding, by their places in it, and with where the finding places its
/// sessions' frames. `replaces`: the search began with the nominal robot, so that what it found takes
/// the place of all that is in the model. `rig`: the robot with the eyes as they are calibrated now, beside which what
/// grows counts, however warm those of the search were. `at`: when it is done.
///
/// # Errors
/// A sentence: why they cannot be added.
pub fn with(
    model: &RigModel,
    rig: &Rig,
    (finding, sessions): (&Finding, &[Session]),
    effects: &[usize],
    replaces: bool,
    at: Timestamp,
) -> Result<RigModel, ModelInUseError> {
    if finding.sessions.len() != sessions.len() || finding.placements.len() != sessions.len() {
        return Err(ModelInUseError::OtherSessions);
    }
    let mut chosen = vec![];
    for &i in effects {
        let effect = finding.effects.get(i).ok_or(ModelInUseError::NoSuchEffect)?;
        if let Some(why) = &effect.not_addable {
            let (title, why) = (effect.title.clone(), why.clone());
            return Err(ModelInUseError::NotAddable { title, why });
        }
        chosen.push(effect);
    }
    let tip = sessions.iter().find_map(|session| session.manifest.chain.as_ref()).map(|chain| &chain.tip);
    let (mut screens, mut externals) = (vec![], vec![]);
    for (i, ((name, session), placement)) in
        finding.sessions.iter().zip(sessions).zip(&finding.placements).enumerate()
    {
        let screen = session.manifest.touchscreen.as_ref().filter(|_| session.touches.is_some());
        screens.extend(screen.map(|screen| PlacedScreen::moved(name, screen, placement)));
        if session.poses.is_some() {
            externals.push(PlacedExternal {
                session: name.clone(),
                frame: session.manifest.pose_setup().external_frame,
                external_from_robot: *placement,
                tip_from_marker: finding.mounts.get(i).copied().unwrap_or_default(),
            });
        }
    }
    let is_of_eyes = |effect: &&NamedEffect| Kind::of_id(&effect.id).is_some_and(Kind::is_of_eyes);
    let eyes = if chosen.iter().any(is_of_eyes) { numbers_of_eyes(rig) } else { vec![] };
    let addition = Addition {
        together: vec![],
        effects: chosen
            .into_iter()
            .map(|effect| model_effect(effect, tip).beside(&rig.eyes.calibrated_at))
            .collect(),
        screens,
        externals,
        eyes,
        replaces,
        at,
        sentence: finding.sentence.clone(),
        sessions: finding.sessions.clone(),
        version: finding.version.clone(),
        gap: gap(&finding.shown),
    };
    let of_eyes = !addition.eyes.is_empty();
    let mut next = model.clone();
    next.add(rig, addition)?;
    if of_eyes {
        let robot = RobotModel::new(Arc::new(rig.clone()), Arc::new(next.clone()))?;
        let tables = sessions.iter().filter_map(|session| session.localizations.as_ref());
        let left = tables.filter_map(|table| robot.left_of(table)).next_back();
        next.contents.eyes_left = left.or(next.contents.eyes_left);
    }
    Ok(next)
}

fn gap(shown: &Shown) -> Option<StepGap> {
    // What may not be added is not in the model either.
    let (after, closure, closure_range) =
        shown.part.as_ref().map_or((shown.after, shown.closure, shown.closure_range), |part| {
            (part.after, part.closure, part.closure_range)
        });
    (shown.rows > 0).then(|| StepGap {
        unit: if shown.unit == ShownUnit::Pixel { "px" } else { "m" }.to_owned(),
        rows: shown.rows,
        before: shown.before,
        after,
        floor: shown.floor,
        closure,
        closure_range,
    })
}

fn model_effect(effect: &NamedEffect, tip: Option<&String>) -> ModelEffect {
    let reported = effect.parameters.iter().map(|found| ReportedParameter {
        name: found.name.clone(),
        value: found.value,
        low: found.low,
        high: found.high,
        text: found.text.clone(),
    });
    ModelEffect {
        id: effect.id.clone(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        tip: tip.cloned(),
        shape: effect.shape,
        reference_s: effect.reference_s,
        values: effect.values.clone(),
        covariance: effect.covariance.clone(),
        probability: Some(effect.probability),
        parameters: reported.collect(),
    }
}

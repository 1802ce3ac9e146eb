//! The arm corrected by all that usually is wrong with arms: names are for people, the arm moves better with
//! small shares of everything else beside them.

use jiff::Timestamp;
use nalgebra::Matrix6;
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Addition, StepGap};
use plumbline_fit::{ArmTouches, Chosen, Known, NECK_SD_RAD, Name, Which};
use plumbline_gap::Finding;
use plumbline_gap::finding::NamedEffect;
use plumbline_model::JobContext;
use plumbline_model::robot::Rig;

use super::error::ModelInUseError;

/// The name that a finding gave to an effect.
pub fn name_of(named: &NamedEffect) -> Name {
    let NamedEffect { id, site, shape, probability, .. } = named;
    Name { id: id.clone(), site: site.clone(), shape: *shape, probability: *probability }
}

/// A model corrected by all usual effects of the arm, the chosen ones of a finding (by place) among them, in
/// place of what it had: the finding began with the nominal robot. `None`: on touches held out that is no
/// better than the named ones alone, or than nothing.
///
/// # Errors
/// When it does not fit to the robot, or is cancelled.
pub fn whole(
    model: &RigModel,
    rig: &Rig,
    touches: &ArmTouches<'_>,
    finding: &Finding,
    effects: &[usize],
    at: Timestamp,
    context: &dyn JobContext,
) -> Result<Option<RigModel>, WholeError> {
    let names: Vec<Name> = effects.iter().filter_map(|i| finding.effects.get(*i)).map(name_of).collect();
    if !names.iter().all(|name| name.is_sized(touches.arm)) {
        return Ok(None);
    }
    // Nothing that the eyes saw ties arm and head: the mount counts for nothing here.
    let mount = Matrix6::identity();
    let known =
        Known { rig, screen: None, hands: None, neck_rad: (0.0, NECK_SD_RAD), mount: &mount, share: 1.0 };
    let chosen = touches.choose(&names, &known, context)?;
    if chosen.which != Which::All {
        return Ok(None);
    }
    let Some(sized) = touches.sized(&names, &chosen, &known, rig) else { return Ok(None) };
    let addition = Addition {
        effects: sized.effects,
        screens: sized.screen.into_iter().collect(),
        externals: vec![],
        eyes: vec![],
        replaces: true,
        at,
        together: sized.together,
        sentence: finding.sentence.clone(),
        sessions: finding.sessions.clone(),
        version: finding.version.clone(),
        gap: gap(&chosen, finding, touches.measurements.rows.len()),
    };
    let mut next = model.clone();
    next.add(rig, addition).map_err(|error| WholeError::Model(Box::new(error.into())))?;
    Ok(Some(next))
}

/// Rms on touches held out, along the glass and in height, beside what noise alone leaves along it.
fn gap(chosen: &Chosen, finding: &Finding, rows: usize) -> Option<StepGap> {
    let (before, after) = chosen.held_out.nothing_m.zip(chosen.error_m())?;
    let floor = finding.shown.floor;
    Some(StepGap { unit: "m".to_owned(), rows, before, after, floor, closure: None, closure_range: None })
}

/// Why an arm is not sized.
#[derive(Debug, thiserror::Error)]
pub enum WholeError {
    /// The model cannot be.
    #[error(transparent)]
    Model(Box<ModelInUseError>),
    /// It was cancelled.
    #[error("cancelled")]
    Cancelled(plumbline_model::Cancelled),
}

impl From<plumbline_model::Cancelled> for WholeError {
    fn from(cancelled: plumbline_model::Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

//! The arm corrected by all that usually is wrong with arms: names are for people, the arm moves better with
//! small shares of everything else beside them.

use jiff::Timestamp;
use nalgebra::Matrix6;
use plumbline_effects::arm::Arm;
use plumbline_effects::rig_model::{Addition, ModelEffect, StepGap};
use plumbline_effects::{Effect, Kind, Measurements, RigModel, What};
use plumbline_fit::{
    Chosen, Known, NECK_SD_RAD, Which, arm_effects, choose, effect_of, fit, lag, placed, together,
};
use plumbline_gap::Finding;
use plumbline_gap::finding::NamedEffect;
use plumbline_model::robot::Rig;
use plumbline_model::{JobContext, Session};

use super::error::ModelInUseError;

/// Fewer touches tell nothing of eighty effects.
pub const LEAST_TOUCHES: usize = 12;

/// The same effects in the library of an arm; those that encoders see are left out: rows have them already.
pub fn library_of<'a>(named: impl Iterator<Item = &'a NamedEffect>, arm: &Arm) -> Vec<Effect> {
    let is_seen = |effect: &&NamedEffect| Kind::of_id(&effect.id).is_some_and(Kind::is_seen_by_encoder);
    named
        .filter(|effect| !is_seen(effect))
        .filter_map(|effect| Effect::find(&effect.id, &effect.site, effect.shape, Some(arm), None))
        .collect()
}

/// Whether an effect that was named is among those that are sized together: else it would be lost.
fn is_sized(named: &NamedEffect, arm: &Arm) -> bool {
    match Kind::of_id(&named.id) {
        Some(Kind::ServoDroop | Kind::Stiction) => true,
        Some(kind) if kind.is_seen_by_encoder() => false,
        _ => Effect::find(&named.id, &named.site, named.shape, Some(arm), None).is_some(),
    }
}

/// Touches of one session with one finger, from which an arm can be sized.
pub struct ArmTouches<'a> {
    /// The session as it is on disk.
    session: &'a Session,
    /// Its rows.
    measurements: &'a Measurements,
    arm: &'a Arm,
    tip: &'a str,
}

impl<'a> ArmTouches<'a> {
    /// `None`: the rows are of several sessions, of something else than touches, or too few.
    pub fn of(sessions: &'a [Session], measurements: &'a Measurements) -> Option<Self> {
        let ([session], [apparatus]) = (sessions, measurements.apparatuses.as_slice()) else { return None };
        let are_touches = measurements.rows.iter().all(|row| row.what == What::Touch);
        let (arm, tip) = (apparatus.arm.as_ref()?, apparatus.tip.as_deref()?);
        (are_touches && measurements.rows.len() >= LEAST_TOUCHES && apparatus.surface.is_some())
            .then_some(Self { session, measurements, arm, tip })
    }
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
    let ArmTouches { session, measurements, arm, tip } = touches;
    let wanted: Vec<&NamedEffect> = effects.iter().filter_map(|i| finding.effects.get(*i)).collect();
    // A family of joints is sized joint by joint.
    let is_chosen = |effect: &Effect| {
        let is_it = |named: &&&NamedEffect| {
            named.id == effect.id() && (named.site == effect.site || named.site.is_empty())
        };
        wanted.iter().find(is_it).copied()
    };
    if !wanted.iter().all(|named| is_sized(named, arm)) {
        return Ok(None);
    }
    let named = library_of(wanted.iter().copied(), arm);
    // Nothing that the eyes saw ties arm and head: the mount counts for nothing here.
    let mount = Matrix6::identity();
    let known =
        Known { rig, screen: None, hands: None, neck_rad: (0.0, NECK_SD_RAD), mount: &mount, share: 1.0 };
    let mut chosen = choose(measurements, arm, named.clone(), &known, context)?;
    // One that was named in another shape than the usual one is sized in its own.
    for effect in named.into_iter().filter(|effect| !effect.is_of_every_site()) {
        chosen.effects.retain(|usual| (usual.kind, &usual.site) != (effect.kind, &effect.site));
        chosen.effects.push(effect);
    }
    let known = Known { share: chosen.share, ..known };
    let rows: Vec<_> = measurements.rows.iter().collect();
    if chosen.which != Which::All {
        return Ok(None);
    }
    let Some(fitted) = fit(measurements, &rows, &chosen.effects, &known) else { return Ok(None) };
    let probability = |effect: &Effect| is_chosen(effect).map(|named| named.probability);
    let mut effects = arm_effects(tip, &fitted, probability);
    let together = together(tip, &fitted, &effects);
    effects.extend(lag(measurements, arm).into_iter().map(|(present, covariance)| {
        let probability = probability(&present.effect);
        ModelEffect { probability, ..effect_of(tip, &present, covariance) }
    }));
    let title = measurements.apparatuses[0].title.clone();
    let nominal = session.manifest.touchscreen.as_ref().unwrap_or(&rig.touchscreen);
    let addition = Addition {
        effects,
        screens: placed(&title, nominal, &fitted).into_iter().collect(),
        externals: vec![],
        eyes: vec![],
        replaces: true,
        at,
        together,
        sentence: finding.sentence.clone(),
        sessions: vec![title],
        version: finding.version.clone(),
        gap: gap(&chosen, finding, measurements.rows.len()),
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

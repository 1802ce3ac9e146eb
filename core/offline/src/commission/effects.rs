//! Step effects: what makes the arm miss. The search names what the touches can name. What they cannot
//! name is still there: all usual effects together, each drawn to zero, are fitted too. Of the nominal
//! arm, the named effects and all together the one that errs least on touches held out is put in use.

use plumbline_effects::arm::Arm;
use plumbline_effects::rig_model::{Addition, ModelEffect, PlacedScreen, StepGap, Together};
use plumbline_effects::{Effect, Kind, Measurements, Present, RigModel, Surface};
use plumbline_engine::gap::search::{measured, search};
use plumbline_engine::gap::sessions::stamps;
use plumbline_engine::gap::store::{KeptFinding, KeptSession, Store};
use plumbline_engine::gap::{Finding, model_name};
use plumbline_engine::rig_models;
use plumbline_engine::touch::plan::TIP;
use plumbline_engine::touch::store;
use plumbline_gap::Options;
use plumbline_gap::finding::NamedEffect;
use plumbline_model::touchscreen::place_screen;
use plumbline_model::{JobContext, Session};

use super::error::CommissionError;
use super::estimate::{Fit, Known, fit, held_out_m, is_first_zero};
use super::glass::SeenScreen;
use super::known::{Seen, Share};
use super::lab::Lab;
use super::lag;
use super::plan::{effects_of, measurements, moves_palm};
use super::seen_by_eyes::SeenHands;
use super::steps::Step;
use super::touches::session;

/// Another model has to err less by this share on held-out touches, or the simpler one stays.
const WORTH: f64 = 0.95;
/// A few named effects have to err less by this share than all usual ones together. Names are for people: a
/// few that explain what a fingertip does may put what they leave out into the height of the glass, where the
/// palm misses it, and do not say so.
const WORTH_ALONE: f64 = 0.75;
/// The arm's effects are tried at these shares of their usual size, the simplest robot first.
const SHARES: [f64; 5] = [0.03, 0.1, 0.25, 0.5, 1.0];

/// Searches, compares, and puts a model in use.
pub(super) fn run(lab: &Lab, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("effects", "touches held out, along the glass and in height, rms");
    let folder = session(lab);
    let measurements = measured(std::slice::from_ref(&folder), &lab.rig)?;
    let options = Options { seed: lab.seed, show: true, advise: false, ..Options::default() };
    let nominal = RigModel::nominal(&lab.rig);
    let finding = search(&measurements, &nominal, &options, context)?;
    let kept = vec![KeptSession { folder: folder.clone(), tables: stamps(&folder) }];
    let about = (model_name(&nominal), vec![]);
    let store = Store::new(lab.world().join("gap"));
    store
        .keep(KeptFinding::new(finding.clone(), kept, about, jiff::Timestamp::now()))
        .map_err(CommissionError::room)?;
    step.notes.push(finding.sentence.clone());

    let measurements = touches(lab)?;
    let arm = Arm::of_rig(&lab.rig, TIP)?;
    let seen = Seen::read(lab)?;
    let mut known = seen.known(&lab.rig, 1.0);
    let all = effects_of(&arm);
    let mut named = named_effects(&finding, &arm);
    // Touches alone cannot name it: the screen that the eyes saw sizes it.
    let first_zero = all.iter().find(|effect| is_first_zero(effect, &lab.rig));
    let every_zero = named.iter().any(|effect| effect.kind == Kind::JointZero && effect.is_of_every_site());
    if let Some(zero) = first_zero.filter(|zero| !named.is_empty() && !every_zero && !named.contains(zero)) {
        named.push(zero.clone());
    }
    context.checkpoint()?;
    let better =
        |new: Option<f64>, old: Option<f64>| matches!((new, old), (Some(n), Some(o)) if n < WORTH * o);
    let of_nothing = held_out_m(&measurements, &[], &known);
    let of_named = if named.is_empty() { None } else { held_out_m(&measurements, &named, &known) };
    context.checkpoint()?;
    // Whether this robot errs as robots usually do, or by less, the touches held out say, too.
    let (mut of_all, mut share_of_all) = (None, 1.0);
    for share in SHARES {
        context.checkpoint()?;
        let error_m = held_out_m(&measurements, &all, &Known { share, ..known });
        if of_all.is_none() || better(error_m, of_all) {
            (of_all, share_of_all) = (error_m, share);
        }
    }
    let mm = |m: Option<f64>| m.map_or("not known".to_owned(), |m| format!("{:.2} mm", 1e3 * m));
    step.notes.push(format!(
        "Held-out touches err by {} without effects, {} with those named, {} with all at \
         {share_of_all} of their usual size.",
        mm(of_nothing),
        mm(of_named),
        mm(of_all)
    ));
    step.before_mm = of_nothing.map(|m| 1e3 * m);
    let none = vec![];
    let (mut best, mut effects, mut what) = (of_nothing, &none, "no effect of the arm");
    if better(of_all, best) {
        (best, effects, what) = (of_all, &all, "all usual effects, each drawn to zero");
        known.share = share_of_all;
    }
    let of_some = best.map(|m| if effects.is_empty() { WORTH * m } else { WORTH_ALONE * m });
    if matches!((of_named, of_some), (Some(named), Some(least)) if named < least) {
        (best, effects, what) = (of_named, &named, "those named");
        known.share = 1.0;
    }
    step.after_mm = best.map(|m| 1e3 * m);
    step.notes.push(format!("In use: {what}."));
    let rows: Vec<_> = measurements.rows.iter().collect();
    let Some(fitted) = fit(&measurements, &rows, effects, &known) else { return Ok(step) };
    if let Some((zero_rad, sd_rad)) = fitted.neck_rad {
        step.notes.push(format!(
            "The neck's turn is off by {:.2}° ± {:.2}°.",
            zero_rad.to_degrees(),
            sd_rad.to_degrees()
        ));
    }
    Share(known.share).write(lab)?;
    let mut effects = arm_effects(&fitted, &finding);
    for (present, covariance) in lag::fit(&measurements, &arm) {
        effects.push(model_effect(&present, covariance, &finding));
    }
    let gap = of_nothing.zip(best).map(|(before, after)| StepGap {
        unit: "m".to_owned(),
        rows: measurements.rows.len(),
        before,
        after,
        floor: 0.0,
        closure: None,
        closure_range: None,
    });
    let said = (finding.sentence.clone(), finding.version.clone());
    accept(lab, RigModel::nominal(&lab.rig), &measurements, &fitted, effects, said, gap)?;
    Ok(step)
}

/// Fits the effects in use again, with the hands that the eyes saw beside the touches.
pub(super) fn again(lab: &Lab, hands: &SeenHands) -> Result<(), CommissionError> {
    let (measurements, arm, model) = (touches(lab)?, Arm::of_rig(&lab.rig, TIP)?, lab.model()?);
    let of_tip = |effect: &&ModelEffect| effect.tip.as_deref() == Some(TIP);
    let library = model.effects().iter().filter(of_tip).filter_map(|effect| {
        Effect::find(&effect.id, &effect.site, effect.shape, Some(&arm), None)
            .filter(|found| !found.kind.is_seen_by_encoder())
    });
    let library: Vec<Effect> = library.collect();
    let seen = Seen::read(lab)?;
    let known = Known { hands: Some(hands), ..seen.known(&lab.rig, Share::read(lab)?.0) };
    let rows: Vec<_> = measurements.rows.iter().collect();
    let Some(fitted) = fit(&measurements, &rows, &library, &known) else { return Ok(()) };
    let mut effects = model.effects().to_vec();
    let mut at = 0;
    for present in &fitted.assumed.effects {
        let width = present.values.len();
        let covariance = fitted.covariance.view((at, at), (width, width)).iter().copied().collect();
        at += width;
        let is_it = |effect: &&mut ModelEffect| {
            effect.id == present.effect.id() && effect.site == present.effect.site
        };
        if let Some(effect) = effects.iter_mut().find(is_it) {
            (effect.values, effect.covariance) = (present.values.clone(), covariance);
        }
    }
    effects.retain(|effect| effect.id != Kind::HeadJoint.id());
    let said = model.history.iter().rev().find(|step| !step.sentence.is_empty());
    let said = said.map_or_else(Default::default, |step| (step.sentence.clone(), step.version.clone()));
    accept(lab, model, &measurements, &fitted, effects, said, None)
}

/// Sizes the effects of an arm that touched nothing by the hands alone that the eyes saw, and by where its
/// servos stopped: all usual ones, each drawn to zero as far as those of the arm that touched. What was known
/// before (`base`) stays as it is.
pub(super) fn by_eyes(
    lab: &Lab,
    base: &RigModel,
    tip: &str,
    hands: &SeenHands,
    lags: &Measurements,
) -> Result<(), CommissionError> {
    let arm = Arm::of_rig(&lab.rig, tip)?;
    let library: Vec<Effect> = effects_of(&arm).into_iter().filter(moves_palm).collect();
    let seen = Seen::read(lab)?;
    let mut known = Known { hands: Some(hands), screen: None, ..seen.known(&lab.rig, Share::read(lab)?.0) };
    // The neck was told by touches and body: the arm is tied to the eyes as they are in use.
    let neck = base.effects().iter().find(|effect| effect.id == Kind::HeadJoint.id());
    if let Some((value, variance)) = neck.and_then(|neck| neck.values.first().zip(neck.covariance.first())) {
        known.neck_rad = (*value, variance.max(0.0).sqrt());
    }
    let surface = Some(Surface::of(&lab.rig.touchscreen));
    let nothing = measurements(&lab.rig, arm.clone(), surface, vec![]);
    let Some(fitted) = fit(&nothing, &[], &library, &known) else { return Ok(()) };
    let mut at = 0;
    let mut effects = vec![];
    for present in &fitted.assumed.effects {
        let width = present.values.len();
        let covariance = fitted.covariance.view((at, at), (width, width));
        at += width;
        effects.push(effect_of(tip, present, covariance.iter().copied().collect()));
    }
    for (present, covariance) in lag::fit(lags, &arm) {
        effects.push(effect_of(tip, &present, covariance));
    }
    let addition = Addition {
        together: together(tip, &fitted, &effects),
        effects,
        screens: vec![],
        externals: vec![],
        eyes: vec![],
        replaces: false,
        at: jiff::Timestamp::now(),
        sentence: "The eyes looked at the hand.".to_owned(),
        sessions: vec![],
        version: String::new(),
        gap: None,
    };
    let mut model = base.clone();
    model.add(&lab.rig, addition).map_err(CommissionError::room)?;
    rig_models::save(&lab.world(), &model, &lab.rig).map_err(CommissionError::room)
}

/// The touches with what the library needs of them.
fn touches(lab: &Lab) -> Result<Measurements, CommissionError> {
    let mut measurements = measured(std::slice::from_ref(&session(lab)), &lab.rig)?;
    directions(lab, &mut measurements)?;
    Ok(measurements)
}

/// Effects of a fit as the model's file holds them.
fn arm_effects(fitted: &Fit, finding: &Finding) -> Vec<ModelEffect> {
    let mut at = 0;
    let mut effects = vec![];
    for present in &fitted.assumed.effects {
        let width = present.values.len();
        let covariance = fitted.covariance.view((at, at), (width, width));
        at += width;
        effects.push(model_effect(present, covariance.iter().copied().collect(), finding));
    }
    effects
}

/// Effects of a finding that can be added, of the library.
fn named_effects(finding: &Finding, arm: &Arm) -> Vec<Effect> {
    // What encoders see is in every row that has them already.
    let is_seen = |effect: &&NamedEffect| Kind::of_id(&effect.id).is_some_and(Kind::is_seen_by_encoder);
    let effects =
        finding.addable().into_iter().map(|i| &finding.effects[i]).filter(|effect| !is_seen(effect));
    effects
        .filter_map(|effect| Effect::find(&effect.id, &effect.site, effect.shape, Some(arm), None))
        .collect()
}

/// The signs of the joints' last motions, which the window's table has in columns of its own.
fn directions(lab: &Lab, measurements: &mut Measurements) -> Result<(), CommissionError> {
    let stored = store::read(&session(lab))?;
    let signs: Vec<Vec<f64>> = stored
        .progress
        .counted()
        .map(|record| record.direction.iter().map(|sign| f64::from(*sign)).collect())
        .collect();
    for row in &mut measurements.rows {
        if let Some(signs) = signs.get(row.row).filter(|signs| signs.len() == row.direction.len()) {
            row.direction.clone_from(signs);
        }
    }
    Ok(())
}

fn model_effect(present: &Present, covariance: Vec<f64>, finding: &Finding) -> ModelEffect {
    let effect = &present.effect;
    let named = finding.effects.iter().find(|named| named.id == effect.id() && named.site == effect.site);
    let probability = named.map(|named| named.probability);
    ModelEffect { probability, ..effect_of(TIP, present, covariance) }
}

fn effect_of(tip: &str, present: &Present, covariance: Vec<f64>) -> ModelEffect {
    let Present { effect, values } = present;
    ModelEffect {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        tip: Some(tip.to_owned()),
        shape: effect.shape,
        values: values.clone(),
        covariance,
        probability: None,
        parameters: vec![],
    }
}

/// How well the effects of a fit are known together, as the model's file holds them.
fn together(tip: &str, fitted: &Fit, effects: &[ModelEffect]) -> Vec<Together> {
    let of_model = |present: &Present| {
        let is_it = |effect: &&ModelEffect| {
            (effect.id.as_str(), &effect.site) == (present.effect.id(), &present.effect.site)
        };
        effects.iter().filter(|effect| effect.tip.as_deref() == Some(tip)).find(is_it).cloned()
    };
    let fitted_effects: Option<Vec<ModelEffect>> = fitted.assumed.effects.iter().map(of_model).collect();
    fitted_effects.and_then(|effects| Together::new(&effects, &fitted.covariance)).into_iter().collect()
}

/// Puts effects in use with the fitted zero of the neck, and the screen where the fit places it.
fn accept(
    lab: &Lab,
    mut model: RigModel,
    measurements: &Measurements,
    fitted: &Fit,
    mut effects: Vec<ModelEffect>,
    (sentence, version): (String, String),
    gap: Option<StepGap>,
) -> Result<(), CommissionError> {
    let read = Session::read(&session(lab))?;
    let title = measurements.apparatuses[0].title.clone();
    let nominal = read.manifest.touchscreen.clone().unwrap_or_else(|| lab.rig.touchscreen.clone());
    let mut placed = PlacedScreen::moved(&title, &nominal, &fitted.assumed.placements[0]);
    placed.over_table_m = SeenScreen::read(lab)?.and_then(|seen| seen.table).map(|table| table.glass_over_m);
    if let Some((zero_rad, sd_rad)) = fitted.neck_rad {
        let joint = lab.rig.description.joint(lab.rig.eyes.pan).name.clone();
        effects.push(ModelEffect {
            id: Kind::HeadJoint.id().to_owned(),
            title: format!("{joint}: {}", Kind::HeadJoint.about()),
            site: joint,
            tip: None,
            shape: None,
            values: vec![zero_rad],
            covariance: vec![sd_rad * sd_rad],
            probability: None,
            parameters: vec![],
        });
    }
    if effects.is_empty() {
        return Ok(());
    }
    let together = together(TIP, fitted, &effects);
    let addition = Addition {
        effects,
        screens: vec![placed.clone()],
        externals: vec![],
        eyes: vec![],
        together,
        replaces: true,
        at: jiff::Timestamp::now(),
        sentence,
        sessions: vec![title],
        version,
        gap,
    };
    model.add(&lab.rig, addition).map_err(CommissionError::room)?;
    rig_models::save(&lab.world(), &model, &lab.rig).map_err(CommissionError::room)?;

    // The same screen for those who know of no effects: it is where the finger found it.
    let screen = &placed.screen;
    let normal = screen.normal().vector();
    let middle = screen.middle();
    let [u_m, v_m] = screen.pitch_m();
    let touches: Vec<_> = measurements
        .rows
        .iter()
        .filter_map(|row| {
            let touched = plumbline_model::Pixel::new(
                middle.u_px + row.measured[0] / u_m,
                middle.v_px + row.measured[1] / v_m,
            );
            let predicted = measurements.predict(row, &fitted.assumed)?;
            let at = plumbline_model::Pixel::new(
                middle.u_px + predicted[0] / u_m,
                middle.v_px + predicted[1] / v_m,
            );
            let tip = screen.point_at(at).coords + normal * predicted[2];
            Some((touched, plumbline_model::Point::from(tip)))
        })
        .collect();
    let placement = place_screen(&lab.rig.touchscreen, &touches).map_err(CommissionError::room)?;
    lab.accept_placement(&placement.of_rig(&lab.rig.name))
}

//! Step effects: what makes the arm miss. The search names what the touches can name. What they cannot
//! name is still there: all usual effects together, each drawn to zero, are fitted too. Of the nominal
//! arm, the named effects and all together the one that errs least on touches held out is put in use.

use plumbline_effects::arm::Arm;
use plumbline_effects::rig_model::{Addition, ModelEffect, StepGap};
use plumbline_effects::{Effect, Kind, Measurements, RigModel, Surface};
use plumbline_engine::gap::model_name;
use plumbline_engine::gap::search::{measured, search};
use plumbline_engine::gap::sessions::stamps;
use plumbline_engine::gap::store::{KeptFinding, KeptSession, Store};
use plumbline_engine::rig_models::{self, library_of};
use plumbline_engine::touch::plan::TIP;
use plumbline_fit::{
    Fit, Known, SeenHands, Which, arm_effects, choose, effect_of, fit, lag, measurements, moves_palm,
    neck_effect, placed, together, usual,
};
use plumbline_gap::Options;
use plumbline_gap::finding::NamedEffect;
use plumbline_model::touchscreen::place_screen;
use plumbline_model::{JobContext, Session};

use super::error::CommissionError;
use super::glass::SeenScreen;
use super::known::{Seen, Share};
use super::lab::Lab;
use super::steps::Step;
use super::touches::session;

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
    let known = seen.known(&lab.rig, 1.0);
    let named = library_of(finding.addable().into_iter().map(|i| &finding.effects[i]), &arm);
    let chosen = choose(&measurements, &arm, named, &known, context)?;
    let known = Known { share: chosen.share, ..known };
    let mm = |m: Option<f64>| m.map_or("not known".to_owned(), |m| format!("{:.2} mm", 1e3 * m));
    step.notes.push(format!(
        "Held-out touches err by {} without effects, {} with those named, {} with all usual ones.",
        mm(chosen.held_out.nothing_m),
        mm(chosen.held_out.named_m),
        mm(chosen.held_out.all_m)
    ));
    let what = match chosen.which {
        Which::Nothing => "no effect of the arm".to_owned(),
        Which::Named => "those named".to_owned(),
        Which::All => {
            format!("all usual effects, each drawn to zero, at {} of their usual size", chosen.share)
        }
    };
    step.notes.push(format!("In use: {what}."));
    let (before_m, after_m) = (chosen.held_out.nothing_m, chosen.error_m());
    (step.before_mm, step.after_mm) = (before_m.map(|m| 1e3 * m), after_m.map(|m| 1e3 * m));
    let rows: Vec<_> = measurements.rows.iter().collect();
    let Some(fitted) = fit(&measurements, &rows, &chosen.effects, &known) else { return Ok(step) };
    if let Some((zero_rad, sd_rad)) = fitted.neck_rad {
        step.notes.push(format!(
            "The neck's turn is off by {:.2}° ± {:.2}°.",
            zero_rad.to_degrees(),
            sd_rad.to_degrees()
        ));
    }
    Share(known.share).write(lab)?;
    let named = |effect: &Effect| {
        let is_it = |named: &&NamedEffect| named.id == effect.id() && named.site == effect.site;
        finding.effects.iter().find(is_it).map(|named| named.probability)
    };
    let mut effects = arm_effects(TIP, &fitted, named);
    for (present, covariance) in lag(&measurements, &arm) {
        effects.push(ModelEffect {
            probability: named(&present.effect),
            ..effect_of(TIP, &present, covariance)
        });
    }
    let gap = before_m.zip(after_m).map(|(before, after)| StepGap {
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
    let library: Vec<Effect> = usual(&arm).into_iter().filter(moves_palm).collect();
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
    for (present, covariance) in lag(lags, &arm) {
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
    Ok(measured(std::slice::from_ref(&session(lab)), &lab.rig)?)
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
    let Some(mut placed) = placed(&title, &nominal, fitted) else { return Ok(()) };
    placed.over_table_m = SeenScreen::read(lab)?.and_then(|seen| seen.table).map(|table| table.glass_over_m);
    effects.extend(neck_effect(&lab.rig, fitted));
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

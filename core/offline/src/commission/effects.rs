//! Step effects: what makes the arm miss. The search names what the touches can name. What they cannot
//! name is still there: all usual effects together, each drawn to zero, are fitted too. Of the nominal
//! arm, the named effects and all together the one that errs least on touches held out is put in use.

use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{Effect, RigModel};
use plumbline_engine::gap::at_tip::moved_m;
use plumbline_engine::gap::search::{measured, search};
use plumbline_engine::gap::sessions::stamps;
use plumbline_engine::gap::store::{KeptFinding, KeptSession, Store};
use plumbline_engine::gap::{model_name, model_view};
use plumbline_engine::rig_models::{self, name_of};
use plumbline_engine::view::AddedEffect;
use plumbline_fit::{ArmTouches, Chosen, HeldOut, Name, SizedArm, Which};
use plumbline_gap::Options;
use plumbline_handeye::{Sizing, Start};
use plumbline_model::JobContext;
use plumbline_model::spread::NORMAL_95;
use plumbline_model::touchscreen::place_screen;

use super::error::CommissionError;
use super::lab::Lab;
use super::steps::Step;
use super::touches::{accept_place, session};

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
    let names = finding.addable().into_iter().map(|i| name_of(&finding.effects[i])).collect();
    let (start, tie) = (lab.start()?, lab.tie()?);
    lab.with_touches(|touches| {
        let sizing = Sizing::begin(&start, touches, &tie, names, context)?;
        told(&mut step, sizing.what());
        lab.keep_share(sizing.what().share)?;
        let arm = sizing.touched(None)?;
        if let Some((zero_rad, sd_rad)) = arm.fitted.neck_rad {
            step.notes.push(format!(
                "The neck's turn is off by {:.2}° ± {:.2}°.",
                zero_rad.to_degrees(),
                NORMAL_95 * sd_rad.to_degrees()
            ));
        }
        let model = sizing.model(&arm, None, &finding.sentence, jiff::Timestamp::now())?;
        step.notes.extend(small(&model_view(&model, &moved_m(&model, &lab.rig)).effects));
        put_in_use(lab, &model)?;
        place_for_others(lab, touches, &arm)
    })?;
    Ok(step)
}

/// What was chosen, in words.
fn told(step: &mut Step, chosen: &Chosen) {
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
}

/// So many small effects are told, the largest; the others are counted.
const MOST_SMALL: usize = 3;

/// Which effects in use move next to nothing, and why they stay; `None`: there is none.
fn small(effects: &[AddedEffect]) -> Option<String> {
    let mut small: Vec<&AddedEffect> = effects.iter().filter(|effect| effect.is_small()).collect();
    small.sort_by(|a, b| b.moved_m.unwrap_or(0.0).total_cmp(&a.moved_m.unwrap_or(0.0)));
    let told: Vec<String> = small.iter().take(MOST_SMALL).map(|effect| effect.told()).collect();
    let more = match small.len().saturating_sub(MOST_SMALL) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!told.is_empty()).then(|| {
        format!(
            "In use although they do little: {}{more}. They stay because the touches tell them from noise, or because \
             together they let the arm err less on touches held out.",
            told.join("; ")
        )
    })
}

/// The effects in use of the arm that touched, to be sized anew.
pub(super) fn in_use(
    lab: &Lab,
    start: &Start,
    touches: &ArmTouches<'_>,
) -> Result<(Vec<Name>, Chosen), CommissionError> {
    let model = start.model.added();
    let of_arm = |effect: &&ModelEffect| effect.tip.as_deref() == Some(touches.tip);
    let find = |effect: &ModelEffect| {
        let found = Effect::find(&effect.id, &effect.site, effect.shape, Some(touches.arm), None);
        found.filter(|found| !found.kind.is_seen_by_encoder())
    };
    let effects = model.effects().iter().filter(of_arm).filter_map(find).collect();
    let chosen = Chosen { which: Which::All, effects, share: lab.share()?, held_out: HeldOut::default() };
    Ok((Name::of_model(model, touches.tip), chosen))
}

/// Puts a model in use.
pub(super) fn put_in_use(lab: &Lab, model: &RigModel) -> Result<(), CommissionError> {
    rig_models::save(&lab.world(), model, &lab.rig).map_err(CommissionError::room)
}

/// The same screen for those who know of no effects: it is where the finger found it.
pub(super) fn place_for_others(
    lab: &Lab,
    touches: &ArmTouches<'_>,
    arm: &SizedArm,
) -> Result<(), CommissionError> {
    let (measurements, Some(placed)) = (touches.measurements, &arm.screen) else { return Ok(()) };
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
            let predicted = measurements.predict(row, &arm.fitted.assumed)?;
            let at = plumbline_model::Pixel::new(
                middle.u_px + predicted[0] / u_m,
                middle.v_px + predicted[1] / v_m,
            );
            let tip = screen.point_at(at).coords + normal * predicted[2];
            Some((touched, plumbline_model::Point::from(tip)))
        })
        .collect();
    let placement = place_screen(&lab.rig.touchscreen, &touches).map_err(CommissionError::room)?;
    accept_place(lab, &placement.of_rig(&lab.rig.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_effects_are_told_with_their_size_and_why_they_stay() {
        let effect = |k: usize, moved_m| AddedEffect {
            name: format!("joint-zero@{k}"),
            is_named: false,
            title: format!("Joint {k}: zero position off"),
            parameters: vec![],
            is_of_eyes: false,
            is_left_out: false,
            moved_m,
        };
        assert_eq!(small(&[effect(0, Some(3e-3)), effect(1, None)]), None);
        let effects: Vec<AddedEffect> = (0..5).map(|k| effect(k, Some(1e-4 * k as f64))).collect();
        let said = small(&effects).expect("all are small");
        assert!(
            said.contains("Joint 4: zero position off (small: 0.40 mm at the fingertip); Joint 3"),
            "{said}"
        );
        assert!(said.contains(" and 2 more. They stay because"), "{said}");
    }
}

//! Step models: the published correction models, learned from the same touches, for those who grasp
//! with them.

use plumbline_correction::Method;
use plumbline_correction::train::FEWEST_FOR_A_NETWORK;
use plumbline_engine::models::learn::{learn, options};
use plumbline_engine::models::losses::Losses;
use plumbline_engine::models::screen::corners;
use plumbline_engine::models::store::Store;
use plumbline_model::JobContext;

use super::error::CommissionError;
use super::lab::Lab;
use super::steps::Step;
use super::touches::session;

/// Trains what the touches suffice for and keeps it; the one that errs least on held-out touches is in use.
pub(super) fn run(lab: &Lab, touches: usize, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("models", "touches held out, along the glass, by the model in use, rms");
    let enough = |method: &Method| *method == Method::M1 || touches >= FEWEST_FOR_A_NETWORK;
    let methods: Vec<Method> = Method::ALL.into_iter().filter(enough).collect();
    let rig = lab.rig_with_screen()?;
    let folder = session(lab);
    let how = options(&folder, &rig, lab.seed, false);
    let trained = learn(&folder, &rig, &methods, &how, &Losses::default(), context)?;
    let mut order: Vec<(f64, _)> = trained
        .models
        .iter()
        .map(|model| {
            let judged = trained.comparison.methods.iter().find(|other| other.method == model.method());
            (judged.map_or(f64::INFINITY, |judged| judged.held_out.errors.rms_2d_m), model)
        })
        .collect();
    // The last one that is accepted is in use.
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let store = Store::new(lab.world().join("models"));
    let (mut history, _) = store.read(&rig.name)?;
    for (error_m, model) in &order {
        context.checkpoint()?;
        history =
            store.accept(&history, Some((&**model, corners(&rig.touchscreen))), jiff::Timestamp::now())?;
        step.notes.push(format!("{}: {:.2} mm.", model.method().name(), 1e3 * error_m));
        step.after_mm = Some(1e3 * error_m);
    }
    Ok(step)
}

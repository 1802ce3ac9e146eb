//! Training: models, their comparison on the same held-out touches, and their maps.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use plumbline_correction::train::{Compared, FEWEST_FOR_A_NETWORK};
use plumbline_correction::{
    Comparison, CorrectionModel, Method, Recipe, TouchData, TrainError, TrainOptions, cross_validate, train,
};
use plumbline_model::JobContext;
use plumbline_model::robot::Rig;

use super::losses::Losses;
use super::map::model_map;
use super::sessions::touch_data;
use super::view::ModelMap;
use crate::ground::jobs::{JobError, Part};
use crate::ground::text::sentence;

/// Name and version of this program, for what comes from it.
const SOFTWARE: &str = concat!("plumbline ", env!("CARGO_PKG_VERSION"));

/// What training gives.
#[derive(Clone, Debug)]
pub struct Trained {
    /// What was learned from.
    pub data: Arc<TouchData>,
    /// The models asked for.
    pub models: Vec<Arc<CorrectionModel>>,
    /// All methods that the touches suffice for, on the same held-out touches.
    pub comparison: Arc<Comparison>,
    /// Maps of the models.
    pub maps: BTreeMap<Method, Arc<ModelMap>>,
}

/// How to train.
pub fn options(session: &Path, rig: &Rig, seed: u64, published_recipe: bool) -> TrainOptions {
    let name = session.file_name().unwrap_or(session.as_os_str());
    TrainOptions {
        seed,
        recipe: if published_recipe { Recipe::Published } else { Recipe::Evidence },
        session: name.to_string_lossy().into_owned(),
        software: SOFTWARE.to_owned(),
        rig: rig.name.clone(),
        screen: Some((&rig.touchscreen).into()),
        ..TrainOptions::default()
    }
}

/// Trains the methods asked for and judges all of them on the same held-out touches.
pub fn learn(
    session: &Path,
    rig: &Rig,
    methods: &[Method],
    options: &TrainOptions,
    losses: &Losses,
    context: &dyn JobContext,
) -> Result<Trained, JobError> {
    context.report(0.0, "reading the touches");
    let data = touch_data(session, rig).map_err(JobError::failed)?;
    let enough = |method: &Method| *method == Method::M1 || data.len() >= FEWEST_FOR_A_NETWORK;
    let judged: Vec<Method> =
        Method::ALL.into_iter().filter(|method| methods.contains(method) || enough(method)).collect();
    let (mut models, mut compared) = (Vec::new(), Vec::new());
    for (i, method) in judged.iter().enumerate() {
        context.checkpoint()?;
        let begin = i as f64 / judged.len() as f64;
        let part = Part { whole: context, begin, end: begin + 0.95 / judged.len() as f64 };
        let named = Named { part, method: *method };
        let held_out = if methods.contains(method) {
            let model =
                train(&data, *method, options, &named, &mut |point| losses.add(point)).map_err(failed)?;
            let held_out = model.provenance().cross_validation.clone();
            models.push(Arc::new(model));
            held_out
        } else {
            Some(cross_validate(&data, *method, options, &named).map_err(failed)?)
        };
        compared.extend(held_out.map(|held_out| Compared { method: *method, held_out }));
    }
    context.checkpoint()?;
    context.report(0.97, "drawing the maps");
    let map =
        |model: &Arc<CorrectionModel>| (model.method(), Arc::new(model_map(model, &rig.touchscreen, true)));
    let rows = data.touches.iter().map(|touch| touch.row).collect();
    Ok(Trained {
        maps: models.iter().map(map).collect(),
        data: Arc::new(data),
        models,
        comparison: Arc::new(Comparison { rows, methods: compared }),
    })
}

fn failed(error: TrainError) -> JobError {
    match error {
        TrainError::Cancelled(cancelled) => cancelled.into(),
        other => JobError::failed(sentence(&other.to_string())),
    }
}

/// Says which model the progress is of.
struct Named<'a> {
    part: Part<'a>,
    method: Method,
}

impl JobContext for Named<'_> {
    fn checkpoint(&self) -> Result<(), plumbline_model::Cancelled> {
        self.part.checkpoint()
    }

    fn report(&self, fraction: f64, doing: &str) {
        self.part.report(fraction, &format!("{}: {doing}", self.method.name()));
    }
}

//! `plumbline train`: a correction model from the touches of a session.

use std::path::PathBuf;
use std::time::Instant;

use plumbline_correction::{
    CorrectionModel, CrossValidation, Errors, FileError, Method, TouchData, spread_of_repeats,
    train as train_model,
};
use plumbline_engine::models;
use plumbline_model::robot::RigPart;
use plumbline_model::session::Screen;
use plumbline_model::{JobContext, Pixel, files};
use serde::Serialize;

use super::{OfflineError, session};

/// What to train.
#[derive(Clone, Debug)]
pub struct TrainArgs {
    /// Folder of the session.
    pub session: PathBuf,
    /// Which model.
    pub method: Method,
    /// Receives the model: ONNX if it is called so, else JSON.
    pub out: PathBuf,
    /// Same seed, same model.
    pub seed: u64,
    /// As published (Adam, 200 epochs), rather than as this program does it.
    pub published_recipe: bool,
}

/// What came of it. Errors are predicted − sent; 2D ones are in the plane.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrainReport {
    /// Which model.
    pub model: String,
    /// Touches that were learned from.
    pub rows: usize,
    /// √(mean squared 2D error) on them.
    pub train_rms_mm: f64,
    /// Mean 2D error on them.
    pub train_mean_mm: f64,
    /// √(mean squared error of the height) on them.
    pub train_height_rms_mm: f64,
    /// √(mean squared 2D error) of touches whose whole block was held out.
    pub cross_validated_rms_mm: f64,
    /// Mean 2D error of touches whose whole block was held out.
    pub cross_validated_mean_mm: f64,
    /// 95 % interval of that mean, from drawing blocks.
    pub cross_validated_mean_interval_mm: [f64; 2],
    /// √(mean squared error of the height) of touches whose whole block was held out.
    pub cross_validated_height_rms_mm: f64,
    /// What was held out together: sets of the session, or areas.
    pub blocks: Vec<String>,
    /// Spread of repeats of one command, 2D rms: no model gets below it. Null without repeats.
    pub noise_floor_mm: Option<f64>,
    /// Area inside the border of the touches.
    pub border_cm2: Option<f64>,
    /// Rows that were left out and why.
    pub left_out: Vec<String>,
    /// Training with its cross-validation.
    pub seconds: f64,
}

/// Trains, cross-validates, and writes the model.
pub fn train(args: &TrainArgs, context: &dyn JobContext) -> Result<TrainReport, OfflineError> {
    let is_onnx = args.out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx"));
    if is_onnx && args.method == Method::M1 {
        // Said before the work, not after it.
        return Err(FileError::NotANetwork.into());
    }
    files::output(&args.out, &[&args.session])?;
    let (recorded, rig) = session::open(&args.session)?;
    if let Some(file) = session::rig_file(&recorded, &args.session) {
        files::output(&args.out, &[&file])?;
    }
    rig.need(RigPart::Touchscreen)?;
    let chain = recorded.manifest.chain.as_ref();
    // A session without touches has no use for a chain, and is told so.
    let usual = || rig.arms.first().and_then(|arm| arm.tips.first()).map(|tip| tip.link.as_str());
    let tip = chain.map(|chain| chain.tip.as_str()).or_else(usual).unwrap_or_default();
    let data = TouchData::of_session(&recorded, &rig.chain(tip)?)?;
    let options = models::options(&args.session, &rig, args.seed, args.published_recipe);
    let began = Instant::now();
    let model = train_model(&data, args.method, &options, context, &mut |_| ())?;
    let seconds = began.elapsed().as_secs_f64();
    if is_onnx {
        model.write_onnx(&args.out)?
    } else {
        model.write(&args.out)?
    }
    context.report(1.0, "trained");
    report(&data, &model, seconds)
}

fn report(data: &TouchData, model: &CorrectionModel, seconds: f64) -> Result<TrainReport, OfflineError> {
    let provenance = model.provenance();
    let (Some(training), Some(held_out)) = (&provenance.training, &provenance.cross_validation) else {
        unreachable!("training always judges its model");
    };
    let (training, CrossValidation { errors, mean_2d_interval_m, blocks, .. }): (&Errors, _) =
        (training, held_out);
    let mm = |meters: f64| meters * 1e3;
    Ok(TrainReport {
        model: model.method().name().to_lowercase(),
        rows: data.len(),
        train_rms_mm: mm(training.rms_2d_m),
        train_mean_mm: mm(training.mean_2d_m),
        train_height_rms_mm: mm(training.rms_z_m),
        cross_validated_rms_mm: mm(errors.rms_2d_m),
        cross_validated_mean_mm: mm(errors.mean_2d_m),
        cross_validated_mean_interval_mm: mean_2d_interval_m.map(mm),
        cross_validated_height_rms_mm: mm(errors.rms_z_m),
        blocks: blocks.names.clone(),
        noise_floor_mm: spread_of_repeats(data).map(|repeats| mm(repeats.rms_2d_m)),
        border_cm2: border_m2(data, model).map(|area_m2| area_m2 * 1e4),
        left_out: data.left_out.clone(),
        seconds,
    })
}

/// Area of the border's outer edge on the glass, m².
fn border_m2(data: &TouchData, model: &CorrectionModel) -> Option<f64> {
    let outline: &[Pixel<Screen>] = model.border()?.outline();
    let next = outline.iter().cycle().skip(1);
    // Gauss's formula for polygons.
    let twice_px2: f64 = outline.iter().zip(next).map(|(a, b)| a.u_px * b.v_px - b.u_px * a.v_px).sum();
    let [u_m, v_m] = data.screen.pitch_m();
    Some(0.5 * twice_px2.abs() * u_m * v_m)
}

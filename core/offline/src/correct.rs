//! `plumbline correct`: which point must be sent so that the fingertip lands on a pixel.

use std::path::{Path, PathBuf};

use plumbline_correction::CorrectionModel;
use plumbline_engine::models::files;
use plumbline_model::session::Screen;
use plumbline_model::{JobContext, Pixel};
use serde::Serialize;

use super::OfflineError;
use super::table::Table;

/// What the file of pixels needs.
const NEEDS: &str = "the header u_px,v_px and one pixel of the touchscreen per line, for example 960,540";

/// What to correct.
#[derive(Clone, Debug)]
pub struct CorrectArgs {
    /// A model: this program's JSON, ONNX, or published weights as JSON.
    pub model: PathBuf,
    /// Table with the columns `u_px`, `v_px`.
    pub points: PathBuf,
}

/// What must be sent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrectReport {
    /// Which kind of model answered.
    pub model: String,
    /// In the order of the table.
    pub points: Vec<CorrectedPoint>,
    /// What has to be known of the model, a sentence each.
    pub remarks: Vec<String>,
}

/// What must be sent for one pixel, in the frame of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CorrectedPoint {
    /// Column on the screen.
    pub u_px: f64,
    /// Row on the screen.
    pub v_px: f64,
    /// Forward.
    pub x_m: f64,
    /// To the left.
    pub y_m: f64,
    /// Up.
    pub z_m: f64,
    /// Whether the pixel lies inside the border of the touches that the model was trained on.
    pub inside: bool,
    /// Standard deviation in the plane, √(σx² + σy²), of a new touch about the answer; null where
    /// nothing is known: the model was imported without its touches.
    pub sigma_m: Option<f64>,
    /// Its standard deviation along x.
    pub sigma_x_m: Option<f64>,
    /// Its standard deviation along y.
    pub sigma_y_m: Option<f64>,
    /// Its standard deviation along z.
    pub sigma_z_m: Option<f64>,
}

/// Asks a model for every pixel of a table.
pub fn correct(args: &CorrectArgs, context: &dyn JobContext) -> Result<CorrectReport, OfflineError> {
    context.checkpoint()?;
    let model = files::read_any(&args.model)?;
    let table = Table::read(&args.points, &["u_px", "v_px"], &[], NEEDS)?;
    near_the_screen(&model, &table, &args.points)?;
    let known = |sd_m: f64| sd_m.is_finite().then_some(sd_m);
    let point = |row: &Vec<f64>| {
        let answer = model.correct(Pixel::new(row[0], row[1]));
        let at = answer.target.coords;
        let [x, y, z] = answer.sd_m;
        CorrectedPoint {
            u_px: row[0],
            v_px: row[1],
            x_m: at.x,
            y_m: at.y,
            z_m: at.z,
            inside: answer.inside,
            sigma_m: known(x.hypot(y)),
            sigma_x_m: known(x),
            sigma_y_m: known(y),
            sigma_z_m: known(z),
        }
    };
    let points: Vec<CorrectedPoint> = table.rows().iter().map(point).collect();
    context.report(1.0, "corrected");
    let mut remarks = model.provenance().remarks.clone();
    remarks.extend(off_screen(&model, &points));
    Ok(CorrectReport { model: model.method().name().to_lowercase(), points, remarks })
}

/// Refuses pixels that lie farther beside the screen of the model than the screen is large: there the
/// model's answer says nothing.
fn near_the_screen(model: &CorrectionModel, table: &Table, file: &Path) -> Result<(), OfflineError> {
    let options = model.provenance().options.as_ref();
    let Some(screen) = options.and_then(|options| options.screen.as_ref()) else { return Ok(()) };
    let beside = |at_px: f64, count: u32| !(-f64::from(count)..=2.0 * f64::from(count)).contains(&at_px);
    let wild = |row: &Vec<f64>| beside(row[0], screen.width_px) || beside(row[1], screen.height_px);
    match table.rows().iter().position(wild) {
        None => Ok(()),
        Some(row) => Err(OfflineError::Table {
            file: file.to_owned(),
            line: row + 2,
            reason: format!(
                "the pixel ({}, {}) lies farther beside the touchscreen of {} × {} px that the model was trained on \
                 than the screen is large",
                table.rows()[row][0],
                table.rows()[row][1],
                screen.width_px,
                screen.height_px
            ),
            needs: NEEDS,
        }),
    }
}

/// What to say when pixels are not on the screen that the model was trained on: its size, since the
/// points may be of another one.
fn off_screen(model: &CorrectionModel, points: &[CorrectedPoint]) -> Option<String> {
    let screen = model.provenance().options.as_ref()?.screen.as_ref()?;
    let size = (screen.width_px, screen.height_px);
    let off = points.iter().filter(|point| !Pixel::<Screen>::new(point.u_px, point.v_px).is_inside(size));
    let count = off.count();
    (count > 0).then(|| {
        format!(
            "{count} of the {} pixels do not lie on the touchscreen that the model was trained on, {}×{} px",
            points.len(),
            size.0,
            size.1
        )
    })
}

//! `plumbline predict`: what the model says each row of a session should have measured.

use std::path::PathBuf;

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{ModelEffect, predict_session_with};
use plumbline_model::predict::{
    Angles, LocalizationPrediction, PosePrediction, SessionPrediction, TipOutcome, TipPlace, TouchPrediction,
};
use plumbline_model::session::Touchscreen;
use plumbline_model::{JobContext, Session};
use serde::Serialize;

use super::OfflineError;
use super::session::{self, ModelFile};

/// What to predict.
#[derive(Clone, Debug)]
pub struct PredictArgs {
    /// Folder of the session.
    pub session: PathBuf,
    /// A rig file, a screen placement or a model with effects to use in place of what the session names.
    pub rig_model: Option<PathBuf>,
}

/// What the model says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PredictReport {
    /// Robot whose model was used.
    pub rig: String,
    /// From where the place of the touchscreen was taken: `session`, `rig-model`.
    pub screen: &'static str,
    /// Effects that were predicted with, as `id@site`.
    pub effects: Vec<String>,
    /// Per table how far what was measured lies from what was predicted.
    pub gaps: Vec<TableGap>,
    /// What became of the rows of each tip or marker of the poses.
    pub tips: Vec<PredictedTip>,
    /// One per row: touches, then localizations, then poses, each in their order.
    pub rows: Vec<PredictedRow>,
}

/// How far a table's measurements lie from their prediction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableGap {
    /// `touches`: on the glass, 2D. `localizations`: place inferred from the measurement against
    /// the known place, on the table, 2D, rows that are marked invalid left out. `poses`: in space,
    /// when a model says where the external frame is, rows of which the place of the marker is known.
    pub table: &'static str,
    /// Rows that were compared.
    pub rows: usize,
    /// Mean distance.
    pub mean_mm: f64,
    /// Root of the mean squared distance.
    pub rms_mm: f64,
}

/// What became of the rows of one tip or marker.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PredictedTip {
    /// As the rows name it, else the chain's tip.
    pub tip: String,
    /// Number of rows.
    pub rows: usize,
    /// `description`: the frame of this name was predicted, and is what was measured. `model`: the marker, where a
    /// model found it at the frame. `frame`: the frame, although what was measured sits elsewhere and nothing tells
    /// where. `none`: the rows are not predicted.
    pub place: &'static str,
    /// The session that the model found the marker in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_in: Option<String>,
    /// In words.
    pub words: String,
}

impl From<&TipOutcome> for PredictedTip {
    fn from(outcome: &TipOutcome) -> Self {
        let found_in = match &outcome.place {
            TipPlace::Model { session } => Some(session.clone()),
            _ => None,
        };
        let (tip, words) = (outcome.tip.clone(), outcome.words.clone());
        Self { tip, rows: outcome.rows, place: outcome.place.word(), found_in, words }
    }
}

/// The prediction of one row, named like the columns that were measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "table", rename_all = "lowercase")]
pub enum PredictedRow {
    /// A touch.
    Touches {
        /// Column on the screen.
        touch_u_px: f64,
        /// Row on the screen.
        touch_v_px: f64,
        /// Height of the fingertip above the glass.
        above_glass_m: f64,
        /// `encoder` or `commanded`.
        angles: &'static str,
    },
    /// A localization. Null: not known or not measured.
    Localizations {
        /// Estimate for the known place.
        est_x_m: Option<f64>,
        /// Estimate for the known place.
        est_y_m: Option<f64>,
        /// Estimate for the known place.
        est_z_m: Option<f64>,
        /// The known place in the images, where the session has image points.
        #[serde(flatten, skip_serializing_if = "Option::is_none")]
        pixels: Option<ImagePoints>,
        /// The place that the model infers from what was measured.
        corrected_x_m: Option<f64>,
        /// The place that the model infers from what was measured.
        corrected_y_m: Option<f64>,
        /// The place that the model infers from what was measured.
        corrected_z_m: Option<f64>,
    },
    /// A pose: in the external frame where a model with effects has it, else in the robot's. Null where the robot
    /// has nothing that the row could have measured, see [`PredictReport::tips`].
    Poses {
        /// Place of the tip.
        meas_x_m: Option<f64>,
        /// Place of the tip.
        meas_y_m: Option<f64>,
        /// Place of the tip.
        meas_z_m: Option<f64>,
        /// How the tip is turned, where the session measured that.
        #[serde(flatten, skip_serializing_if = "Option::is_none")]
        turn: Option<Turn>,
        /// `encoder` or `commanded`.
        angles: Option<&'static str>,
    },
}

/// An orientation as a unit quaternion, its scalar part positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "named like the columns of the session format")]
pub struct Turn {
    pub meas_qw: f64,
    pub meas_qx: f64,
    pub meas_qy: f64,
    pub meas_qz: f64,
}

/// A place in both images, raw pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "named like the columns of the session format")]
pub struct ImagePoints {
    pub left_u_px: f64,
    pub left_v_px: f64,
    pub right_u_px: f64,
    pub right_v_px: f64,
}

/// Predicts every row of a session.
pub fn predict(args: &PredictArgs, context: &dyn JobContext) -> Result<PredictReport, OfflineError> {
    context.checkpoint()?;
    let (recorded, mut rig) = session::open(&args.session)?;
    let (mut screen, mut model) = (None, RigModel::nominal(&rig));
    if let Some(file) = &args.rig_model {
        match ModelFile::read(file, &rig)? {
            ModelFile::Rig(other) => {
                rig = *other;
                screen = Some(rig.touchscreen.clone());
            }
            ModelFile::Placement(placement) => screen = Some(placement.screen),
            ModelFile::Effects(of_file) => model = *of_file,
        }
    }
    let own = recorded.manifest.touchscreen.as_ref().filter(|_| recorded.touches.is_some());
    if let Some(own) = own {
        // A nominal model is the nominal robot, whatever it was placed with before.
        screen = screen.or_else(|| model.screen(own).filter(|_| !model.is_nominal()).cloned());
    }
    if let (Some(own), Some(other)) = (own, &screen) {
        same_size(own, other)?;
    }
    let frame = recorded.manifest.pose_setup().external_frame;
    let predicted = predict_session_with(&recorded, &rig, screen.as_ref(), &model)?;
    context.report(1.0, "predicted");
    Ok(PredictReport {
        rig: rig.name,
        screen: if screen.is_some() { "rig-model" } else { "session" },
        effects: model.effects().iter().map(ModelEffect::name).collect(),
        gaps: gaps(
            &recorded,
            &predicted,
            screen.as_ref(),
            model.external(frame.as_deref()).is_some() && !model.is_nominal(),
        ),
        tips: predicted.tips.iter().map(PredictedTip::from).collect(),
        rows: rows(&recorded, &predicted),
    })
}

fn same_size(own: &Touchscreen, other: &Touchscreen) -> Result<(), OfflineError> {
    let size = |screen: &Touchscreen| {
        format!(
            "{}×{} px, {:.1}×{:.1} mm",
            screen.width_px,
            screen.height_px,
            screen.width_m * 1e3,
            screen.height_m * 1e3
        )
    };
    if (own.width_px, own.height_px) == (other.width_px, other.height_px) {
        return Ok(());
    }
    Err(OfflineError::OtherScreen { expected: size(own), found: size(other) })
}

fn gaps(
    session: &Session,
    predicted: &SessionPrediction,
    screen: Option<&Touchscreen>,
    in_external_frame: bool,
) -> Vec<TableGap> {
    let mut gaps = Vec::new();
    let screen = screen.or(session.manifest.touchscreen.as_ref());
    if let (Some(table), Some(screen)) = (&session.touches, screen) {
        let off_m = table.rows().zip(&predicted.touches).filter_map(|(row, prediction)| {
            Some(screen.point_at(row.touch?).distance_m(&screen.point_at(prediction.touch)))
        });
        gaps.extend(gap("touches", off_m.collect()));
    }
    if let Some(table) = &session.localizations {
        let valid = table.rows().zip(&predicted.localizations).filter(|(row, _)| row.valid);
        let off_m = valid.filter_map(|(row, prediction)| {
            Some((prediction.corrected?.coords.xy() - row.truth?.coords.xy()).norm())
        });
        gaps.extend(gap("localizations", off_m.collect()));
    }
    if let Some(table) = session.poses.as_ref().filter(|_| in_external_frame) {
        let chain_tip = session.manifest.chain.as_ref().map(|chain| &chain.tip);
        // A marker whose place nobody knows is not where its frame is.
        let is_known = |tip: Option<&String>| {
            let mut of_tip = predicted.tips.iter().filter(|one| Some(&one.tip) == tip.or(chain_tip));
            !of_tip.any(|one| one.place == TipPlace::Frame)
        };
        let known = table.rows().zip(&predicted.poses).filter(|(row, _)| is_known(row.tip.as_ref()));
        let off_m = known.filter_map(|(row, prediction)| {
            Some((row.measured?.coords - prediction.as_ref()?.tip.coords).norm())
        });
        gaps.extend(gap("poses", off_m.collect()));
    }
    gaps
}

fn gap(table: &'static str, off_m: Vec<f64>) -> Option<TableGap> {
    let count = off_m.len() as f64;
    (!off_m.is_empty()).then(|| TableGap {
        table,
        rows: off_m.len(),
        mean_mm: off_m.iter().sum::<f64>() / count * 1e3,
        rms_mm: (off_m.iter().map(|off| off * off).sum::<f64>() / count).sqrt() * 1e3,
    })
}

fn rows(session: &Session, predicted: &SessionPrediction) -> Vec<PredictedRow> {
    let turned = session.poses.as_ref().is_some_and(|table| table.table().has("meas_qw"));
    let touches = predicted.touches.iter().map(touch_row);
    let localizations = predicted.localizations.iter().map(localization_row);
    let poses = predicted.poses.iter().map(|pose| pose_row(pose.as_ref(), turned));
    touches.chain(localizations).chain(poses).collect()
}

fn name(angles: Angles) -> &'static str {
    match angles {
        Angles::Encoder => "encoder",
        Angles::Commanded => "commanded",
    }
}

fn touch_row(touch: &TouchPrediction) -> PredictedRow {
    PredictedRow::Touches {
        touch_u_px: touch.touch.u_px,
        touch_v_px: touch.touch.v_px,
        above_glass_m: touch.above_glass_m,
        angles: name(touch.angles),
    }
}

fn localization_row(located: &LocalizationPrediction) -> PredictedRow {
    let (estimate, corrected) = (located.estimate, located.corrected);
    PredictedRow::Localizations {
        est_x_m: estimate.map(|point| point.coords.x),
        est_y_m: estimate.map(|point| point.coords.y),
        est_z_m: estimate.map(|point| point.coords.z),
        pixels: located.pixels.map(|(left, right)| ImagePoints {
            left_u_px: left.u_px,
            left_v_px: left.v_px,
            right_u_px: right.u_px,
            right_v_px: right.v_px,
        }),
        corrected_x_m: corrected.map(|point| point.coords.x),
        corrected_y_m: corrected.map(|point| point.coords.y),
        corrected_z_m: corrected.map(|point| point.coords.z),
    }
}

fn pose_row(pose: Option<&PosePrediction>, turned: bool) -> PredictedRow {
    let turn = pose.filter(|_| turned).map(|pose| {
        // Both signs of a quaternion are the same turn.
        let sign = if pose.turn.w < 0.0 { -1.0 } else { 1.0 };
        let [meas_qw, meas_qx, meas_qy, meas_qz] =
            [pose.turn.w, pose.turn.i, pose.turn.j, pose.turn.k].map(|part| sign * part);
        Turn { meas_qw, meas_qx, meas_qy, meas_qz }
    });
    let tip = pose.map(|pose| pose.tip.coords);
    PredictedRow::Poses {
        meas_x_m: tip.map(|tip| tip.x),
        meas_y_m: tip.map(|tip| tip.y),
        meas_z_m: tip.map(|tip| tip.z),
        turn,
        angles: pose.map(|pose| name(pose.angles)),
    }
}

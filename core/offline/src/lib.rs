//! What the window does with recorded data, without a window: for scripts and for checks.
//!
//! Every function takes its arguments as a struct, reports progress to a [`JobContext`] and
//! gives a report whose serialized keys are those of the command line's JSON.
//!
//! [`JobContext`]: plumbline_model::JobContext

mod bench;
mod calibrate;
mod check;
mod commission;
mod correct;
mod detect;
mod detect_eval;
mod detector_set;
mod disparity;
pub mod doctor;
mod error;
mod gap;
mod gap_calibrations;
#[cfg(test)]
mod gap_tests;
mod grasp;
mod grid;
mod health;
mod ik;
mod lerobot;
mod locate;
mod pairs;
mod predict;
mod rig;
mod sample;
mod session;
mod table;
#[cfg(test)]
mod touch_tests;
mod train;
mod twin_body;

pub use bench::{BenchReport, Figure, Peer, bench};
pub use calibrate::{CalibrateArgs, CalibrateReport, LeftOutCorner, PairErrors, Rejected, calibrate_stereo};
pub use check::{CheckArgs, CheckReport, check};
pub use commission::{
    CommissionArgs, CommissionError, CommissionReport, PalmError, PlaceError, PlaceRow,
    Step as CommissionStep, TouchError, commission,
};
pub use correct::{CorrectArgs, CorrectReport, CorrectedPoint, correct};
pub use detect::{DetectArgs, DetectReport, FoundBox, LeftOutImage, detect};
pub use detect_eval::{
    ClassReport, DetectEvalArgs, DetectEvalReport, FailedModel, ModelReport, detect_eval, workspace_part,
};
pub use detector_set::{ClassBoxes, DetectorSetArgs, DetectorSetReport, detector_set};
pub use disparity::{DisparityArgs, DisparityReport, Geometry, disparity};
pub use error::OfflineError;
pub use gap::{EffectReport, GapArgs, GapReport, gap};
pub use grasp::{
    GraspArgs, GraspMethod, GraspReport, HandChoice, Judged, MethodSummary, PositionSummary, Spread, Summary,
    TrialsArgs, TrialsError, grasp, grasp_trials, merge_trials,
};
pub use grid::{GridArgs, GridCorrection, GridReport, GridRow, grid};
pub use health::{CalibrationHealth, HealthArgs, HealthReport, health};
pub use ik::{IkArgs, IkReport, IkSolution, ik};
pub use lerobot::{LerobotArgs, LerobotReport, lerobot};
pub use locate::{
    LocateArgs, LocateEyes, LocateReport, LocateRobot, LocatedPoint, PointInRobot, Stood, locate,
};
pub use plumbline_twin::training_set::SetWorld;
pub use plumbline_vision::detect as detector;
pub use plumbline_vision::detect_score as scores;
pub use plumbline_vision::yolo_set::Split;
pub use predict::{ImagePoints, PredictArgs, PredictReport, PredictedRow, PredictedTip, TableGap, predict};
pub use rig::{RigCheckReport, RigExportArgs, RigExportReport, RigFormat, rig_check, rig_export};
pub use sample::{SampleArgs, SampleReport, write_sample};
pub use train::{TrainArgs, TrainReport, train};

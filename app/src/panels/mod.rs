//! What the tiles show. A panel draws a snapshot and says what the operator asked for; it keeps
//! nothing but how it is looked at.

pub mod arrows;
mod blend;
mod board;
mod board_draft;
mod commission;
mod comparison;
mod context;
mod copied;
mod coverage;
mod depth;
mod drift;
mod error_bars;
mod eye;
mod figures;
mod files;
mod gap;
mod gates;
mod grasp;
mod handeye;
mod health;
mod labels;
mod models;
mod mount;
mod objects;
mod pairs;
mod parts;
mod picture;
mod probe;
mod probe_state;
mod rectified;
mod residuals;
pub(crate) mod rest;
mod robot;
mod scores;
mod source_state;
mod start;
mod table;
mod timeline;
mod touch;
mod twin;
mod verdict_line;

pub(crate) use commission::show_inspector as show_commission_inspector;
pub use context::{PanelContext, PanelState};
pub(crate) use context::{padded, shown_calibration, shown_calibration_ref};
pub(crate) use copied::table_of;
pub(crate) use drift::show_inspector as show_drift_inspector;
pub(crate) use gap::show_inspector as show_gap_inspector;
pub(crate) use gates::show as show_gates;
pub(crate) use grasp::parts::{ghost as grasp_ghost, palm_way};
pub(crate) use grasp::show_inspector as show_grasp_inspector;
pub(crate) use grasp::things::{mark as mark_things, point as point_at_thing};
pub(crate) use handeye::show_inspector as show_handeye_inspector;
pub(crate) use labels::show_inspector as show_labels_inspector;
pub(crate) use models::show_inspector as show_models_inspector;
pub(crate) use objects::show_inspector as show_objects_inspector;
pub(crate) use picture::key as picture_key;
pub use probe::probe_readout;
pub(crate) use residuals::chosen_fit;
pub(crate) use robot::show_inspector as show_robot_inspector;
pub(crate) use scores::show_inspector as show_scores_inspector;
pub(crate) use source_state::source_age;
pub(crate) use start::show as show_start;
pub(crate) use timeline::show_inspector as show_timeline_inspector;
pub(crate) use touch::parts::{ghost as touch_ghost, next_touch};
pub(crate) use touch::show_inspector as show_touch_inspector;

use egui::Ui;
use plumbline_model::Eye;

use crate::operator::Pane;

/// Draws one panel into the available space.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    match pane {
        Pane::CommissionSteps => commission::show_steps(ui, cx),
        Pane::LeftEye => eye::show(ui, cx, Eye::Left),
        Pane::RightEye => eye::show(ui, cx, Eye::Right),
        Pane::Rectified => rectified::show(ui, cx),
        Pane::Anaglyph => blend::anaglyph(ui, cx),
        Pane::Blink => blend::blink(ui, cx),
        Pane::Disparity => depth::disparity(ui, cx),
        Pane::Depth => depth::depth(ui, cx),
        Pane::Board => board::show(ui, cx),
        Pane::Coverage => coverage::show(ui, cx),
        Pane::Pairs => pairs::show(ui, cx),
        Pane::PairErrors => error_bars::show(ui, cx),
        Pane::Residuals => residuals::show(ui, cx),
        Pane::Figures => figures::show(ui, cx),
        Pane::Uncertainty => table::uncertainty(ui, cx),
        Pane::Difference => table::difference(ui, cx),
        Pane::Comparison => comparison::show(ui, cx),
        Pane::Files => files::show(ui, cx),
        Pane::Scene => robot::show_scene(ui, cx),
        Pane::Joints => robot::show_joints(ui, cx),
        Pane::Jog => robot::show_jog(ui, cx),
        Pane::Poses => robot::show_poses(ui, cx),
        Pane::Twin => twin::show(ui, cx),
        Pane::HeadViews => mount::show_views(ui, cx),
        Pane::EyeMount => mount::show_result(ui, cx),
        Pane::TouchPlan => touch::show_plan(ui, cx),
        Pane::TouchMap => touch::show_map(ui, cx),
        Pane::TouchRun => touch::show_run(ui, cx),
        Pane::ScreenPlace => touch::show_place(ui, cx),
        Pane::ModelTraining | Pane::ModelComparison | Pane::ModelMap | Pane::GraspTables => {
            models::show(ui, pane, cx);
        }
        Pane::GapCompare
        | Pane::GapNames
        | Pane::GapCandidates
        | Pane::GapMap
        | Pane::GapShown
        | Pane::GapNext
        | Pane::GapHistory => gap::show(ui, pane, cx),
        Pane::HandEyeParts => handeye::show_parts(ui, cx),
        Pane::HandEyeMap => handeye::show_map(ui, cx),
        Pane::GraspRun => grasp::show_run(ui, cx),
        Pane::GraspAttempts => grasp::show_attempts(ui, cx),
        Pane::GraspExperiment => grasp::show_experiment(ui, cx),
        Pane::DriftCourse => drift::show_course(ui, cx),
        Pane::DriftTable => drift::show_table(ui, cx),
        Pane::DriftGrid => drift::show_grid(ui, cx),
        Pane::TimelineLine => timeline::show_line(ui, cx),
        Pane::TimelineInUse => timeline::show_in_use(ui, cx),
        Pane::TimelineCompared => timeline::show_compared(ui, cx),
        Pane::ScoreChoice
        | Pane::ScoreTable
        | Pane::ScoreClasses
        | Pane::ScoreConfusion
        | Pane::ScoreCell => scores::show(ui, pane, cx),
        Pane::LabelList | Pane::LabelCanvas | Pane::LabelGallery | Pane::LabelChecks => {
            labels::show(ui, pane, cx);
        }
    }
}

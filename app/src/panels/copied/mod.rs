//! What stands in the tiles, as a table: one row per thing, numbers as they are known, units in the
//! headings. What is not known is left empty.
//!
//! Every tile is asked here, so a new one has to say what its rows are, or that it has none.

mod eyes;
mod findings;
mod judged;
mod learned;
mod moved;
mod wandered;

use plumbline_engine::View;

use super::context::shown_calibration_ref;
use super::residuals;
use crate::operator::{Pane, Table};

use crate::panels::PanelState;

/// The table of a tile; `None`: it has none, or it is empty.
pub fn table_of(pane: Pane, view: &View, state: &PanelState) -> Option<Table> {
    let table = match pane {
        // Pictures, and what is only set.
        Pane::LeftEye
        | Pane::RightEye
        | Pane::Rectified
        | Pane::Anaglyph
        | Pane::Blink
        | Pane::Disparity
        | Pane::Depth
        | Pane::Board
        | Pane::Scene
        | Pane::Jog
        | Pane::Poses
        | Pane::Twin
        | Pane::GraspRun
        | Pane::ScoreChoice
        | Pane::ScoreCell
        | Pane::LabelCanvas => return None,
        Pane::CommissionSteps => judged::commission(view),
        Pane::Coverage => eyes::coverage(state),
        Pane::Pairs => eyes::pairs(&view.eyes),
        Pane::PairErrors => eyes::pair_errors(shown_calibration_ref(&view.eyes)?, &view.eyes),
        Pane::Residuals => eyes::corners(residuals::chosen_fit(view, state.chosen_pair.as_deref())?),
        Pane::Figures | Pane::Comparison => eyes::figures(&view.eyes),
        Pane::Uncertainty => eyes::map(eyes::uncertainty(&view.eyes)?, "sd_mm"),
        Pane::Difference => eyes::map(view.eyes.proposal.as_ref()?.difference.as_ref()?, "difference_mm"),
        Pane::Files => eyes::earlier(&view.eyes),
        Pane::Joints => moved::joints(view),
        Pane::HeadViews => moved::head_views(view),
        Pane::EyeMount => moved::mount(view),
        Pane::TouchPlan | Pane::TouchMap | Pane::TouchRun => moved::touches(view),
        Pane::ScreenPlace => moved::screen(view),
        Pane::GraspAttempts => moved::attempts(view),
        Pane::GraspExperiment => moved::experiment(view),
        Pane::HandEyeParts | Pane::HandEyeMap => moved::hands(view),
        Pane::ModelTraining => learned::losses(view),
        Pane::ModelComparison => learned::compared(view),
        Pane::ModelMap => learned::map(view),
        Pane::GraspTables => learned::grasp_tables(view),
        Pane::GapCompare => findings::compared(view),
        Pane::GapNames => findings::named(view),
        Pane::GapCandidates => findings::candidates(view),
        Pane::GapMap => findings::residuals(view),
        Pane::GapShown => findings::shown(view),
        Pane::GapNext => findings::next(view),
        Pane::GapHistory => findings::history(view),
        Pane::DriftCourse => wandered::course(view),
        Pane::DriftTable => wandered::table(view),
        Pane::DriftGrid => wandered::grid(view),
        Pane::TimelineLine => wandered::timeline(view, None),
        Pane::TimelineInUse => wandered::in_use(view),
        Pane::TimelineCompared => wandered::timeline(view, Some(&state.timeline.chosen)),
        Pane::ScoreTable | Pane::ScoreClasses => judged::scores(view),
        Pane::ScoreConfusion => judged::confusion(view, state),
        Pane::LabelList | Pane::LabelGallery => judged::images(view),
        Pane::LabelChecks => judged::problems(view),
    };
    (!table.rows.is_empty()).then_some(table)
}

fn number(value: Option<f64>, factor: f64, digits: usize) -> String {
    value
        .filter(|value| value.is_finite())
        .map_or_else(String::new, |value| format!("{:.digits$}", factor * value))
}

fn degrees(value_rad: Option<f64>) -> String {
    number(value_rad.map(f64::to_degrees), 1.0, 3)
}

fn mm(value_m: Option<f64>) -> String {
    number(value_m, 1e3, 3)
}

fn meters(value_m: f64) -> String {
    number(Some(value_m), 1.0, 4)
}

fn pixels(value_px: Option<f64>) -> String {
    number(value_px, 1.0, 4)
}

#[cfg(test)]
mod tests;

//! What the tiles show. A panel draws a snapshot and says what the operator asked for; it keeps
//! nothing but how it is looked at.

pub mod arrows;
mod blend;
mod board;
mod comparison;
mod coverage;
mod depth;
mod error_bars;
mod eye;
mod figures;
mod files;
mod gap;
mod labels;
mod models;
mod mount;
mod objects;
mod pairs;
mod parts;
mod picture;
mod probe;
mod rectified;
mod residuals;
mod robot;
mod scores;
mod source_state;
mod start;
mod table;
mod touch;
mod twin;
mod verdict_line;

pub use board::BoardDraft;
pub use gap::GapPanels;
pub(crate) use gap::show_inspector as show_gap_inspector;
pub use labels::LabelsPanels;
pub(crate) use labels::show_inspector as show_labels_inspector;
pub use models::ModelsPanels;
pub(crate) use models::show_inspector as show_models_inspector;
pub use objects::ObjectsPanels;
pub(crate) use objects::show_inspector as show_objects_inspector;
pub(crate) use picture::key as picture_key;
pub use probe::{ProbeState, probe_readout};
pub(crate) use residuals::chosen_fit;
pub use robot::RobotPanels;
pub(crate) use robot::show_inspector as show_robot_inspector;
pub use scores::ScoresPanels;
pub(crate) use scores::show_inspector as show_scores_inspector;
pub(crate) use source_state::source_age;
pub(crate) use start::show as show_start;
pub use touch::TouchPanels;
pub(crate) use touch::show_inspector as show_touch_inspector;
pub(crate) use touch::{ghost as touch_ghost, next_touch};
pub use twin::TwinPanels;

use std::sync::Arc;

use egui::Ui;
use plumbline_engine::view::EyesView;
use plumbline_engine::{Exported, View};
use plumbline_model::{Eye, StereoCalibration};
use plumbline_widgets::colormap::Colormap;
use plumbline_widgets::image_view::ViewState;
use plumbline_widgets::seen::Seen;
use plumbline_widgets::texture::TextureCache;

use crate::operator::{Outbox, Pane, Screen};

/// How the panels are looked at: kept from frame to frame, never saved.
pub struct PanelState {
    /// Pictures by name.
    pub textures: TextureCache,
    /// Zoom of the raw eyes.
    pub raw: [ViewState; 2],
    /// Zoom of everything that shows the rectified pair, so that all of it moves together.
    pub rectified: ViewState,
    /// Zoom of the chosen pair's images.
    pub chosen: [ViewState; 2],
    /// The measured point.
    pub probe: ProbeState,
    /// What the detector sees.
    pub objects: ObjectsPanels,
    /// How the live views are drawn.
    pub live: LiveStyle,
    /// The pair chosen in a list or by a bar.
    pub chosen_pair: Option<String>,
    /// The pair and its fit that the residuals were last fitted to.
    pub residuals_of: Option<String>,
    /// The eye chosen with it.
    pub chosen_eye: Option<Eye>,
    /// The board as it is being typed.
    pub board: Option<BoardDraft>,
    /// Where the board has been.
    pub coverage: coverage::CountedCoverage,
    /// The proposal that was shown last.
    pub proposal_seen: Seen<StereoCalibration>,
    /// Which calibration is exported while there are two.
    pub exported: Exported,
    /// The robot.
    pub robot: RobotPanels,
    /// The twin.
    pub twin: TwinPanels,
    /// Touching the screen.
    pub touch: TouchPanels,
    /// Correction models.
    pub models: ModelsPanels,
    /// The gap between model and measurement.
    pub gap: GapPanels,
    /// The lab's own data sets.
    pub labels: LabelsPanels,
    /// Judging detectors.
    pub scores: ScoresPanels,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            textures: TextureCache::default(),
            raw: Default::default(),
            rectified: ViewState::default(),
            chosen: Default::default(),
            probe: ProbeState::default(),
            objects: ObjectsPanels::default(),
            live: LiveStyle::default(),
            chosen_pair: None,
            residuals_of: None,
            chosen_eye: None,
            board: None,
            coverage: Default::default(),
            proposal_seen: Seen::default(),
            exported: Exported::InUse,
            robot: RobotPanels::default(),
            twin: TwinPanels::default(),
            touch: TouchPanels::default(),
            models: ModelsPanels::default(),
            gap: GapPanels::default(),
            labels: LabelsPanels::default(),
            scores: ScoresPanels::default(),
        }
    }
}

/// The calibration that is judged: the proposal, else the one in use.
pub(crate) fn shown_calibration(eyes: &EyesView) -> Option<Arc<StereoCalibration>> {
    let proposed = eyes.proposal.as_ref().map(|proposal| &proposal.calibration);
    proposed.or(eyes.in_use.as_ref().map(|in_use| &in_use.calibration)).cloned()
}

fn shown_calibration_ref(eyes: &EyesView) -> Option<&StereoCalibration> {
    let proposed = eyes.proposal.as_ref().map(|proposal| &*proposal.calibration);
    proposed.or(eyes.in_use.as_ref().map(|in_use| &*in_use.calibration))
}

/// How the live views are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveStyle {
    /// Lines across the rectified pair.
    pub epipolar_lines: bool,
    /// Colors of disparity and depth.
    pub colormap: Colormap,
    /// Depths at the ends of the colors, meters; `None` fits them to the next picture.
    pub depth_range_m: Option<[f32; 2]>,
}

impl Default for LiveStyle {
    fn default() -> Self {
        Self { epipolar_lines: true, colormap: Colormap::default(), depth_range_m: Some([0.2, 1.0]) }
    }
}

/// What a panel has at hand.
pub struct PanelContext<'a> {
    /// The snapshot to draw.
    pub view: &'a View,
    /// The screen that the panel stands on.
    pub screen: Screen,
    /// How it is looked at.
    pub state: &'a mut PanelState,
    /// What the operator asks for.
    pub outbox: &'a mut Outbox,
}

/// Room around the content of a panel that is not a picture; its left edge is that of the
/// tile's title.
fn padded<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let margin = egui::Margin { left: 12, right: 12, top: 4, bottom: 8 };
    egui::Frame::new().inner_margin(margin).show(ui, contents).inner
}

/// Draws one panel into the available space.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    match pane {
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

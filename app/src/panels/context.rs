//! What every panel has at hand, and how all of them are looked at.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::Ui;
use plumbline_engine::view::{CollectedPair, EyesView};
use plumbline_engine::{Exported, View};
use plumbline_model::{Eye, StereoCalibration};
use plumbline_widgets::Memo;
use plumbline_widgets::colormap::Colormap;
use plumbline_widgets::coverage::Coverage;
use plumbline_widgets::image_view::ViewState;
use plumbline_widgets::seen::Seen;
use plumbline_widgets::texture::TextureCache;

use super::board_draft::BoardDraft;
use super::probe_state::ProbeState;
use super::{
    gap::state::GapPanels, grasp::state::GraspPanels, handeye::HandEyePanels, labels::state::LabelsPanels,
    models::state::ModelsPanels, objects::state::ObjectsPanels, robot::state::RobotPanels,
    scores::state::ScoresPanels, timeline::state::TimelinePanels, touch::state::TouchPanels,
    twin::state::TwinPanels,
};
use crate::operator::{Outbox, Pane, Screen};

/// How the panels are looked at: kept from frame to frame, never saved.
pub struct PanelState {
    /// Pictures by name.
    pub textures: TextureCache,
    /// Zoom of the pictures, each by itself; the two of a rectified pair move together.
    pub views: BTreeMap<(Screen, Pane), ViewState>,
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
    pub coverage: Memo<Seen<[Arc<CollectedPair>]>, Option<Coverage>>,
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
    /// Tying the arms to the eyes.
    pub handeye: HandEyePanels,
    /// Grasping.
    pub grasp: GraspPanels,
    /// The thing of the 9 by 4 evaluation, where one was chosen.
    pub grid_object: Option<String>,
    /// The lab's own data sets.
    pub labels: LabelsPanels,
    /// Judging detectors.
    pub scores: ScoresPanels,
    /// The timeline of results.
    pub timeline: TimelinePanels,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            textures: TextureCache::default(),
            views: BTreeMap::new(),
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
            handeye: HandEyePanels::default(),
            grasp: GraspPanels::default(),
            grid_object: None,
            labels: LabelsPanels::default(),
            scores: ScoresPanels::default(),
            timeline: TimelinePanels::default(),
        }
    }
}

/// The calibration that is judged: the proposal, else the one in use.
pub(crate) fn shown_calibration(eyes: &EyesView) -> Option<Arc<StereoCalibration>> {
    let proposed = eyes.proposal.as_ref().map(|proposal| &proposal.calibration);
    proposed.or(eyes.in_use.as_ref().map(|in_use| &in_use.calibration)).cloned()
}

pub(crate) fn shown_calibration_ref(eyes: &EyesView) -> Option<&StereoCalibration> {
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
pub(crate) fn padded<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let margin = egui::Margin { left: 12, right: 12, top: 4, bottom: 8 };
    egui::Frame::new().inner_margin(margin).show(ui, contents).inner
}

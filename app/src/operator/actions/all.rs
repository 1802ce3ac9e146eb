//! All that can be asked for by name, in the order of the palette.

use plumbline_engine::{ExportFormat, Exported, WatchedThread};

use super::{
    Action, CommissionAction, DetectAction, GapAction, GraspAction, GridAction, HandEyeAction, LabelsAction,
    ModelsAction, MountAction, RobotAction, ScoresAction, TimelineAction, TouchAction, TrialsAction,
};
use crate::operator::screens::Screen;

/// All actions with a place in the palette, in its order.
pub fn all() -> impl Iterator<Item = Action> {
    let robot = RobotAction::ALL.into_iter().map(Action::Robot);
    let mount = MountAction::ALL.into_iter().map(Action::Mount);
    let touch = TouchAction::ALL.into_iter().map(Action::Touch);
    let models = ModelsAction::ALL.into_iter().map(Action::Models);
    let gap = GapAction::ALL.into_iter().map(Action::Gap);
    let grasp = GraspAction::ALL.into_iter().map(Action::Grasp);
    let handeye = HandEyeAction::ALL.into_iter().map(Action::HandEye);
    let trials = TrialsAction::ALL.into_iter().map(Action::Trials);
    let commission = CommissionAction::ALL.into_iter().map(Action::Commission);
    let timeline = TimelineAction::ALL.into_iter().map(Action::Timeline);
    let detect = DetectAction::ALL.into_iter().map(Action::Detect);
    let labels = LabelsAction::ALL.into_iter().map(Action::Labels);
    let scores = ScoresAction::ALL.into_iter().map(Action::Scores);
    let grid = GridAction::ALL.into_iter().map(Action::Grid);
    let steps = robot
        .chain(mount)
        .chain(touch)
        .chain(models)
        .chain(gap)
        .chain(handeye)
        .chain(grasp)
        .chain(trials)
        .chain(grid);
    let threads = WatchedThread::ALL.into_iter().map(Action::StartAgain);
    ALL.iter()
        .copied()
        .chain(commission)
        .chain(detect)
        .chain(steps)
        .chain(labels)
        .chain(timeline)
        .chain(scores)
        .chain(threads)
}

const ALL: &[Action] = &[
    Action::Next,
    Action::Stop,
    Action::OpenFolder,
    Action::OpenTwoFolders,
    Action::OpenVideos,
    Action::OpenCameras,
    Action::OpenPath,
    Action::CloseSource,
    Action::RetrySource,
    Action::PlayPause,
    Action::StepForward,
    Action::StepBack,
    Action::ToggleLoop,
    Action::ToggleRecording,
    Action::PlayLastRecording,
    Action::ExportRecording,
    Action::WatchDrift,
    Action::ExplainDrift,
    Action::ToggleTruth,
    Action::Go(Screen::Commission),
    Action::Go(Screen::Live),
    Action::Go(Screen::Collect),
    Action::Go(Screen::Judge),
    Action::Go(Screen::Accept),
    Action::Go(Screen::Mount),
    Action::Go(Screen::Touch),
    Action::Go(Screen::Models),
    Action::Go(Screen::Gap),
    Action::Go(Screen::HandEye),
    Action::Go(Screen::Grasp),
    Action::Go(Screen::Drift),
    Action::Go(Screen::Timeline),
    Action::Go(Screen::Robot),
    Action::Go(Screen::Images),
    Action::Go(Screen::Scores),
    Action::RecognizeBoard,
    Action::UseSeenBoard,
    Action::Capture,
    Action::ToggleAutoCapture,
    Action::CollectRecording,
    Action::DeleteLast,
    Action::DeleteAll,
    Action::Undo,
    Action::Solve,
    Action::JudgeHealth,
    Action::Accept,
    Action::Discard,
    Action::Import,
    Action::Export(Exported::InUse, ExportFormat::Plumbline),
    Action::Export(Exported::InUse, ExportFormat::RosCameraInfo),
    Action::Export(Exported::InUse, ExportFormat::OpenCv),
    Action::Export(Exported::InUse, ExportFormat::Kalibr),
    Action::Export(Exported::InUse, ExportFormat::MrcalCorners),
    Action::CancelJob,
    Action::SaveWindow,
    Action::Palette,
    Action::Help,
    Action::About,
    Action::ToggleInspector,
    Action::ToggleLog,
    Action::ToggleNotices,
    Action::ToggleTheme,
    Action::ResetArrangement,
    Action::ResetAllArrangements,
    Action::ToggleFrameTimes,
    Action::Quit,
];

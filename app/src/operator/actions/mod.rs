//! Everything that can be asked for by name: by a button, a shortcut or the command palette.

mod commission;
mod detect;
mod gap;
mod grasp;
mod grid;
mod handeye;
mod labels;
mod models;
mod robot;
pub mod timeline;
mod touch;
mod trials;
pub mod undo;

pub use commission::{CommissionAction, FIRST_CLASS, FIRST_PLACE_M};
pub use detect::DetectAction;
pub use gap::{GapAction, plan as gap_plan, proof as gap_proof};
pub use grasp::GraspAction;
pub use grid::{GridAction, USUAL_THING};
pub use handeye::HandEyeAction;
pub use labels::{LabelsAction, ScoresAction};
pub use models::ModelsAction;
pub use robot::{MountAction, RobotAction, default_scenario};
pub use timeline::TimelineAction;
pub use touch::{Preset, TouchAction, is_under_way, needs_window, screen_of, usual_area};
pub use trials::TrialsAction;

use std::borrow::Cow;

use plumbline_engine::view::{HealthState, RecordingState, SourceStatus};
use plumbline_engine::{ExportFormat, Exported, View, WatchedThread};
use serde::Serialize;
use serde_json::Value;

use super::screens::Screen;
use crate::operator::snapshot::models::Method;

/// One thing that the operator can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// Stops everything that runs.
    Stop,
    /// Does what the bottom line proposes.
    Next,
    /// Chooses a folder of pairs (or one with `left` and `right` in it).
    OpenFolder,
    /// Chooses two folders, left eye first.
    OpenTwoFolders,
    /// Chooses two video files, left eye first.
    OpenVideos,
    /// Chooses two USB cameras.
    OpenCameras,
    /// Types a path.
    OpenPath,
    /// Forgets the source.
    CloseSource,
    /// Tries a lost source again at once.
    RetrySource,
    /// Plays or holds a recording.
    PlayPause,
    /// One pair forward.
    StepForward,
    /// One pair back.
    StepBack,
    /// Starts over at the end, or not.
    ToggleLoop,
    /// Records what works live, or stops that.
    ToggleRecording,
    /// Plays the recording that was made last.
    PlayLastRecording,
    /// Watches whether places stay where they are, or stops that.
    WatchDrift,
    /// Names what makes the watched places wander.
    ExplainDrift,
    /// Shows the twin's truth beside what is measured, or stops that.
    ToggleTruth,
    /// Opens a screen.
    Go(Screen),
    /// Says which board the newest pair shows.
    RecognizeBoard,
    /// Takes the board that was recognized.
    UseSeenBoard,
    /// Adds the newest pair.
    Capture,
    /// Captures without asking, or stops that.
    ToggleAutoCapture,
    /// Collects every pair of the recording.
    CollectRecording,
    /// Removes the pair added last.
    DeleteLast,
    /// Removes all pairs.
    DeleteAll,
    /// Takes back what was changed last on the screen that is open.
    Undo,
    /// Solves what is collected.
    Solve,
    /// Judges the calibration in use, and a proposed one, by what the eyes see.
    JudgeHealth,
    /// Puts the proposal in use.
    Accept,
    /// Forgets the proposal.
    Discard,
    /// Reads a calibration file.
    Import,
    /// Writes a calibration file.
    Export(Exported, ExportFormat),
    /// Something of the robot or its twin.
    Robot(RobotAction),
    /// Something of the mount of the eyes.
    Mount(MountAction),
    /// Something of touching the screen.
    Touch(TouchAction),
    /// Something of correction models.
    Models(ModelsAction),
    /// Of the gap between model and measurement.
    Gap(GapAction),
    /// Of grasping.
    Grasp(GraspAction),
    /// Of tying the arms to the eyes.
    HandEye(HandEyeAction),
    /// Of the experiment with grasps.
    Trials(TrialsAction),
    /// Of the 9 by 4 evaluation.
    Grid(GridAction),
    /// Of commissioning.
    Commission(CommissionAction),
    /// Of the timeline of results.
    Timeline(TimelineAction),
    /// Of the lab's own data sets.
    Labels(LabelsAction),
    /// Of judging detectors.
    Scores(ScoresAction),
    /// Of detecting objects, live.
    Detect(DetectAction),
    /// Asks the running job to stop.
    CancelJob,
    /// Starts a part of the program that has failed inside again.
    StartAgain(WatchedThread),
    /// Saves a picture of the window.
    SaveWindow,
    /// Opens the list of everything that can be done.
    Palette,
    /// The manual at this screen.
    Help,
    /// Which version this is.
    About,
    /// Opens or closes the inspector.
    ToggleInspector,
    /// Opens or closes the log.
    ToggleLog,
    /// Opens or closes the history of messages.
    ToggleNotices,
    /// Dark or light.
    ToggleTheme,
    /// Puts the tiles of this screen back.
    ResetArrangement,
    /// Puts the tiles of all screens back.
    ResetAllArrangements,
    /// Shows how long frames take.
    ToggleFrameTimes,
    /// Closes the window.
    Quit,
}

macro_rules! into_action {
    ($($workflow:ident: $type:ty),*) => {
        $(impl From<$type> for Action {
            fn from(action: $type) -> Self {
                Self::$workflow(action)
            }
        })*
    };
}
into_action!(
    Robot: RobotAction, Mount: MountAction, Touch: TouchAction, Models: ModelsAction, Gap: GapAction,
    Grasp: GraspAction, HandEye: HandEyeAction, Trials: TrialsAction, Grid: GridAction, Commission: CommissionAction,
    Timeline: TimelineAction, Labels: LabelsAction, Scores: ScoresAction, Detect: DetectAction
);

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

impl Action {
    /// What scripts call it, by the parts that it is serialized of: `touch-plan-corners`.
    pub fn name(self) -> String {
        let parts = serde_json::to_value(self).map(|value| parts(&value)).unwrap_or_default();
        parts.join("-")
    }

    /// All that have a name in scripts: what has a place in the palette, and the three models.
    pub fn named() -> impl Iterator<Item = Self> {
        let models = Method::ALL.into_iter().flat_map(|m| [ModelsAction::Accept(m), ModelsAction::Show(m)]);
        all().chain(models.map(Self::Models))
    }

    /// What it is called everywhere.
    pub fn label(self) -> String {
        match self {
            Self::Stop => "Stop everything",
            Self::Next => "Do what comes next",
            Self::OpenFolder => "Open a folder of pairs…",
            Self::OpenTwoFolders => "Open two folders…",
            Self::OpenVideos => "Open two videos…",
            Self::OpenCameras => "Use USB cameras…",
            Self::OpenPath => "Open a typed path…",
            Self::CloseSource => "Close the source",
            Self::RetrySource => "Try the source again",
            Self::PlayPause => "Play or pause",
            Self::StepForward => "One pair forward",
            Self::StepBack => "One pair back",
            Self::ToggleLoop => "Loop the recording",
            Self::Go(Screen::Commission) => "Go to Commission",
            Self::Go(Screen::Live) => "Go to Live",
            Self::Go(Screen::Collect) => "Go to Eyes: collect",
            Self::Go(Screen::Judge) => "Go to Eyes: judge",
            Self::Go(Screen::Accept) => "Go to Eyes: accept",
            Self::Go(Screen::Mount) => "Go to Mount",
            Self::Go(Screen::Touch) => "Go to Touch",
            Self::Go(Screen::Models) => "Go to Models",
            Self::Go(Screen::Gap) => "Go to Gap",
            Self::Go(Screen::HandEye) => "Go to Hand-eye",
            Self::Go(Screen::Grasp) => "Go to Grasp",
            Self::Go(Screen::Drift) => "Go to Drift",
            Self::Go(Screen::Timeline) => "Go to Timeline",
            Self::Go(Screen::Robot) => "Go to Robot",
            Self::Go(Screen::Images) => "Go to Detect: images",
            Self::Go(Screen::Scores) => "Go to Detect: scores",
            Self::Robot(action) => action.label(),
            Self::Mount(action) => action.label(),
            Self::Touch(action) => action.label(),
            Self::Models(action) => action.label(),
            Self::Gap(action) => action.label(),
            Self::Grasp(action) => action.label(),
            Self::HandEye(action) => action.label(),
            Self::Trials(action) => action.label(),
            Self::Grid(action) => action.label(),
            Self::Commission(action) => action.label(),
            Self::Timeline(action) => action.label(),
            Self::Labels(action) => action.label(),
            Self::Scores(action) => action.label(),
            Self::Detect(action) => action.label(),
            Self::ToggleRecording => "Record, or stop recording",
            Self::PlayLastRecording => "Play the last recording",
            Self::WatchDrift => "Watch drift, or stop watching",
            Self::ExplainDrift => "Explain what was watched",
            Self::ToggleTruth => "Show the twin's truth, or hide it",
            Self::RecognizeBoard => "Recognize the board",
            Self::UseSeenBoard => "Use the recognized board",
            Self::Capture => "Capture pair",
            Self::ToggleAutoCapture => "Capture by itself",
            Self::CollectRecording => "Use all pairs of the folder or recording",
            Self::DeleteLast => "Delete the last pair",
            Self::DeleteAll => "Delete all pairs",
            Self::Undo => "Undo",
            Self::Solve => "Solve the collected pairs",
            Self::JudgeHealth => "Is the calibration still good?",
            Self::Accept => "Accept calibration",
            Self::Discard => "Discard the proposal",
            Self::Import => "Import a calibration…",
            Self::StartAgain(thread) => return Self::start_again_label(thread),
            Self::Export(_, format) => return format!("Export as {}…", format_name(format)),
            Self::CancelJob => "Cancel the running job",
            Self::SaveWindow => "Save a picture of the window…",
            Self::Palette => "All commands",
            Self::Help => "Help: the manual at this screen",
            Self::About => "About Plumbline",
            Self::ToggleInspector => "Inspector",
            Self::ToggleLog => "Log",
            Self::ToggleNotices => "Messages",
            Self::ToggleTheme => "Change between dark and light",
            Self::ResetArrangement => "Reset the tiles of this screen",
            Self::ResetAllArrangements => "Reset the tiles of all screens",
            Self::ToggleFrameTimes => "Frame times",
            Self::Quit => "Quit",
        }
        .to_owned()
    }

    /// Whether it puts a proposal in use.
    pub fn puts_in_use(self) -> bool {
        matches!(
            self,
            Self::Accept
                | Self::Mount(MountAction::Accept)
                | Self::Touch(TouchAction::AcceptScreen)
                | Self::Models(ModelsAction::AcceptShown | ModelsAction::Accept(_))
                | Self::Gap(GapAction::Add)
                | Self::HandEye(HandEyeAction::Accept)
                | Self::Labels(LabelsAction::AcceptProposals | LabelsAction::AcceptImport)
        )
    }

    /// Why it cannot be done now; `None` when it can.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let eyes = &view.eyes;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::CloseSource => when(view.source.status != SourceStatus::None, "no source is open"),
            Self::RetrySource => {
                when(matches!(view.source.status, SourceStatus::Lost { .. }), "no source is lost")
            }
            Self::PlayPause | Self::StepForward | Self::StepBack | Self::ToggleLoop => {
                when(view.source.replay.is_some(), "no recording is open")
            }
            Self::RecognizeBoard | Self::Capture => when(view.live.raw.is_some(), "there is no image yet"),
            Self::UseSeenBoard => when(
                eyes.board_seen.as_ref().is_some_and(|s| s.inner_corners.is_some()),
                "no board was recognized",
            ),
            Self::ToggleRecording if view.recording.is_on() => match view.recording.state {
                RecordingState::On { .. } => None,
                _ => Some("the file is being written".into()),
            },
            Self::ToggleRecording => when(
                view.source.replay.is_none() && view.source.status == SourceStatus::Running,
                "no eyes are live",
            ),
            Self::WatchDrift if view.drift.is_watching => None,
            Self::WatchDrift => when(
                view.source.status == SourceStatus::Running && !view.source.photographs,
                "no eyes are live",
            ),
            Self::ToggleTruth if view.truth.is_on => None,
            Self::ToggleTruth => when(
                view.twin.running && view.robot.connection.is_connected(),
                "no twin is connected: of a real robot nobody knows the truth",
            ),
            Self::PlayLastRecording => when(view.recording.last.is_some(), "nothing was recorded yet"),
            Self::CollectRecording => when(view.source.replay.is_some(), "no recording is open"),
            Self::ExplainDrift if view.gap.searching.is_some() => Some("the gap is being looked for".into()),
            Self::ExplainDrift => view.drift.unexplained.map(Cow::Borrowed),
            Self::DeleteLast | Self::DeleteAll => when(!eyes.collected.is_empty(), "no pair is collected"),
            Self::Solve if eyes.solving.is_some() => Some("a solution is being computed".into()),
            Self::Solve => when(!eyes.collected.is_empty(), "no pair is collected"),
            Self::JudgeHealth if eyes.health.state == HealthState::Judging => {
                Some("what both eyes see is being compared".into())
            }
            Self::JudgeHealth if eyes.in_use.is_none() => Some("no calibration is in use".into()),
            Self::JudgeHealth => when(view.source.status != SourceStatus::None, "no source is open"),
            Self::Accept if eyes.health.is_against_proposal() => {
                Some("by what the eyes see it is not better than the one in use".into())
            }
            Self::Accept | Self::Discard => when(eyes.proposal.is_some(), "nothing is proposed"),
            Self::Export(Exported::InUse, _) => when(eyes.in_use.is_some(), "no calibration is in use"),
            Self::Export(Exported::Proposal, _) => when(eyes.proposal.is_some(), "nothing is proposed"),
            Self::Robot(action) => action.refusal(view),
            Self::Mount(action) => action.refusal(view),
            Self::Touch(action) => action.refusal(view),
            Self::Models(action) => action.refusal(view),
            Self::Gap(action) => action.refusal(view),
            Self::Grasp(action) => action.refusal(view),
            Self::HandEye(action) => action.refusal(view),
            Self::Trials(action) => action.refusal(view),
            Self::Grid(action) => action.refusal(view),
            Self::Commission(action) => action.refusal(view),
            Self::Timeline(action) => action.refusal(view),
            Self::Labels(action) => action.refusal(view),
            Self::Scores(action) => action.refusal(view),
            Self::Detect(action) => action.refusal(view),
            Self::StartAgain(thread) => Self::start_again_refusal(thread, view).map(Cow::Borrowed),
            Self::CancelJob => when(view.running_job().is_some(), "no job is running"),
            _ => None,
        }
    }
}

/// Names and values, the outer ones first.
fn parts(value: &Value) -> Vec<String> {
    match value {
        Value::String(text) => vec![text.clone()],
        Value::Array(values) => values.iter().flat_map(parts).collect(),
        Value::Object(fields) => {
            fields.iter().flat_map(|(name, value)| [vec![name.clone()], parts(value)].concat()).collect()
        }
        other => vec![other.to_string()],
    }
}

/// What people call a file format.
pub fn format_name(format: ExportFormat) -> &'static str {
    match format {
        ExportFormat::Plumbline => "Plumbline file",
        ExportFormat::RosCameraInfo => "ROS camera_info",
        ExportFormat::OpenCv => "OpenCV FileStorage",
        ExportFormat::Kalibr => "Kalibr camchain",
        ExportFormat::MrcalCorners => "mrcal corners",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_name_of_its_own() {
        let mut names: Vec<String> = Action::named().map(Action::name).collect();
        for name in ["solve", "go-judge", "touch-plan-corners", "models-accept-m3", "export-in-use-kalibr"] {
            assert!(names.iter().any(|known| known == name), "{name}");
        }
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(names.iter().all(|name| !name.is_empty() && !name.contains(':')), "{names:?}");
    }

    #[test]
    fn without_anything_open_the_reasons_are_said() {
        let view = View::default();
        assert_eq!(Action::Solve.refusal(&view).as_deref(), Some("no pair is collected"));
        assert_eq!(Action::PlayPause.refusal(&view).as_deref(), Some("no recording is open"));
        let going = Action::Robot(RobotAction::Move).refusal(&view);
        assert_eq!(going.as_deref(), Some("no robot is connected"));
        assert_eq!(Action::Stop.refusal(&view), None, "stop can always be asked for");
    }
}

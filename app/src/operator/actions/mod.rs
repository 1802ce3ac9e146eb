//! Everything that can be asked for by name: by a button, a shortcut or the command palette.

mod all;
mod commission;
mod detect;
mod gap;
mod grasp;
mod grid;
mod handeye;
mod labels;
mod let_go;
mod models;
mod names;
mod refusal;
mod robot;
pub mod timeline;
mod touch;
mod trials;
pub mod undo;

pub use all::all;
pub use commission::{CommissionAction, FIRST_CLASS, FIRST_PLACE_M};
pub use detect::DetectAction;
pub use gap::{GapAction, plan as gap_plan, proof as gap_proof};
pub use grasp::GraspAction;
pub use grid::{GridAction, USUAL_THING};
pub use handeye::HandEyeAction;
pub use labels::{LabelsAction, ScoresAction};
pub(crate) use let_go::would_drop;
pub use models::{ModelsAction, too_few, too_few_for, training_refusal};
pub use names::format_name;
pub use robot::{MountAction, RobotAction, default_scenario, led_by};
pub use timeline::TimelineAction;
pub use touch::{Preset, TouchAction, full_hand, is_under_way, needs_window, screen_of, usual_area};
pub use trials::TrialsAction;

use plumbline_engine::{ExportFormat, Exported, WatchedThread};
use serde::Serialize;

use super::screens::Screen;

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
    /// Writes the recording that is open, else the last one, as a LeRobot data set (asks where to).
    ExportRecording,
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

//! What the operator can ask for: one enum per workflow, serializable, so that a journal of
//! commands is a replay.

mod detect;
mod gap;
mod labels;
mod robot;
mod scores;
mod touch;
mod watch;

use std::path::PathBuf;

use plumbline_hardware::SourceSpec;
use plumbline_model::{CalibrationOptions, Eye};
use serde::{Deserialize, Serialize};

pub use detect::{DetectCommand, DetectorChoice, Provider};
pub use gap::{GapCommand, GapModel};
pub use labels::{BoxEdit, LabelsCommand};
pub use robot::{Destination, JOG_DEADLINE_MS, JogRates, MountCommand, RobotCommand, TwinCommand};
pub use scores::{ConfusionCell, ScoresCommand, SetPart};
pub use touch::{
    ContactWith, Correction, GraspTable, ModelsCommand, ScreenContact, ScreenWindow, TablesCommand,
    TouchCommand,
};
pub use watch::WatchCommand;

/// Anything that the window (or a script) can ask of the engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "workflow", content = "command", rename_all = "kebab-case")]
pub enum Command {
    /// Where the images come from.
    Source(SourceCommand),
    /// What is computed from them, live.
    Live(LiveCommand),
    /// Detecting objects in those images, live.
    Detect(DetectCommand),
    /// Calibrating the eyes.
    Eyes(EyesCommand),
    /// The robot: connecting and moving it.
    Robot(RobotCommand),
    /// The twin's table, clock and faults.
    Twin(TwinCommand),
    /// Calibrating how the eyes sit in the head.
    Mount(MountCommand),
    /// Touching the screen.
    Touch(TouchCommand),
    /// Correction models, and the tables of grasp height and yaw.
    Models(ModelsCommand),
    /// Finding, naming and adding what makes measurement differ from the model.
    Gap(GapCommand),
    /// The lab's own data sets: images with boxes.
    Labels(LabelsCommand),
    /// Judging detectors.
    Scores(ScoresCommand),
    /// Long work that is running.
    Job(JobCommand),
    /// Messages to the operator.
    Notice(NoticeCommand),
    /// The program's own threads.
    Watch(WatchCommand),
}

/// Where the images come from and, for recordings, how they are played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceCommand {
    /// Opens a source in place of the present one.
    Open(SourceSpec),
    /// Opens what these paths mean: a folder of pairs, two folders, two videos, or image files.
    OpenPaths(Vec<PathBuf>),
    /// Stops delivering and forgets the source.
    Close,
    /// Tries a lost source again at once.
    Retry,
    /// Plays a recording.
    Play,
    /// Holds a recording (or a camera's picture) still.
    Pause,
    /// Moves by this many pairs and stays there; negative goes back.
    Step(i64),
    /// Shows the pair with this index (0 is the first).
    Seek(u64),
    /// Starts over at the end.
    Loop(bool),
    /// Pairs per second at which a recording is played.
    PairsPerSecond(f64),
    /// Looks which cameras this machine has, see [`crate::view::SourceView::cameras`].
    ListCameras,
}

/// What is computed live.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LiveCommand {
    /// Which products are looked at; nothing else is computed.
    Want(Products),
    /// Measures the point under the mouse on every new pair, until [`LiveCommand::StopProbe`].
    Probe(ProbePoint),
    /// Measures no point.
    StopProbe,
    /// How the virtual pair looks at the workspace.
    Aim(AimChoice),
    /// Where the head looks, which says where the eyes are in the robot's frame.
    Head(HeadPose),
}

/// Live products that somebody looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Products {
    /// The rectified pair.
    pub rectified: bool,
    /// Disparity (computes the rectified pair too).
    pub disparity: bool,
    /// Chessboard corners drawn over both eyes.
    pub corners: bool,
    /// Objects in both eyes.
    #[serde(default)]
    pub detections: bool,
}

/// A point of an image to be measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "image", rename_all = "kebab-case")]
pub enum ProbePoint {
    /// In the raw image of one eye.
    Raw {
        /// Which eye.
        eye: Eye,
        /// Column, pixels.
        u_px: f64,
        /// Row, pixels.
        v_px: f64,
    },
    /// In the rectified image of the left eye.
    Rectified {
        /// Column, pixels.
        u_px: f64,
        /// Row, pixels.
        v_px: f64,
    },
}

/// How the virtual pair is aimed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "aim", rename_all = "kebab-case")]
pub enum AimChoice {
    /// At the table in front of the robot, filling the view.
    #[default]
    Table,
    /// By hand.
    Manual {
        /// Rotation about the baseline; positive looks down, radians.
        pitch_rad: f64,
        /// Width of the field of view, radians.
        horizontal_field_of_view_rad: f64,
    },
}

/// Joint angles of the head.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadPose {
    /// `head_z`, positive looks to the left, radians.
    pub head_z_rad: f64,
    /// `head_y`, positive looks up, radians.
    pub head_y_rad: f64,
}

impl Default for HeadPose {
    /// As it works on the table.
    fn default() -> Self {
        let rig = crate::live::default_rig();
        let home = rig.home();
        Self { head_z_rad: home[rig.eyes.pan], head_y_rad: home[rig.eyes.tilt] }
    }
}

/// Calibrating the eyes, in the order of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EyesCommand {
    /// Says which board is used, counted in squares.
    ChooseBoard {
        /// Squares along a row.
        columns: u32,
        /// Squares along a column.
        rows: u32,
        /// Side of a square, meters.
        square_m: f64,
    },
    /// Looks at the newest pair and says which board it shows.
    RecognizeBoard,
    /// How to solve.
    ChooseOptions(CalibrationOptions),
    /// Minutes since the cameras were switched on, as the operator knows it.
    MinutesSinceOn(Option<f64>),
    /// Adds the newest pair.
    Capture,
    /// Captures by itself whenever the board is still, sharp, seen by both eyes and somewhere new.
    AutoCapture(bool),
    /// Collects every pair of the open recording in which the board is seen.
    CollectRecording,
    /// Removes the pair that was added last.
    DeleteLast,
    /// Removes one pair.
    Delete {
        /// Its name.
        pair: String,
    },
    /// Removes all pairs.
    DeleteAll,
    /// Takes back the last change of the collection.
    Undo,
    /// Solves the collected pairs; gives a proposal.
    Solve,
    /// Leaves a pair out of the next solution.
    DropPair {
        /// Its name.
        pair: String,
    },
    /// Takes a dropped pair back in.
    RestorePair {
        /// Its name.
        pair: String,
    },
    /// Makes the proposal the calibration in use.
    Accept,
    /// Forgets the proposal; the calibration in use stays.
    Discard,
    /// Reads a calibration file as a proposal.
    Import {
        /// One file, or one per eye (left first) for ROS camera_info.
        files: Vec<PathBuf>,
        /// Unit of lengths in files of other programs.
        #[serde(default)]
        length: FileLength,
    },
    /// Writes a calibration to a file.
    Export {
        /// Which one.
        what: Exported,
        /// In which format.
        format: ExportFormat,
        /// Where to. For ROS camera_info this is the left eye's file; the right eye's gets
        /// `_left` replaced by (or `_right` added to) its name.
        file: PathBuf,
    },
    /// Collects, in place of what is collected, the pairs that the proposal (or else the
    /// calibration in use) was solved from, to solve them again.
    CollectEvidence,
    /// Proposes a calibration that was accepted earlier.
    ProposeEarlier {
        /// Its id in [`crate::view::EyesView::earlier`].
        id: String,
    },
}

/// Unit of lengths in a calibration file of another program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileLength {
    /// Meters; refused when that puts the eyes implausibly far apart.
    #[default]
    AsPrescribed,
    /// Meters, however far apart that puts the eyes.
    Meters,
    /// Millimeters, as many OpenCV scripts use.
    Millimeters,
    /// Sides of the board's squares.
    Squares {
        /// Side of a square, meters.
        side_m: f64,
    },
}

/// Which calibration is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exported {
    /// The one in use.
    InUse,
    /// The one proposed.
    Proposal,
}

/// File formats that a calibration can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportFormat {
    /// The program's own, with its evidence.
    Plumbline,
    /// ROS camera_info, one file per eye.
    RosCameraInfo,
    /// OpenCV FileStorage.
    OpenCv,
    /// Kalibr camchain.
    Kalibr,
    /// Corners for mrcal (`.vnl`), not a calibration.
    MrcalCorners,
}

/// Long work that is running.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JobCommand {
    /// Asks a job to stop; what was there before stays.
    Cancel(JobId),
    /// Takes a job that has ended out of the list.
    Dismiss(JobId),
}

/// Number of a job, unique while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct JobId(pub u64);

/// Messages to the operator.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoticeCommand {
    /// Adds a message of the window itself (a screenshot was saved, …).
    Add {
        /// How much it matters.
        level: crate::notice::NoticeLevel,
        /// A sentence.
        text: String,
    },
    /// Empties the history.
    Clear,
}

macro_rules! into_command {
    ($($workflow:ident: $type:ty),*) => {
        $(impl From<$type> for Command {
            fn from(command: $type) -> Self {
                Self::$workflow(command)
            }
        })*
    };
}
into_command!(
    Source: SourceCommand, Live: LiveCommand, Detect: DetectCommand, Eyes: EyesCommand, Robot: RobotCommand, Twin: TwinCommand,
    Mount: MountCommand, Touch: TouchCommand, Models: ModelsCommand, Gap: GapCommand, Labels: LabelsCommand, Scores: ScoresCommand, Job: JobCommand, Notice: NoticeCommand,
    Watch: WatchCommand
);

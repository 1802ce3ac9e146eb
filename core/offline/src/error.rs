//! Why work on recorded data could not be done.

use std::path::{Path, PathBuf};

use plumbline_correction::{DataError, FileError, TrainError};
use plumbline_effects::{MeasurementsError, RigModelError};
use plumbline_gap::GapError;
use plumbline_hardware::{ImageProblem, SourceError};
use plumbline_model::predict::PredictError;
use plumbline_model::robot::ik::{IkError, SolverError};
use plumbline_model::robot::{DescriptionError, Limits, RigError};
use plumbline_model::{AimError, BoardError, Cancelled, FormatError, PlacementError, SessionError};
use plumbline_recording::RecordingError;
use plumbline_report::ReportError;
use plumbline_vision::calibrate::SolveError;
use plumbline_vision::detect::DetectError;
use plumbline_vision::detect_score::EvaluateError;
use plumbline_vision::disparity::DisparityError;
use plumbline_vision::health::HealthError;
use plumbline_vision::locate::NoBaseline;
use plumbline_vision::mount::MountFileError;
use plumbline_vision::rectify::RectifyError;
use plumbline_vision::yolo_set::YoloSetError;

/// Why work on recorded data could not be done, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum OfflineError {
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The twin cannot be built.
    #[error(transparent)]
    Twin(#[from] plumbline_twin::TwinError),
    /// The robot has no such hand.
    #[error(transparent)]
    Arm(#[from] plumbline_grasp::NoArm),
    /// A hand has no shape.
    #[error(transparent)]
    Hand(#[from] plumbline_grasp::attempt::NoHand),
    /// An experiment with grasps.
    #[error(transparent)]
    Trials(#[from] plumbline_engine::trials::TrialsError),
    /// Nothing is known of such a thing.
    #[error("nothing is known of a thing called {object}: choose one of tomato, mushroom, onion, orange")]
    UnknownThing {
        /// Its name.
        object: String,
    },
    /// The board cannot be used.
    #[error(transparent)]
    Board(#[from] BoardError),
    /// The pairs cannot be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// An image cannot be read.
    #[error(transparent)]
    Image(#[from] ImageProblem),
    /// The pairs cannot be solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A calibrated mount cannot be read.
    #[error(transparent)]
    Mount(#[from] MountFileError),
    /// A folder in which nothing, or not enough, was accepted.
    #[error(
        "{} is no commissioned lab ({why}): give the folder that plumbline commission wrote, and let it finish there",
        .folder.display()
    )]
    NoLab {
        /// The folder.
        folder: PathBuf,
        /// What is missing.
        why: &'static str,
    },
    /// A head that cannot have stood so.
    #[error(
        "the joint {joint} of the head cannot stand at {angle_rad} rad, for it turns from {:.2} to {:.2} rad: give what its encoder said, in radians",
        .limits.lower_rad,
        .limits.upper_rad
    )]
    HeadAngle {
        /// The joint.
        joint: String,
        /// What was asked for.
        angle_rad: f64,
        /// How far it turns.
        limits: Limits,
    },
    /// A calibration file cannot be read or written.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The views cannot be aimed.
    #[error(transparent)]
    Aim(#[from] AimError),
    /// The images cannot be rectified.
    #[error(transparent)]
    Rectify(#[from] RectifyError),
    /// No disparity can be computed.
    #[error(transparent)]
    Disparity(#[from] DisparityError),
    /// The published pipeline could not be run beside ours.
    #[error("the comparison with the published pipeline failed: {0}")]
    Comparison(String),
    /// No point can be located.
    #[error(transparent)]
    NoBaseline(#[from] NoBaseline),
    /// The board was never seen.
    #[error(
        "in none of the {pairs} pairs do both eyes see the board of {board}. {example} Check --board, which counts inner corners: one less than squares each way"
    )]
    BoardNeverSeen {
        /// Pairs that were searched.
        pairs: usize,
        /// The board.
        board: String,
        /// What was seen in one of them.
        example: String,
    },
    /// A file that was to be left out is not there.
    #[error("there is no pair with the file {0} to leave out: check --exclude")]
    NothingToExclude(String),
    /// The calibration is for other images.
    #[error(
        "the images are {images} px but the calibration is for {calibrated} px: give the calibration of these cameras at this size"
    )]
    OtherSize {
        /// Size of the images.
        images: String,
        /// Size that was calibrated.
        calibrated: String,
    },
    /// A session without pairs.
    #[error(
        "{0} has no pairs of images: they belong into stereo/left and stereo/right, by the same names, or into its \
         recording log.mcap"
    )]
    NoPairs(PathBuf),
    /// An image of a recording that is none.
    #[error(
        "the images of pair {pair} in {log} cannot be read ({reason}): the file was changed or damaged; record again"
    )]
    RecordedImage {
        /// The recording.
        log: PathBuf,
        /// From 1.
        pair: usize,
        /// Why.
        reason: String,
    },
    /// A recording that cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A session without places to judge.
    #[error(
        "{0} has no localizations.csv with true places and estimates that count: give a session that has"
    )]
    NoGrid(PathBuf),
    /// The recording cannot be exported.
    #[error(transparent)]
    Lerobot(#[from] plumbline_lerobot::ExportError),
    /// The eyes cannot be judged.
    #[error(transparent)]
    Health(#[from] HealthError),
    /// With this calibration the eyes do not see the table.
    #[error("with {0} the eyes do not see the table at all: give the calibration of these eyes")]
    TableNotSeen(PathBuf),
    /// A table cannot be read.
    #[error("{file}, line {line}: {reason}. The file needs {needs}")]
    Table {
        /// The file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong.
        reason: String,
        /// What the file needs, with an example.
        needs: &'static str,
    },
    /// The robot is not known, or its file cannot be used.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The tip is not known, or cannot be solved.
    #[error(transparent)]
    Tip(#[from] SolverError),
    /// The inverse kinematics cannot be asked so.
    #[error(transparent)]
    Kinematics(#[from] IkError),
    /// The table asks for a part of an orientation.
    #[error(
        "{file} has the columns {given} of an orientation: give all of roll_rad, pitch_rad and yaw_rad for a whole pose, yaw_rad alone for a heading, or none of them"
    )]
    HalfAnOrientation {
        /// The file.
        file: PathBuf,
        /// The columns that are there.
        given: String,
    },
    /// A session cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Nothing can be learned from a session.
    #[error(transparent)]
    Touches(#[from] DataError),
    /// A model cannot be trained.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// A model file cannot be read or written.
    #[error(transparent)]
    Model(#[from] FileError),
    /// A session cannot be predicted.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// The sessions cannot be looked at together.
    #[error(transparent)]
    Measurements(#[from] MeasurementsError),
    /// No gap can be looked for.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// A placement of the screen cannot be used.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// A model with effects cannot be used.
    #[error(transparent)]
    Effects(#[from] RigModelError),
    /// The description cannot hold the effects.
    #[error(transparent)]
    Export(#[from] plumbline_effects::rig_model::ExportError),
    /// No report can be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Effects of a finding cannot be added.
    #[error("{0}")]
    NotAdded(String),
    /// Neither a rig file nor a placement nor a model with effects.
    #[error(
        "{file} is neither a rig file nor a screen placement nor a model with effects ({reason}): give the rig.toml of a robot, the screen.toml that was written when the touchscreen was placed, or the rig-model.toml that was written when effects were added"
    )]
    RigModel {
        /// The file.
        file: PathBuf,
        /// What it is instead.
        reason: String,
    },
    /// A placement of a screen of another size.
    #[error(
        "the rig model has a touchscreen of {found}, the session one of {expected}: give the rig model of the robot that was measured"
    )]
    OtherScreen {
        /// Size in the session.
        expected: String,
        /// Size in the rig model.
        found: String,
    },
    /// The robot of a session has no such tip.
    #[error("the session and its robot do not fit together: {0}")]
    Chain(#[from] DescriptionError),
    /// Left and right image of a pair differ in size.
    #[error("the left image is {left} px and the right one {right} px: give the two images of one pair")]
    EyesDiffer {
        /// Size of the left image.
        left: String,
        /// Size of the right image.
        right: String,
    },
    /// A twin is not commissioned, or an experiment not carried out, in the words of its own error.
    #[error("{0}")]
    OnTwin(Box<dyn std::error::Error + Send + Sync>),
    /// The detector cannot be opened.
    #[error(transparent)]
    Detect(#[from] DetectError),
    /// A labeled set cannot be read.
    #[error(transparent)]
    YoloSet(#[from] YoloSetError),
    /// A detector cannot be judged.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// No detector of several could be judged.
    #[error("none of the {models} models could be judged. For example {example}")]
    NoModelJudged {
        /// How many there are.
        models: usize,
        /// What is wrong with one.
        example: String,
    },
    /// The program came without a detector.
    #[error("the detector that comes with the program was not found: give one of your own with --model")]
    NoDetector,
    /// A folder without images.
    #[error("there are no images in {}: give the folder that holds the PNG or JPEG files themselves", .folder.display())]
    NoImages {
        /// The folder.
        folder: PathBuf,
    },
    /// No image could be looked at.
    #[error("none of the {images} images could be looked at. For example {example}")]
    NoImageDetected {
        /// How many there are.
        images: usize,
        /// What is wrong with one.
        example: String,
    },
    /// A file itself cannot be read or written, or is an input that would be lost.
    #[error(transparent)]
    File(#[from] plumbline_model::files::FileError),
    /// A folder with an attempt in it, which another one would be mixed with.
    #[error("{} holds an attempt already: name a new folder, or remove that one", .0.display())]
    KeptAlready(std::path::PathBuf),
    /// What is kept of a grasp.
    #[error(transparent)]
    Keeping(#[from] plumbline_engine::grasp::KeepingError),
    /// A file cannot be read or written.
    #[error("{}: {error}. Check the path, the permissions and the free space", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

impl OfflineError {
    pub(super) fn unknown_thing(object: &str) -> Self {
        Self::UnknownThing { object: object.to_owned() }
    }

    /// For `map_err` of file operations.
    pub(super) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |error| Self::Io { path, error }
    }
}

/// Width × height, for messages.
pub(super) fn size_text((width, height): (u32, u32)) -> String {
    format!("{width}x{height}")
}

//! The application minus the window: state, commands, live pipeline, jobs.
//!
//! `ground` is what all stand on; then come the rooms, one folder per workflow, each with its
//! commands, its view, its state and its work; `command`, `view`, `work` and `state` are the sums of
//! the rooms; `engine` runs them on threads. Arrows go down only.

pub mod ground;

pub mod commission;
pub mod detect;
pub mod drift;
pub mod eyes;
pub mod gap;
pub mod grasp;
pub mod handeye;
pub mod labels;
pub mod live;
pub mod models;
pub mod motion;
pub mod mount;
mod recording;
pub mod rig_models;
pub mod robot;
mod scores;
mod source;
pub mod timeline;
pub mod touch;
pub mod trials;
mod truth;
mod twin;

pub mod command;
pub mod state;
pub mod view;
pub mod work;

pub mod engine;

pub use command::{
    AimChoice, BoxEdit, Command, CommissionCommand, ConfusionCell, ContactWith, Correction, Destination,
    DetectCommand, DetectorChoice, DriftCommand, ExportFormat, Exported, EyesCommand, FileLength, GapCommand,
    GapModel, GraspCommand, GraspTable, GraspTarget, GridCommand, GridCorrection, GridSide, HandEyeCommand,
    HandStep, HeadPose, JOG_DEADLINE_MS, JobCommand, JobId, JogRates, LabelsCommand, LiveCommand,
    ModelsCommand, MountCommand, NoticeCommand, ProbePoint, Products, Provider, RecordingCommand,
    RobotCommand, ScoresCommand, ScreenContact, ScreenWindow, SetPart, SourceCommand, TablesCommand,
    TimelineCommand, TimelineFormat, TouchCommand, TrialsCommand, TrialsFormat, TruthCommand, TwinCommand,
    WatchCommand,
};
pub use engine::settings::{self, EngineSettings};
pub use engine::{Engine, Wake, journal, libraries, replay};
pub use ground::notice::{Notice, NoticeLevel};
pub use ground::stage::Skipped;
pub use ground::watched::WatchedThread;
pub use ground::{data_folder, jobs, notice, slot, software, statistics, watched};
pub use plumbline_hardware::{CameraDevice, SourceSpec};
pub use plumbline_vision::disparity::{DisparityMap, Origin as DisparityOrigin};
pub use source::Control;
pub use state::Action;
pub use view::View;

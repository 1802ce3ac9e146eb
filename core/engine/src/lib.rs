//! The application minus the window: state, commands, live pipeline, jobs.

mod bell;
pub mod command;
mod context;
pub mod data_folder;
pub mod detect;
mod detector_scores;
pub mod doctor;
pub mod engine;
pub mod eyes;
mod gaps;
mod job_list;
pub mod jobs;
pub mod journal;
#[cfg(all(test, target_os = "linux"))]
mod kept;
pub mod label_sets;
mod live;
mod models;
mod mount;
pub mod notice;
pub mod offline;
pub mod rig_models;
pub mod robot;
pub mod settings;
pub mod slot;
mod source;
pub mod stages;
pub mod state;
pub mod statistics;
mod text;
mod touch;
pub mod view;
pub mod watched;
pub mod work;

pub use command::{
    AimChoice, BoxEdit, Command, ConfusionCell, ContactWith, Correction, Destination, DetectCommand,
    DetectorChoice, ExportFormat, Exported, EyesCommand, FileLength, GapCommand, GapModel, GraspTable,
    HeadPose, JOG_DEADLINE_MS, JobCommand, JobId, JogRates, LabelsCommand, LiveCommand, ModelsCommand,
    MountCommand, NoticeCommand, ProbePoint, Products, Provider, RobotCommand, ScoresCommand, ScreenContact,
    ScreenWindow, SetPart, SourceCommand, TablesCommand, TouchCommand, TwinCommand, WatchCommand,
};
pub use context::Action;
pub use engine::{Engine, Wake};
pub use live::Skipped;
pub use notice::{Notice, NoticeLevel};
pub use plumbline_correction as correction;
pub use plumbline_effects as effects;
pub use plumbline_gap as gap;
pub use plumbline_hardware::{CameraDevice, SourceSpec};
pub use plumbline_report as report;
pub use plumbline_vision::disparity::{DisparityMap, Origin as DisparityOrigin};
pub use settings::EngineSettings;
pub use source::Control;
pub use view::View;
pub use watched::WatchedThread;

/// Program and version, as written into results.
pub fn software() -> String {
    concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned()
}

//! The application minus the window: state, commands, live pipeline, jobs.

pub mod command;
pub mod engine;
pub mod eyes;
pub mod jobs;
pub mod journal;
pub mod notice;
pub mod settings;
pub mod slot;
mod source_spec;
pub mod statistics;
pub mod view;

pub use command::{
    AimChoice, Command, ExportFormat, Exported, EyesCommand, HeadPose, JobCommand, JobId, LiveCommand,
    NoticeCommand, ProbePoint, Products, SourceCommand,
};
pub use engine::{Engine, Wake};
pub use notice::{Notice, NoticeLevel};
pub use settings::EngineSettings;
pub use source_spec::SourceSpec;
pub use view::View;

/// Program and version, as written into results.
pub fn software() -> String {
    concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned()
}

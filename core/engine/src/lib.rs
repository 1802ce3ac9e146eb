//! The application minus the window: state, commands, live pipeline, jobs.

pub mod command;
pub mod engine;
pub mod eyes;
pub mod notice;
pub mod settings;
mod source_spec;
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

//! What takes long: reading and writing the file, and the report.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::{JobContext, files};
use plumbline_report::setup::{Setup, setup_html, setup_pdf};

use super::command::TimelineFormat;
use super::view::TimelineEntry;
use super::{kept, page};
use crate::ground::jobs::JobError;
use crate::ground::{self, LongWork};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum TimelineWork {
    /// Reads what is kept.
    Restore {
        /// The file.
        file: PathBuf,
    },
    /// Writes all of it.
    Keep {
        /// The file.
        file: PathBuf,
        /// All entries.
        entries: Arc<[TimelineEntry]>,
    },
    /// Writes the report.
    Report {
        /// Where to.
        file: PathBuf,
        /// As what.
        format: TimelineFormat,
        /// All entries.
        entries: Arc<[TimelineEntry]>,
        /// What stands on the page.
        setup: Box<Setup>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum TimelineResult {
    /// What was kept.
    Restored(Vec<TimelineEntry>),
    /// It is on disk.
    Kept,
    /// The report was written.
    Written(PathBuf),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, TimelineWork>;

impl LongWork for TimelineWork {
    type Result = TimelineResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read the timeline of results".to_owned(),
            Self::Keep { .. } => "Write the timeline of results".to_owned(),
            Self::Report { .. } => "Write the report of the setup".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        !matches!(self, Self::Report { .. })
    }

    fn run(self, _: &dyn JobContext) -> Result<TimelineResult, JobError> {
        match self {
            Self::Restore { file } => {
                Ok(TimelineResult::Restored(kept::read(&file).map_err(JobError::told)?))
            }
            Self::Keep { file, entries } => {
                kept::write(&file, &entries).map_err(JobError::told)?;
                Ok(TimelineResult::Kept)
            }
            Self::Report { file, format, entries, setup } => {
                files::export(&file).map_err(JobError::told)?;
                let bytes = match format {
                    TimelineFormat::Csv => page::csv(&entries).map_err(JobError::told)?,
                    TimelineFormat::Html => setup_html(&setup).into_bytes(),
                    TimelineFormat::Pdf => setup_pdf(&setup).map_err(JobError::told)?,
                };
                files::write(&file, bytes).map_err(JobError::told)?;
                Ok(TimelineResult::Written(file))
            }
        }
    }
}

impl TimelineResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(entries) => {
                format!("{} on the timeline.", plumbline_model::counted(entries.len(), "result"))
            }
            Self::Kept => "The timeline is on disk.".to_owned(),
            Self::Written(file) => format!("The report of the setup was written to {}.", file.display()),
        }
    }
}

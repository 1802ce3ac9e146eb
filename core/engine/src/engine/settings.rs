//! What the engine needs to know before it starts.

use std::path::PathBuf;

use plumbline_hardware::SourceSpec;

/// What the engine needs to know before it starts.
#[derive(Clone, Debug, Default)]
pub struct EngineSettings {
    /// Where accepted calibrations, sessions and the journal are kept; `None` takes the user's
    /// data folder of this program.
    pub data_dir: Option<PathBuf>,
    /// Scenario of a twin to start and connect to at once.
    pub twin: Option<String>,
    /// A source to open at once.
    pub source: Option<SourceSpec>,
}

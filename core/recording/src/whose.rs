//! Whose a recording is, without reading all of it.

use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::Record;

use crate::error::RecordingError;
use crate::parse::parse;
use crate::records::each_record;

/// Whose a recording is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Whose {
    /// The robot's name; `None`: it does not say.
    pub rig: Option<String>,
    /// Whether it is of the simulated robot.
    pub of_twin: bool,
}

impl Whose {
    /// Reads the beginning of a recording, which says it before everything else.
    ///
    /// # Errors
    /// When there is no file, or it is no recording. One that does not say whose it is, is the robot's.
    pub fn read(file: &Path) -> Result<Self, RecordingError> {
        let mut whose = Self::default();
        each_record(file, 1 << 20, 0, |opcode, body| match parse(opcode, body) {
            Ok(Record::Metadata(metadata)) if metadata.name == "plumbline" => {
                whose = Self::of(&metadata);
                ControlFlow::Break(())
            }
            Ok(Record::Chunk { .. }) | Err(_) => ControlFlow::Break(()),
            Ok(_) => ControlFlow::Continue(()),
        })?;
        Ok(whose)
    }

    pub(crate) fn of(metadata: &mcap::records::Metadata) -> Self {
        let of_twin = metadata.metadata.get("of").is_some_and(|of| of == "twin");
        Self { rig: metadata.metadata.get("rig").cloned(), of_twin }
    }
}

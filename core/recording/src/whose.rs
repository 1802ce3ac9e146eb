//! Whose a recording is, without reading all of it.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::error::RecordingError;

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
        let mut input = BufReader::new(File::open(file).map_err(RecordingError::io(file))?);
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_skip_end_magic(true)
            .with_record_length_limit(1 << 20);
        let mut reader = LinearReader::new_with_options(options);
        let mut is_at_end = false;
        while let Some(event) = reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(wanted)) => {
                    let read = input.read(reader.insert(wanted)).map_err(RecordingError::io(file))?;
                    reader.notify_read(read);
                    if read == 0 && std::mem::replace(&mut is_at_end, true) {
                        break;
                    }
                }
                Ok(LinearReadEvent::Record { data, opcode }) => {
                    match mcap::parse_record(opcode, data).map_err(RecordingError::mcap(file))? {
                        Record::Metadata(metadata) if metadata.name == "plumbline" => {
                            return Ok(Self::of(&metadata));
                        }
                        Record::Chunk { .. } => break,
                        _ => {}
                    }
                }
                Err(error) => return Err(RecordingError::mcap(file)(error)),
            }
        }
        Ok(Self::default())
    }

    pub(crate) fn of(metadata: &mcap::records::Metadata) -> Self {
        let of_twin = metadata.metadata.get("of").is_some_and(|of| of == "twin");
        Self { rig: metadata.metadata.get("rig").cloned(), of_twin }
    }
}

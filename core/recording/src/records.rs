//! One record of a file after the other.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::Path;

use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::error::RecordingError;

/// Reads records from this byte on (0: from the beginning), chunks as a whole, until `take` (what it is, its body) has enough, or the file is cut or
/// damaged: what stands before is whole.
///
/// # Errors
/// When there is no file, or it does not begin as MCAP does.
pub(crate) fn each_record(
    file: &Path,
    longest: usize,
    from: u64,
    mut take: impl FnMut(u8, &[u8]) -> ControlFlow<()>,
) -> Result<(), RecordingError> {
    let mut input = BufReader::with_capacity(1 << 20, File::open(file).map_err(RecordingError::io(file))?);
    input.seek(SeekFrom::Start(from)).map_err(RecordingError::io(file))?;
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_skip_start_magic(from > 0)
        .with_skip_end_magic(true)
        .with_record_length_limit(longest);
    let mut reader = LinearReader::new_with_options(options);
    let mut is_at_end = false;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let read = input.read(reader.insert(wanted)).map_err(RecordingError::io(file))?;
                reader.notify_read(read);
                // A second read of nothing: it was cut in the middle of a record.
                if read == 0 && std::mem::replace(&mut is_at_end, true) {
                    break;
                }
            }
            Ok(LinearReadEvent::Record { data, opcode }) => {
                if take(opcode, data).is_break() {
                    break;
                }
            }
            Err(mcap::McapError::BadMagic) => {
                let what = "it does not begin as MCAP does".to_owned();
                return Err(RecordingError::NotARecording { file: file.to_owned(), what });
            }
            Err(_) => break,
        }
    }
    Ok(())
}

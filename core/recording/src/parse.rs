//! Records whose texts lie within them. The library that parses records believes a text to be as long as it says and
//! asks for the memory before it reads, so that one damaged length would end the program.

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult};

/// A record of this kind.
///
/// # Errors
/// When it is damaged.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    if !texts_fit(opcode, body) {
        return Err(McapError::UnexpectedEof);
    }
    mcap::parse_record(opcode, body)
}

/// The records in a chunk, of which `body` is the record, one after the other: what it is, its body.
///
/// # Errors
/// What `take` says, or when the chunk is damaged.
pub(crate) fn each_in_chunk(
    body: &[u8],
    longest: usize,
    mut take: impl FnMut(u8, &[u8]) -> McapResult<()>,
) -> McapResult<()> {
    let head = [&[op::CHUNK][..], &(body.len() as u64).to_le_bytes()].concat();
    let mut parts = [head.as_slice(), body];
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(longest);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let Some(part) = parts.iter_mut().find(|part| !part.is_empty()) else { break };
                let count = wanted.min(part.len());
                reader.insert(count).copy_from_slice(&part[..count]);
                reader.notify_read(count);
                *part = &part[count..];
            }
            LinearReadEvent::Record { data, opcode } => take(opcode, data)?,
        }
    }
    Ok(())
}

/// Whether the texts of a record end where it ends, or before.
fn texts_fit(opcode: u8, body: &[u8]) -> bool {
    let mut rest = Rest(body);
    let fits = match opcode {
        op::HEADER => rest.texts(2),
        op::SCHEMA => rest.skip(2).and_then(|()| rest.texts(2)),
        op::CHANNEL => rest.skip(4).and_then(|()| rest.texts(2)).and_then(|()| rest.map()),
        op::CHUNK => rest.skip(28).and_then(|()| rest.texts(1)),
        op::ATTACHMENT => rest.skip(16).and_then(|()| rest.texts(2)),
        op::CHUNK_INDEX => {
            rest.skip(32).and_then(|()| rest.block()).and_then(|()| rest.skip(8)).and_then(|()| rest.texts(1))
        }
        op::ATTACHMENT_INDEX => rest.skip(40).and_then(|()| rest.texts(2)),
        op::METADATA => rest.texts(1).and_then(|()| rest.map()),
        op::METADATA_INDEX => rest.skip(16).and_then(|()| rest.texts(1)),
        _ => Some(()),
    };
    fits.is_some()
}

/// What of a record was not looked at yet.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn skip(&mut self, bytes: usize) -> Option<()> {
        self.0 = self.0.get(bytes..)?;
        Some(())
    }

    fn length(&mut self) -> Option<usize> {
        let (length, rest) = self.0.split_first_chunk::<4>()?;
        self.0 = rest;
        usize::try_from(u32::from_le_bytes(*length)).ok()
    }

    /// As many bytes as stand before it.
    fn block(&mut self) -> Option<()> {
        let length = self.length()?;
        self.skip(length)
    }

    fn texts(&mut self, count: usize) -> Option<()> {
        (0..count).try_for_each(|_| self.block())
    }

    /// Pairs of texts in as many bytes as stand before them.
    fn map(&mut self) -> Option<()> {
        let length = self.length()?;
        let mut pairs = Rest(self.0.get(..length)?);
        while !pairs.0.is_empty() {
            pairs.texts(2)?;
        }
        self.skip(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A channel of this topic, whose text says that it is so much longer.
    fn channel(topic: &str, longer: u32) -> Vec<u8> {
        let text = |text: &str, longer: u32| {
            [&(text.len() as u32 + longer).to_le_bytes()[..], text.as_bytes()].concat()
        };
        [vec![1, 0, 0, 0], text(topic, longer), text("json", 0), vec![0; 4]].concat()
    }

    #[test]
    fn a_text_that_says_to_be_longer_than_its_record_is_refused_before_anything_is_asked_for() {
        assert!(
            matches!(parse(op::CHANNEL, &channel("/tf", 0)), Ok(Record::Channel(found)) if found.topic == "/tf")
        );
        for longer in [40, 0xd900_0000, u32::MAX - 3] {
            let body = channel("/tf", longer);
            assert!(matches!(parse(op::CHANNEL, &body), Err(McapError::UnexpectedEof)), "{longer}");
        }
        for opcode in op::HEADER..=op::DATA_END {
            for length in 0..60 {
                // Whatever it is: it is refused or read, and asks for no more than it holds.
                _ = parse(opcode, &vec![0xd9; length]);
            }
        }
    }
}

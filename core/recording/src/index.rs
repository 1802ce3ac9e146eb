//! What stands where in a file, found by reading it once from the beginning: a file that was cut has no
//! index of its own.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::Record;

use crate::error::RecordingError;
use crate::parse::{each_in_chunk, parse};
use crate::records::each_record;
use crate::topic::Topic;
use crate::whose::Whose;
use crate::writer::{Attached, END};

/// A record longer than this is no record of a recording, bytes.
pub(crate) const LONGEST: usize = 256 << 20;
/// Bytes before the first record.
const MAGIC: u64 = 8;
/// Bytes before the body of a record: what it is, and how long.
const HEAD: u64 = 9;

/// Where a message stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Number of its chunk.
    pub chunk: usize,
    /// Which of the messages of that chunk.
    pub nth: usize,
    /// Time of the log, ns.
    pub at: u64,
    /// Number within its topic.
    pub sequence: u32,
}

/// A chunk in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ChunkPlace {
    /// Where its body begins.
    pub offset: u64,
    /// Bytes of the body.
    pub length: usize,
}

/// All of it.
#[derive(Debug, Default)]
pub(crate) struct Index {
    pub software: String,
    pub whose: Whose,
    /// Whether this program has written it.
    pub is_ours: bool,
    pub chunks: Vec<ChunkPlace>,
    pub messages: BTreeMap<Topic, Vec<Place>>,
    pub attached: Vec<Attached>,
    /// Whether it ends as a recording does that was finished.
    pub is_whole: bool,
    /// Pairs and messages that are not in it.
    pub dropped: Option<u64>,
    /// Where the record behind the last whole one begins.
    offset: u64,
    topics: BTreeMap<u16, Topic>,
}

impl Index {
    /// Reads the whole file once.
    pub fn of(file: &Path) -> Result<Self, RecordingError> {
        let mut index = Self { offset: MAGIC, ..Self::default() };
        index.read(file, 0)?;
        Ok(index)
    }

    /// Reads what was written since.
    pub fn go_on(&mut self, file: &Path) -> Result<(), RecordingError> {
        if self.is_whole { Ok(()) } else { self.read(file, self.offset) }
    }

    fn read(&mut self, file: &Path, from: u64) -> Result<(), RecordingError> {
        each_record(file, LONGEST, from, |opcode, body| match self.take(opcode, body) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        })
    }

    pub fn of_topic(&self, topic: Topic) -> &[Place] {
        self.messages.get(&topic).map_or(&[], Vec::as_slice)
    }
}

impl Index {
    fn take(&mut self, opcode: u8, body: &[u8]) -> mcap::McapResult<()> {
        let offset = self.offset + HEAD;
        match parse(opcode, body)? {
            Record::Header(header) => self.software = header.library,
            Record::Channel(channel) => self.channel(&channel),
            Record::Metadata(metadata) if metadata.name == "plumbline" => {
                (self.whose, self.is_ours) = (Whose::of(&metadata), true);
            }
            Record::Metadata(metadata) if metadata.name == END => {
                self.dropped = metadata.metadata.get("dropped").and_then(|dropped| dropped.parse().ok());
            }
            Record::Attachment { header, data, .. } => self.attached.push(Attached {
                name: header.name,
                media_type: header.media_type,
                bytes: data.into_owned(),
            }),
            Record::Chunk { .. } => self.chunk(offset, body)?,
            Record::DataEnd(_) => self.is_whole = true,
            _ => {}
        }
        // One that is not whole yet, of a file that is still being written, is read again.
        self.offset = offset + body.len() as u64;
        Ok(())
    }

    fn channel(&mut self, channel: &mcap::records::Channel) {
        if let Some(topic) = Topic::of_name(&channel.topic) {
            self.topics.insert(channel.id, topic);
        }
    }

    fn chunk(&mut self, offset: u64, body: &[u8]) -> mcap::McapResult<()> {
        let chunk = self.chunks.len();
        let mut found = Vec::new();
        let mut nth = 0;
        each_in_chunk(body, LONGEST, |opcode, body| {
            match parse(opcode, body)? {
                Record::Channel(channel) => self.channel(&channel),
                Record::Message { header, .. } => {
                    let place = Place { chunk, nth, at: header.log_time, sequence: header.sequence };
                    found.extend(self.topics.get(&header.channel_id).map(|topic| (*topic, place)));
                    nth += 1;
                }
                _ => {}
            }
            Ok(())
        })?;
        let length = body.len();
        self.chunks.push(ChunkPlace { offset, length });
        for (topic, place) in found {
            self.messages.entry(topic).or_default().push(place);
        }
        Ok(())
    }
}

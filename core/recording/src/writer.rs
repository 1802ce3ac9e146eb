//! Writes a recording.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use foxglove::Encode;
use jiff::{SignedDuration, Timestamp};
use mcap::records::MessageHeader;
use mcap::{Attachment, WriteOptions, Writer};
use plumbline_model::{Eye, EyesThen, StereoCameras};
use serde::Serialize;

use crate::error::RecordingError;
use crate::frames::{self, EyePlaces};
use crate::messages::{self, JointGoal, JointReading, Note};
use crate::outlines::{self, Outline};
use crate::topic::Topic;

/// A chunk is closed this long after it was begun.
const CHUNK: SignedDuration = SignedDuration::from_secs(1);
/// Or when it holds so many bytes.
const CHUNK_BYTES: u64 = 16 << 20;
/// What is known at the end only stands under this name.
pub(crate) const END: &str = "plumbline.end";

/// An image as the camera has compressed it, or as it was compressed for the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Jpeg(pub Vec<u8>);

/// A file that a recording carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attached {
    /// Its name: "rig.toml".
    pub name: String,
    /// Its media type: "application/toml".
    pub media_type: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What is known when a recording begins.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The program that writes, with its version.
    pub software: String,
    /// The robot's name.
    pub rig: String,
    /// Whether it is of the simulated robot.
    pub of_twin: bool,
    /// The calibration of the eyes in use.
    pub cameras: Option<StereoCameras>,
    /// Files that belong to it.
    pub attached: Vec<Attached>,
}

/// How much was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs of images.
    pub pairs: u64,
    /// Other messages.
    pub messages: u64,
    /// Bytes of messages.
    pub bytes: u64,
}

/// A recording that is being written.
pub struct RecordingWriter {
    file: PathBuf,
    mcap: Writer<BufWriter<File>>,
    channels: BTreeMap<Topic, u16>,
    chunk_began: Option<Timestamp>,
    counts: Counts,
    dropped: Option<u64>,
}

impl RecordingWriter {
    /// Begins a new file; one that is there already is refused.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(file: &Path, at: Timestamp, about: &About) -> Result<Self, RecordingError> {
        let output = File::create_new(file).map_err(RecordingError::io(file))?;
        // Without compression, because images are compressed already; without going back in the file, so
        // that a chunk is written in one piece.
        let options = WriteOptions::new()
            .compression(None)
            .profile("")
            .library(about.software.as_str())
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true);
        let mcap = options.create(BufWriter::new(output)).map_err(RecordingError::mcap(file))?;
        let mut writer = Self {
            file: file.to_owned(),
            mcap,
            channels: BTreeMap::new(),
            chunk_began: None,
            counts: Counts::default(),
            dropped: None,
        };
        writer.begin(at, about)?;
        Ok(writer)
    }

    fn begin(&mut self, at: Timestamp, about: &About) -> Result<(), RecordingError> {
        let of = if about.of_twin { "twin" } else { "robot" };
        let whose = [("rig", about.rig.as_str()), ("of", of)];
        let whose = whose.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let metadata = mcap::records::Metadata { name: "plumbline".to_owned(), metadata: whose.into() };
        // First of all: whose it is, is known without reading the rest.
        self.mcap.write_metadata(&metadata).map_err(RecordingError::mcap(&self.file))?;
        for attached in &about.attached {
            let time = messages::nanoseconds(at);
            let attachment = Attachment {
                log_time: time,
                create_time: time,
                name: attached.name.clone(),
                media_type: attached.media_type.clone(),
                data: Cow::Borrowed(&attached.bytes),
            };
            self.mcap.attach(&attachment).map_err(RecordingError::mcap(&self.file))?;
        }
        for topic in Topic::ALL {
            let channel = self.channel(topic).map_err(RecordingError::mcap(&self.file))?;
            self.channels.insert(topic, channel);
        }
        if let Some(cameras) = &about.cameras {
            let [left, right] = [(Eye::Left, &cameras.left), (Eye::Right, &cameras.right)]
                .map(|(eye, camera)| messages::calibration(eye, at, camera));
            self.put(Topic::LeftCalibration, at, 0, &left)?;
            self.put(Topic::RightCalibration, at, 0, &right)?;
        }
        self.close_chunk()
    }

    fn channel(&mut self, topic: Topic) -> mcap::McapResult<u16> {
        let (schema, encoding) = messages::kind(topic);
        let schema = self.mcap.add_schema(&schema.name, &schema.encoding, &schema.data)?;
        self.mcap.add_channel(schema, topic.name(), &encoding, &BTreeMap::new())
    }

    /// Writes a pair that was captured at this time; `right_later_s`: the right image after the left one,
    /// s, where it is known. `number` counts the pairs of the source.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn pair(
        &mut self,
        at: Timestamp,
        number: u64,
        [left, right]: [Jpeg; 2],
        right_later_s: Option<f64>,
    ) -> Result<(), RecordingError> {
        // The format counts messages of a topic by 32 bits, round and round.
        let sequence = (number & u64::from(u32::MAX)) as u32;
        let later = right_later_s.and_then(|s| SignedDuration::try_from_secs_f64(s).ok()).unwrap_or_default();
        let right_at = at.checked_add(later).unwrap_or(at);
        self.close_chunk_in_time(at)?;
        self.put(Topic::LeftEye, at, sequence, &messages::image(Eye::Left, at, left.0))?;
        // Both images of a pair stand at the same time of the log.
        self.put(Topic::RightEye, at, sequence, &messages::image(Eye::Right, right_at, right.0))?;
        self.counts.messages -= 2;
        self.counts.pairs += 1;
        Ok(())
    }

    /// Writes how the eyes were when the pair of this time and number was taken; where nothing is known of that,
    /// nothing is written.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn eyes(
        &mut self,
        at: Timestamp,
        number: u64,
        then: &EyesThen,
        places: Option<&EyePlaces>,
    ) -> Result<(), RecordingError> {
        if !then.is_unknown() {
            let sequence = (number & u64::from(u32::MAX)) as u32;
            let refused = |error: serde_json::Error| RecordingError::Message {
                topic: Topic::Eyes.name(),
                what: error.to_string(),
            };
            let bytes = serde_json::to_vec(then).map_err(refused)?;
            self.put_bytes(Topic::Eyes, at, sequence, &bytes)?;
        }
        match places {
            Some(places) => self.put(Topic::Transforms, at, 0, &frames::transforms(at, places)),
            None => Ok(()),
        }
    }

    /// Writes what was seen in the images of the pair of this time: left, right.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn outlines(&mut self, at: Timestamp, seen: &[Vec<Outline>; 2]) -> Result<(), RecordingError> {
        self.close_chunk_in_time(at)?;
        for (topic, seen) in [Topic::LeftAnnotations, Topic::RightAnnotations].into_iter().zip(seen) {
            self.put(topic, at, 0, &outlines::annotations(at, seen))?;
        }
        Ok(())
    }

    /// Writes angles of joints.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn joints(&mut self, at: Timestamp, readings: &[JointReading]) -> Result<(), RecordingError> {
        self.close_chunk_in_time(at)?;
        self.put(Topic::Joints, at, 0, &messages::joints(at, readings))
    }

    /// Writes the angles that joints were sent last; joints that hold none (limp, or never told) are not among them.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn goals(&mut self, at: Timestamp, goals: &[JointGoal]) -> Result<(), RecordingError> {
        self.close_chunk_in_time(at)?;
        self.put(Topic::Goals, at, 0, &messages::goals(at, goals))
    }

    /// Writes a message for the operator.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn note(&mut self, at: Timestamp, note: &Note) -> Result<(), RecordingError> {
        self.close_chunk_in_time(at)?;
        self.put(Topic::Notes, at, 0, &messages::log(at, note))
    }

    /// Writes what only this program knows.
    ///
    /// # Errors
    /// When it is not an object, or cannot be written.
    pub fn told(&mut self, topic: Topic, at: Timestamp, told: &impl Serialize) -> Result<(), RecordingError> {
        let refused = |what: String| RecordingError::Message { topic: topic.name(), what };
        let value = serde_json::to_value(told).map_err(|error| refused(error.to_string()))?;
        if messages::kind(topic).1 != "json" || !value.is_object() {
            return Err(refused("it is no object of JSON, or this topic has none".to_owned()));
        }
        self.close_chunk_in_time(at)?;
        self.put_bytes(topic, at, 0, value.to_string().as_bytes())
    }

    /// How much was written.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// So many pairs and messages are not in it, because disk or processor did not keep up: that is written at the
    /// end.
    pub fn set_dropped(&mut self, dropped: u64) {
        self.dropped = Some(dropped);
    }

    /// Closes the file, with the index that readers wind by.
    ///
    /// # Errors
    /// When it cannot be written; what was written before is whole.
    pub fn finish(mut self) -> Result<Counts, RecordingError> {
        if let Some(dropped) = self.dropped {
            let told = [("pairs", self.counts.pairs), ("dropped", dropped)];
            let told = told.map(|(key, value)| (key.to_owned(), value.to_string()));
            let metadata = mcap::records::Metadata { name: END.to_owned(), metadata: told.into() };
            self.mcap.write_metadata(&metadata).map_err(RecordingError::mcap(&self.file))?;
        }
        self.mcap.finish().map_err(RecordingError::mcap(&self.file))?;
        let synced = self.mcap.into_inner().into_inner();
        let file = synced.map_err(|error| error.into_error()).map_err(RecordingError::io(&self.file))?;
        file.sync_all().map_err(RecordingError::io(&self.file))?;
        Ok(self.counts)
    }

    fn put<T: Encode>(
        &mut self,
        topic: Topic,
        at: Timestamp,
        sequence: u32,
        message: &T,
    ) -> Result<(), RecordingError> {
        self.put_bytes(topic, at, sequence, &messages::bytes(topic, message)?)
    }

    fn put_bytes(
        &mut self,
        topic: Topic,
        at: Timestamp,
        sequence: u32,
        bytes: &[u8],
    ) -> Result<(), RecordingError> {
        let time = messages::nanoseconds(at);
        let channel_id = self.channels[&topic];
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        let written = self.mcap.write_to_known_channel(&header, bytes);
        written.map_err(RecordingError::mcap(&self.file))?;
        self.chunk_began.get_or_insert(at);
        self.counts.messages += 1;
        self.counts.bytes += bytes.len() as u64;
        Ok(())
    }

    /// A clock that goes back closes it, too.
    fn close_chunk_in_time(&mut self, at: Timestamp) -> Result<(), RecordingError> {
        match self.chunk_began {
            Some(began) if at.duration_since(began).abs() >= CHUNK => self.close_chunk(),
            _ => Ok(()),
        }
    }

    fn close_chunk(&mut self) -> Result<(), RecordingError> {
        self.chunk_began = None;
        self.mcap.flush().map_err(RecordingError::mcap(&self.file))
    }
}

//! Reads a recording.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use foxglove::Decode;
use foxglove::messages::{CompressedImage, FrameTransforms, JointStates, Log};
use jiff::Timestamp;
use mcap::records::Record;
use plumbline_model::EyesThen;
use serde_json::Value;

use crate::error::RecordingError;
use crate::frames;
use crate::index::{Index, LONGEST, Place};
use crate::messages::{self, JointGoal, JointReading, Note};
use crate::parse::{each_in_chunk, parse};
use crate::topic::Topic;
use crate::whose::Whose;
use crate::writer::{Attached, Jpeg};

/// A pair of images as it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPair {
    /// When it was captured.
    pub at: Timestamp,
    /// Its number in the source that it was recorded from.
    pub number: u32,
    /// Left, right.
    pub images: [Jpeg; 2],
    /// The right image after the left one, s.
    pub right_later_s: f64,
    /// How the eyes were then, as far as it says.
    pub eyes: EyesThen,
}

/// Something that was told at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Told<T> {
    /// When.
    pub at: Timestamp,
    /// What.
    pub what: T,
}

/// A recording, whole or cut.
pub struct Recording {
    path: PathBuf,
    file: File,
    index: Index,
    /// Left and right image of each pair.
    pairs: Vec<[Place; 2]>,
    /// How the eyes were, by time and number of a pair.
    eyes: BTreeMap<(u64, u32), Place>,
    /// Bodies of the messages of the chunk that was read last.
    chunk: Option<(usize, Vec<Vec<u8>>)>,
}

impl Recording {
    /// Opens a recording and finds what stands where in it; a file that was cut ends with its last whole
    /// second.
    ///
    /// # Errors
    /// When there is none, or it is something else.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let index = Index::of(path)?;
        let file = File::open(path).map_err(RecordingError::io(path))?;
        if !index.is_ours && index.messages.is_empty() {
            let what = "there is nothing in it that this program has recorded".to_owned();
            return Err(RecordingError::NotARecording { file: path.to_owned(), what });
        }
        let pairs = pairs(index.of_topic(Topic::LeftEye), index.of_topic(Topic::RightEye));
        let eyes = by_pair(index.of_topic(Topic::Eyes));
        Ok(Self { path: path.to_owned(), file, index, pairs, eyes, chunk: None })
    }

    /// Takes up what was written since it was opened, of a recording that is still being written; how many pairs
    /// came.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn go_on(&mut self) -> Result<usize, RecordingError> {
        let before = self.pairs.len();
        self.index.go_on(&self.path)?;
        self.pairs = pairs(self.index.of_topic(Topic::LeftEye), self.index.of_topic(Topic::RightEye));
        self.eyes = by_pair(self.index.of_topic(Topic::Eyes));
        Ok(self.pairs.len().saturating_sub(before))
    }

    /// The program that has written it.
    pub fn software(&self) -> &str {
        &self.index.software
    }

    /// Whose it is.
    pub fn whose(&self) -> &Whose {
        &self.index.whose
    }

    /// Whether it was finished; otherwise it was cut, and what is missing at its end is not known.
    pub fn is_whole(&self) -> bool {
        self.index.is_whole
    }

    /// Pairs and messages that are not in it, because disk or processor did not keep up; `None`: it does not say,
    /// as one that was cut.
    pub fn dropped(&self) -> Option<u64> {
        self.index.dropped
    }

    /// Files that belong to it.
    pub fn attached(&self) -> &[Attached] {
        &self.index.attached
    }

    /// Number of pairs.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// When a pair was captured; `None`: there is no such pair.
    pub fn captured_at(&self, index: usize) -> Option<Timestamp> {
        messages::moment(self.pairs.get(index)?[0].at)
    }

    /// A pair.
    ///
    /// # Errors
    /// When there is none of this number, or the file cannot be read any more.
    pub fn pair(&mut self, index: usize) -> Result<RecordedPair, RecordingError> {
        let none = RecordingError::NoSuchPair { index, pairs: self.pairs.len() };
        let [left_place, right_place] = *self.pairs.get(index).ok_or(none)?;
        let left: CompressedImage = self.message(left_place)?;
        let right: CompressedImage = self.message(right_place)?;
        let captured = |image: &CompressedImage| image.timestamp.as_ref().map(|time| time.total_nanos());
        let right_later_s = match (captured(&left), captured(&right)) {
            (Some(left), Some(right)) => (i128::from(right) - i128::from(left)) as f64 * 1e-9,
            _ => 0.0,
        };
        let eyes = self.eyes.get(&(left_place.at, left_place.sequence)).copied();
        let eyes = eyes.map(|place| self.eyes_then(place)).transpose()?.flatten().unwrap_or_default();
        Ok(RecordedPair {
            eyes,
            at: self.moment(left_place)?,
            number: left_place.sequence,
            images: [left, right].map(|image| Jpeg(image.data.to_vec())),
            right_later_s,
        })
    }

    /// How the eyes were; numbers that cannot be are not known, and `None`: it is damaged, and its pair is seen all
    /// the same.
    fn eyes_then(&mut self, place: Place) -> Result<Option<EyesThen>, RecordingError> {
        let then: Result<EyesThen, _> = serde_json::from_slice(self.bytes(place)?);
        Ok(then.ok().map(EyesThen::as_can_be))
    }

    /// Where the left eye was in the robot each time that was written: rows of a matrix 4 by 4 that takes points (m)
    /// of the left eye there.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn robot_from_left(&mut self) -> Result<Vec<Told<[[f64; 4]; 4]>>, RecordingError> {
        let told = self.all(Topic::Transforms, |recording, place| {
            recording.message::<FrameTransforms>(place).map(|told| frames::robot_from_left(&told))
        })?;
        Ok(told.into_iter().filter_map(|told| Some(Told { at: told.at, what: told.what? })).collect())
    }

    /// All readings of joints.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn joints(&mut self) -> Result<Vec<Told<Vec<JointReading>>>, RecordingError> {
        let of =
            |recording: &mut Self, place| recording.message::<JointStates>(place).map(messages::readings);
        self.all(Topic::Joints, of)
    }

    /// What joints were told, each time that was written: all joints that held or went where they were told to.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn goals(&mut self) -> Result<Vec<Told<Vec<JointGoal>>>, RecordingError> {
        let of = |recording: &mut Self, place| recording.message::<JointStates>(place).map(messages::wanted);
        self.all(Topic::Goals, of)
    }

    /// All messages for the operator.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn notes(&mut self) -> Result<Vec<Told<Note>>, RecordingError> {
        self.all(Topic::Notes, |recording, place| recording.message::<Log>(place).map(messages::note))
    }

    /// All that only this program knows, of a topic.
    ///
    /// # Errors
    /// When the file cannot be read any more, or holds something else.
    pub fn told(&mut self, topic: Topic) -> Result<Vec<Told<Value>>, RecordingError> {
        self.all(topic, |recording, place| {
            let bytes = recording.bytes(place)?;
            serde_json::from_slice(bytes).map_err(|error| recording.damaged(&error.to_string()))
        })
    }

    fn all<T>(
        &mut self,
        topic: Topic,
        read: impl Fn(&mut Self, Place) -> Result<T, RecordingError>,
    ) -> Result<Vec<Told<T>>, RecordingError> {
        let places = self.index.of_topic(topic).to_vec();
        places
            .into_iter()
            .map(|place| Ok(Told { at: self.moment(place)?, what: read(self, place)? }))
            .collect()
    }

    fn moment(&self, place: Place) -> Result<Timestamp, RecordingError> {
        messages::moment(place.at).ok_or_else(|| self.damaged("a time beyond the calendar"))
    }

    fn message<T: Decode>(&mut self, place: Place) -> Result<T, RecordingError> {
        let bytes = self.bytes(place)?;
        T::decode(bytes).map_err(|error| self.damaged(&error.to_string()))
    }

    fn bytes(&mut self, place: Place) -> Result<&[u8], RecordingError> {
        if self.chunk.as_ref().is_none_or(|(chunk, _)| *chunk != place.chunk) {
            self.chunk = Some((place.chunk, self.read_chunk(place.chunk)?));
        }
        let messages = self.chunk.as_ref().map_or(&[][..], |(_, messages)| messages);
        let lacks = || damaged(&self.path, "a chunk has lost messages since it was opened");
        messages.get(place.nth).map(Vec::as_slice).ok_or_else(lacks)
    }

    fn read_chunk(&mut self, number: usize) -> Result<Vec<Vec<u8>>, RecordingError> {
        let place = self.index.chunks[number];
        let mut body = vec![0; place.length];
        let io = |error| RecordingError::Io { file: self.path.clone(), error };
        self.file.seek(SeekFrom::Start(place.offset)).map_err(io)?;
        self.file.read_exact(&mut body).map_err(io)?;
        let wrong = |error: mcap::McapError| damaged(&self.path, &error.to_string());
        let mut messages = Vec::new();
        each_in_chunk(&body, LONGEST, |opcode, body| {
            if let Record::Message { data, .. } = parse(opcode, body)? {
                messages.push(data.into_owned());
            }
            Ok(())
        })
        .map_err(wrong)?;
        Ok(messages)
    }

    fn damaged(&self, what: &str) -> RecordingError {
        damaged(&self.path, what)
    }
}

fn damaged(path: &Path, what: &str) -> RecordingError {
    RecordingError::NotARecording { file: path.to_owned(), what: what.to_owned() }
}

/// Images of the same time of the log; one without a partner is left out.
fn pairs(left: &[Place], right: &[Place]) -> Vec<[Place; 2]> {
    let partners = by_pair(right);
    let partner = |left: &Place| Some([*left, *partners.get(&(left.at, left.sequence))?]);
    left.iter().filter_map(partner).collect()
}

/// By time and number of the pair that they belong to.
fn by_pair(places: &[Place]) -> BTreeMap<(u64, u32), Place> {
    places.iter().map(|place| ((place.at, place.sequence), *place)).collect()
}

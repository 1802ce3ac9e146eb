//! A row per frame.

use std::path::Path;

use jiff::Timestamp;
use plumbline_model::Eye;
use plumbline_recording::Recording;
use serde_json::{Value, json};

use crate::data::{Column, TableWriter};
use crate::error::ExportError;
use crate::frames::{Frame, Frames};
use crate::meta::{self, About};
use crate::statistics::Statistics;

/// Images that the statistics look at, spread over all.
const LOOKED_AT: usize = 20;
/// Of a pair of which nobody knows where the eyes were: no number.
const UNKNOWN_PLACE: [f32; 16] = [f32::NAN; 16];

/// Names of the columns that there are, in their order, whatever that of the keys of JSON is.
pub(crate) fn names(about: &About<'_>) -> Vec<&'static str> {
    let is_there = |name: &&str| match *name {
        meta::ACTION => !about.actions.is_empty(),
        meta::PLACES => about.has_places,
        _ => true,
    };
    let all = [
        meta::image_key(Eye::Left),
        meta::image_key(Eye::Right),
        meta::STATE,
        meta::ACTION,
        meta::CAPTURED,
        "timestamp",
        "frame_index",
        "episode_index",
        "index",
        "task_index",
        meta::PLACES,
    ];
    all.into_iter().filter(is_there).collect()
}

/// The kinds of the columns as readers of Hugging Face know them.
pub(crate) fn hugging_face(about: &About<'_>) -> (String, String) {
    let one = |dtype: &str| json!({ "dtype": dtype, "_type": "Value" });
    let list = |length: usize| match length {
        1 => one("float32"),
        length => json!({ "feature": one("float32"), "length": length, "_type": "Sequence" }),
    };
    let kind = |name: &str| match name {
        meta::STATE => list(about.joints.len()),
        meta::ACTION => list(about.actions.len()),
        meta::PLACES => list(UNKNOWN_PLACE.len()),
        meta::CAPTURED => one("float64"),
        "timestamp" => one("float32"),
        image if image.starts_with("observation.images") => json!({ "_type": "Image" }),
        _ => one("int64"),
    };
    let features: serde_json::Map<String, Value> =
        names(about).into_iter().map(|name| (name.to_owned(), kind(name))).collect();
    ("huggingface".to_owned(), json!({ "info": { "features": features } }).to_string())
}

/// The rows, group by group.
pub(crate) struct Rows<'a> {
    recording: &'a Path,
    names: Vec<&'static str>,
    rate_hz: f64,
    every: usize,
    first: Option<Timestamp>,
    written: usize,
    of_state: Statistics,
    of_action: Statistics,
    of_places: Statistics,
    of_time: Statistics,
    of_captured: Statistics,
    of_number: Statistics,
    of_zero: Statistics,
    of_images: [Statistics; 2],
}

/// What is gathered of a group of frames.
#[derive(Default)]
struct Gathered {
    images: [Vec<(Vec<u8>, String)>; 2],
    state: Vec<f32>,
    action: Vec<f32>,
    captured_s: Vec<f64>,
    time_s: Vec<f32>,
    number: Vec<i64>,
    places: Vec<f32>,
}

impl<'a> Rows<'a> {
    pub fn new(recording: &'a Path, about: &About<'_>) -> Self {
        Self {
            recording,
            names: names(about),
            rate_hz: about.rate_hz.round().max(1.0),
            every: about.frames.div_ceil(LOOKED_AT).max(1),
            first: None,
            written: 0,
            of_state: Statistics::default(),
            of_action: Statistics::default(),
            of_places: Statistics::default(),
            of_time: Statistics::default(),
            of_captured: Statistics::default(),
            of_number: Statistics::default(),
            of_zero: Statistics::default(),
            of_images: Default::default(),
        }
    }

    /// How many there are so far.
    pub fn written(&self) -> usize {
        self.written
    }

    pub fn write(
        &mut self,
        table: &mut TableWriter<'_>,
        recording: &mut Recording,
        of: &Frames,
        group: &[Frame],
    ) -> Result<(), ExportError> {
        let mut gathered = Gathered::default();
        for frame in group {
            let pair = recording.pair(frame.pair)?;
            for (eye, jpeg) in pair.images.into_iter().enumerate() {
                if self.written.is_multiple_of(self.every) {
                    self.look(eye, &jpeg.0, frame.pair)?;
                }
                gathered.images[eye].push((jpeg.0, format!("frame-{:06}.jpg", self.written)));
            }
            self.gather(of, frame, &mut gathered);
            self.written += 1;
        }
        table.rows(&self.columns(of, gathered, group.len()))
    }

    fn gather(&mut self, of: &Frames, frame: &Frame, gathered: &mut Gathered) {
        let double = |values: &[f32]| values.iter().map(|value| f64::from(*value)).collect::<Vec<_>>();
        let (state, action) = (of.angles(frame), of.commanded(frame));
        self.of_state.add(double(&state));
        self.of_action.add(double(&action));
        gathered.state.extend(state);
        gathered.action.extend(action);
        match frame.robot_from_left {
            Some(rows) => {
                self.of_places.add(rows.iter().flatten().copied());
                gathered.places.extend(rows.iter().flatten().map(|value| *value as f32));
            }
            None => gathered.places.extend(UNKNOWN_PLACE),
        }
        let number = self.written;
        let time_s = number as f64 / self.rate_hz;
        let captured_s = frame.at.duration_since(*self.first.get_or_insert(frame.at)).as_secs_f64();
        self.of_time.add([time_s]);
        self.of_captured.add([captured_s]);
        self.of_number.add([number as f64]);
        self.of_zero.add([0.0]);
        gathered.time_s.push(time_s as f32);
        gathered.captured_s.push(captured_s);
        gathered.number.push(number as i64);
    }

    /// In the order of the names.
    fn columns(&self, of: &Frames, gathered: Gathered, rows: usize) -> Vec<Column> {
        let [left, right] = gathered.images;
        let zeros = || Column::Integers(vec![0; rows]);
        let numbers = || Column::Integers(gathered.number.clone());
        let all = [
            (meta::image_key(Eye::Left), Column::Images(left)),
            (meta::image_key(Eye::Right), Column::Images(right)),
            (meta::STATE, numbers_of(of.joints.len(), gathered.state)),
            (meta::ACTION, numbers_of(of.actions.len(), gathered.action)),
            (meta::CAPTURED, Column::Doubles(gathered.captured_s)),
            ("timestamp", Column::Floats(gathered.time_s)),
            ("frame_index", numbers()),
            ("episode_index", zeros()),
            ("index", numbers()),
            ("task_index", zeros()),
            (meta::PLACES, Column::FloatLists(UNKNOWN_PLACE.len(), gathered.places)),
        ];
        all.into_iter().filter(|(name, _)| self.names.contains(name)).map(|(_, column)| column).collect()
    }

    /// Colors of an image, 0 to 1.
    fn look(&mut self, eye: usize, jpeg: &[u8], pair: usize) -> Result<(), ExportError> {
        for pixel in decoded(self.recording, jpeg, pair)?.pixels().step_by(97) {
            self.of_images[eye].add(pixel.0.map(|channel| f64::from(channel) / 255.0));
        }
        Ok(())
    }

    /// Of every column.
    pub fn statistics(&self) -> Value {
        let of = |name: &&'static str| {
            let number = |value: f64| json!(value);
            let told = match *name {
                meta::STATE => self.of_state.json(number),
                meta::ACTION => self.of_action.json(number),
                meta::PLACES => self.of_places.json(number),
                meta::CAPTURED => self.of_captured.json(number),
                "timestamp" => self.of_time.json(number),
                "frame_index" | "index" => self.of_number.json(number),
                "episode_index" | "task_index" => self.of_zero.json(number),
                image => {
                    let eye = usize::from(image == meta::image_key(Eye::Right));
                    self.of_images[eye].json(|value| json!([[value]]))
                }
            };
            ((*name).to_owned(), told)
        };
        Value::Object(self.names.iter().map(of).collect())
    }
}

/// So many numbers per row. The layout has one number alone without a list around it.
fn numbers_of(length: usize, values: Vec<f32>) -> Column {
    if length == 1 { Column::Floats(values) } else { Column::FloatLists(length, values) }
}

/// An image of a pair (counted from 0).
pub(crate) fn decoded(recording: &Path, jpeg: &[u8], pair: usize) -> Result<image::RgbImage, ExportError> {
    let image = image::load_from_memory(jpeg).map_err(|error| ExportError::Image {
        recording: recording.to_owned(),
        pair: pair + 1,
        reason: error.to_string(),
    })?;
    Ok(image.to_rgb8())
}

//! From a recording to the files of a data set.

use std::path::Path;

use jiff::Timestamp;
use plumbline_model::{Eye, JobContext, StereoCameras, files};
use plumbline_recording::{JointReading, RecordedPair, Recording, Told};
use serde_json::json;

use crate::data::{Column, TableWriter, write_table};
use crate::error::ExportError;
use crate::meta::{self, About, FIRST_DATA, FIRST_EPISODES};
use crate::statistics::Statistics;

/// Rows of a group: so many pairs are in memory at once.
const GROUP: usize = 100;
/// Images that the statistics look at, spread over all.
const LOOKED_AT: usize = 20;

/// What is said with the data.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// What was being done, a sentence.
    pub task: &'a str,
    /// Lenses and how the eyes sit to each other.
    pub cameras: Option<&'a StereoCameras>,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// Pairs of images.
    pub frames: usize,
    /// Pairs from before angles were read: not in it.
    pub left_out: usize,
    /// Pairs a second, by the median of the times between them.
    pub rate_hz: f64,
    /// Joints whose angles are in it.
    pub joints: Vec<String>,
    /// Whether it says for each pair where the left eye was in the robot.
    pub has_places: bool,
}

/// Writes a data set with one episode into an empty or a new folder.
///
/// # Errors
/// When the recording cannot be read, has nothing that makes a frame, or the folder cannot be written.
pub fn export(
    recording: &Path,
    folder: &Path,
    options: &Options<'_>,
    context: &dyn JobContext,
) -> Result<Exported, ExportError> {
    if folder.read_dir().is_ok_and(|mut inside| inside.next().is_some()) {
        return Err(ExportError::NotEmpty(folder.to_owned()));
    }
    let mut opened = Recording::open(recording)?;
    let readings = opened.joints()?;
    let places = opened.robot_from_left()?;
    let names = joint_names(&readings);
    let frames = frames(&opened, &readings, &places);
    if frames.is_empty() || names.is_empty() {
        return Err(ExportError::NoFrames(recording.to_owned()));
    }
    let captured: Vec<Timestamp> = frames.iter().map(|frame| frame.at).collect();
    let rate_hz = rate_hz(&captured);
    let image = dimensions(recording, &opened.pair(frames[0].pair)?, frames[0].pair)?;
    let robot = opened.whose().rig.clone().unwrap_or_else(|| "unknown".to_owned());
    let has_places = frames.iter().all(|frame| frame.robot_from_left.is_some());
    let about = About { robot: &robot, joints: &names, image, frames: frames.len(), rate_hz, has_places };
    let mut rows = Rows::new(recording, &about);
    let features = json!({ "info": { "features": hugging_face(&about) } }).to_string();
    let told = vec![("huggingface".to_owned(), features)];
    write_table(&folder.join(FIRST_DATA), order(has_places), told, |table| {
        for group in frames.chunks(GROUP) {
            context.checkpoint()?;
            context.report(rows.written as f64 / frames.len() as f64, "writing rows");
            rows.write(table, &mut opened, &readings, &names, group)?;
        }
        Ok(())
    })?;
    let left_out = opened.pair_count() - frames.len();
    let statistics = rows.statistics();
    tables(folder, options.task, frames.len())?;
    meta::write_json(&folder.join("meta/info.json"), &meta::info(&about))?;
    meta::write_json(&folder.join("meta/stats.json"), &statistics)?;
    if let Some(cameras) = options.cameras {
        meta::write_json(&folder.join("meta/cameras.json"), &meta::cameras(cameras))?;
    }
    for attached in opened.attached() {
        // Names come from a file that anybody may have written.
        let Some(name) = Path::new(&attached.name).file_name() else { continue };
        let file = folder.join("meta").join(name);
        if !file.exists() {
            files::write(&file, &attached.bytes)?;
        }
    }
    Ok(Exported { frames: frames.len(), left_out, rate_hz, joints: names, has_places })
}

/// A pair that is in the data set, and the reading before it.
struct Frame {
    pair: usize,
    reading: usize,
    at: Timestamp,
    /// Where the left eye was in the robot: rows of a matrix 4 by 4.
    robot_from_left: Option<[[f64; 4]; 4]>,
}

fn frames(
    recording: &Recording,
    readings: &[Told<Vec<JointReading>>],
    places: &[Told<[[f64; 4]; 4]>],
) -> Vec<Frame> {
    let frame = |pair: usize| {
        let at = recording.captured_at(pair)?;
        let reading = readings.partition_point(|reading| reading.at <= at).checked_sub(1)?;
        // It is written with each pair; what is older was of another posture of the head.
        let place = places.partition_point(|place| place.at <= at).checked_sub(1).map(|k| &places[k]);
        let robot_from_left = place.filter(|place| place.at == at).map(|place| place.what);
        Some(Frame { pair, reading, at, robot_from_left })
    };
    (0..recording.pair_count()).filter_map(frame).collect()
}

/// Joints of the first reading: of those each pair from then on has an angle.
fn joint_names(readings: &[Told<Vec<JointReading>>]) -> Vec<String> {
    readings
        .first()
        .map_or_else(Vec::new, |first| first.what.iter().map(|joint| joint.name.clone()).collect())
}

fn seconds(from: Timestamp, to: Timestamp) -> f64 {
    to.duration_since(from).as_secs_f64()
}

fn rate_hz(captured: &[Timestamp]) -> f64 {
    let mut apart: Vec<f64> = captured.windows(2).map(|two| seconds(two[0], two[1])).collect();
    apart.sort_by(f64::total_cmp);
    apart.get(apart.len() / 2).filter(|s| **s > 1e-4).map_or(1.0, |s| 1.0 / s)
}

fn dimensions(recording: &Path, pair: &RecordedPair, number: usize) -> Result<[u32; 2], ExportError> {
    let image = decoded(recording, &pair.images[0].0, number)?;
    Ok([image.height(), image.width()])
}

fn decoded(recording: &Path, jpeg: &[u8], number: usize) -> Result<image::RgbImage, ExportError> {
    let image = image::load_from_memory(jpeg).map_err(|error| ExportError::Image {
        recording: recording.to_owned(),
        pair: number + 1,
        reason: error.to_string(),
    })?;
    Ok(image.to_rgb8())
}

/// The rows, group by group.
struct Rows<'a> {
    recording: &'a Path,
    rate_hz: f64,
    every: usize,
    has_places: bool,
    first: Option<Timestamp>,
    written: usize,
    of_state: Statistics,
    of_places: Statistics,
    of_time: Statistics,
    of_captured: Statistics,
    of_number: Statistics,
    of_zero: Statistics,
    of_images: [Statistics; 2],
}

impl<'a> Rows<'a> {
    fn new(recording: &'a Path, about: &About<'_>) -> Self {
        Self {
            recording,
            rate_hz: about.rate_hz.round().max(1.0),
            every: about.frames.div_ceil(LOOKED_AT).max(1),
            has_places: about.has_places,
            first: None,
            written: 0,
            of_state: Statistics::default(),
            of_places: Statistics::default(),
            of_time: Statistics::default(),
            of_captured: Statistics::default(),
            of_number: Statistics::default(),
            of_zero: Statistics::default(),
            of_images: Default::default(),
        }
    }

    fn write(
        &mut self,
        table: &mut TableWriter<'_>,
        recording: &mut Recording,
        readings: &[Told<Vec<JointReading>>],
        names: &[String],
        group: &[Frame],
    ) -> Result<(), ExportError> {
        let mut images: [Vec<(Vec<u8>, String)>; 2] = Default::default();
        let (mut state, mut captured, mut times, mut numbers) = (vec![], vec![], vec![], vec![]);
        let mut places: Vec<f32> = vec![];
        for frame in group {
            let number = self.written;
            let first = *self.first.get_or_insert(frame.at);
            let pair = recording.pair(frame.pair)?;
            for (eye, jpeg) in pair.images.into_iter().enumerate() {
                if number.is_multiple_of(self.every) {
                    self.look(eye, &jpeg.0, frame.pair)?;
                }
                images[eye].push((jpeg.0, format!("frame-{number:06}.jpg")));
            }
            let angles = angles(&readings[..=frame.reading], names);
            self.of_state.add(angles.iter().map(|angle| f64::from(*angle)));
            state.extend(angles);
            if let Some(rows) = frame.robot_from_left.filter(|_| self.has_places) {
                self.of_places.add(rows.iter().flatten().copied());
                places.extend(rows.iter().flatten().map(|value| *value as f32));
            }
            let time = number as f64 / self.rate_hz;
            let at_s = seconds(first, frame.at);
            self.of_time.add([time]);
            self.of_captured.add([at_s]);
            self.of_number.add([number as f64]);
            self.of_zero.add([0.0]);
            times.push(time as f32);
            captured.push(at_s);
            numbers.push(number as i64);
            self.written += 1;
        }
        let zeros = vec![0; group.len()];
        let [left, right] = images;
        let mut columns = vec![
            Column::Images(left),
            Column::Images(right),
            Column::FloatLists(names.len(), state),
            Column::Doubles(captured),
            Column::Floats(times),
            Column::Integers(numbers.clone()),
            Column::Integers(zeros.clone()),
            Column::Integers(numbers),
            Column::Integers(zeros),
        ];
        if self.has_places {
            columns.push(Column::FloatLists(16, places));
        }
        table.rows(&columns)
    }

    /// Colors of an image, 0 to 1.
    fn look(&mut self, eye: usize, jpeg: &[u8], pair: usize) -> Result<(), ExportError> {
        for pixel in decoded(self.recording, jpeg, pair)?.pixels().step_by(97) {
            self.of_images[eye].add(pixel.0.map(|channel| f64::from(channel) / 255.0));
        }
        Ok(())
    }

    fn statistics(&self) -> serde_json::Value {
        let number = |value: f64| json!(value);
        let image = |eye: usize| self.of_images[eye].json(|value| json!([[value]]));
        let mut all = json!({
            meta::image_key(Eye::Left): image(0),
            meta::image_key(Eye::Right): image(1),
            "observation.state": self.of_state.json(number),
            "observation.captured_s": self.of_captured.json(number),
            "timestamp": self.of_time.json(number),
            "frame_index": self.of_number.json(number),
            "index": self.of_number.json(number),
            "episode_index": self.of_zero.json(number),
            "task_index": self.of_zero.json(number),
        });
        if self.has_places {
            all[meta::PLACES] = self.of_places.json(number);
        }
        all
    }
}

/// The order of the columns, whatever that of the keys of JSON is.
const ORDER: [&str; 10] = [
    "observation.images.left_eye",
    "observation.images.right_eye",
    "observation.state",
    "observation.captured_s",
    "timestamp",
    "frame_index",
    "episode_index",
    "index",
    "task_index",
    meta::PLACES,
];

/// The columns that there are.
fn order(has_places: bool) -> &'static [&'static str] {
    if has_places { &ORDER } else { &ORDER[..ORDER.len() - 1] }
}

/// Angles of joints as each was read last, rad.
fn angles(readings: &[Told<Vec<JointReading>>], names: &[String]) -> Vec<f32> {
    let last = |name: &String| {
        let all = readings.iter().rev().flat_map(|reading| &reading.what);
        all.into_iter().find(|joint| joint.name == *name).map(|joint| joint.angle_rad as f32)
    };
    names.iter().filter_map(last).collect()
}

/// The kinds of the columns as readers of Hugging Face know them.
fn hugging_face(about: &About<'_>) -> serde_json::Value {
    let one = |dtype: &str| json!({ "dtype": dtype, "_type": "Value" });
    let mut all = json!({
        ORDER[0]: { "_type": "Image" },
        ORDER[1]: { "_type": "Image" },
        ORDER[2]: { "feature": one("float32"), "length": about.joints.len(), "_type": "Sequence" },
        ORDER[3]: one("float64"),
        ORDER[4]: one("float32"),
        ORDER[5]: one("int64"),
        ORDER[6]: one("int64"),
        ORDER[7]: one("int64"),
        ORDER[8]: one("int64"),
    });
    if about.has_places {
        all[meta::PLACES] = json!({ "feature": one("float32"), "length": 16, "_type": "Sequence" });
    }
    all
}

/// The one task, and the one episode.
fn tables(folder: &Path, task: &str, frames: usize) -> Result<(), ExportError> {
    let index = json!({
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [
            { "name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": null },
            { "name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": null },
        ],
        "pandas_version": "2.0.0",
    });
    let about = vec![("pandas".to_owned(), index.to_string())];
    write_table(&folder.join("meta/tasks.parquet"), &["task_index", "task"], about, |table| {
        table.rows(&[Column::Integers(vec![0]), Column::Texts(vec![task.to_owned()])])
    })?;
    let names = [
        "episode_index",
        "tasks",
        "length",
        "data/chunk_index",
        "data/file_index",
        "dataset_from_index",
        "dataset_to_index",
        "meta/episodes/chunk_index",
        "meta/episodes/file_index",
    ];
    let frames = frames as i64;
    let number = |value: i64| Column::Integers(vec![value]);
    let columns = [
        number(0),
        Column::TextLists(vec![task.to_owned()]),
        number(frames),
        number(0),
        number(0),
        number(0),
        number(frames),
        number(0),
        number(0),
    ];
    write_table(&folder.join(FIRST_EPISODES), &names, vec![], |table| table.rows(&columns))
}

//! From a recording to the files of a data set.

use std::path::Path;

use jiff::Timestamp;
use plumbline_model::formats::native;
use plumbline_model::{JobContext, StereoCameras, files};
use plumbline_recording::{RecordedPair, Recording};

use crate::data::write_table;
use crate::error::ExportError;
use crate::frames::{Frames, NotCommanded};
use crate::meta::{self, About, FIRST_DATA};
use crate::rows::{self, Rows, decoded};
use crate::tables;

/// Rows of a group: so many pairs are in memory at once.
const GROUP: usize = 100;

/// The calibration that a recording carries.
const CARRIED: &str = "rig-cameras.yaml";

/// What is said with the data.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// What was being done, a sentence.
    pub task: &'a str,
    /// Lenses and how the eyes sit to each other; `None`: those that the recording carries.
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
    /// Those of them whose commanded angles are in it as `action`: they held, or went where they were told to, in
    /// every pair.
    pub actions: Vec<String>,
    /// The others, and in how many pairs they were told nothing.
    pub not_commanded: Vec<NotCommanded>,
    /// Whether lenses and how the eyes sit to each other are in it.
    pub has_cameras: bool,
    /// Whether it says where the left eye was in the robot.
    pub has_places: bool,
    /// Pairs of which that is not known.
    pub without_place: usize,
}

/// Writes a data set with one episode into an empty or a new folder.
///
/// # Errors
/// When the recording cannot be read, has nothing that makes a frame, the folder cannot be written, or it is cancelled;
/// then nothing of it stays.
pub fn export(
    recording: &Path,
    folder: &Path,
    options: &Options<'_>,
    context: &dyn JobContext,
) -> Result<Exported, ExportError> {
    // A folder that cannot be looked into may hold anything.
    let is_free = match folder.read_dir() {
        Ok(mut inside) => inside.next().is_none(),
        Err(why) => why.kind() == std::io::ErrorKind::NotFound,
    };
    if !is_free {
        return Err(ExportError::NotEmpty(folder.to_owned()));
    }
    let was_there = folder.is_dir();
    files::make_folder(folder)?;
    // Whoever exports to it at the same time may have been faster: what that one writes is not touched.
    if !files::make_new_folder(&folder.join("meta"))? {
        return Err(ExportError::NotEmpty(folder.to_owned()));
    }
    let exported = write(recording, folder, options, context);
    if exported.is_err() {
        take_back(folder, was_there);
    }
    exported
}

/// What was written of a data set that is not whole: whoever tries again finds the folder as it was.
fn take_back(folder: &Path, was_there: bool) {
    for part in ["meta", "data"] {
        // What cannot be taken back is in the way of the next try, which says so.
        let _ = std::fs::remove_dir_all(folder.join(part));
    }
    if !was_there {
        let _ = std::fs::remove_dir(folder);
    }
}

fn write(
    recording: &Path,
    folder: &Path,
    options: &Options<'_>,
    context: &dyn JobContext,
) -> Result<Exported, ExportError> {
    let mut opened = Recording::open(recording)?;
    let of = Frames::of(&mut opened)?;
    let Some(first) = of.frames.first().filter(|_| !of.joints.is_empty()) else {
        return Err(ExportError::NoFrames(recording.to_owned()));
    };
    let image = dimensions(recording, &opened.pair(first.pair)?, first.pair)?;
    let robot = opened.whose().rig.clone().unwrap_or_else(|| "unknown".to_owned());
    let without_place = of.frames.iter().filter(|frame| frame.robot_from_left.is_none()).count();
    let about = About {
        robot: &robot,
        joints: &of.joints,
        actions: &of.actions,
        image,
        frames: of.frames.len(),
        rate_hz: rate_hz(&of.frames.iter().map(|frame| frame.at).collect::<Vec<_>>()),
        has_places: without_place < of.frames.len(),
    };
    keep_attached(&opened, folder)?;
    let mut rows = Rows::new(recording, &about);
    let names = rows::names(&about);
    write_table(&folder.join(FIRST_DATA), &names, vec![rows::hugging_face(&about)], |table| {
        for group in of.frames.chunks(GROUP) {
            context.checkpoint()?;
            context.report(rows.written() as f64 / of.frames.len() as f64, "writing rows");
            rows.write(table, &mut opened, &of, group)?;
        }
        Ok(())
    })?;
    let statistics = rows.statistics();
    tables::write(folder, options.task, of.frames.len())?;
    meta::write_json(&folder.join("meta/info.json"), &meta::info(&about))?;
    meta::write_json(&folder.join("meta/stats.json"), &statistics)?;
    let cameras = options.cameras.copied().or_else(|| carried(folder));
    if let Some(cameras) = &cameras {
        meta::write_json(&folder.join("meta/cameras.json"), &meta::cameras(cameras))?;
    }
    Ok(Exported {
        frames: about.frames,
        left_out: opened.pair_count() - about.frames,
        rate_hz: about.rate_hz,
        has_cameras: cameras.is_some(),
        has_places: about.has_places,
        joints: of.joints,
        actions: of.actions,
        not_commanded: of.not_commanded,
        without_place,
    })
}

/// Lenses and how the eyes sit to each other, as the recording carries them; `None`: it carries none that can be read.
fn carried(folder: &Path) -> Option<StereoCameras> {
    native::read(&folder.join("meta").join(CARRIED)).ok().map(|calibration| calibration.cameras)
}

/// Files of the recording, beside what says of the set.
fn keep_attached(recording: &Recording, folder: &Path) -> Result<(), ExportError> {
    let meta = folder.join("meta");
    for attached in recording.attached() {
        // Names come from a file that anybody may have written.
        let Some(name) = Path::new(&attached.name).file_name() else { continue };
        let file = meta.join(name);
        if !file.exists() {
            files::write(&file, &attached.bytes)?;
        }
    }
    Ok(())
}

fn rate_hz(captured: &[Timestamp]) -> f64 {
    let apart = captured.windows(2).map(|two| two[1].duration_since(two[0]).as_secs_f64());
    let mut apart: Vec<f64> = apart.collect();
    apart.sort_by(f64::total_cmp);
    apart.get(apart.len() / 2).filter(|s| **s > 1e-4).map_or(1.0, |s| 1.0 / s)
}

fn dimensions(recording: &Path, pair: &RecordedPair, number: usize) -> Result<[u32; 2], ExportError> {
    let image = decoded(recording, &pair.images[0].0, number)?;
    Ok([image.height(), image.width()])
}

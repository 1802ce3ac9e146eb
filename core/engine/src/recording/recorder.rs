//! The thread that compresses and writes, so that nobody waits for a disk.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, Sender};
use image::RgbImage;
use jiff::Timestamp;
use plumbline_hardware::{QUALITY, encode_jpeg};
use plumbline_model::EyesThen;
use plumbline_recording::{
    Counts, EyePlaces, JointGoal, JointReading, Jpeg, Note, Outline, RecordingError, RecordingWriter, Topic,
};
use serde_json::Value;

/// What may wait for the disk: three seconds of pairs.
const WAITING: usize = 90;

/// Something to be written.
pub enum Item {
    /// A pair.
    Pair {
        /// When it was captured.
        at: Timestamp,
        /// Its number.
        number: u64,
        /// Left, right.
        images: [Arc<RgbImage>; 2],
        /// The images as the cameras have compressed them, where they did.
        jpegs: Option<[Arc<[u8]>; 2]>,
        /// The right image after the left one, s.
        right_later_s: Option<f64>,
        /// How the eyes were then.
        eyes: EyesThen,
        /// Where they were, where that is known.
        places: Option<Box<EyePlaces>>,
    },
    /// Angles of joints, and what they were told.
    Joints(Timestamp, Vec<JointReading>, Vec<JointGoal>),
    /// A message for the operator.
    Note(Timestamp, Note),
    /// What only this program knows.
    Told(Topic, Timestamp, Value),
    /// Things in the images of the pair of this time: left, right.
    Outlines(Timestamp, [Vec<Outline>; 2]),
}

/// A recording under way; all copies are of the same one, which ends when the last of them is dropped.
#[derive(Clone, Debug)]
pub struct Recorder {
    session: PathBuf,
    items: Option<Sender<Item>>,
    told: Arc<Told>,
}

/// What the thread tells.
#[derive(Debug, Default)]
struct Told {
    pairs: AtomicU64,
    bytes: AtomicU64,
    dropped: AtomicU64,
    thread: Mutex<Option<JoinHandle<Result<Written, RecordingError>>>>,
}

/// What is in the file in the end.
#[derive(Clone, Copy, Debug)]
pub struct Written {
    /// What was written.
    pub counts: Counts,
    /// Pairs and messages that are missing in it, as it says itself.
    pub dropped: u64,
}

/// Why a recording ended otherwise than asked.
#[derive(Debug, thiserror::Error)]
pub enum Broken {
    /// It could not be written.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The system gave no thread.
    #[error("the system gives no thread for the recording ({0}): close other programs")]
    NoThread(std::io::Error),
    /// A defect of this program.
    #[error("the recording ended by a mistake of this program; what was written is there")]
    Panicked,
}

impl Recorder {
    /// Begins to write.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn start(session: PathBuf, writer: RecordingWriter) -> Result<Self, Broken> {
        let (items, waiting) = crossbeam_channel::bounded(WAITING);
        let told = Arc::new(Told::default());
        let tells = told.clone();
        let thread = std::thread::Builder::new().name("recorder".to_owned());
        let thread = thread.spawn(move || write(writer, &waiting, &tells)).map_err(Broken::NoThread)?;
        *told.thread.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread);
        Ok(Self { session, items: Some(items), told })
    }

    /// The folder of its session.
    pub fn session(&self) -> &Path {
        &self.session
    }

    /// Hands something over; never waits. What does not fit is counted.
    pub fn put(&self, item: Item) {
        let Some(items) = &self.items else { return };
        if items.try_send(item).is_err() {
            self.told.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// So many pairs came that nobody could hand over.
    pub fn missed(&self, pairs: u64) {
        self.told.dropped.fetch_add(pairs, Ordering::Relaxed);
    }

    /// Pairs, bytes, and what was dropped.
    pub fn so_far(&self) -> (u64, u64, u64) {
        let read = |number: &AtomicU64| number.load(Ordering::Relaxed);
        (read(&self.told.pairs), read(&self.told.bytes), read(&self.told.dropped))
    }

    /// Whether its thread has ended by itself.
    pub fn is_broken(&self) -> bool {
        let thread = self.told.thread.lock().unwrap_or_else(PoisonError::into_inner);
        thread.as_ref().is_some_and(JoinHandle::is_finished)
    }

    /// Takes nothing more; what waits is still written.
    pub fn close(&mut self) {
        self.items = None;
    }

    /// Waits until everything is written. All other copies must be closed.
    ///
    /// # Errors
    /// Why it is not.
    pub fn finish(mut self) -> Result<Written, Broken> {
        self.close();
        let thread = self.told.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        match thread.map(JoinHandle::join) {
            Some(Ok(written)) => Ok(written?),
            Some(Err(_)) | None => Err(Broken::Panicked),
        }
    }
}

fn write(
    mut writer: RecordingWriter,
    items: &Receiver<Item>,
    told: &Told,
) -> Result<Written, RecordingError> {
    for item in items {
        match item {
            Item::Pair { at, number, images, jpegs, right_later_s, eyes, places } => {
                match compressed(images, jpegs) {
                    Some(jpegs) => {
                        writer.pair(at, number, jpegs, right_later_s)?;
                        writer.eyes(at, number, &eyes, places.as_deref())?;
                    }
                    // Only an image beyond what a JPEG can be; the next ones may be others.
                    None => _ = told.dropped.fetch_add(1, Ordering::Relaxed),
                }
            }
            Item::Joints(at, readings, goals) => {
                writer.joints(at, &readings)?;
                writer.goals(at, &goals)?;
            }
            Item::Note(at, note) => writer.note(at, &note)?,
            Item::Told(topic, at, value) => writer.told(topic, at, &value)?,
            Item::Outlines(at, seen) => writer.outlines(at, &seen)?,
        }
        let counts = writer.counts();
        told.pairs.store(counts.pairs, Ordering::Relaxed);
        told.bytes.store(counts.bytes, Ordering::Relaxed);
    }
    // Whoever hands over has ended, and so has counting.
    let dropped = told.dropped.load(Ordering::Relaxed);
    writer.set_dropped(dropped);
    Ok(Written { counts: writer.finish()?, dropped })
}

/// As the cameras sent them, else compressed now; `None`: beyond what a JPEG can be.
fn compressed(images: [Arc<RgbImage>; 2], jpegs: Option<[Arc<[u8]>; 2]>) -> Option<[Jpeg; 2]> {
    if let Some(jpegs) = jpegs {
        return Some(jpegs.map(|jpeg| Jpeg(jpeg.to_vec())));
    }
    let [left, right] = images.map(|image| encode_jpeg(&image, QUALITY).ok());
    Some([Jpeg(left?), Jpeg(right?)])
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use jiff::SignedDuration;
    use plumbline_recording::About;

    use super::*;

    /// Time that this thread was on a processor, s; `None` where the system does not say.
    fn on_processor_s() -> Option<f64> {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        told.split_whitespace().next()?.parse::<f64>().ok().map(|ns| 1e-9 * ns)
    }

    /// As large as NICO's, with as much in it as granite has.
    fn picture(number: u32) -> Arc<RgbImage> {
        Arc::new(RgbImage::from_fn(640, 480, |u, v| {
            let mut grain = ((u / 2 + number) * 0x9E37) ^ ((v / 2) * 0x85EB);
            grain = (grain ^ (grain >> 7)).wrapping_mul(0x2C1B_3C6D) >> 27;
            let shade = (90 + grain + 40 * ((u / 80 + v / 60) % 2)) as u8;
            Rgb([shade, shade - 12, shade - 30])
        }))
    }

    /// A measurement, with pictures as full of grain as a table of granite:
    /// `cargo test --release -p plumbline-engine --lib -- --ignored --nocapture thirty_pairs`.
    #[test]
    #[ignore = "measures time"]
    #[allow(clippy::print_stdout, reason = "a measurement")]
    fn thirty_pairs_a_second_take_a_tenth_of_a_core_at_most() {
        const PAIRS: u32 = 300;
        let folder = tempfile::tempdir().expect("a folder");
        let start: Timestamp = "2026-11-21T10:04:00Z".parse().expect("a time");
        let writer = RecordingWriter::create(&folder.path().join("log.mcap"), start, &About::default());
        let (items, waiting) = crossbeam_channel::bounded(PAIRS as usize);
        let pictures: Vec<_> = (0..8).map(picture).collect();
        for number in 0..PAIRS {
            let at = start + SignedDuration::from_millis(i64::from(number) * 1000 / 30);
            let images = [0, 1].map(|eye| pictures[(number as usize + 3 * eye) % 8].clone());
            let eyes = EyesThen { on_s: Some(1.0), head_rad: Some([0.0, -0.6]) };
            let (jpegs, right_later_s, places) = (None, None, None);
            let item = Item::Pair { at, number: number.into(), images, jpegs, right_later_s, eyes, places };
            items.send(item).expect("room");
        }
        drop(items);
        let before = on_processor_s().expect("this system says");
        let Written { counts, .. } =
            write(writer.expect("begun"), &waiting, &Told::default()).expect("written");
        let took_s = on_processor_s().expect("this system says") - before;
        let share = took_s * 30.0 / f64::from(PAIRS);
        println!(
            "{:.2} ms a pair of {:.0} kB, {:.1} % of a core at 30 pairs a second",
            1e3 * took_s / f64::from(PAIRS),
            1e-3 * counts.bytes as f64 / f64::from(PAIRS),
            1e2 * share
        );
        assert!(share <= 0.10, "{share}");
    }
}

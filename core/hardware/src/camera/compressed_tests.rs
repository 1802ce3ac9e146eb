//! Cameras that compress: what they send is what stands in a recording, from the buffer of the driver to the file
//! and back.

use std::time::Duration;

use image::{Rgb, RgbImage};
use jiff::{SignedDuration, Timestamp};
use opencv::core::Mat;
use plumbline_recording::{About, Recording, RecordingWriter};

use super::capture::captured;
use super::*;
use crate::jpeg;
use crate::recording_source::RecordingSource;
use crate::replay::Replay;

const SIZE: (u32, u32) = (64, 48);
/// As long as the longest frame could be, bytes.
const BUFFER: usize = 40_000;
const PERIOD: Duration = Duration::from_millis(40);
const PAIRS: usize = 30;
/// Each so manyth frame of a bad cable is cut.
const CUT_EVERY: u32 = 7;
/// Colors that two decoders may differ by, of 255, in the mean.
const DECODERS_DIFFER: f64 = 3.0;

/// What an eye sees in its frame of this number: each is another picture, and the larger ones are the longer files.
fn picture(eye: Eye, number: u32) -> RgbImage {
    let grain = number % 5;
    RgbImage::from_fn(SIZE.0, SIZE.1, |u, v| {
        let speck = if (u * 7 + v * 13 + number).is_multiple_of(6 - grain) { 60 } else { 0 };
        Rgb([(4 * (number % 40)) as u8, 100 + speck, if eye == Eye::Left { 40 } else { 200 }])
    })
}

fn sent(eye: Eye, number: u32) -> Vec<u8> {
    jpeg::encode(&picture(eye, number), jpeg::QUALITY).expect("small")
}

/// A camera that compresses, behind a driver that hands out all of its buffer whatever the length of the frame is.
struct CompressingCamera {
    eye: Eye,
    start: Instant,
    number: u32,
    buffer: Vec<u8>,
    has_bad_cable: bool,
    leaves_tables_out: bool,
}

impl CompressingCamera {
    fn new(eye: Eye) -> Self {
        let buffer = vec![0; BUFFER];
        Self { eye, start: Instant::now(), number: 0, buffer, has_bad_cable: false, leaves_tables_out: false }
    }
}

impl EyeCamera for CompressingCamera {
    fn grab(&mut self) -> Result<(), String> {
        std::thread::sleep((self.start + PERIOD * self.number).saturating_duration_since(Instant::now()));
        let mut frame = sent(self.eye, self.number);
        if self.leaves_tables_out {
            frame = jpeg::without_huffman_tables(&frame);
        }
        if self.has_bad_cable && self.number % CUT_EVERY == 3 {
            // The end does not come, and what stood in the buffer is not its end either.
            self.buffer.fill(0);
            frame.truncate(frame.len() / 2);
        }
        self.buffer[..frame.len()].copy_from_slice(&frame);
        self.number += 1;
        Ok(())
    }

    fn retrieve(&mut self) -> Result<Captured, String> {
        let length = i32::try_from(self.buffer.len()).expect("short");
        let received = Mat::new_rows_cols_with_bytes::<u8>(1, length, &self.buffer);
        captured(&received.expect("bytes").clone_pointee())
    }

    fn delivers(&self) -> Delivered {
        Delivered { size: SIZE, rate_hz: 1.0 / PERIOD.as_secs_f64() }
    }
}

/// Pairs of two such cameras until there are enough, and what the source counted.
fn pairs(left: CompressingCamera, right: CompressingCamera) -> (Vec<StereoFrame>, Counters) {
    let settings = CameraSettings { size: None, rate_hz: None, ..CameraSettings::default() };
    let cameras: [Box<dyn EyeCamera>; 2] = [Box::new(left), Box::new(right)];
    let mut source = CameraSource::start("compressing".to_owned(), cameras, settings).expect("two cameras");
    let deadline = Instant::now() + Duration::from_secs(20);
    let mut found = Vec::new();
    while found.len() < PAIRS {
        assert!(Instant::now() < deadline, "{} pairs in 20 s", found.len());
        match source.next_pair().expect("cameras that run") {
            Next::Pair(pair) => found.push(pair),
            Next::NotYet => std::thread::sleep(Duration::from_millis(1)),
            Next::End => panic!("cameras have no end"),
        }
    }
    (found, source.counters())
}

/// Which frame this was: only one has these bytes.
fn number_of(eye: Eye, jpeg: &[u8]) -> u32 {
    (0..1000).find(|number| sent(eye, *number) == jpeg).expect("it is a frame that was sent, to the byte")
}

#[test]
fn what_cameras_compress_is_recorded_to_the_byte_and_played_again() {
    let mut right = CompressingCamera::new(Eye::Right);
    right.has_bad_cable = true;
    let (pairs, counters) = pairs(CompressingCamera::new(Eye::Left), right);
    assert!(counters.unpaired_left > 0, "frames without a partner are counted: {counters:?}");

    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log.mcap");
    let start: Timestamp = "2026-11-21T10:04:00Z".parse().expect("a time");
    let mut writer = RecordingWriter::create(&file, start, &About::default()).expect("begun");
    let mut in_buffers = 0;
    for (number, pair) in (0..).zip(&pairs) {
        let jpegs = pair.beside.jpegs.clone().expect("both eyes compress");
        in_buffers += jpegs.iter().map(|jpeg| jpeg.len() as u64).sum::<u64>();
        let at = start + SignedDuration::from_millis(40 * number);
        let jpegs = jpegs.map(|jpeg| plumbline_recording::Jpeg(jpeg.to_vec()));
        writer.pair(at, pair.stamp.seq, jpegs, pair.time_difference_s).expect("written");
    }
    let counts = writer.finish().expect("finished");
    assert!(in_buffers < 2 * (PAIRS * BUFFER / 4) as u64, "the rest of the buffers is not kept");
    assert!(counts.bytes < in_buffers + 200 * 2 * PAIRS as u64, "{counts:?}");

    let mut recording = Recording::open(&file).expect("a recording");
    for (index, pair) in pairs.iter().enumerate() {
        let recorded = recording.pair(index).expect("readable");
        let [left, right] = &recorded.images;
        number_of(Eye::Left, &left.0);
        let number = number_of(Eye::Right, &right.0);
        assert!(number % CUT_EVERY != 3, "a frame that was cut is no image: {number}");
        let later_s = pair.time_difference_s.expect("cameras know it");
        assert!((recorded.right_later_s - later_s).abs() < 1e-6, "{later_s}");
    }

    let mut played = RecordingSource::open(&file, Replay::ONCE).expect("it plays");
    for pair in &pairs {
        let Next::Pair(shown) = played.next_pair().expect("readable") else { panic!("a pair is missing") };
        for (shown, live) in [(&shown.left, &pair.left), (&shown.right, &pair.right)] {
            let off: f64 = shown.iter().zip(live.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
            assert!(off / (live.len() as f64) < DECODERS_DIFFER, "it is shown as it was live: {off}");
        }
    }
}

#[test]
fn frames_without_their_tables_are_seen_and_left_to_be_compressed_anew() {
    let mut left = CompressingCamera::new(Eye::Left);
    left.leaves_tables_out = true;
    let (pairs, _) = pairs(left, CompressingCamera::new(Eye::Right));
    for pair in pairs {
        assert_eq!(pair.beside.jpegs, None, "no other program could read them");
        // Colors are half as sharp as brightness: each by itself may be off, all together are not.
        let blue = |image: &RgbImage| {
            image.pixels().map(|pixel| f64::from(pixel.0[2])).sum::<f64>() / f64::from(SIZE.0 * SIZE.1)
        };
        assert!((blue(&pair.left) - 40.0).abs() < 12.0 && (blue(&pair.right) - 200.0).abs() < 12.0);
    }
}

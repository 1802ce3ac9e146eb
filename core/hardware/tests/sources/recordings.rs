//! Recordings are played as they were made.

use std::time::Duration;

use image::{Rgb, RgbImage};
use jiff::{SignedDuration, Timestamp};
use plumbline_hardware::{
    Growth, Next, QUALITY, Replay, Report, SourceError, SourceKind, SourceOptions, SourceSpec, StereoSource,
    encode_jpeg, open,
};
use plumbline_model::EyesThen;
use plumbline_recording::{About, FILE, Jpeg, Recording, RecordingWriter};

/// Brighter with each pair, the right eye by 100.
fn gray(number: u64, eye: u8) -> u8 {
    10 * number as u8 + 100 * eye
}

fn image(number: u64, eye: u8) -> Jpeg {
    let image = RgbImage::from_pixel(64, 48, Rgb([gray(number, eye); 3]));
    Jpeg(encode_jpeg(&image, QUALITY).expect("a small image"))
}

/// Eight pairs at 20 Hz, then one a second later, in a session's folder.
fn session(of_twin: bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let start: Timestamp = "2026-11-21T10:04:00Z".parse().expect("a time");
    let about = About { of_twin, ..About::default() };
    let mut writer = RecordingWriter::create(&folder.path().join(FILE), start, &about).expect("begun");
    for number in 0..9 {
        let after_ms = if number == 8 { 1350 } else { 50 * number };
        let at = start + SignedDuration::from_millis(after_ms as i64);
        writer.pair(at, number, [image(number, 0), image(number, 1)], Some(0.002)).expect("written");
    }
    writer.finish().expect("finished");
    folder
}

fn source(folder: &std::path::Path, replay: Replay) -> Box<dyn StereoSource> {
    let spec = SourceSpec::from_paths(&[folder.to_owned()]).expect("a recording is in it");
    open(&spec, &SourceOptions { replay, ..SourceOptions::default() }).expect("opened")
}

/// Which pair a frame is of, by its brightness.
fn next(source: &mut dyn StereoSource) -> Option<u64> {
    loop {
        match source.next_pair().expect("readable") {
            Next::Pair(frame) => {
                let brightness = |image: &RgbImage| f64::from(image.get_pixel(30, 20).0[0]);
                let number = (brightness(&frame.left) / 10.0).round() as u64;
                assert!((brightness(&frame.right) - f64::from(gray(number, 1))).abs() < 3.0);
                let later_s = frame.time_difference_s.expect("recorded");
                assert!((later_s - 0.002).abs() < 1e-9, "{later_s}");
                return Some(number);
            }
            Next::End => return None,
            Next::NotYet => std::thread::sleep(Duration::from_millis(1)),
        }
    }
}

#[test]
fn all_pairs_are_delivered_in_order_and_wound_to() {
    let folder = session(true);
    let mut source = source(folder.path(), Replay::ONCE);
    let described = source.describe();
    assert_eq!((described.kind, described.pair_count), (SourceKind::Recording, Some(9)));
    assert_eq!(described.image_size, Some((64, 48)));
    assert_eq!((0..10).map_while(|_| next(source.as_mut())).collect::<Vec<_>>(), (0..9).collect::<Vec<_>>());
    source.as_finite().expect("it has an end").seek(5).expect("there are nine");
    assert_eq!(next(source.as_mut()), Some(5));
    let beyond = source.as_finite().expect("it has an end").seek(9);
    assert_eq!(beyond, Err(SourceError::NoSuchPair { index: 9, pairs: 9 }));
    assert_eq!(source.take_reports(), []);
}

#[test]
fn the_world_that_it_is_of_is_known_before_it_is_opened() {
    for of_twin in [false, true] {
        let folder = session(of_twin);
        let file = folder.path().join(FILE);
        let spec = SourceSpec::from_paths(std::slice::from_ref(&file)).expect("a recording");
        assert_eq!(spec, SourceSpec::Recording { file, of_twin });
    }
}

#[test]
fn a_recording_is_played_at_the_times_of_its_capture() {
    let folder = session(false);
    let mut source = source(folder.path(), Replay { looping: false, ..Replay::default() });
    let began = std::time::Instant::now();
    let times: Vec<f64> =
        (0..9).map(|_| next(source.as_mut()).map(|_| began.elapsed().as_secs_f64()).expect("nine")).collect();
    // A busy machine is late, never early.
    assert!(times[7] > 0.34 && times[8] - times[7] > 0.95, "{times:?}");
}

#[test]
fn what_was_cut_is_told_and_what_is_none_refused() {
    let folder = session(false);
    let file = folder.path().join(FILE);
    let bytes = std::fs::read(&file).expect("there");
    std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("written");
    match SourceSpec::from_paths(&[folder.path().to_owned()])
        .and_then(|spec| open(&spec, &SourceOptions::default()))
    {
        Ok(mut source) => assert_eq!(source.take_reports(), [Report::Cut { file: FILE.to_owned() }]),
        Err(error) => assert!(error.to_string().contains("holds no images"), "{error}"),
    }
    std::fs::write(&file, b"not a recording at all").expect("written");
    let refused = SourceSpec::from_paths(&[folder.path().to_owned()]).expect_err("it is none").to_string();
    assert!(refused.contains("is not a recording that can be read"), "{refused}");
}

/// Of a recording of nine pairs what was on disk when eight of them were closed.
fn eight_of(bytes: &[u8], file: &std::path::Path) {
    let cut = (1..bytes.len()).rev().step_by(16).find(|length| {
        std::fs::write(file, &bytes[..*length]).expect("written");
        Recording::open(file).is_ok_and(|recording| recording.pair_count() == 8)
    });
    assert!(cut.is_some(), "a part of it holds eight pairs");
}

#[test]
fn what_is_still_written_is_followed_until_it_ends() {
    let folder = session(false);
    let file = folder.path().join(FILE);
    let bytes = std::fs::read(&file).expect("there");
    eight_of(&bytes, &file);
    let mut source = source(folder.path(), Replay { looping: true, ..Replay::ONCE });
    assert_eq!(next(source.as_mut()), Some(0));
    let finite = source.as_finite().expect("it has an end");
    assert_eq!(finite.growth(), Growth::Open);
    finite.follow(true).expect("readable");
    assert_eq!(finite.growth(), Growth::Followed);
    assert_eq!(next(source.as_mut()), Some(7), "at its end at once");
    assert!(matches!(source.next_pair(), Ok(Next::NotYet)), "it does not begin again");
    std::fs::write(&file, &bytes).expect("written");
    assert_eq!(next(source.as_mut()), Some(8));
    assert_eq!(next(source.as_mut()), None, "it was finished");
    assert_eq!(source.describe().pair_count, Some(9));
    let told: Vec<String> = source.take_reports().iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("was finished")), "{told:?}");
    let finite = source.as_finite().expect("it has an end");
    finite.follow(true).expect("readable");
    assert_eq!(finite.growth(), Growth::Ended, "nothing comes any more");
}

#[test]
fn how_the_eyes_were_comes_with_each_pair() {
    let folder = tempfile::tempdir().expect("a folder");
    let start: Timestamp = "2026-11-21T10:04:00Z".parse().expect("a time");
    let file = folder.path().join(FILE);
    let mut writer = RecordingWriter::create(&file, start, &About::default()).expect("begun");
    let then = EyesThen { on_s: Some(600.0), head_rad: Some([0.1, -0.6]) };
    writer.pair(start, 0, [image(0, 0), image(0, 1)], None).expect("written");
    writer.eyes(start, 0, &then, None).expect("written");
    writer.finish().expect("finished");
    let mut source = source(folder.path(), Replay::ONCE);
    let Ok(Next::Pair(frame)) = source.next_pair() else { panic!("it has one") };
    assert_eq!(frame.beside.then, Some(then));
}

//! Pairs of video files.

use std::path::Path;
use std::time::{Duration, Instant};

use opencv::core::{Mat, Scalar, Size};
use opencv::prelude::*;
use opencv::videoio::VideoWriter;
use plumbline_hardware::{Next, Replay, SourceError, StereoSource, VideoSource};

use crate::world::{World, collect, reports};

/// Writes an uncompressed-looking video whose frame N is gray 10 N.
fn film(path: &Path, frames: u8, rate_hz: f64, size: (i32, i32)) {
    let mjpg = VideoWriter::fourcc('M', 'J', 'P', 'G').expect("a code");
    let mut writer =
        VideoWriter::new(path, mjpg, rate_hz, Size::new(size.0, size.1), true).expect("a writer");
    assert!(writer.is_opened().expect("a state"), "this OpenCV writes no MJPG video");
    for frame in 0..frames {
        let gray = Scalar::all(f64::from(frame) * 10.0);
        let image =
            Mat::new_rows_cols_with_default(size.1, size.0, opencv::core::CV_8UC3, gray).expect("a frame");
        writer.write(&image).expect("writing a frame");
    }
    writer.release().expect("closing the file");
}

fn two_films(world: &World, left: (u8, f64), right: (u8, f64)) -> VideoSource {
    film(&world.at("left.avi"), left.0, left.1, (64, 48));
    film(&world.at("right.avi"), right.0, right.1, (64, 48));
    VideoSource::open(&world.at("left.avi"), &world.at("right.avi"), Replay::ONCE).expect("two videos")
}

/// Frame numbers (left, right) of the pairs.
fn numbers(source: &mut VideoSource, limit: usize) -> Vec<(u8, u8)> {
    // JPEG keeps flat gray to within a value or two.
    let number = |gray: u8| (gray + 5) / 10;
    collect(source, limit)
        .expect("a running source")
        .iter()
        .map(|pair| (number(pair.left.get_pixel(9, 9).0[0]), number(pair.right.get_pixel(9, 9).0[0])))
        .collect()
}

#[test]
fn equal_videos_pair_frame_by_frame() {
    let world = World::new();
    let mut source = two_films(&world, (12, 25.0), (12, 25.0));
    assert_eq!(source.describe().pair_count, Some(12));
    assert_eq!(source.describe().image_size, Some((64, 48)));
    assert_eq!(numbers(&mut source, 100), (0..12).map(|i| (i, i)).collect::<Vec<_>>());
    assert!(matches!(source.next_pair(), Ok(Next::End)));
    assert_eq!(reports(&mut source), [""; 0]);
}

#[test]
fn different_rates_pair_by_time_and_the_shorter_one_ends() {
    let world = World::new();
    let mut source = two_films(&world, (20, 30.0), (8, 15.0));
    assert_eq!(numbers(&mut source, 100), (0..8).map(|i| (2 * i, i)).collect::<Vec<_>>());
    assert!(source.counters().unpaired_left >= 7);
    let told = reports(&mut source);
    assert!(told[0].contains("the left video has 30.00 frames per second, the right 15.00"), "{told:?}");
    assert!(told[1].contains("the left video has 20 frames, the right 8"), "{told:?}");
}

#[test]
fn winding_and_looping() {
    let world = World::new();
    let mut source = two_films(&world, (12, 25.0), (12, 25.0));
    for index in [7, 2, 0] {
        source.as_finite().expect("finite").seek(index).expect("it is there");
        assert_eq!(source.as_finite().expect("finite").position(), index);
        let index = u8::try_from(index).expect("small");
        assert_eq!(numbers(&mut source, 2), [(index, index), (index + 1, index + 1)]);
    }
    let finite = source.as_finite().expect("finite");
    assert_eq!(finite.seek(12), Err(SourceError::NoSuchPair { index: 12, pairs: 12 }));
    finite.set_replay(Replay { looping: true, ..Replay::ONCE }).expect("a rate");
    finite.seek(10).expect("it is there");
    assert_eq!(numbers(&mut source, 4), [(10, 10), (11, 11), (0, 0), (1, 1)]);
}

#[test]
fn replay_takes_as_long_as_the_recording() {
    let world = World::new();
    film(&world.at("left.avi"), 11, 20.0, (64, 48));
    film(&world.at("right.avi"), 11, 20.0, (64, 48));
    let replay = Replay { looping: false, ..Replay::default() };
    let mut source =
        VideoSource::open(&world.at("left.avi"), &world.at("right.avi"), replay).expect("two videos");
    let start = Instant::now();
    assert_eq!(collect(&mut source, 100).expect("pairs").len(), 11);
    let took = start.elapsed();
    assert!((Duration::from_millis(480)..Duration::from_millis(1500)).contains(&took), "{took:?}");
}

#[test]
fn files_that_are_no_pair_of_videos_are_refused_precisely() {
    let world = World::new();
    film(&world.at("left.avi"), 4, 25.0, (64, 48));
    film(&world.at("large.avi"), 4, 25.0, (128, 96));
    world.write("text.avi", "this is no video");
    world.write("empty.avi", "");
    let left = world.at("left.avi");
    let cases = [
        ("gone.avi", "gone.avi cannot be played: there is no such file"),
        ("text.avi", "text.avi cannot be played: it is not a video"),
        ("empty.avi", "empty.avi cannot be played: the file is empty"),
        ("large.avi", "its frames are 128x96 px, those of the left video 64x48 px"),
        ("left.avi", "was given for both eyes"),
    ];
    for (right, expected) in cases {
        let error =
            VideoSource::open(&left, &world.at(right), Replay::ONCE).err().expect("refused").to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_deleted_video_is_lost() {
    let world = World::new();
    let mut source = two_films(&world, (12, 25.0), (12, 25.0));
    collect(&mut source, 2).expect("pairs");
    std::fs::remove_file(world.at("right.avi")).expect("deleting");
    let error = collect(&mut source, 100).expect_err("one file is gone").to_string();
    assert!(error.contains("right.avi is gone; bring it back"), "{error}");
}

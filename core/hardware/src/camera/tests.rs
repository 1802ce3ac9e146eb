//! Cameras that are not there: the threads and the pairing with a camera made of numbers.

use super::*;
use image::{Rgb, RgbImage};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Delivers an image every `period`, numbered in its first pixel, until it is unplugged.
struct NumberCamera {
    size: (u32, u32),
    period: Duration,
    offset: Duration,
    count: u8,
    start: Instant,
    unplugged: Arc<AtomicBool>,
    damaged: bool,
    sends_jpeg: bool,
}

impl NumberCamera {
    fn new(unplugged: &Arc<AtomicBool>) -> Self {
        Self {
            size: (8, 6),
            period: Duration::from_millis(40),
            offset: Duration::ZERO,
            count: 0,
            start: Instant::now(),
            unplugged: Arc::clone(unplugged),
            damaged: false,
            sends_jpeg: false,
        }
    }
}

impl EyeCamera for NumberCamera {
    fn grab(&mut self) -> Result<(), String> {
        let due = self.start + self.offset + self.period * u32::from(self.count);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if self.unplugged.load(Ordering::Relaxed) {
            return Err("was unplugged; plug it in again".to_owned());
        }
        self.count += 1;
        Ok(())
    }

    fn retrieve(&mut self) -> Result<Captured, String> {
        if self.damaged {
            return Err("the frame is damaged".to_owned());
        }
        let image = RgbImage::from_pixel(self.size.0, self.size.1, Rgb([self.count; 3]));
        Ok(Captured { image, jpeg: self.sends_jpeg.then(|| Arc::from([self.count])) })
    }

    fn delivers(&self) -> Delivered {
        Delivered { size: self.size, rate_hz: 1.0 / self.period.as_secs_f64() }
    }
}

fn settings() -> CameraSettings {
    CameraSettings { size: None, rate_hz: None, ..CameraSettings::default() }
}

fn start(
    left: NumberCamera,
    right: NumberCamera,
    settings: CameraSettings,
) -> Result<CameraSource, SourceError> {
    CameraSource::start("two cameras".to_owned(), [Box::new(left), Box::new(right)], settings)
}

/// Asks until `count` pairs came, the source fails, or ten seconds are over.
fn pairs(source: &mut CameraSource, count: usize) -> Result<Vec<StereoFrame>, SourceError> {
    let deadline = Instant::now() + Duration::from_secs(10);
    let mut found = Vec::new();
    while found.len() < count && Instant::now() < deadline {
        match source.next_pair()? {
            Next::Pair(pair) => found.push(pair),
            Next::NotYet => std::thread::sleep(Duration::from_millis(1)),
            Next::End => panic!("cameras have no end"),
        }
    }
    Ok(found)
}

#[test]
fn frames_of_one_moment_are_paired_and_their_difference_is_right_minus_left() {
    let plugged = Arc::new(AtomicBool::new(false));
    // Far enough apart that a busy machine does not blur the order.
    let (mut left, mut right) = (NumberCamera::new(&plugged), NumberCamera::new(&plugged));
    left.period = Duration::from_millis(120);
    right.period = left.period;
    right.offset = Duration::from_millis(30);
    let mut source = start(left, right, settings()).expect("two cameras");
    let found = pairs(&mut source, 6).expect("running cameras");
    assert_eq!(found.len(), 6);
    for (seq, pair) in found.iter().enumerate() {
        assert_eq!(pair.stamp.seq, seq as u64);
        assert_eq!(pair.left.get_pixel(0, 0), pair.right.get_pixel(0, 0), "frames of different moments");
        let difference_s = pair.time_difference_s.expect("cameras know it");
        // The scheduler may delay either; the sign and the size must show all the same.
        assert!((0.005..0.06).contains(&difference_s), "{difference_s}");
    }
    assert!(found.windows(2).all(|w| w[0].stamp.captured_at < w[1].stamp.captured_at));
}

#[test]
fn a_slow_caller_gets_the_newest_pair_and_the_others_are_counted() {
    let plugged = Arc::new(AtomicBool::new(false));
    let mut source =
        start(NumberCamera::new(&plugged), NumberCamera::new(&plugged), settings()).expect("two cameras");
    let first = pairs(&mut source, 1).expect("running cameras");
    std::thread::sleep(Duration::from_millis(400));
    let second = pairs(&mut source, 1).expect("running cameras");
    let age = second[0].stamp.captured_at.elapsed();
    assert!(age < Duration::from_millis(250), "an old pair was delivered: {age:?}");
    assert!(second[0].left.get_pixel(0, 0).0[0] > first[0].left.get_pixel(0, 0).0[0] + 5);
    let counters = source.counters();
    assert_eq!(counters.delivered, 2);
    assert!(counters.superseded + counters.unpaired_left > 3, "drops must be counted: {counters:?}");
}

#[test]
fn an_unplugged_camera_is_lost_by_name() {
    let plugged = Arc::new(AtomicBool::new(false));
    let unplugged = Arc::new(AtomicBool::new(false));
    let mut source =
        start(NumberCamera::new(&plugged), NumberCamera::new(&unplugged), settings()).expect("two cameras");
    pairs(&mut source, 2).expect("running cameras");
    unplugged.store(true, Ordering::Relaxed);
    let error = pairs(&mut source, 1000).expect_err("one camera is gone");
    assert_eq!(
        error,
        SourceError::Lost { reason: "the right camera was unplugged; plug it in again".to_owned() }
    );
}

#[test]
fn a_silent_camera_is_lost_and_does_not_hold_up_its_owner() {
    let plugged = Arc::new(AtomicBool::new(false));
    let mut silent = NumberCamera::new(&plugged);
    silent.offset = Duration::from_secs(3);
    let settings = CameraSettings { silence_limit_s: 0.2, ..settings() };
    let mut source = start(silent, NumberCamera::new(&plugged), settings).expect("two cameras");
    let error = pairs(&mut source, 1).expect_err("the left camera is silent").to_string();
    assert!(error.starts_with("the left camera has sent no image for 0."), "{error}");
    let dropped_at = Instant::now();
    drop(source);
    assert!(dropped_at.elapsed() < Duration::from_secs(1), "dropping waited for a hanging camera");
}

#[test]
fn a_camera_with_damaged_images_only_is_lost() {
    let plugged = Arc::new(AtomicBool::new(false));
    let mut broken = NumberCamera::new(&plugged);
    broken.damaged = true;
    broken.period = Duration::from_millis(2);
    let mut source = start(NumberCamera::new(&plugged), broken, settings()).expect("two cameras");
    let error = pairs(&mut source, 1).expect_err("no usable image").to_string();
    assert!(error.contains("the right camera sends damaged images only"), "{error}");
    assert!(source.counters().unpaired_right > 0);
}

#[test]
fn cameras_of_different_size_are_refused_and_deviations_told() {
    let plugged = Arc::new(AtomicBool::new(false));
    let mut large = NumberCamera::new(&plugged);
    large.size = (16, 12);
    let refused = start(NumberCamera::new(&plugged), large, settings()).err().expect("different sizes");
    assert!(refused.to_string().contains("left camera delivers 8x6 px and the right 16x12 px"), "{refused}");

    let asked = CameraSettings { size: Some((640, 480)), rate_hz: Some(25.0), ..settings() };
    let mut source =
        start(NumberCamera::new(&plugged), NumberCamera::new(&plugged), asked).expect("a source");
    let told: Vec<String> = source.take_reports().iter().map(Report::to_string).collect();
    assert_eq!(
        told,
        [
            "the left camera delivers 8x6 px instead of the 640x480 px asked for",
            "the right camera delivers 8x6 px instead of the 640x480 px asked for"
        ]
    );
}

#[test]
fn settings_that_are_none_are_refused() {
    let wrong = [
        CameraSettings { size: Some((0, 480)), ..settings() },
        CameraSettings { rate_hz: Some(f64::NAN), ..settings() },
        CameraSettings { time_difference_limit_s: Some(0.0), ..settings() },
        CameraSettings { silence_limit_s: f64::INFINITY, ..settings() },
    ];
    for settings in wrong {
        assert!(matches!(CameraSource::open(0, 1, settings), Err(SourceError::CameraSetting { .. })));
    }
    assert_eq!(CameraSource::open(2, 2, settings()).err(), Some(SourceError::SameCamera { index: 2 }));
}

#[test]
fn camera_threads_have_names() {
    struct NameCamera(Arc<Mutex<Option<String>>>);
    impl EyeCamera for NameCamera {
        fn grab(&mut self) -> Result<(), String> {
            *self.0.lock().expect("a lock") = std::thread::current().name().map(str::to_owned);
            Err("was only asked its name".to_owned())
        }
        fn retrieve(&mut self) -> Result<Captured, String> {
            Err("nothing was grabbed".to_owned())
        }
        fn delivers(&self) -> Delivered {
            Delivered { size: (1, 1), rate_hz: 30.0 }
        }
    }
    let names = [Arc::new(Mutex::new(None)), Arc::new(Mutex::new(None))];
    let cameras = [Box::new(NameCamera(names[0].clone())), Box::new(NameCamera(names[1].clone()))];
    let mut source =
        CameraSource::start("names".to_owned(), cameras.map(|c| c as Box<dyn EyeCamera>), settings())
            .expect("a source");
    pairs(&mut source, 1).expect_err("both end at once");
    let known = || names.each_ref().map(|name| name.lock().expect("a lock").clone());
    let deadline = Instant::now() + Duration::from_secs(10);
    while known().contains(&None) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
    drop(source);
    let names = known();
    assert_eq!(names, [Some("left camera".to_owned()), Some("right camera".to_owned())]);
}

#[test]
fn what_both_cameras_have_compressed_comes_with_the_pair() {
    let plugged = Arc::new(AtomicBool::new(false));
    for [left_sends, right_sends] in [[true, true], [true, false]] {
        let [mut left, mut right] = [NumberCamera::new(&plugged), NumberCamera::new(&plugged)];
        (left.sends_jpeg, right.sends_jpeg) = (left_sends, right_sends);
        let mut source = start(left, right, settings()).expect("two cameras");
        let pair = pairs(&mut source, 1).expect("running cameras").remove(0);
        let numbers = [&pair.left, &pair.right].map(|image| vec![image.get_pixel(0, 0).0[0]]);
        let sent = pair.beside.jpegs.map(|jpegs| jpegs.map(|jpeg| jpeg.to_vec()));
        assert_eq!(sent, (left_sends && right_sends).then_some(numbers));
    }
}

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use image::RgbImage;
use plumbline_hardware::{Counters, FiniteSource, MemorySource, RetryPolicy, SourceDescription};
use plumbline_model::Stamp;
use plumbline_recording::{About, Jpeg, RecordingWriter};

use super::*;

fn pairs(count: usize) -> Vec<StereoFrame> {
    (0..count)
        .map(|i| StereoFrame {
            stamp: Stamp { seq: 0, captured_at: Instant::now() },
            left: Arc::new(RgbImage::new(4, 3)),
            right: Arc::new(RgbImage::new(4, 3)),
            time_difference_s: None,
            name: Some(i.to_string()),
            beside: Default::default(),
        })
        .collect()
}

fn spec() -> SourceSpec {
    SourceSpec::Folder("pairs".into())
}

/// Says that it is gone while `gone` is set, as an unplugged camera does.
struct Fragile {
    inner: MemorySource,
    gone: Arc<AtomicBool>,
}

impl Fragile {
    fn lost() -> SourceError {
        SourceError::Lost { reason: "the cable was pulled; plug it in again".to_owned() }
    }
}

impl StereoSource for Fragile {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        if self.gone.load(Ordering::Relaxed) { Err(Self::lost()) } else { self.inner.next_pair() }
    }
    fn describe(&self) -> SourceDescription {
        self.inner.describe()
    }
    fn counters(&self) -> Counters {
        self.inner.counters()
    }
    fn take_reports(&mut self) -> Vec<Report> {
        self.inner.take_reports()
    }
    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        self.inner.as_finite()
    }
}

/// A player whose every source has `count` pairs, as fast as asked.
fn player(count: usize) -> (Player, Arc<AtomicBool>) {
    let gone = Arc::new(AtomicBool::new(false));
    let shared = gone.clone();
    let opener: Opener = Box::new(move |spec, _| {
        if spec == &SourceSpec::Folder("missing".into()) {
            return Err(SourceError::NoSuchFolder { path: "missing".into() });
        }
        let gone = shared.clone();
        let reopen = move || -> Result<Box<dyn StereoSource>, SourceError> {
            if gone.load(Ordering::Relaxed) {
                return Err(Fragile::lost());
            }
            let inner = MemorySource::new("pairs in memory", pairs(count), Replay::ONCE)?;
            Ok(Box::new(Fragile { inner, gone: gone.clone() }))
        };
        let soon = Duration::from_millis(1);
        Retrying::open(reopen, RetryPolicy { first_pause: soon, longest_pause: soon })
    });
    (Player::with_opener(opener), gone)
}

fn shown(player: &mut Player) -> Option<StereoFrame> {
    for _ in 0..1000 {
        match player.poll().0 {
            Polled::Frame(frame) => return Some(frame),
            Polled::Wait(time) if time < IDLE => std::thread::sleep(time),
            Polled::Wait(_) => return None,
        }
    }
    None
}

fn name(player: &mut Player) -> Option<String> {
    shown(player)?.name
}

#[test]
fn a_recording_plays_to_its_end_and_again() {
    let (mut player, _) = player(3);
    assert!(player.control(Control::Open(spec())).is_empty());
    let names: Vec<_> = std::iter::from_fn(|| name(&mut player)).collect();
    assert_eq!(names, ["0", "1", "2"]);
    assert_eq!(player.view().status, SourceStatus::Ended);
    player.control(Control::Play);
    assert_eq!(name(&mut player).as_deref(), Some("0"));
    assert_eq!(player.view().status, SourceStatus::Running);
}

#[test]
fn pausing_stepping_and_seeking_show_the_right_pair() {
    let (mut player, _) = player(5);
    player.control(Control::Open(spec()));
    name(&mut player);
    player.control(Control::Pause);
    assert_eq!(name(&mut player), None);
    for (control, expected) in [
        (Control::Step(1), "1"),
        (Control::Step(2), "3"),
        (Control::Step(-1), "2"),
        (Control::Step(100), "4"),
        (Control::Step(-100), "0"),
        (Control::Seek(3), "3"),
    ] {
        player.control(control.clone());
        assert_eq!(name(&mut player).as_deref(), Some(expected), "{control:?}");
        assert_eq!(name(&mut player), None, "it stays there");
        let position = player.view().replay.expect("a recording").position;
        assert_eq!(position.map(|p| p.to_string()).as_deref(), Some(expected));
    }
    let beyond = player.control(Control::Seek(99));
    assert!(beyond.len() <= 1, "an impossible place is refused with one message at most");
}

#[test]
fn a_lost_source_is_said_and_comes_back_by_itself() {
    let (mut player, gone) = player(4);
    player.control(Control::Open(spec()));
    assert_eq!(name(&mut player).as_deref(), Some("0"));
    gone.store(true, Ordering::Relaxed);
    let mut notes = player.poll().1;
    notes.extend(player.poll().1);
    let SourceStatus::Lost { reason, .. } = player.view().status else { panic!("lost") };
    assert!(reason.contains("plug it in"), "{reason}");
    assert!(notes.iter().any(|(level, _)| *level == NoticeLevel::Warning), "{notes:?}");
    gone.store(false, Ordering::Relaxed);
    let frame = shown(&mut player).expect("back");
    assert_eq!((frame.name.as_deref(), frame.stamp.seq), (Some("1"), 1));
    assert_eq!(player.view().status, SourceStatus::Running);
}

#[test]
fn a_source_that_cannot_be_opened_leaves_the_present_one() {
    let (mut player, _) = player(4);
    player.control(Control::Open(spec()));
    name(&mut player);
    let notes = player.control(Control::Open(SourceSpec::Folder("missing".into())));
    assert!(notes[0].1.contains("missing does not exist"), "{notes:?}");
    assert_eq!(player.view().spec, Some(spec()));
    assert_eq!(name(&mut player).as_deref(), Some("1"));
}

#[test]
fn sequence_numbers_go_on_over_sources() {
    let (mut player, _) = player(2);
    let mut numbers = Vec::new();
    for _ in 0..2 {
        player.control(Control::Open(spec()));
        numbers.extend(std::iter::from_fn(|| shown(&mut player)).map(|frame| frame.stamp.seq));
    }
    assert_eq!(numbers, [0, 1, 2, 3]);
}

#[test]
fn a_closed_source_is_gone() {
    let (mut player, _) = player(2);
    player.control(Control::Open(spec()));
    player.control(Control::Close);
    assert_eq!(name(&mut player), None);
    assert_eq!(player.view(), SourceView { opened: 2, ..SourceView::default() });
}

#[test]
fn a_rate_that_is_none_is_refused_and_the_one_before_stays() {
    let (mut player, _) = player(3);
    assert!(player.control(Control::Open(spec())).is_empty());
    assert!(player.control(Control::PairsPerSecond(50.0)).is_empty());
    for rate in [0.0, -1.0, 1e-30, 1e9, f64::NAN, f64::INFINITY] {
        let notes = player.control(Control::PairsPerSecond(rate));
        assert!(notes.iter().any(|(_, text)| text.contains("between 0.01 and 1000")), "{rate}: {notes:?}");
    }
    let rate = player.view().replay.and_then(|replay| replay.pairs_per_second);
    assert_eq!(rate, Some(50.0));
}

#[test]
fn a_player_in_place_of_another_counts_on() {
    let (player, _) = player(3);
    let mut player = player.in_place_of_one(41, 7);
    assert_eq!(player.opened(), 7);
    player.control(Control::Open(spec()));
    assert_eq!(player.opened(), 8, "a source opened now is told from those before");
    loop {
        if let (Polled::Frame(frame), _) = player.poll() {
            assert_eq!(frame.stamp.seq, 41);
            return;
        }
    }
}

/// A recording of a pair, by a robot of this name.
fn recorded(folder: &Path, rig: &str) -> PathBuf {
    let file = folder.join(format!("of-{rig}.mcap"));
    let about = About { rig: rig.to_owned(), ..About::default() };
    let at = jiff::Timestamp::from_second(1_700_000_000).expect("a time");
    let mut writer = RecordingWriter::create(&file, at, &about).expect("begun");
    let image = image::RgbImage::from_pixel(64, 48, image::Rgb([90; 3]));
    let jpeg = Jpeg(plumbline_hardware::encode_jpeg(&image, plumbline_hardware::QUALITY).expect("encoded"));
    writer.pair(at, 1, [jpeg.clone(), jpeg], None).expect("written");
    writer.finish().expect("finished");
    file
}

#[test]
fn a_recording_of_another_robot_is_refused_and_what_is_shown_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let [own, unknown, other] = ["nico", "", "icub"].map(|rig| recorded(folder.path(), rig));
    let mut player = Player::default();
    for file in [&own, &unknown] {
        let notes = player.control(Control::OpenPaths(vec![file.clone()]));
        assert!(notes.iter().all(|(level, _)| *level != NoticeLevel::Error), "{notes:?}");
        assert!(shown(&mut player).is_some(), "{}", file.display());
    }
    let notes = player.control(Control::OpenPaths(vec![other]));
    let said = &notes.last().expect("told").1;
    assert!(said.contains("of the robot icub") && said.contains("this one is nico"), "{said}");
    let unknown = SourceSpec::Recording { file: unknown, of_twin: false };
    assert_eq!(player.view().spec, Some(unknown), "what was shown stays");
}

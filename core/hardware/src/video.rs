//! Two video files, one per eye, paired by the time stamps of their frames.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::RgbImage;
use opencv::core::Mat;
use opencv::prelude::*;
use opencv::videoio::{self, VideoCapture};
use plumbline_model::files::{self, FileError, Size};
use plumbline_model::{Eye, Stamp, StereoFrame};

use crate::cv;
use crate::error::SourceError;
use crate::image_file::file_name;
use crate::pair_by_time::{PairByTime, Timed, TimedPair};
use crate::replay::{Pace, Replay};
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, SourceKind, StereoSource};

/// Delivers pairs from two videos. The left video leads: its frames are counted, its rate is
/// the rate of the recording.
pub struct VideoSource {
    videos: [Video; 2],
    pairing: PairByTime<RgbImage>,
    replay: Replay,
    pace: Pace,
    /// Time of the last pair in the recording, for the distance to the next; `None` if the
    /// next is due at once.
    last_time_s: Option<f64>,
    /// A pair read ahead and not yet due.
    ahead: Option<TimedPair<RgbImage>>,
    counters: Counters,
    reports: Vec<Report>,
}

impl VideoSource {
    /// Opens both files and reads their first frames.
    pub fn open(left: &Path, right: &Path, replay: Replay) -> Result<Self, SourceError> {
        let replay = replay.check()?;
        if left.canonicalize().ok().is_some_and(|path| right.canonicalize().ok() == Some(path)) {
            return Err(SourceError::SameForBothEyes { path: left.to_path_buf() });
        }
        let videos = [Video::open(left)?, Video::open(right)?];
        let reports = compare(&videos)?;
        let fastest_hz = videos[0].rate_hz.max(videos[1].rate_hz);
        Ok(Self {
            videos,
            pairing: PairByTime::new(0.5 / fastest_hz, 8),
            replay,
            pace: Pace::start(),
            last_time_s: None,
            ahead: None,
            counters: Counters::default(),
            reports,
        })
    }

    /// Reads until a pair is found; `None` at the end of the shorter video.
    fn read_pair(&mut self) -> Result<Option<TimedPair<RgbImage>>, SourceError> {
        loop {
            if let Some(pair) = self.pairing.take(&mut self.counters) {
                return Ok(Some(pair));
            }
            for eye in Eye::BOTH {
                if self.pairing.needs(eye) {
                    match self.videos[eye.index()].read()? {
                        Some(frame) => {
                            self.pairing.push(eye, frame.time_s, frame.frame, &mut self.counters);
                        }
                        None => return Ok(None),
                    }
                }
            }
        }
    }

    /// Reads the next pair ahead and sets when it is due; at the end, from the beginning
    /// again if looping.
    fn read_ahead(&mut self) -> Result<(), SourceError> {
        self.check_files()?;
        let mut pair = self.read_pair()?;
        if pair.is_none() && self.replay.looping && self.counters.delivered > 0 {
            self.rewind(0)?;
            // The first frame follows the last one at the usual distance.
            self.last_time_s = Some(-1.0 / self.videos[0].rate_hz);
            pair = self.read_pair()?;
        }
        if let Some((left, _)) = &pair
            && let Some(last_s) = self.last_time_s
            && left.time_s > last_s
        {
            self.pace.advance(self.replay.period(1.0 / (left.time_s - last_s)));
        }
        self.ahead = pair;
        Ok(())
    }

    fn rewind(&mut self, index: usize) -> Result<(), SourceError> {
        let time_s = index as f64 / self.videos[0].rate_hz;
        for video in &mut self.videos {
            video.seek(time_s)?;
        }
        self.pairing.clear();
        self.ahead = None;
        self.last_time_s = None;
        Ok(())
    }

    fn check_files(&self) -> Result<(), SourceError> {
        match self.videos.iter().find(|video| !video.path.exists()) {
            Some(video) => Err(SourceError::Lost {
                reason: format!(
                    "the video {} is gone; bring it back, or connect its disk again",
                    video.path.display()
                ),
            }),
            None => Ok(()),
        }
    }
}

impl StereoSource for VideoSource {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        if self.ahead.is_none() {
            self.read_ahead()?;
        }
        if self.ahead.is_some() && !self.pace.is_due() {
            return Ok(Next::NotYet);
        }
        let Some((left, right)) = self.ahead.take() else { return Ok(Next::End) };
        self.last_time_s = Some(left.time_s);
        let seq = self.counters.delivered;
        self.counters.delivered += 1;
        Ok(Next::Pair(StereoFrame {
            stamp: Stamp { seq, captured_at: Instant::now() },
            time_difference_s: Some(right.time_s - left.time_s),
            left: Arc::new(left.frame),
            right: Arc::new(right.frame),
            name: Some(format!("{:.3} s", left.time_s)),
            beside: Default::default(),
        }))
    }

    fn describe(&self) -> SourceDescription {
        let [left, right] = &self.videos;
        SourceDescription {
            kind: SourceKind::Videos,
            title: format!("videos {} and {}", file_name(&left.path), file_name(&right.path)),
            image_size: Some(left.size),
            rate_hz: self.replay.rate_hz(left.rate_hz),
            pair_count: Some(self.videos[0].frame_count.min(self.videos[1].frame_count)),
        }
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    fn wait_hint(&self) -> Duration {
        self.pace.wait()
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        Some(self)
    }
}

impl FiniteSource for VideoSource {
    fn pair_count(&self) -> usize {
        self.videos[0].frame_count.min(self.videos[1].frame_count)
    }

    fn position(&self) -> usize {
        let waiting = usize::from(self.ahead.is_some() || !self.pairing.needs(Eye::Left));
        self.videos[0].next_index.saturating_sub(waiting)
    }

    fn seek(&mut self, index: usize) -> Result<(), SourceError> {
        let pairs = self.pair_count();
        if index >= pairs {
            return Err(SourceError::NoSuchPair { index, pairs });
        }
        self.rewind(index)?;
        self.pace.restart();
        Ok(())
    }

    fn replay(&self) -> Replay {
        self.replay
    }

    fn set_replay(&mut self, replay: Replay) -> Result<(), SourceError> {
        self.replay = replay.check()?;
        self.pace.restart();
        Ok(())
    }
}

/// Refuses videos that do not fit each other, tells what is merely unlike.
fn compare([left, right]: &[Video; 2]) -> Result<Vec<Report>, SourceError> {
    if left.size != right.size {
        return Err(SourceError::Video {
            path: right.path.clone(),
            problem: format!(
                "its frames are {}x{} px, those of the left video {}x{} px; record both eyes at the same size",
                right.size.0, right.size.1, left.size.0, left.size.1
            ),
        });
    }
    let mut reports = Vec::new();
    if (left.rate_hz - right.rate_hz).abs() > 0.01 * left.rate_hz {
        reports.push(Report::Unlike(format!(
            "the left video has {:.2} frames per second, the right {:.2}: frames without a partner are dropped",
            left.rate_hz, right.rate_hz
        )));
    }
    if left.frame_count != right.frame_count {
        reports.push(Report::Unlike(format!(
            "the left video has {} frames, the right {}: replay ends with the shorter one",
            left.frame_count, right.frame_count
        )));
    }
    Ok(reports)
}

/// One open video file.
struct Video {
    path: PathBuf,
    capture: VideoCapture,
    /// Which of OpenCV's readers opened it.
    reader: i32,
    rate_hz: f64,
    frame_count: usize,
    size: (u32, u32),
    /// Whether the file stamps its frames; if not, number and rate make the time.
    has_times: bool,
    next_index: usize,
    decoded: Mat,
}

impl Video {
    fn open(path: &Path) -> Result<Self, SourceError> {
        let problem =
            |problem: &str| SourceError::Video { path: path.to_path_buf(), problem: problem.to_owned() };
        check(path).map_err(|reason| problem(&reason))?;
        cv::quiet();
        let unreadable =
            "it is not a video, or of a kind that is not read; convert it to MP4 (H.264) or AVI (MJPG)";
        let (capture, reader) = open_capture(path).ok_or_else(|| problem(unreadable))?;
        let rate_hz = property(&capture, videoio::CAP_PROP_FPS).filter(|hz| (0.1..=1000.0).contains(hz));
        let frame_count = property(&capture, videoio::CAP_PROP_FRAME_COUNT).unwrap_or(0.0);
        let mut video = Self {
            path: path.to_path_buf(),
            capture,
            reader,
            rate_hz: rate_hz.unwrap_or(Replay::USUAL_RATE_HZ),
            frame_count: frame_count as usize,
            size: (0, 0),
            has_times: true,
            next_index: 0,
            decoded: Mat::default(),
        };
        let first = video.read()?.ok_or_else(|| problem("it holds no frame that can be read"))?;
        video.size = first.frame.dimensions();
        if let Some(second) = video.read()? {
            video.has_times = second.time_s > first.time_s;
        }
        video.seek(0.0)?;
        Ok(video)
    }

    /// The next frame; `None` at the end.
    fn read(&mut self) -> Result<Option<Timed<RgbImage>>, SourceError> {
        let failed = |problem: String| SourceError::Video { path: self.path.clone(), problem };
        let grabbed = self.capture.grab().map_err(|error| failed(cv::message(&error)))?;
        if !grabbed {
            return Ok(None);
        }
        let time_s = match property(&self.capture, videoio::CAP_PROP_POS_MSEC) {
            Some(time_ms) if self.has_times => time_ms / 1000.0,
            _ => self.next_index as f64 / self.rate_hz,
        };
        let got =
            self.capture.retrieve_def(&mut self.decoded).map_err(|error| failed(cv::message(&error)))?;
        if !got {
            return Ok(None);
        }
        let frame = cv::rgb_image(&self.decoded).map_err(failed)?;
        self.next_index += 1;
        Ok(Some(Timed { time_s, frame }))
    }

    /// Winds to the frame at a time. To the beginning by opening the file again, which is
    /// exact for every kind of file.
    fn seek(&mut self, time_s: f64) -> Result<(), SourceError> {
        let index = (time_s * self.rate_hz).round();
        let failed = |error: opencv::Error| SourceError::Video {
            path: self.path.clone(),
            problem: format!("it cannot be wound to {time_s:.2} s ({})", cv::message(&error)),
        };
        if index < 1.0 {
            check(&self.path).map_err(|problem| SourceError::Video { path: self.path.clone(), problem })?;
            self.capture = VideoCapture::from_file(&self.path, self.reader).map_err(failed)?;
            self.next_index = 0;
        } else {
            self.capture.set(videoio::CAP_PROP_POS_FRAMES, index).map_err(failed)?;
            self.next_index = index as usize;
        }
        Ok(())
    }
}

/// Checks what OpenCV opens by its name: a pipe would wait for ever.
fn check(path: &Path) -> Result<(), String> {
    match files::open(path, Size::VIDEO) {
        Err(error) if error.is_absent() => Err("there is no such file; check the path".to_owned()),
        Err(FileError::Unreadable { source, .. }) => Err(format!("{source}; check its permissions")),
        Err(FileError::NotAFile { kind, .. }) => Err(format!("it is {kind}; give a video file")),
        Err(error) => Err(error.to_string()),
        Ok(opened) if opened.metadata().is_ok_and(|about| about.len() == 0) => {
            Err("the file is empty; the recording was interrupted".to_owned())
        }
        Ok(_) => Ok(()),
    }
}

/// Opens a file with the first of OpenCV's readers that can. GStreamer is left out: on a
/// file it cannot play it writes complaints to standard error that nothing silences.
fn open_capture(path: &Path) -> Option<(VideoCapture, i32)> {
    [videoio::CAP_FFMPEG, videoio::CAP_OPENCV_MJPEG].into_iter().find_map(|reader| {
        let capture = VideoCapture::from_file(path, reader).ok()?;
        capture.is_opened().unwrap_or(false).then_some((capture, reader))
    })
}

/// A property that the reader knows: finite and not negative.
fn property(capture: &VideoCapture, id: i32) -> Option<f64> {
    capture.get(id).ok().filter(|value| value.is_finite() && *value >= 0.0)
}

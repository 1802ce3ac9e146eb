//! Finds the board in all pairs of a recording.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use plumbline_hardware::{Next, PairFiles, PairFolder, Replay, SourceOptions, SourceSpec};
use plumbline_model::{Cancelled, Chessboard, JobContext, StereoCameras, StereoFrame};
use rayon::prelude::*;

use super::capture::{find_in_both, glimpse_in_both, gray, size};
use crate::eyes::auto_capture::{AutoCapture, Look};
use crate::eyes::coverage::{self, Novelty};
use crate::eyes::place::{place_of, rough_pose};
use crate::eyes::sharpness::of_both;
use crate::eyes::times::taken_then;
use crate::eyes::view::{CaptureHint, CollectedPair};
use crate::ground::jobs::JobError;

/// Find the board in all pairs of a recording.
#[derive(Clone, Debug)]
pub struct CollectRecording {
    /// The recording.
    pub source: SourceSpec,
    /// The board looked for.
    pub board: Chessboard,
    /// Pairs that are collected already and need not be searched.
    pub known: BTreeSet<String>,
    /// Eyes good enough to tell where the board is.
    pub rough_cameras: StereoCameras,
}

/// Pairs of a recording.
#[derive(Clone, Debug)]
pub struct Collected {
    /// Both eyes see the board.
    pub pairs: Vec<CollectedPair>,
    /// Name and reason of the others.
    pub not_collected: Vec<(String, String)>,
    /// Size (width, height) of both images; `None` when no pair could be read.
    pub sizes_px: Option<[(u32, u32); 2]>,
    /// The board looked for.
    pub board: Chessboard,
}

impl Collected {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        let of = self.pairs.len() + self.not_collected.len();
        format!("Both eyes see the board in {} of {of} pairs.", self.pairs.len())
    }
}

impl CollectRecording {
    /// Searches folders pair by pair on all cores, videos from beginning to end.
    pub fn run(self, context: &dyn JobContext) -> Result<Collected, JobError> {
        let folder = match &self.source {
            SourceSpec::Folder(folder) => PairFolder::open_one(folder),
            SourceSpec::Folders { left, right } => PairFolder::open_two(left, right),
            SourceSpec::Videos { .. } | SourceSpec::Recording { .. } => return self.search_video(context),
            SourceSpec::Cameras { .. } | SourceSpec::Twin => {
                return Err(JobError::failed(
                    "Cameras are no recording. Capture single pairs, or switch on capturing by itself.",
                ));
            }
        };
        let folder =
            folder.map_err(|error| JobError::failed(crate::ground::text::sentence(&error.to_string())))?;
        let wanted: Vec<&PairFiles> =
            folder.pairs().iter().filter(|pair| !self.known.contains(&pair.name)).collect();
        Ok(collect_folder(&folder, &wanted, &self.board, context)?)
    }

    /// Of a video those pairs in which the board is still, sharp and somewhere new.
    fn search_video(&self, context: &dyn JobContext) -> Result<Collected, JobError> {
        let failed = |error: plumbline_hardware::SourceError| {
            JobError::failed(crate::ground::text::sentence(&error.to_string()))
        };
        let options = SourceOptions { replay: Replay::ONCE, ..SourceOptions::default() };
        let mut source = plumbline_hardware::open(&self.source, &options).map_err(failed)?;
        let count = source.describe().pair_count.unwrap_or(1).max(1);
        let mut search = VideoSearch::new(self);
        loop {
            context.checkpoint()?;
            let looked = search.looked;
            context.report(f64::from(looked) / count as f64, &format!("looking at pair {looked} of {count}"));
            match source.next_pair().map_err(failed)? {
                Next::Pair(frame) => search.look(&frame),
                Next::NotYet => std::thread::sleep(source.wait_hint().min(Duration::from_millis(20))),
                Next::End => break,
            }
        }
        Ok(search.collected)
    }
}

/// Finds the board in some pairs of a folder, on all cores.
pub fn collect_folder(
    folder: &PairFolder,
    wanted: &[&PairFiles],
    board: &Chessboard,
    context: &dyn JobContext,
) -> Result<Collected, Cancelled> {
    let done = AtomicUsize::new(0);
    let found: Vec<Found> = wanted
        .par_iter()
        .map(|files| {
            context.checkpoint()?;
            let found = find_in_files(folder, files, board);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let doing = format!("looking for the board, {done} of {} pairs", wanted.len());
            context.report(done as f64 / wanted.len() as f64, &doing);
            Ok(found)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut collected =
        Collected { pairs: Vec::new(), not_collected: Vec::new(), sizes_px: None, board: *board };
    for found in found {
        match found {
            Ok((pair, sizes_px)) => {
                collected.sizes_px = Some(sizes_px);
                collected.pairs.push(pair);
            }
            Err(not) => collected.not_collected.push(not),
        }
    }
    Ok(collected)
}

/// The pair and the sizes of its images, or the pair's name and a reason.
type Found = Result<(CollectedPair, [(u32, u32); 2]), (String, String)>;

fn find_in_files(folder: &PairFolder, files: &PairFiles, board: &Chessboard) -> Found {
    let named = |reason: String| (files.name.clone(), crate::ground::text::sentence(&reason));
    let images = folder.load(files).map_err(|problem| named(problem.to_string()))?;
    let sizes_px = [size(&images.left), size(&images.right)];
    let images = [gray(&images.left), gray(&images.right)];
    let pair = find_in_both(files.name.clone(), images, board).map_err(|not| named(not.to_string()))?;
    Ok((pair, sizes_px))
}

/// Frames are searched faster than they were recorded; stillness is judged by their own time,
/// taken to be a thirtieth of a second each.
const FRAME_TIME: Duration = Duration::from_micros(33_333);

/// Captures by itself from a video.
struct VideoSearch<'a> {
    work: &'a CollectRecording,
    auto: AutoCapture,
    collected: Collected,
    begun: Instant,
    looked: u32,
}

impl<'a> VideoSearch<'a> {
    fn new(work: &'a CollectRecording) -> Self {
        let collected =
            Collected { pairs: Vec::new(), not_collected: Vec::new(), sizes_px: None, board: work.board };
        Self { work, auto: AutoCapture::default(), collected, begun: Instant::now(), looked: 0 }
    }

    fn look(&mut self, frame: &StereoFrame) {
        let index = self.looked;
        let board = &self.work.board;
        let images = [gray(&frame.left), gray(&frame.right)];
        let [left, right] = glimpse_in_both([&images[0], &images[1]], board);
        let place = left
            .as_ref()
            .and_then(|left| rough_pose(&self.work.rough_cameras.left, board, left))
            .and_then(|pose| place_of(board, &pose));
        let size_px = size(&frame.left);
        let novelty = left.as_ref().zip(right.as_ref()).map(|(left, right)| {
            let covered = coverage::coverage(board, size_px, &self.collected.pairs);
            let elsewhere = coverage::is_elsewhere(size_px, left, place.as_ref(), &self.collected.pairs);
            let novelty = coverage::novelty(&covered, board, size_px, [left, right], place.as_ref());
            Novelty { elsewhere, ..novelty }
        });
        let edge_width_px = of_both(board, [&images[0], &images[1]], [left.as_ref(), right.as_ref()]);
        let hint = self.auto.look(Look {
            at: self.begun + FRAME_TIME * index,
            width_px: size_px.0,
            left: left.as_ref(),
            right: right.as_ref(),
            edge_width_px,
            novelty,
            photograph: false,
        });
        self.looked += 1;
        if hint == CaptureHint::Ready {
            let [left_image, right_image] = images.map(|image| Some(std::sync::Arc::new(image)));
            let name = frame.name.clone().unwrap_or_else(|| format!("frame {index:06}"));
            self.collected.sizes_px = Some([size_px, size(&frame.right)]);
            let taken = frame.beside.then.as_ref().and_then(taken_then);
            let pair = CollectedPair { name, left, right, left_image, right_image, place, taken };
            self.collected.pairs.push(pair);
        }
    }
}

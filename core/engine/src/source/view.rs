//! Where the images come from and how it is doing.

use std::sync::Arc;
use std::time::Instant;

pub use plumbline_hardware::Growth;
use plumbline_hardware::{CameraDevice, SourceSpec};

/// Where the images come from and how it is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceView {
    /// Counts sources opened and closed; tells pairs of different sources apart.
    pub opened: u64,
    /// What was opened last.
    pub spec: Option<SourceSpec>,
    /// For people: "30 pairs in nico-chessboard".
    pub description: String,
    /// How it is doing.
    pub status: SourceStatus,
    /// Playing state; `None` for cameras.
    pub replay: Option<ReplayView>,
    /// Whether its pairs are single photographs rather than a stream in time.
    pub photographs: bool,
    /// Width and height of its images, as far as known before the first pair.
    pub image_size_px: Option<(u32, u32)>,
    /// Where pairs went.
    pub counters: SourceCounters,
    /// Cameras of this machine; `None` until asked for with
    /// [`crate::command::SourceCommand::ListCameras`].
    pub cameras: Option<Arc<[CameraDevice]>>,
}

/// Where pairs of the source went since it was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SourceCounters {
    /// Pairs delivered.
    pub delivered: u64,
    /// Pairs that could not be used because one of their images is bad.
    pub unusable: u64,
    /// Live pairs replaced by a newer one before anybody asked for them.
    pub superseded: u64,
    /// Left frames without a partner of the same time.
    pub unpaired_left: u64,
    /// Right frames without a partner of the same time.
    pub unpaired_right: u64,
}

/// How a source is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SourceStatus {
    /// None was opened.
    #[default]
    None,
    /// Being opened.
    Opening,
    /// Delivering pairs.
    Running,
    /// Held still by the operator.
    Paused,
    /// A recording came to its end.
    Ended,
    /// Delivers nothing any more; tried again by itself.
    Lost {
        /// What happened and what to do.
        reason: String,
        /// Since when.
        since: Instant,
        /// How often it was tried again.
        attempts: u32,
    },
}

/// Playing a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplayView {
    /// Index of the pair shown, from 0; `None` before the first.
    pub position: Option<u64>,
    /// How many pairs there are.
    pub length: u64,
    /// Whether it moves on by itself.
    pub playing: bool,
    /// Whether it starts over at the end.
    pub looping: bool,
    /// Pairs per second it aims at; `None` if as fast as possible.
    pub pairs_per_second: Option<f64>,
    /// Whether more may come at its end.
    pub growth: Growth,
}

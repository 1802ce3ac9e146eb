//! Calibrating the eyes: what was collected, what was solved, what is in use.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

use image::GrayImage;
use jiff::Timestamp;
use plumbline_model::{
    CalibrationOptions, Chessboard, Corners, Eye, InnerCorners, Pixel, Raw, StereoCalibration,
};

pub use super::health_view::{
    DriftTold, Drifted, EyesHealth, HealthFigures, HealthState, HealthView, JudgedWhen, ProposalHealth,
};
use super::map::TableMap;
use crate::ground::jobs::JobId;
use crate::ground::step::StepState;

/// Why pairs are not captured without asking any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureEnded {
    /// A calibration was accepted.
    Accepted,
    /// The mount looks at the board, from where the head turns: what it sees is none of the eyes' pairs.
    MountLooks,
}

/// The whole workflow.
#[derive(Clone, Debug)]
pub struct EyesView {
    /// State on the rail.
    pub step: StepState,
    /// The board in use.
    pub board: Chessboard,
    /// Whether the operator has confirmed the board (or it was read from a file).
    pub board_chosen: bool,
    /// How to solve.
    pub options: CalibrationOptions,
    /// Minutes since the cameras were switched on; it goes on while they are live. Of what was recorded: how long
    /// they had been on then.
    pub minutes_since_on: Option<f64>,
    /// What [`crate::command::EyesCommand::RecognizeBoard`] or a failed search found.
    pub board_seen: Option<BoardSeen>,
    /// Whether pairs are captured without asking.
    pub auto_capture: bool,
    /// Why that was switched off although nobody asked for it; `None`: it was not.
    pub capture_ended: Option<CaptureEnded>,
    /// What capturing waits for; `None` without an image.
    pub hint: Option<CaptureHint>,
    /// Pairs in the order of capture.
    pub collected: Arc<[Arc<CollectedPair>]>,
    /// For how long the eyes had been on when each of them was taken, min; `None`: nobody knows.
    pub minutes_on: Arc<[Option<f64>]>,
    /// Names of pairs left out of the next solution.
    pub dropped: Arc<BTreeSet<String>>,
    /// Pairs of the last recording that were not taken, and why.
    pub not_collected: Arc<[(String, String)]>,
    /// Whether there is a change to take back.
    pub can_undo: bool,
    /// Whether pairs came, went, were dropped or restored since the proposal was solved.
    pub pairs_changed: bool,
    /// Where the board has been.
    pub coverage: Arc<Coverage>,
    /// Where to hold the board next.
    pub ghost: Option<Arc<GhostBoard>>,
    /// The job that solves, if one does.
    pub solving: Option<JobId>,
    /// What waits for a decision.
    pub proposal: Option<Arc<Proposal>>,
    /// What the eyes are rectified with.
    pub in_use: Option<Arc<AcceptedCalibration>>,
    /// Whether that was solved from the pairs that are collected, as they are.
    pub is_solved_in_use: bool,
    /// Accepted before, newest first.
    pub earlier: Arc<[EarlierCalibration]>,
    /// Whether the calibration in use still holds, and whether the proposed one is better.
    pub health: HealthView,
}

/// A board that was seen although another one was looked for, or was asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardSeen {
    /// Inner corners; `None` when no board is seen at all.
    pub inner_corners: Option<InnerCorners>,
    /// A sentence for the operator, with the count in squares.
    pub text: String,
}

/// What the next capture waits for.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureHint {
    /// The board is not seen by this eye (or by neither).
    NotSeen {
        /// Eyes that do not see it.
        eyes: Vec<Eye>,
    },
    /// The board moves.
    Moving {
        /// Fastest corner since the pair before, pixels.
        motion_px: f64,
    },
    /// The image is blurred.
    Blurred {
        /// Median width of the board's edges, pixels.
        edge_width_px: f64,
    },
    /// The board has been here before.
    NothingNew,
    /// Ready.
    Ready,
    /// Was captured just now.
    Captured {
        /// Its name.
        pair: String,
    },
}

/// A pair in which both eyes saw the board.
#[derive(Clone, Debug)]
pub struct CollectedPair {
    /// Unique within the collection.
    pub name: String,
    /// Corners in the left image.
    pub left: Option<Corners>,
    /// Corners in the right image.
    pub right: Option<Corners>,
    /// The left image; `None` where only corners are known (read from a calibration file).
    pub left_image: Option<Arc<GrayImage>>,
    /// The right image.
    pub right_image: Option<Arc<GrayImage>>,
    /// Where the board was, roughly; `None` when that could not be told.
    pub place: Option<BoardPlace>,
    /// When it was taken, where it was taken live.
    pub taken: Option<Taken>,
}

/// When a pair was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// By cameras, at this moment: how long they had been on may be said later.
    At(Instant),
    /// By eyes that had been on for so long then, min.
    After(f64),
}

impl CollectedPair {
    /// Corners of one eye.
    pub fn corners(&self, eye: Eye) -> Option<&Corners> {
        match eye {
            Eye::Left => self.left.as_ref(),
            Eye::Right => self.right.as_ref(),
        }
    }

    /// Image of one eye.
    pub fn image(&self, eye: Eye) -> Option<&Arc<GrayImage>> {
        match eye {
            Eye::Left => self.left_image.as_ref(),
            Eye::Right => self.right_image.as_ref(),
        }
    }
}

/// Rough place of a board, good enough to tell whether it is somewhere new.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardPlace {
    /// From the left eye to the middle of the board, meters.
    pub distance_m: f64,
    /// Tilt against the line of sight about the image's horizontal axis, radians; positive:
    /// the top is further away than the bottom.
    pub tilt_up_down_rad: f64,
    /// Tilt about the image's vertical axis, radians; positive: the left is further away.
    pub tilt_left_right_rad: f64,
}

/// Where the board has been.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Corners per cell of the left image.
    pub left: CoverageGrid,
    /// Corners per cell of the right image.
    pub right: CoverageGrid,
    /// Pairs per bin of distance, near to far; the last bin is open.
    pub by_distance: Vec<u32>,
    /// Where one bin ends and the next begins, meters; one entry fewer than bins.
    pub distance_edges_m: Vec<f64>,
    /// Pairs per direction of tilt, in the order of [`Coverage::TILT_NAMES`].
    pub by_tilt: [u32; 5],
}

impl Coverage {
    /// Names of the entries of [`Coverage::by_tilt`].
    pub const TILT_NAMES: [&'static str; 5] = [
        "facing the eyes",
        "its top tilted away",
        "its top tilted near",
        "its left side turned away",
        "its right side turned away",
    ];
}

/// Corners per cell of an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CoverageGrid {
    /// Cells across.
    pub columns: usize,
    /// Cells down.
    pub rows: usize,
    /// Row by row.
    pub corners: Vec<u32>,
}

impl CoverageGrid {
    /// Share of cells with at least one corner, 0 to 1.
    pub fn filled_fraction(&self) -> f64 {
        if self.corners.is_empty() {
            return 0.0;
        }
        self.corners.iter().filter(|&&n| n > 0).count() as f64 / self.corners.len() as f64
    }
}

/// Where to hold the board next, drawn over both eyes. Edges are polylines because a fisheye
/// bends them.
#[derive(Clone, Debug, PartialEq)]
pub struct GhostBoard {
    /// Closed outline in the left image.
    pub left: Vec<Pixel<Raw>>,
    /// Closed outline in the right image.
    pub right: Vec<Pixel<Raw>>,
    /// What is new about it: "lower left of both eyes, near".
    pub reason: String,
    /// Where it is.
    pub place: BoardPlace,
}

/// A calibration that waits for a decision.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The calibration.
    pub calibration: Arc<StereoCalibration>,
    /// Where it comes from.
    pub origin: Origin,
    /// How far points of the table move against the calibration in use.
    pub difference: Option<TableMap>,
    /// One standard deviation of a point on the table, from the match and the parameters.
    pub uncertainty: Option<TableMap>,
    /// Distance in front of the eyes for which [`Proposal::depth_per_px_m`] is stated, meters.
    pub stated_at_m: f64,
    /// Change of distance, at that distance straight ahead, that moves the match by one pixel, meters.
    pub depth_per_px_m: Option<f64>,
    /// What speaks against accepting, in sentences.
    pub doubts: Vec<String>,
    /// Why it no longer belongs to what is collected; `None` while it does.
    pub stale: Option<String>,
}

/// Where a proposal comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Solved from the collected pairs.
    Solved,
    /// Read from a file.
    Imported {
        /// Its name.
        file: String,
    },
    /// Accepted earlier.
    Earlier {
        /// When.
        accepted: Timestamp,
    },
}

/// The calibration in use.
#[derive(Clone, Debug)]
pub struct AcceptedCalibration {
    /// Its id among all that were accepted.
    pub id: String,
    /// The calibration.
    pub calibration: Arc<StereoCalibration>,
    /// When it was accepted.
    pub accepted: Timestamp,
    /// One standard deviation of a point on the table.
    pub uncertainty: Option<TableMap>,
    /// Distance for which [`AcceptedCalibration::depth_per_px_m`] is stated, meters.
    pub stated_at_m: f64,
    /// Change of distance, at that distance straight ahead, that moves the match by one pixel, meters.
    pub depth_per_px_m: Option<f64>,
}

/// A calibration that was accepted before.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlierCalibration {
    /// Its id, for [`crate::command::EyesCommand::ProposeEarlier`].
    pub id: String,
    /// When it was accepted.
    pub accepted: Timestamp,
    /// For people: "30 pairs, 0.094 px".
    pub description: String,
    /// Whether it is the one in use.
    pub in_use: bool,
}

impl Default for EyesView {
    fn default() -> Self {
        Self {
            step: StepState::NotDone,
            board: plumbline_model::default_board(),
            board_chosen: false,
            options: CalibrationOptions::default(),
            minutes_since_on: None,
            board_seen: None,
            auto_capture: false,
            capture_ended: None,
            hint: None,
            collected: Arc::from([]),
            minutes_on: Arc::from([]),
            dropped: Arc::default(),
            not_collected: Arc::from([]),
            can_undo: false,
            pairs_changed: false,
            coverage: Arc::default(),
            ghost: None,
            solving: None,
            proposal: None,
            in_use: None,
            is_solved_in_use: false,
            earlier: Arc::from([]),
            health: HealthView::default(),
        }
    }
}

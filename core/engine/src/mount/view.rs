//! Calibrating how the eyes sit in the head.

use std::sync::Arc;

use plumbline_model::frame::{Head, LeftCamera, Pose};
use plumbline_vision::mount::is_included;

use crate::ground::step::StepState;

/// Calibrating how the eyes sit in the head.
#[derive(Clone, Debug, Default)]
pub struct MountView {
    /// For the rail.
    pub step: StepState,
    /// Views collected so far.
    pub views: Arc<[HeadViewSummary]>,
    /// Whether views were deleted that can be brought back.
    pub can_undo: bool,
    /// Whether the mount in use was solved from just these views.
    pub is_solved: bool,
    /// Planned head poses (pan, tilt; rad) that are still to be seen.
    pub planned: Arc<[(f64, f64)]>,
    /// The tour of the head through them, while it is under way.
    pub tour: Option<MountTour>,
    /// What to do next, a sentence.
    pub next: String,
    /// A solution that waits to be accepted.
    pub proposal: Option<MountSummary>,
    /// Why it is of other views than these; `None`: it is of these.
    pub proposal_stale: Option<String>,
    /// The one in use; `None`: nominal.
    pub in_use: Option<MountSummary>,
}

impl MountView {
    /// At least so many views are asked for before the mount is solved.
    pub const LEAST_VIEWS: usize = 6;
}

/// The head on its tour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MountTour {
    /// Number of the pose that is under way, from 1.
    pub pose: usize,
    /// Of so many.
    pub of: usize,
    /// Whether it waits until joints are heard.
    pub waits: bool,
}

/// A collected view.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadViewSummary {
    /// Its name.
    pub name: String,
    /// Head angles, rad.
    pub pan_rad: f64,
    /// Positive looks up, rad.
    pub tilt_rad: f64,
    /// Corners seen by the left and the right eye.
    pub corners: (usize, usize),
    /// Residual in the proposal, px.
    pub rms_px: Option<f64>,
    /// Whether the eyes were colder than in others, and saw otherwise.
    pub is_colder: bool,
}

/// A solved mount.
#[derive(Clone, Debug, PartialEq)]
pub struct MountSummary {
    /// Place of the left eye in the head.
    pub head_from_left: Pose<Head, LeftCamera>,
    /// Its difference to the nominal place, axes of the head, m.
    pub moved_m: [f64; 3],
    /// Its difference in direction to the nominal one (rotation vector, axes of the head), rad.
    pub turned_rad: [f64; 3],
    /// Standard deviations of `moved_m`.
    pub moved_sd_m: [f64; 3],
    /// Standard deviations of `turned_rad`.
    pub turned_sd_rad: [f64; 3],
    /// Residual, px.
    pub rms_px: f64,
    /// Views used.
    pub views: usize,
    /// Views left out: name and reason.
    pub rejected: Vec<(String, String)>,
    /// Which directions could not be seen and what would show them; empty when all could.
    pub not_seen: Vec<String>,
    /// What else the views say: slack, what the uncertainty does not include; a sentence each.
    pub remarks: Vec<String>,
    /// When it was solved.
    pub at: jiff::Timestamp,
}

impl MountSummary {
    /// What speaks against the numbers, and what they hold already.
    pub fn doubts(&self) -> (Vec<&str>, Vec<&str>) {
        let (held, others): (Vec<&str>, Vec<&str>) =
            self.remarks.iter().map(String::as_str).partition(|remark| is_included(remark));
        (self.not_seen.iter().map(String::as_str).chain(others).collect(), held)
    }
}

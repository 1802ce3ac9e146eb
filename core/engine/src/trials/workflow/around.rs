//! What the experiment can see of the rest.

use std::sync::Arc;
use std::time::Instant;

use plumbline_model::robot::Rig;
use plumbline_model::{Point, Robot};

use super::super::plan::ROBOT;
use crate::grasp::view::AttemptView;
use crate::robot::view::RobotView;
use crate::twin::view::TwinView;

/// It lies where it was laid when it is this near, m: what is round rolls a little.
const LAID_M: f64 = 0.05;

/// What grasping does just now.
#[derive(Clone, Debug, Default)]
pub struct GraspNow {
    /// Nothing is under way.
    pub is_idle: bool,
    /// The newest attempt.
    pub newest: Option<AttemptView>,
}

/// What the workflow can see of the rest.
pub struct TrialsAround {
    /// The robot as it is known.
    pub rig: Arc<Rig>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// The twin, as far as the operator sees it.
    pub twin: Arc<TwinView>,
    /// Whether this is the world of the twin.
    pub is_twin: bool,
    /// Grasping.
    pub grasp: GraspNow,
    /// When the newest pair was captured.
    pub newest_pair: Option<Instant>,
}

impl TrialsAround {
    /// What an experiment is made with, for its file.
    pub(super) fn who(&self) -> String {
        if self.is_twin { self.twin.scenario.clone() } else { format!("{ROBOT}{}", self.rig.name) }
    }

    /// How high a thing stands on the twin's table, as the scene shows it, m.
    pub(super) fn height_m(&self, object: &str) -> Option<f64> {
        Some(self.place(object)?.coords.z)
    }

    /// Where a thing is on the twin's table, as the scene shows it.
    fn place(&self, object: &str) -> Option<Point<Robot>> {
        self.twin.toys.iter().find(|toy| toy.name.eq_ignore_ascii_case(object))?.place
    }

    /// Whether a thing that has come to rest by `rests` lies where it was laid and was seen there since.
    pub(super) fn is_seen_at(&self, object: &str, [x_m, y_m]: [f64; 2], rests: Instant) -> bool {
        let lies = |at: Point<Robot>| (at.coords.x - x_m).hypot(at.coords.y - y_m) < LAID_M;
        let lies = !self.is_twin || self.place(object).is_some_and(lies);
        lies && self.newest_pair.is_some_and(|captured| captured > rests)
    }
}

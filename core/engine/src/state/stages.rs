//! What each stage of the live pipeline is given, and who takes what it makes.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::detect::{DetectInput, DetectOutput, DetectStage};
use crate::drift::{DriftInput, DriftOutput, DriftStage};
use crate::eyes::{CornersInput, CornersStage, Look};
use crate::ground::stage::{Stage, Timed};
use crate::live::{ProbeInput, ProbeOutput, ProbeStage, RectifyInput, RectifyOutput, RectifyStage};

/// What a stage is given and to whom its results go.
pub trait Serves<S: Stage> {
    /// What the stage is to do with the newest pair, if anything.
    fn input(&self) -> Option<S::Input>;

    /// The stage has something.
    fn output(&mut self, output: Timed<S::Output>, now: Instant);
}

impl Serves<RectifyStage> for State {
    fn input(&self) -> Option<RectifyInput> {
        self.rectify_input()
    }

    fn output(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        self.rectified(output, now);
    }
}

impl Serves<CornersStage> for State {
    fn input(&self) -> Option<CornersInput> {
        self.corners_input()
    }

    fn output(&mut self, output: Timed<Look>, now: Instant) {
        self.looked(output, now);
    }
}

impl Serves<DetectStage> for State {
    fn input(&self) -> Option<DetectInput> {
        self.detect_input()
    }

    fn output(&mut self, output: Timed<DetectOutput>, now: Instant) {
        self.detected(output, now);
    }
}

impl Serves<ProbeStage> for State {
    fn input(&self) -> Option<ProbeInput> {
        self.probe_input()
    }

    fn output(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        self.probed(output, now);
    }
}

impl Serves<DriftStage> for State {
    fn input(&self) -> Option<Arc<DriftInput>> {
        self.drift_input()
    }

    fn output(&mut self, output: Timed<DriftOutput>, _now: Instant) {
        self.drift_looked(output);
    }
}

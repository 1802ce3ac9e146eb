//! What the source and the stages gave.

use std::time::Instant;

use plumbline_model::StereoFrame;

use super::LiveWorkflow;
use crate::eyes::Look;
use crate::ground::stage::Timed;
use crate::ground::text::sentence;
use crate::ground::watched::WatchedThread;
use crate::live::probe::ProbeOutput;
use crate::live::rectify::RectifyOutput;
use crate::live::view::{CornersView, NotMeasured, ProbeView};

impl LiveWorkflow {
    /// A pair has come from the source.
    pub fn frame(&mut self, frame: StereoFrame, now: Instant) {
        self.clocks.source.note(now, frame.stamp.captured_at, std::time::Duration::ZERO);
        self.raw = Some(frame);
    }

    /// Rectification has something. What belongs to an older setup is not shown.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        if output.result.generation != self.generation || !(self.wanted.rectified || self.wanted.disparity) {
            return;
        }
        self.clocks.rectify.note(now, output.stamp.captured_at, output.busy);
        match output.result.products {
            Ok((rectified, disparity)) => {
                self.rectified = Some(rectified);
                if self.wanted.disparity && disparity.is_some() {
                    self.disparity = disparity;
                }
                self.failed = None;
            }
            Err(reason) => {
                (self.rectified, self.disparity) = (None, None);
                self.failed = Some(sentence(&reason.to_string()));
            }
        }
    }

    /// A stage gives nothing any more, or does again.
    pub fn stage_is_down(&mut self, stage: WatchedThread, why: Option<String>) {
        match why {
            Some(why) => {
                self.gave_nothing(stage, &why);
                self.down.insert(stage, why);
            }
            None => {
                self.down.remove(&stage);
                self.failed = None;
            }
        }
    }

    /// A stage gave nothing of the newest pair: what it gave before must not be taken for it.
    pub fn gave_nothing(&mut self, stage: WatchedThread, why: &str) {
        match stage {
            WatchedThread::Rectify => {
                (self.rectified, self.disparity) = (None, None);
                self.failed = Some(why.to_owned());
            }
            WatchedThread::Corners => self.corners = None,
            WatchedThread::Probe => {
                let asked = self.probe_asked;
                let failed = |asked| ProbeView {
                    asked,
                    stamp: None,
                    reading: Err(NotMeasured::Nothing(why.to_owned())),
                };
                self.probe = asked.map(failed);
            }
            _ => {}
        }
    }

    /// The chessboard search has something.
    pub fn corners(&mut self, output: &Timed<Look>, now: Instant) {
        self.clocks.corners.note(now, output.stamp.captured_at, output.busy);
        if self.wanted.corners {
            let shown = |corners: &Option<plumbline_model::Corners>| {
                corners.as_ref().map(|corners| corners.iter().flatten().copied().collect())
            };
            let look = &output.result;
            self.corners =
                Some(CornersView { stamp: output.stamp, left: shown(&look.left), right: shown(&look.right) });
        }
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        let ProbeOutput { point, generation, reading } = output.result;
        if generation != self.generation || self.probe_asked.is_none() {
            return;
        }
        self.clocks.probe.note(now, output.stamp.captured_at, output.busy);
        let reading = reading.map_err(NotMeasured::from);
        self.probe = Some(ProbeView { asked: point, stamp: Some(output.stamp), reading });
    }
}

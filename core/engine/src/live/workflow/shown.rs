//! What the window shows of it.

use std::time::Instant;

use plumbline_model::AimedPair;

use super::LiveWorkflow;
use crate::ground::stage::Skipped;
use crate::ground::watched::WatchedThread;
use crate::live::command::AimChoice;
use crate::live::setup::NoSetup;
use crate::live::view::{AimView, LiveView, NotMeasured, ProbeView, Statistics};

impl LiveWorkflow {
    /// How old the newest pair is, s; `None`: none came yet.
    pub fn newest_pair_age_s(&self, now: Instant) -> Option<f64> {
        Some(now.saturating_duration_since(self.clocks.source.newest_at()?).as_secs_f64())
    }

    /// What the window shows.
    pub fn view(&mut self, skipped: Skipped, now: Instant) -> LiveView {
        self.clocks.source.set_skipped(skipped.source);
        self.clocks.rectify.set_skipped(skipped.rectify);
        self.clocks.corners.set_skipped(skipped.corners);
        self.clocks.probe.set_skipped(skipped.probe);
        let statistics = Statistics {
            source: self.clocks.source.figures(now),
            rectify: self.clocks.rectify.figures(now),
            corners: self.clocks.corners.figures(now),
            probe: self.clocks.probe.figures(now),
            time_difference_s: self.raw.as_ref().and_then(|frame| frame.time_difference_s),
        };
        let no_setup = self.setup.as_ref().err().map(NoSetup::to_string);
        let down = self.down.get(&WatchedThread::Rectify).cloned();
        let no_rectified_because = no_setup
            .or_else(|| self.misfit().map(|misfit| misfit.to_string()))
            .or(down)
            .or_else(|| self.failed.clone());
        LiveView {
            wanted: self.wanted,
            raw: self.raw.clone(),
            rectified: self.rectified.clone(),
            disparity: self.disparity.clone(),
            corners: self.corners.clone(),
            probe: self.probe_view(no_rectified_because.as_deref()),
            aim: self.setup.as_ref().ok().map(|setup| aim_view(self.aim, &setup.pair)),
            no_rectified_because,
            head: self.head,
            nominal_lenses: self.calibration.is_none() && self.nominal.is_some(),
            statistics,
        }
    }

    fn probe_view(&self, nothing_because: Option<&str>) -> Option<ProbeView> {
        let asked = self.probe_asked?;
        let nothing_because = self.down.get(&WatchedThread::Probe).map(String::as_str).or(nothing_because);
        match (nothing_because, &self.probe) {
            (Some(reason), _) => {
                let reading = Err(NotMeasured::Nothing(reason.to_owned()));
                Some(ProbeView { asked, stamp: None, reading })
            }
            (None, probe) => probe.clone(),
        }
    }
}

fn aim_view(choice: AimChoice, pair: &AimedPair) -> AimView {
    let across = |pixels: u32| 2.0 * (0.5 * (f64::from(pixels) - 1.0) / pair.f_px).atan();
    AimView {
        choice,
        pitch_rad: pair.down_rad(),
        size_px: pair.size_px(),
        focal_px: pair.f_px,
        field_of_view_rad: (across(pair.width_px), across(pair.height_px)),
        baseline_m: pair.baseline_m,
    }
}

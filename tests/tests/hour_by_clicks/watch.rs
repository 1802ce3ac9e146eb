//! What is watched in every frame of the way: whether the arm was stopped by something else than the
//! operator, and whether the window stutters.

use std::time::Duration;

use plumbline_engine::view::{MotionState, StepState, TouchPhase};
use plumbline_engine::{NoticeLevel, View};

/// A frame that takes longer is seen to stutter.
const SLOW: Duration = Duration::from_millis(100);

/// What was seen from the beginning of the way.
#[derive(Debug, Default)]
pub struct Watch {
    /// What stopped the arm, where the operator did not: in words.
    pub pauses: Vec<String>,
    /// Frames over 100 ms while nothing is computed, with what was done.
    pub slow: Vec<String>,
    /// Frames so far.
    pub frames: u64,
    /// The longest frame while nothing was computed.
    pub longest: Duration,
    /// What stopped it in the frame before: it is counted once.
    stops: Option<String>,
    /// Messages up to this number were looked at.
    last_notice: u64,
    /// Warnings of the way, for who reads the table.
    pub warnings: Vec<String>,
}

impl Watch {
    /// Looks at the view that a frame has drawn.
    pub fn look(&mut self, view: &View) {
        let stops = stopped_by(view);
        if let Some(why) = stops.clone().filter(|_| stops != self.stops) {
            println!("           pause: {why}");
            self.pauses.push(why);
        }
        self.stops = stops;
        let newest = view.notices.iter().map(|notice| notice.number).max().unwrap_or(0);
        for notice in view.notices.iter().filter(|notice| notice.number > self.last_notice) {
            if !matches!(notice.level, NoticeLevel::Info | NoticeLevel::Success) {
                self.warnings.push(notice.text.clone());
            }
        }
        self.last_notice = self.last_notice.max(newest);
    }

    /// Takes in how long a frame took of the processor; `computing`: work was under way for it.
    pub fn frame(&mut self, took: Duration, computing: bool, doing: &str) {
        self.frames += 1;
        if computing {
            return;
        }
        self.longest = self.longest.max(took);
        if took > SLOW {
            let said = format!("{:.0} ms, {doing}", took.as_secs_f64() * 1e3);
            println!("           slow frame: {said}");
            self.slow.push(said);
        }
    }
}

/// Why the arm stands, where the operator did not make it.
fn stopped_by(view: &View) -> Option<String> {
    let robot = &view.robot;
    if robot.stopped {
        return Some("STOP is latched".to_owned());
    }
    if let Some(refusal) = &robot.refusal {
        return Some(format!("refused: {refusal}"));
    }
    match &view.touch.phase {
        TouchPhase::Paused { why } => {
            return Some(format!("run paused: {}", why.as_deref().unwrap_or("nobody says why")));
        }
        TouchPhase::Waiting { what, .. } => return Some(format!("run waits: {what}")),
        _ => {}
    }
    if view.mount.tour.is_some_and(|tour| tour.waits) {
        return Some("the head waits on its tour until joints are heard".to_owned());
    }
    match &robot.motion {
        MotionState::Holding { why: Some(why) } => Some(format!("holds: {why}")),
        _ => None,
    }
}

/// Whether work goes on that the operator waits for: then there is nothing to press.
pub fn is_under_way(view: &View) -> bool {
    let moves = matches!(view.robot.motion, MotionState::Moving { .. });
    let touches = matches!(view.touch.phase, TouchPhase::Planning | TouchPhase::Running { .. });
    let looks = view.mount.tour.is_some() || view.mount.step == StepState::Running;
    let shows = view.twin.board_tour.is_some();
    moves || touches || looks || shows || view.running_job().is_some()
}

/// Whether something is computed in the background.
pub fn is_computing(view: &View) -> bool {
    view.jobs.iter().any(|job| job.state.is_running()) || view.models.training || view.gap.searching.is_some()
}

//! Watching drift: what is the matter, and what to do about it.

use plumbline_engine::View;
use plumbline_engine::view::{DriftMover, DriftVerdict};

use super::sentence::{Guidance, say};
use super::{eyes_off, source_trouble};
use crate::operator::{Action, Screen, words};

pub(super) fn drift(view: &View) -> Guidance {
    let drift = &view.drift;
    if !drift.is_watching {
        if let Some(guidance) = source_trouble(view) {
            return guidance;
        }
        if let Some(guidance) = eyes_off(view) {
            return guidance;
        }
        let said = if drift.course.is_some() {
            "Not watched any more: what is shown is what was seen until then."
        } else {
            "Nobody watches whether places stay where they are. Nothing moves for it."
        };
        return say(said).then("Start watching", Action::WatchDrift);
    }
    let stop = |guidance: Guidance| guidance.then("Stop watching", Action::WatchDrift);
    if let Some(why) = &drift.failed {
        return stop(say(why.clone()).warn());
    }
    let Some(course) = &drift.course else {
        let why = drift.waits_because.clone().unwrap_or_else(|| "Looks for the first time.".to_owned());
        return stop(say(why));
    };
    match course.verdict {
        DriftVerdict::Moved(alarm) => {
            let guidance = say(course.sentence.clone()).warn();
            match alarm.what {
                DriftMover::Head => guidance.then("Go to Mount", Action::Go(Screen::Mount)),
                _ => guidance.then("Calibrate the eyes", Action::Go(Screen::Collect)),
            }
        }
        DriftVerdict::Warming { .. } => stop(say(course.sentence.clone()).warn()),
        _ => match &drift.waits_because {
            Some(why) => stop(say(why.clone())),
            None => stop(match &drift.anew {
                Some(anew) => say(words::drift::anew(anew)).warn(),
                None => say(course.sentence.clone()),
            }),
        },
    }
}

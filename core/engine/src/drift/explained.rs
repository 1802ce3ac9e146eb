//! What was watched is made a session, to be explained where all that is missing is looked for.

use std::path::PathBuf;

use plumbline_drift::is_too_short;

use super::DriftAround;
use super::cold::counted_twice;
use super::work::{Context, DriftWork};
use super::workflow::DriftWorkflow;
use crate::ground::notice::NoticeLevel;

impl DriftWorkflow {
    pub(super) fn explain(&mut self, around: &DriftAround, context: &mut Context<'_>) {
        if let Some(why) = self.unexplained(around) {
            return context.refuse(format!("What was watched cannot be explained: {why}."));
        }
        let (Some(watch), Some(world)) = (&self.watch, around.world) else { return };
        for words in counted_twice(around) {
            context.notices.add(NoticeLevel::Warning, words);
        }
        self.logging = Some(context.start(DriftWork::WriteLog {
            sessions: world.folder(&self.data_dir).join("sessions"),
            samples: watch.monitor.samples().into(),
            model: around.model.clone(),
            posture: around.posture(),
            at: context.time.day,
        }));
    }

    /// Why what was watched cannot be explained now, a part of a sentence; `None`: it can.
    pub(super) fn unexplained(&self, around: &DriftAround) -> Option<&'static str> {
        let Some(watch) = &self.watch else { return Some("nothing is being watched") };
        if self.logging.is_some() || self.retelling.is_some() {
            return Some("it is being worked at already; wait a moment");
        }
        if !watch.from_switching_on && around.is_recorded {
            return Some("this recording does not say when its cameras were switched on");
        }
        if !watch.from_switching_on {
            return Some(
                "nobody knows when the cameras were switched on; say it at the clock in the top line, and it is \
                 watched anew",
            );
        }
        if around.world.is_none() {
            return Some("the eyes that are shown are not those of the robot that is connected");
        }
        let samples = watch.monitor.samples();
        let span_s = samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.at_s - first.at_s);
        is_too_short(samples.len(), span_s)
            .then_some("it has to be watched for at least 3 minutes, better 10")
    }

    /// The session that was made of what was watched, once.
    pub fn next_log(&mut self) -> Option<PathBuf> {
        let (log, told) = self.log.as_mut()?;
        (!std::mem::replace(told, true)).then(|| log.clone())
    }
}

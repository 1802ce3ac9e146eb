//! What a watch tells of where places are now, for whoever judged the eyes.

use std::sync::Arc;

use plumbline_effects::RobotModel;

use super::view::DriftPoint;
use super::workflow::DriftWorkflow;

/// What a watch tells of where places are now.
#[derive(Clone, Copy, Debug)]
pub enum Told<'a> {
    /// It has not looked yet.
    Nothing,
    /// What was seen is being told with another model.
    Anew,
    /// With which model, and the newest look.
    Newest(&'a Arc<RobotModel>, &'a DriftPoint),
}

impl DriftWorkflow {
    /// Which watch it is, counted, and what it tells, also when it has ended; `None`: there was none, or it was of another
    /// source than the one `opened` counts: other eyes, or these before.
    pub fn newest(&self, opened: u64) -> Option<(u64, Told<'_>)> {
        let (model, watched) = match &self.watch {
            Some(watch) => (&watch.model, watch.opened),
            None => self.told_with.as_ref().map(|(model, watched)| (model, *watched))?,
        };
        if watched != opened {
            return None;
        }
        let newest = self.course.as_ref().and_then(|course| course.points.last());
        let told = match newest {
            _ if self.retelling.is_some() => Told::Anew,
            Some(newest) => Told::Newest(model, newest),
            None => Told::Nothing,
        };
        Some((self.number, told))
    }
}

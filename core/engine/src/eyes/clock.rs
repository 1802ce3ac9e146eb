//! For how long the cameras have been on: said once, it goes on by itself.

use std::time::{Duration, Instant};

use plumbline_hardware::SourceSpec;

use crate::source::view::{SourceStatus, SourceView};

/// Cameras that were away for no longer than this are as warm as before: their housings take minutes.
const SHORTLY_AWAY: Duration = Duration::from_secs(30);

/// Told when cameras that were away for longer are back.
pub(super) const BEGINS_ANEW: &str = "The cameras were away and are back: the time since they were switched on counts \
     from now. If they had power meanwhile, say at the clock in the top line for how long they have been on.";

/// For how long the cameras have been on. Unknown until somebody says it, or until they are seen to come back:
/// cameras that deliver when they are opened may have been on for hours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CamerasClock {
    /// How long, s, at which moment.
    set: Option<(f64, Instant)>,
    lost_since: Option<Instant>,
}

impl CamerasClock {
    /// The operator says how long they have been on; `None`: not known.
    pub fn say(&mut self, minutes: Option<f64>, now: Instant) {
        self.set = minutes.map(|minutes| (60.0 * minutes, now));
    }

    /// How long, s; `None`: nobody knows, or they were not on then.
    pub fn on_s(&self, when: Instant) -> Option<f64> {
        let (on_s, at) = self.set?;
        let later_s = when.saturating_duration_since(at).as_secs_f64();
        let earlier_s = at.saturating_duration_since(when).as_secs_f64();
        Some(on_s + later_s - earlier_s).filter(|on_s| *on_s >= 0.0)
    }

    /// The same in minutes, for people: it goes on by whole seconds, the window need not be drawn again for less.
    pub fn shown_min(&self, now: Instant) -> Option<f64> {
        let (on_s, at) = self.set?;
        let later_s = now.saturating_duration_since(at).as_secs();
        Some(on_s / 60.0 + later_s as f64 / 60.0)
    }

    /// The source says how it is doing; whether the clock began anew, because the cameras were away for long.
    pub fn follow(&mut self, source: &SourceView, now: Instant) -> bool {
        if !matches!(source.spec, Some(SourceSpec::Cameras { .. })) {
            self.lost_since = None;
            return false;
        }
        match &source.status {
            SourceStatus::Lost { since, .. } => {
                self.lost_since.get_or_insert(*since);
            }
            // Held still they are on, too.
            SourceStatus::Running | SourceStatus::Paused => {
                let away = self.lost_since.take().map(|since| now.saturating_duration_since(since));
                if away.is_some_and(|away| away > SHORTLY_AWAY) {
                    self.set = Some((0.0, now));
                    return true;
                }
            }
            _ => {}
        }
        false
    }
}

/// Whether pairs come as they are taken; a recording was taken at another time, and so were photographs.
pub(super) fn is_live(source: &SourceView) -> bool {
    source.replay.is_none() && !source.photographs
}

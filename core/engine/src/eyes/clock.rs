//! For how long the cameras have been on: said once, it goes on by itself.

use std::time::{Duration, Instant};

use plumbline_hardware::SourceSpec;

use crate::ground::Time;
use crate::source::view::{SourceStatus, SourceView};

/// Cameras that were away for no longer than this are as warm as before: their housings take minutes.
const SHORTLY_AWAY: Duration = Duration::from_secs(30);

/// Between two looks both clocks of a machine that is awake differ by less: only the time of day goes on while it
/// sleeps.
const SLEPT: Duration = Duration::from_secs(60);

/// Told when cameras that were away for longer are back.
pub(super) const BEGINS_ANEW: &str = "The cameras were away and are back: the time since they were switched on counts \
     from now. If they had power meanwhile, say at the clock in the top line for how long they have been on.";

/// Told when the machine slept, or its time of day was set.
pub(super) const IS_UNKNOWN: &str = "This computer slept, or its time of day was set: it is not known any more how \
     long the cameras have been on. Say it at the clock in the top line.";

/// For how long the cameras have been on. Unknown until somebody says it, or until they are seen to come back:
/// cameras that deliver when they are opened may have been on for hours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CamerasClock {
    /// How long, s, at which moment.
    set: Option<(f64, Instant)>,
    lost_since: Option<Instant>,
    /// Of which two cameras, the smaller number first.
    cameras: Option<[u32; 2]>,
    /// Counts how often it was set.
    settings: u64,
    /// When it was looked at last.
    looked: Option<Time>,
}

impl CamerasClock {
    /// The operator says how long they have been on; `None`: not known.
    pub fn say(&mut self, minutes: Option<f64>, now: Time) {
        self.set = minutes.map(|minutes| (60.0 * minutes, now.instant));
        self.settings += 1;
        self.looked = Some(now);
    }

    /// Counts how often it was set: times before and after are of different clocks.
    pub fn settings(&self) -> u64 {
        self.settings
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

    /// The source says how it is doing; a word for the operator where that changes what is known.
    pub fn follow(&mut self, source: &SourceView, now: Time) -> Option<&'static str> {
        let slept = self.forget_if_it_slept(now).then_some(IS_UNKNOWN);
        let Some(SourceSpec::Cameras { left_index, right_index }) = &source.spec else { return slept };
        let cameras = [*left_index.min(right_index), *left_index.max(right_index)];
        if self.cameras.replace(cameras).is_some_and(|before| before != cameras) {
            // Nobody knows how long other ones have been on.
            self.set = None;
            self.lost_since = None;
            self.settings += 1;
        }
        match &source.status {
            SourceStatus::Lost { since, .. } => {
                self.lost_since.get_or_insert(*since);
            }
            // Held still they are on, too.
            SourceStatus::Running | SourceStatus::Paused => {
                let away = self.lost_since.take().map(|since| now.instant.saturating_duration_since(since));
                if away.is_some_and(|away| away > SHORTLY_AWAY) {
                    self.set = Some((0.0, now.instant));
                    self.settings += 1;
                    return Some(BEGINS_ANEW);
                }
            }
            _ => {}
        }
        slept
    }

    /// An [`Instant`] stands still while the machine sleeps, and the cameras may have had power or not: whether
    /// something that was known is known no more.
    fn forget_if_it_slept(&mut self, now: Time) -> bool {
        let Some(before) = self.looked.replace(now) else { return false };
        let by_instants_s = now.instant.saturating_duration_since(before.instant).as_secs_f64();
        let by_day_s = now.day.duration_since(before.day).as_secs_f64();
        if (by_day_s - by_instants_s).abs() <= SLEPT.as_secs_f64() || self.set.take().is_none() {
            return false;
        }
        self.settings += 1;
        true
    }
}

/// Whether pairs come as they are taken; a recording was taken at another time, and so were photographs. Where
/// nothing is open, nothing comes.
pub(super) fn is_live(source: &SourceView) -> bool {
    source.spec.is_some() && source.replay.is_none() && !source.photographs
}

//! For how long the eyes had been on: now, and when pairs were taken.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::SourceSpec;
use plumbline_model::{EyesThen, StereoFrame};

use super::clock::is_live;
use super::view::Taken;
use super::work::Context;
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::Time;
use crate::source::view::SourceView;

/// A year: nobody knows better how long cameras were on.
const LONGEST_ON_MINUTES: f64 = 527_040.0;

impl EyesWorkflow {
    pub(super) fn set_minutes(
        &mut self,
        minutes: Option<f64>,
        around: &EyesAround,
        context: &mut Context<'_>,
    ) {
        match minutes {
            Some(value) if !(0.0..=LONGEST_ON_MINUTES).contains(&value) => {
                context.refuse(format!("Give the minutes since the cameras were switched on as a number from 0 to {LONGEST_ON_MINUTES}, or leave it empty."));
            }
            _ if around.source.spec == Some(SourceSpec::Twin) => {
                context.refuse("The twin knows for how long its eyes have been on.");
            }
            minutes if is_live(&around.source) => self.clock.say(minutes, context.time),
            minutes => self.minutes_of_pairs = minutes,
        }
    }

    /// For how long the eyes that this source shows have been on, s; `None`: nobody knows. What was said of
    /// photographs stands still; a recording does not say it.
    pub fn on_s(&self, source: &SourceView, now: Instant) -> Option<f64> {
        match is_live(source) {
            true => self.clock.on_s(now),
            false => self.minutes_of_pairs.filter(|_| source.photographs).map(|minutes| 60.0 * minutes),
        }
    }

    /// The source says how it is doing; a word for the operator where that changes what is known of the cameras.
    pub fn follow(&mut self, source: &SourceView, now: Time) -> Option<&'static str> {
        let before = self.clock;
        let words = self.clock.follow(source, now);
        if self.clock.settings() != before.settings() {
            // Pairs that were taken by it keep their time.
            self.clocks_before.push((now.instant, before));
        }
        words
    }

    /// Counts how often the time since the cameras were switched on was set.
    pub fn clock_settings(&self) -> u64 {
        self.clock.settings()
    }

    /// For how long the eyes had been on when the collected pairs were taken, min, in the mean of those of which it
    /// is known; `None`: nobody knows.
    pub(super) fn minutes_of_collected(&self) -> Option<f64> {
        let dropped = self.collection.dropped();
        let used = self.collection.pairs().iter().filter(|pair| !dropped.contains(&pair.name));
        let live: Vec<Taken> = used.filter_map(|pair| pair.taken).collect();
        if live.is_empty() {
            return self.minutes_of_pairs;
        }
        let known: Vec<f64> = live.into_iter().filter_map(|taken| self.minutes_at(taken)).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    }

    /// For how long the eyes had been on when each collected pair was taken, min.
    pub(super) fn minutes_of_each(&self) -> Arc<[Option<f64>]> {
        self.derived.collected.iter().map(|pair| self.minutes_at(pair.taken?)).collect()
    }

    fn minutes_at(&self, taken: Taken) -> Option<f64> {
        match taken {
            Taken::After(minutes) => Some(minutes),
            Taken::At(when) => {
                let of_then = self.clocks_before.iter().find(|(until, _)| when <= *until);
                of_then.map_or(&self.clock, |(_, clock)| clock).on_s(when).map(|on_s| on_s / 60.0)
            }
        }
    }
}

/// When a pair was taken; `None`: it was not taken live, and its recording does not say.
pub(super) fn taken(frame: &StereoFrame, around: &EyesAround) -> Option<Taken> {
    if let Some(then) = &frame.beside.then {
        return taken_then(then);
    }
    // Pairs of cameras and of the twin have no name yet.
    if frame.name.is_some() || !is_live(&around.source) {
        return None;
    }
    Some(around.twin_on_s.map_or(Taken::At(frame.stamp.captured_at), |on_s| Taken::After(on_s / 60.0)))
}

/// As its recording says of a pair.
pub(in crate::eyes) fn taken_then(then: &EyesThen) -> Option<Taken> {
    then.on_s.map(|on_s| Taken::After(on_s / 60.0))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use image::RgbImage;
    use plumbline_model::robot::default_rig;
    use plumbline_model::{Beside, Stamp};

    use super::super::view::CollectedPair;
    use super::*;
    use crate::ground::Workflow as _;
    use crate::source::view::SourceStatus;

    fn pair(name: &str, taken: Taken) -> CollectedPair {
        CollectedPair {
            name: name.to_owned(),
            left: None,
            right: None,
            left_image: None,
            right_image: None,
            place: None,
            taken: Some(taken),
        }
    }

    #[test]
    fn pairs_keep_the_time_at_which_they_were_taken_when_cameras_are_switched_on_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut room = EyesWorkflow::new(folder.path());
        let start = Time::now();
        let at = |seconds| start.after(Duration::from_secs(seconds));
        let spec = SourceSpec::Cameras { left_index: 0, right_index: 2 };
        let cameras = |status| SourceView { spec: Some(spec.clone()), status, ..SourceView::default() };
        let lost = SourceStatus::Lost { reason: "gone".to_owned(), since: at(200).instant, attempts: 0 };
        room.follow(&cameras(SourceStatus::Running), start);
        room.clock.say(Some(10.0), start);
        for (name, seconds) in [("a", 60), ("b", 180)] {
            let pair = pair(name, Taken::At(at(seconds).instant));
            room.collection.add(pair, [(640, 480); 2]).expect("it fits");
        }
        let is_mean = |room: &EyesWorkflow, expected_min: f64| {
            room.minutes_of_collected().is_some_and(|minutes| (minutes - expected_min).abs() < 1e-6)
        };
        assert!(is_mean(&room, 12.0), "{:?}", room.minutes_of_collected());
        room.clock.say(Some(23.0), at(180));
        assert!(is_mean(&room, 22.0), "a correction is of them, too: {:?}", room.minutes_of_collected());
        room.follow(&cameras(lost), at(200));
        room.follow(&cameras(SourceStatus::Running), at(500));
        room.clock.say(Some(1.0), at(510));
        assert!(is_mean(&room, 22.0), "they were away later: {:?}", room.minutes_of_collected());
        room.refresh();
        let each = room.minutes_of_each();
        let is =
            |minutes: Option<f64>, expected: f64| minutes.is_some_and(|min| (min - expected).abs() < 1e-6);
        assert!(each.len() == 2 && is(each[0], 21.0) && is(each[1], 23.0), "each by its own time: {each:?}");
        room.collection.drop_pair("a").expect("it is there");
        assert!(is_mean(&room, 23.0), "of those that are used: {:?}", room.minutes_of_collected());
    }

    #[test]
    fn pairs_of_the_twin_are_taken_by_the_clock_of_the_twin() {
        let source = SourceView { spec: Some(SourceSpec::Twin), ..SourceView::default() };
        let around = EyesAround {
            newest: None,
            source: Arc::new(source),
            twin_on_s: Some(600.0),
            rig: default_rig(),
            arm_moves: false,
            is_watched: false,
            drifted: None,
            is_corrected: false,
        };
        let gray = Arc::new(RgbImage::new(64, 48));
        let stamp = Stamp { seq: 0, captured_at: Instant::now() };
        let frame = StereoFrame {
            stamp,
            left: gray.clone(),
            right: gray,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        assert_eq!(taken(&frame, &around), Some(Taken::After(10.0)));
        let named = StereoFrame { name: Some("01.png".to_owned()), ..frame };
        assert_eq!(taken(&named, &around), None, "a file was not taken just now");
        let recorded = |on_s| {
            let beside = Beside { then: Some(EyesThen { on_s, head_rad: None }), jpegs: None };
            taken(&StereoFrame { beside, ..named.clone() }, &around)
        };
        assert_eq!(
            recorded(Some(120.0)),
            Some(Taken::After(2.0)),
            "a recording says when its pairs were taken"
        );
        assert_eq!(recorded(None), None, "an older one does not");
    }
}

//! How the eyes were when a pair was taken: what a recording is told of it, and what is taken from one that is played.

use plumbline_hardware::SourceSpec;
use plumbline_model::{EyesThen, StereoFrame};
use plumbline_recording::EyePlaces;

use super::State;
use crate::command::HeadPose;
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;

/// Whether a source was recorded at another time, by this program.
pub(super) fn is_recording(source: Option<&SourceSpec>) -> bool {
    matches!(source, Some(SourceSpec::Recording { .. }))
}

impl State {
    /// How the eyes are that the source shows, as far as that is known.
    pub(super) fn eyes_then(&self) -> EyesThen {
        EyesThen { on_s: self.eyes_on_s(self.shown), head_rad: self.head_rad() }
    }

    /// Where they are; `None`: it is not known how the head stands.
    pub(super) fn eye_places(&self) -> Option<EyePlaces> {
        let head_rad = self.head_rad()?;
        let model = self.models.of(self.shown);
        let rig = model.rig();
        let posture = rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &head_rad);
        let right_from_left = rig.eyes.cameras.right_from_left;
        Some(EyePlaces { robot_from_left: model.robot_from_left(&posture), right_from_left })
    }

    /// Pan and tilt of the head whose eyes the source shows.
    fn head_rad(&self) -> Option<[f64; 2]> {
        let eyes = &self.models.of(self.shown).rig().eyes;
        let posture = self.robot.known(&[eyes.pan, eyes.tilt])?;
        let is_own =
            self.shows_own_eyes() && self.shown == self.arm_of && self.robot.connection.is_connected();
        is_own.then(|| [posture[eyes.pan], posture[eyes.tilt]])
    }

    /// Places of a pair that was recorded are put by the head and the time of then.
    pub(super) fn follow_recorded(&mut self, opened: u64, frame: &StereoFrame) {
        let Some(then) = frame.beside.then else { return };
        let is_first = self.then.is_none() || self.shown_of != opened;
        self.then = Some(then);
        let recorded = then.head_rad.map(|[head_z_rad, head_y_rad]| HeadPose { head_z_rad, head_y_rad });
        // Where it does not say so, the head of another recording is none of it.
        if let Some(head) = recorded.or_else(|| is_first.then(HeadPose::default)) {
            self.rooms.live.set_head(head);
            self.use_workspace();
        }
        if is_first {
            self.say_what_is_missing(then);
        }
    }

    /// A recording was closed: the head stands as it does now.
    pub(super) fn leave_recorded(&mut self) {
        if self.then.take().is_none() {
            return;
        }
        let head = self.head_rad();
        let now = head.map(|[head_z_rad, head_y_rad]| HeadPose { head_z_rad, head_y_rad });
        self.rooms.live.set_head(now.unwrap_or_default());
    }

    fn say_what_is_missing(&mut self, then: EyesThen) {
        let said = [
            (then.on_s.is_none()).then_some(
                "for how long its cameras had been on: no effect that grows with time is taken off",
            ),
            (then.head_rad.is_none())
                .then_some("how the head stood: places are put as if it looked at the table as usual"),
        ];
        let said: Vec<&str> = said.into_iter().flatten().collect();
        if !said.is_empty() {
            let text = sentence(&format!("this recording does not say {}", said.join(", nor ")));
            self.notices.add(NoticeLevel::Info, text);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Instant;

    use image::RgbImage;
    use plumbline_model::{Beside, Stamp};

    use super::*;
    use crate::ground::World;
    use crate::source::view::{ReplayView, SourceStatus, SourceView};

    fn played(opened: u64) -> SourceView {
        let spec = SourceSpec::Recording { file: "log.mcap".into(), of_twin: false };
        let replay = ReplayView {
            position: Some(0),
            length: 9,
            playing: true,
            looping: true,
            pairs_per_second: None,
            growth: Default::default(),
        };
        SourceView {
            opened,
            spec: Some(spec),
            status: SourceStatus::Running,
            replay: Some(replay),
            ..SourceView::default()
        }
    }

    fn pair(seq: u64, then: EyesThen) -> StereoFrame {
        let image = Arc::new(RgbImage::new(8, 8));
        StereoFrame {
            stamp: Stamp { seq, captured_at: Instant::now() },
            left: image.clone(),
            right: image,
            time_difference_s: None,
            name: Some(format!("pair {seq}")),
            beside: Beside { jpegs: None, then: Some(then) },
        }
    }

    fn said(state: &mut State) -> Vec<String> {
        state.notices.view().iter().map(|notice| notice.text.clone()).collect()
    }

    #[test]
    fn places_of_a_recording_are_put_by_the_head_and_the_time_of_then() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut state = State::new(folder.path());
        state.source_changed(played(1));
        for (seq, on_s, pan_rad) in [(1, 600.0, 0.3), (2, 601.5, -0.2)] {
            let then = EyesThen { on_s: Some(on_s), head_rad: Some([pan_rad, -0.5]) };
            state.frame(1, pair(seq, then), Instant::now());
            assert_eq!(state.eyes_on_s(World::Robot), Some(on_s));
            let setup = state.rooms.live.setup().expect("lenses of the description");
            let eyes = &setup.model.rig().eyes;
            assert_eq!([setup.posture[eyes.pan], setup.posture[eyes.tilt]], [pan_rad, -0.5]);
            assert_eq!(setup.eyes_on_s, Some(on_s.floor()));
            assert_eq!(state.eyes_on_s(World::Twin), None, "it is of the robot");
        }
        assert_eq!(said(&mut state), [""; 0]);
        // Closed, nobody knows any more.
        state.source_changed(SourceView { opened: 2, ..SourceView::default() });
        assert_eq!(state.eyes_on_s(World::Robot), None);
    }

    #[test]
    fn what_an_older_recording_does_not_say_is_said_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut state = State::new(folder.path());
        state.source_changed(played(1));
        (1..4).for_each(|seq| state.frame(1, pair(seq, EyesThen::default()), Instant::now()));
        let all = said(&mut state);
        let [words] = &all[..] else { panic!("{all:?}") };
        assert!(words.contains("had been on") && words.contains("how the head stood"), "{words}");
        assert_eq!(state.eyes_on_s(World::Robot), None, "no zero");
    }
}

//! How the eyes were when a pair was taken: what a recording is told of it, and what is taken from one that is played.

use std::time::{Duration, Instant};

use plumbline_hardware::SourceSpec;
use plumbline_model::robot::JointIndex;
use plumbline_model::{EyesThen, StereoFrame};
use plumbline_recording::EyePlaces;

use super::State;
use crate::command::HeadPose;
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;
use crate::robot::view::MotionState;

/// A joint of the head that turns no faster than this stands, rad/s.
const STANDS_RAD_S: f64 = 0.05;
/// Where a head was that turns is known for so long before and after it was read.
const KNOWN_FOR: Duration = Duration::from_millis(100);

/// Whether a source was recorded at another time, by this program.
pub(super) fn is_recording(source: Option<&SourceSpec>) -> bool {
    matches!(source, Some(SourceSpec::Recording { .. }))
}

impl State {
    /// How the eyes that the source shows were when a pair was captured just now, as far as that is known.
    pub(super) fn eyes_then(&self, captured_at: Instant) -> EyesThen {
        EyesThen { on_s: self.eyes_on_s(self.shown), head_rad: self.head_at(captured_at) }
    }

    /// Where they were; `None`: it is not known how the head stood.
    pub(super) fn eye_places(&self, captured_at: Instant) -> Option<EyePlaces> {
        let head_rad = self.head_at(captured_at)?;
        let model = self.models.of(self.shown);
        let rig = model.rig();
        let posture = rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &head_rad);
        let right_from_left = rig.eyes.cameras.right_from_left;
        Some(EyePlaces { robot_from_left: model.robot_from_left(&posture), right_from_left })
    }

    /// Pan and tilt of the head at a time, by how it was read last and how fast it turned then.
    fn head_at(&self, when: Instant) -> Option<[f64; 2]> {
        let eyes = &self.models.of(self.shown).rig().eyes;
        let [pan_rad, tilt_rad] = self.head_rad()?;
        Some([
            pan_rad + self.turned_since_read_rad(eyes.pan, when)?,
            tilt_rad + self.turned_since_read_rad(eyes.tilt, when)?,
        ])
    }

    /// How far a joint had turned at a time since it was read, rad; `None`: it turns, and that is not known.
    fn turned_since_read_rad(&self, joint: JointIndex, when: Instant) -> Option<f64> {
        let Some(joint) = self.robot.joints.iter().find(|view| view.joint == joint) else {
            return Some(0.0);
        };
        let Some(speed_rad_s) = joint.speed_rad_s else {
            let may_turn = matches!(self.robot.motion, MotionState::Moving { .. });
            return (!may_turn).then_some(0.0);
        };
        if speed_rad_s.abs() <= STANDS_RAD_S {
            return Some(0.0);
        }
        let read_at = self.robot_told_at?.checked_sub(joint.age?)?;
        let [after, before] =
            [when.saturating_duration_since(read_at), read_at.saturating_duration_since(when)];
        let is_near = after.max(before) <= KNOWN_FOR;
        is_near.then_some(speed_rad_s * (after.as_secs_f64() - before.as_secs_f64()))
    }

    /// Pan and tilt of the head whose eyes the source shows, as they were read last.
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
        // A head whose place is not known while it turns is taken for where it was seen last.
        let seen_rad = self.then.filter(|_| !is_first).and_then(|before| before.head_rad);
        self.then = Some(EyesThen { head_rad: then.head_rad.or(seen_rad), ..then });
        let recorded = then.head_rad.map(|[head_z_rad, head_y_rad]| HeadPose { head_z_rad, head_y_rad });
        // Where it does not say so, the head of another recording is none of it.
        if let Some(head) = recorded.or_else(|| is_first.then(HeadPose::default)) {
            self.rooms.live.set_recorded_head(head);
            self.use_workspace();
        }
        if is_first {
            self.say_what_is_missing(then);
        }
    }

    /// A recording was closed: the head stands as it does now, or as the operator has set it where no robot says so.
    pub(super) fn leave_recorded(&mut self) {
        if self.then.take().is_none() {
            return;
        }
        let head = self.head_rad();
        let now = head.map(|[head_z_rad, head_y_rad]| HeadPose { head_z_rad, head_y_rad });
        self.rooms.live.leave_recorded_head(now);
        self.use_workspace();
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
    use crate::command::LiveCommand;
    use crate::ground::{Time, World};
    use crate::robot::News;
    use crate::robot::view::{Connection, JointView, RobotView};
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

    fn head(state: &State) -> [f64; 2] {
        let setup = state.rooms.live.setup().expect("lenses of the description");
        let eyes = &setup.model.rig().eyes;
        [setup.posture[eyes.pan], setup.posture[eyes.tilt]]
    }

    #[test]
    fn the_head_that_the_operator_has_set_comes_back_when_a_recording_is_closed() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut state = State::new(folder.path());
        let set = HeadPose { head_z_rad: 0.4, head_y_rad: -0.3 };
        state.apply_at(LiveCommand::Head(set).into(), Time::now());
        for then in [[0.1, -0.5], [0.2, -0.6]] {
            state.source_changed(played(1));
            state.frame(1, pair(1, EyesThen { on_s: None, head_rad: Some(then) }), Instant::now());
            assert_eq!(head(&state), then);
            // While it turned nobody knew: it is taken for where it was seen last.
            state.frame(1, pair(2, EyesThen { on_s: Some(5.0), head_rad: None }), Instant::now());
            assert_eq!((head(&state), state.then.and_then(|then| then.head_rad)), (then, Some(then)));
            state.source_changed(SourceView { opened: 2, ..SourceView::default() });
            state.rooms.live.use_nominal_lenses(true);
            assert_eq!(head(&state), [0.4, -0.3]);
        }
    }

    #[test]
    fn a_head_that_turns_is_recorded_where_it_was_when_the_pair_was_captured() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut state = State::new(folder.path());
        let time = Time::now();
        state.clock.hold(Some(time));
        let source = SourceView { opened: 1, spec: Some(SourceSpec::Twin), ..SourceView::default() };
        state.source_changed(SourceView { status: SourceStatus::Running, ..source });
        let rig = state.rig.clone();
        let eyes = &rig.eyes;
        let [home_pan, home_tilt] = [rig.home()[eyes.pan], rig.home()[eyes.tilt]];
        let mut told = |speed_rad_s: Option<f64>, motion: MotionState, after_ms: u64| {
            let servo = rig.servo_of(eyes.pan).expect("the head has a servo");
            let age = Some(Duration::from_millis(20));
            let pan = JointView { speed_rad_s, age, ..JointView::unheard(servo, rig.limits(eyes.pan)) };
            let robot = RobotView {
                rig: Some(rig.clone()),
                connection: Connection::Connected { to: "twin".to_owned(), twin: true },
                motion,
                joints: Arc::from([pan]),
                measured: Some(rig.home()),
                ..RobotView::default()
            };
            let news = News { robot: Arc::new(robot), twin: Arc::default(), twins_started: 0 };
            state.robot_changed(news);
            let captured_at = time.after(Duration::from_millis(after_ms)).instant;
            assert_eq!(
                state.eye_places(captured_at).is_some(),
                state.eyes_then(captured_at).head_rad.is_some()
            );
            state.eyes_then(captured_at).head_rad
        };
        let moving = || MotionState::Moving { what: "a look".to_owned(), fraction: None, remaining: None };
        // Read 20 ms before it was told.
        let [pan, tilt] = told(Some(-0.5), moving(), 30).expect("it is known how fast it turns");
        assert!((pan - (home_pan - 0.5 * 0.05)).abs() < 1e-9 && tilt == home_tilt, "{pan}, {tilt}");
        assert_eq!(told(Some(-0.5), moving(), 90), None, "too long after it was read");
        assert_eq!(told(None, moving(), 30), None, "it may turn, and nobody knows how fast");
        let home = Some([home_pan, home_tilt]);
        assert_eq!(told(None, MotionState::Holding { why: None }, 900), home);
        assert_eq!(told(Some(0.01), moving(), 900), home, "the arm moves, and the head stands");
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

//! What the threads have: pairs, looks, the robot's news; and what each is to do next.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::SourceSpec;
use plumbline_model::StereoFrame;
use plumbline_model::robot::Rig;

use super::recorded::is_recording;
use super::rooms::Neighbors;
use super::{Action, State};
use crate::command::HeadPose;
use crate::commission::CommissionWorkflow;
use crate::detect::{DetectInput, DetectOutput, DetectWorkflow};
use crate::drift::{DriftInput, DriftOutput, DriftWorkflow};
use crate::eyes::{CornersInput, EyesWorkflow, Look};
use crate::grasp::GraspWorkflow;
use crate::ground::World;
use crate::ground::stage::Timed;
use crate::live::{ProbeInput, ProbeOutput, RectifyInput, RectifyOutput};
use crate::mount::MountWorkflow;
use crate::recording::RecordingWorkflow;
use crate::robot::view::Connection;
use crate::robot::{News, RobotControl, TouchNews};
use crate::source::view::SourceView;
use crate::source::{Control, Note};
use crate::touch::TouchWorkflow;
use crate::trials::TrialsWorkflow;
use crate::twin::BoardLook;

impl State {
    /// A pair has come from the source.
    ///
    /// `opened` counts the sources opened; a pair of an earlier source comes too late.
    pub fn frame(&mut self, opened: u64, frame: StereoFrame, now: Instant) {
        if opened < self.rooms.source.view().opened {
            return;
        }
        self.follow_recorded(opened, &frame);
        self.shown_of = opened;
        self.rooms.eyes.of_mut(self.shown).set_image_size(frame.left.dimensions());
        self.rooms.grasp.of(self.arm_of).saw(&frame);
        self.rooms.handeye.of(self.arm_of).saw(&frame);
        self.use_eyes_clock();
        // What a source delivers before it is known of is not of the recording of the one before.
        if opened == self.rooms.source.view().opened {
            let is_on = self.rooms.recording.is_on();
            let at = frame.stamp.captured_at;
            let (eyes, places) = (self.eyes_then(at), is_on.then(|| self.eye_places(at)).flatten());
            self.record(|recording, time| recording.saw(&frame, eyes, places, time));
        }
        self.with::<DriftWorkflow>(World::default(), |drift, around, context| {
            drift.saw(&frame, around, context);
        });
        let eyes = self.rooms.eyes.of(self.shown);
        if eyes.wants_pairs() || eyes.may_give_way() || eyes.may_look(self.clock.time().instant) {
            self.with::<EyesWorkflow>(self.shown, |eyes, around, context| eyes.saw(&frame, around, context));
        }
        self.rooms.live.frame(frame, now);
    }

    /// Time passes, whether pairs come or not: nobody waits for an answer without end. Whether something has changed.
    pub fn time_passes(&mut self) -> bool {
        let now = self.clock.time().instant;
        let overdue = World::ALL.map(|world| self.rooms.eyes.of(world).is_overdue(now).then_some(world));
        for world in overdue.into_iter().flatten() {
            self.with::<EyesWorkflow>(world, |eyes, around, context| eyes.time_passes(around, context));
        }
        overdue.iter().any(Option::is_some)
    }

    /// So many pairs of the source, since the program was started, were replaced before they came here.
    pub fn pairs_replaced(&mut self, replaced: u64) {
        self.rooms.recording.were_replaced(replaced);
    }

    /// The thread that watches drift has looked.
    pub fn drift_looked(&mut self, output: Timed<DriftOutput>) {
        self.with::<DriftWorkflow>(World::default(), |drift, _, context| drift.looked(output, context));
    }

    /// What it is to look at, if anything.
    pub fn drift_input(&self) -> Option<Arc<DriftInput>> {
        self.rooms.drift.input()
    }

    /// The source says how it is doing.
    pub fn source_changed(&mut self, view: SourceView) {
        if view.opened != self.rooms.source.view().opened && view.opened != self.shown_of {
            self.rooms.live.clear();
            self.rooms.detect.clear();
        }
        self.shown = self.shown_by(view.spec.as_ref());
        // A recording was made by these eyes, whose head stood otherwise.
        let is_recorded = is_recording(view.spec.as_ref());
        let own_lenses = is_recorded || is_of_this_robot(view.spec.as_ref());
        self.follow_cameras(&view);
        self.rooms.source.update(view);
        self.source_before_silence = None;
        if !is_recorded {
            self.leave_recorded();
        }
        self.with::<RecordingWorkflow>(World::default(), |recording, around, context| {
            recording.follow_source(around, context);
        });
        for world in World::ALL {
            if self.rooms.eyes.of(world).wants_pairs() {
                self.with::<EyesWorkflow>(world, |eyes, around, context| {
                    eyes.source_changed(around, context)
                });
            }
        }
        self.use_models();
        self.rooms.live.use_nominal_lenses(own_lenses);
    }

    /// Whose eyes these are. Where none are open: those of the arm that is, or was, connected.
    fn shown_by(&self, source: Option<&SourceSpec>) -> World {
        source.map_or(self.arm_of, |source| World::of(Some(source)))
    }

    /// The source has a message for the operator.
    pub fn source_note(&mut self, (level, text): Note) {
        self.notices.add(level, text);
    }

    /// The robot or the twin has something new.
    pub fn robot_changed(&mut self, news: News) {
        let eyes_of_this_robot = self.shows_own_eyes();
        let head = |rig: &Rig| news.robot.known(&[rig.eyes.pan, rig.eyes.tilt]).cloned();
        // Where it is not known the view stays aimed as it was; the servos' lamp says which is silent.
        if let Some(rig) = &news.robot.rig
            && let (Some(posture), true) = (head(rig), eyes_of_this_robot)
        {
            let head = HeadPose { head_z_rad: posture[rig.eyes.pan], head_y_rad: posture[rig.eyes.tilt] };
            self.rooms.live.set_head(head);
            self.use_workspace();
        }
        if news.twins_started > self.twins_started {
            self.twins_started = news.twins_started;
            self.actions.push(Action::Source(Control::Open(SourceSpec::Twin)));
        }
        (self.robot, self.twin) = (news.robot, news.twin);
        self.robot_told_at = Some(self.clock.time().instant);
        let robot = self.robot.clone();
        self.record(|recording, time| recording.read(&robot, time));
        self.before_silence = None;
        self.arm_of = match &self.robot.connection {
            Connection::Connected { twin, .. } => World::of_robot(*twin),
            _ => self.arm_of,
        };
        self.shown = self.shown_by(self.rooms.source.view().spec.clone().as_ref());
        self.use_models();
        self.with::<MountWorkflow>(self.shown, |mount, around, context| mount.step(around, context));
        self.with::<TouchWorkflow>(self.arm_of, |touch, around, context| touch.step(around, context));
        if self.rooms.grasp.of(self.arm_of).is_watching() {
            self.with::<GraspWorkflow>(self.arm_of, |grasp, around, context| grasp.watch(around, context));
        }
        self.with::<TrialsWorkflow>(self.arm_of, |trials, around, context| trials.step(around, context));
        self.with::<CommissionWorkflow>(self.arm_of, |room, around, context| room.look(around, context));
    }

    /// The robot's thread tells how a touch is doing.
    pub fn touch_news(&mut self, news: TouchNews) {
        self.with::<TouchWorkflow>(self.arm_of, |touch, around, context| touch.news(news, around, context));
    }

    /// Rectification has something.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        self.rooms.live.rectified(output, now);
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        self.rooms.live.probed(output, now);
    }

    /// The chessboard search has something.
    pub fn looked(&mut self, output: Timed<Look>, now: Instant) {
        self.rooms.live.corners(&output, now);
        let look = output.result;
        if self.rooms.mount.of(self.shown).wants_corners() || self.rooms.live.wants_corners() {
            let look = look.clone();
            self.with::<MountWorkflow>(self.shown, |mount, around, context| {
                mount.look(look, around, context)
            });
        }
        let captured_at = look.frame.stamp.captured_at;
        self.with::<EyesWorkflow>(self.shown, |eyes, around, context| eyes.look(look, around, context));
        // Whoever shows the board waits until it was captured.
        if self.twin.board_tour.is_some() && self.shown == World::Twin && self.shows_own_eyes() {
            let is_done = self.shown_eyes().is_done_with_board();
            self.actions.push(Action::Robot(RobotControl::BoardLooked(BoardLook { captured_at, is_done })));
        }
    }

    /// The detector has something.
    pub fn detected(&mut self, output: Timed<DetectOutput>, now: Instant) {
        let before = self.rooms.detect.found().cloned();
        self.rooms.detect.detected(output, self.shown_of, now);
        // What failed, or came too late, leaves what was found before.
        let found = self.rooms.detect.found().cloned();
        let is_new = |found: &Arc<_>| before.as_ref().is_none_or(|before| !Arc::ptr_eq(before, found));
        if let Some(found) = found.filter(is_new) {
            self.record(|recording, time| recording.found(&found, time));
        }
    }

    /// What the detector is to do with the newest pair, if anything.
    pub fn detect_input(&self) -> Option<DetectInput> {
        self.rooms.detect.input(Neighbors::<DetectWorkflow>::around(self, World::default()))
    }

    /// What rectification is to do with the newest pair, if anything.
    pub fn rectify_input(&self) -> Option<RectifyInput> {
        self.rooms.live.rectify_input()
    }

    /// What measuring is to do with the newest pair, if anything.
    pub fn probe_input(&self) -> Option<ProbeInput> {
        self.rooms.live.probe_input()
    }

    /// What the chessboard search is to do with the newest pair, if anything.
    pub fn corners_input(&self) -> Option<CornersInput> {
        let mount_wants = self.rooms.mount.of(self.shown).wants_corners();
        let wanted = self.rooms.live.wants_corners()
            || self.shown_eyes().auto_capture()
            || mount_wants
            || self.rooms.drift.looks_for_board();
        let frame = self.rooms.live.newest().filter(|_| wanted)?.clone();
        Some(CornersInput { frame, board: *self.shown_eyes().board() })
    }

    /// Whether the source shows what a robot or a twin sees now.
    pub(super) fn shows_own_eyes(&self) -> bool {
        is_of_this_robot(self.rooms.source.view().spec.as_ref())
    }
}

fn is_of_this_robot(source: Option<&SourceSpec>) -> bool {
    matches!(source, Some(SourceSpec::Twin | SourceSpec::Cameras { .. }))
}

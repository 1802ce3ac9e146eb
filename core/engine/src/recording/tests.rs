//! From the press to a file that is read again.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use plumbline_hardware::SourceSpec;
use plumbline_model::robot::default_rig;
use plumbline_model::session::Session;
use plumbline_model::{Beside, EyesThen, Stamp, StereoFrame, Unattended};
use plumbline_recording::{EyePlaces, FILE, JointGoal, Jpeg, Recording, Topic};
use serde_json::json;

use super::command::RecordingCommand;
use super::view::{RecordingState, RecordingView};
use super::work::RecordingWork;
use super::{RecordingAround, RecordingWorkflow};
use crate::ground::jobs::list::JobList;
use crate::ground::notice::{NoticeLevel, Notices};
use crate::ground::stage::Skipped;
use crate::ground::{Asked, Context, LongWork as _, Moment, Time, Workflow as _, World};
use crate::robot::view::{JointView, RobotView};

struct Desk {
    room: RecordingWorkflow,
    around: RecordingAround,
    notices: Notices,
    jobs: JobList,
}

impl Desk {
    fn new(folder: &Path, is_live: bool) -> Self {
        let around = RecordingAround {
            world: World::Twin,
            is_live,
            opened: 1,
            spec: Some(SourceSpec::Twin),
            superseded: 0,
            rig: "nico".to_owned(),
            cameras: Some(default_rig().eyes.cameras),
        };
        let room = RecordingWorkflow::new(folder);
        Self { room, around, notices: Notices::default(), jobs: JobList::default() }
    }

    fn apply(&mut self, command: RecordingCommand) {
        self.act(|room, around, context| room.apply(command, around, context));
    }

    /// A pair comes; of the eyes nothing is known.
    fn saw(&mut self, frame: &StereoFrame) {
        self.room.saw(frame, EyesThen::default(), None, Time::now());
    }

    fn finish(&mut self, id: crate::ground::jobs::JobId, work: RecordingWork) {
        let result = work.run(&Unattended);
        let mut asked = Vec::new();
        let Self { room, around, notices, jobs } = self;
        let mut context = Context::new(notices, jobs, Time::now(), &mut asked);
        match result {
            Ok(result) => room.work_done(id, result, around, &mut context),
            Err(error) => {
                context.notices.add(NoticeLevel::Error, error.to_string());
                room.work_ended(id, Some("failed"), around, &mut context);
            }
        }
    }

    fn follow_source(&mut self) {
        self.act(|room, around, context| room.follow_source(around, context));
    }

    fn look_after(&mut self) {
        self.act(|room, _, context| room.look_after(context));
    }

    fn act(
        &mut self,
        act: impl FnOnce(&mut RecordingWorkflow, &RecordingAround, &mut super::work::Context<'_>),
    ) {
        let mut asked = Vec::new();
        let Self { room, around, notices, jobs } = self;
        act(room, around, &mut Context::new(notices, jobs, Time::now(), &mut asked));
        for asked in asked {
            let Asked::Start(id, work) = asked else { continue };
            self.finish(id, work);
        }
    }

    fn view(&mut self) -> Arc<RecordingView> {
        let moment = Moment { now: Instant::now(), skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    fn said(&mut self) -> String {
        self.notices.view().last().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}

fn frame(number: u64) -> StereoFrame {
    let image = |eye: u8| Arc::new(RgbImage::from_pixel(64, 48, Rgb([(number % 10) as u8 + eye; 3])));
    StereoFrame {
        stamp: Stamp { seq: number, captured_at: Instant::now() },
        left: image(0),
        right: image(100),
        time_difference_s: Some(0.001),
        name: None,
        beside: Default::default(),
    }
}

#[test]
fn what_came_while_it_was_on_is_in_the_file_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.saw(&frame(0));
    desk.notices.add(NoticeLevel::Warning, "before");
    assert_eq!(desk.view().state, RecordingState::Off);
    desk.apply(RecordingCommand::Start);
    let RecordingState::On { session, .. } = desk.view().state.clone() else { panic!("{:?}", desk.view()) };
    for number in 1..=6 {
        desk.saw(&frame(number));
    }
    desk.room.asked(&json!({ "workflow": "grasp" }), Time::now());
    desk.notices.add(NoticeLevel::Error, "after");
    let notices = desk.notices.view();
    desk.room.told(&notices);
    desk.room.told(&notices);
    desk.room.read(&RobotView::default(), Time::now());
    desk.apply(RecordingCommand::Start);
    assert!(desk.said().contains("stop it first"), "{}", desk.said());
    desk.apply(RecordingCommand::Stop);
    let view = desk.view();
    assert_eq!(view.state, RecordingState::Off);
    let last = view.last.clone().expect("finished");
    assert_eq!((&last.session, last.so_far.pairs, last.so_far.dropped), (&session, 6, 0));
    desk.saw(&frame(7));

    assert!(session.starts_with(folder.path().join("twin")), "of the twin, beside its other sessions");
    Session::read(&session).expect("a session");
    let mut recording = Recording::open(&session.join(FILE)).expect("a recording");
    assert!(recording.is_whole() && recording.whose().of_twin);
    let numbers: Vec<u32> =
        (0..recording.pair_count()).map(|index| recording.pair(index).expect("readable").number).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6]);
    let notes: Vec<String> =
        recording.notes().expect("readable").into_iter().map(|told| told.what.text).collect();
    assert_eq!(notes, ["before", "after"]);
    assert_eq!(recording.dropped(), Some(0), "that nothing is missing stands in it");
    assert_eq!(recording.told(Topic::Commands).expect("readable")[0].what, json!({ "workflow": "grasp" }));
    assert!(recording.joints().expect("readable").is_empty(), "no joint was read");
    let attached: Vec<&str> = recording.attached().iter().map(|file| file.name.as_str()).collect();
    assert_eq!(attached, ["rig.toml", "robot.urdf", "rig-cameras.yaml"]);
}

#[test]
fn how_the_eyes_were_and_what_the_cameras_sent_is_in_it_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    let rig = default_rig();
    let robot_from_left = rig.robot_from_left(&rig.home());
    let places = EyePlaces { robot_from_left, right_from_left: rig.eyes.cameras.right_from_left };
    let then = EyesThen { on_s: Some(321.0), head_rad: Some([0.2, -0.6]) };
    let sent = [vec![0xff, 0xd8, 1], vec![0xff, 0xd8, 2]];
    let jpegs = Some(sent.clone().map(Arc::from));
    let compressed = StereoFrame { beside: Beside { jpegs, then: None }, ..frame(1) };
    desk.room.saw(&compressed, then, Some(places), Time::now());
    desk.saw(&frame(2));
    desk.apply(RecordingCommand::Stop);
    let session = desk.view().last.as_ref().expect("finished").session.clone();
    let mut recording = Recording::open(&session.join(FILE)).expect("a recording");
    let [first, second] = [0, 1].map(|index| recording.pair(index).expect("readable"));
    assert_eq!((first.eyes, first.images), (then, sent.map(Jpeg)), "not compressed again");
    assert!(second.eyes.is_unknown());
    let told = recording.robot_from_left().expect("readable");
    assert_eq!((told.len(), told[0].at), (1, first.at));
}

#[test]
fn what_joints_are_told_is_in_it_beside_where_they_are_and_limp_ones_are_told_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    let rig = default_rig();
    let robot = |goals_rad: [Option<f64>; 2]| {
        let joint = |k: usize| {
            let servo = &rig.servos[k];
            let unheard = JointView::unheard(servo, rig.limits(servo.joint));
            JointView { angle_rad: Some(0.1), goal_rad: goals_rad[k], ..unheard }
        };
        RobotView { joints: Arc::from([joint(0), joint(1)]), ..RobotView::default() }
    };
    for goals_rad in [[Some(0.3), None], [None, None]] {
        desk.room.read(&robot(goals_rad), Time::now());
    }
    desk.apply(RecordingCommand::Stop);
    let session = desk.view().last.as_ref().expect("finished").session.clone();
    let mut recording = Recording::open(&session.join(FILE)).expect("a recording");
    let (joints, goals) = (recording.joints().expect("readable"), recording.goals().expect("readable"));
    assert_eq!(joints.iter().map(|told| told.what.len()).collect::<Vec<_>>(), [2, 2]);
    let told = JointGoal { name: rig.servos[0].joint_name.clone(), angle_rad: 0.3 };
    assert_eq!(goals.iter().map(|told| told.what.clone()).collect::<Vec<_>>(), [vec![told], vec![]]);
    assert_eq!(goals[0].at, joints[0].at);
}

#[test]
fn a_recording_is_written_as_a_data_set_and_what_came_of_it_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    let export = |session: &Path, to: &Path| RecordingCommand::ExportLerobot {
        file: session.join(plumbline_recording::FILE),
        folder: to.to_owned(),
        task: "Grasp the tomato.".to_owned(),
    };
    desk.apply(RecordingCommand::Start);
    let RecordingState::On { session, .. } = desk.view().state.clone() else { panic!("{:?}", desk.view()) };
    let set = folder.path().join("set");
    desk.apply(export(&session, &set));
    assert!(desk.said().contains("still being written") && !set.exists(), "{}", desk.said());
    desk.saw(&frame(1));
    desk.apply(RecordingCommand::Stop);
    // Nobody had read a joint: there is no frame.
    desk.apply(export(&session, &set));
    assert!(desk.said().contains("record with the robot connected"), "{}", desk.said());
    assert!(!set.exists() && desk.view().exporting.is_none());
    desk.apply(RecordingCommand::Start);
    let RecordingState::On { session, .. } = desk.view().state.clone() else { panic!("{:?}", desk.view()) };
    let rig = default_rig();
    let servo = &rig.servos[0];
    let joint = JointView {
        angle_rad: Some(0.1),
        goal_rad: Some(0.1),
        ..JointView::unheard(servo, rig.limits(servo.joint))
    };
    desk.room.read(&RobotView { joints: Arc::from([joint]), ..RobotView::default() }, Time::now());
    for number in 2..6 {
        std::thread::sleep(Duration::from_millis(5));
        desk.saw(&frame(number));
    }
    desk.apply(RecordingCommand::Stop);
    desk.apply(export(&session, &set));
    assert!(set.join("meta/info.json").is_file(), "{}", desk.said());
    assert!(set.join("meta/cameras.json").is_file(), "the calibration lies beside the recording");
    assert!(desk.view().exporting.is_none());
    let work = RecordingWork::Export(super::export::ExportLerobot {
        file: session.join(plumbline_recording::FILE),
        folder: folder.path().join("another"),
        task: "Grasp the tomato.".to_owned(),
    });
    let said = work.run(&Unattended).expect("written").summary();
    assert!(said.contains("another: 4 frames at ") && said.contains("with 1 joint."), "{said}");
}

#[test]
fn where_nothing_is_live_nothing_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), false);
    desk.apply(RecordingCommand::Start);
    assert!(desk.said().contains("nothing live to record"), "{}", desk.said());
    desk.apply(RecordingCommand::Stop);
    assert!(desk.said().contains("Nothing is being recorded"), "{}", desk.said());
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
}

#[test]
fn without_room_it_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file lies where the folder of sessions would be.
    std::fs::create_dir_all(folder.path().join("twin")).expect("made");
    std::fs::write(folder.path().join("twin/sessions"), "").expect("written");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    assert!(desk.said().contains("sessions"), "{}", desk.said());
    assert_eq!(desk.view().state, RecordingState::Off);
}

#[test]
fn a_recorder_that_does_not_keep_up_counts_what_it_drops() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    let large = Arc::new(RgbImage::from_fn(1600, 1200, |x, y| Rgb([(x * y) as u8, x as u8, y as u8])));
    let pairs = 400;
    for number in 0..pairs {
        let frame = StereoFrame { left: large.clone(), right: large.clone(), ..frame(number) };
        desk.saw(&frame);
    }
    std::thread::sleep(Duration::from_millis(50));
    desk.apply(RecordingCommand::Stop);
    let so_far = desk.view().last.as_ref().expect("finished").so_far;
    assert!(so_far.dropped > 0, "{so_far:?}");
    assert_eq!(so_far.pairs + so_far.dropped, pairs, "none is lost without being counted");
    let session = desk.view().last.as_ref().expect("finished").session.clone();
    let recording = Recording::open(&session.join(FILE)).expect("a recording");
    assert_eq!(recording.dropped(), Some(so_far.dropped), "the file says it, too");
}

#[test]
fn pairs_that_were_replaced_before_they_came_are_missing_and_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    // What was replaced before it was begun is not missing in it.
    desk.room.were_replaced(7);
    desk.apply(RecordingCommand::Start);
    for number in 0..10 {
        desk.room.were_replaced(7 + 2 * number);
        desk.saw(&frame(number));
    }
    let RecordingState::On { so_far, .. } = desk.view().state else { panic!("{:?}", desk.view()) };
    assert_eq!(so_far.dropped, 18);
    desk.apply(RecordingCommand::Stop);
    desk.room.were_replaced(100);
    let last = desk.view().last.clone().expect("finished");
    assert_eq!((last.so_far.pairs, last.so_far.dropped), (10, 18));
    let recording = Recording::open(&last.session.join(FILE)).expect("a recording");
    assert_eq!(recording.dropped(), Some(18));
}

#[test]
fn another_source_ends_the_recording_with_a_word() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    desk.saw(&frame(1));
    desk.follow_source();
    assert!(desk.view().is_on(), "it is the same one");
    desk.around.opened += 1;
    desk.around.spec = Some(SourceSpec::Cameras { left_index: 0, right_index: 2 });
    desk.follow_source();
    assert!(desk.said().contains("the recording has ended"), "{}", desk.said());
    let last = desk.view().last.clone().expect("finished");
    desk.saw(&frame(2));
    let recording = Recording::open(&last.session.join(FILE)).expect("a recording");
    assert!(recording.is_whole() && recording.pair_count() == 1);
    // The next one is of the source that is open now.
    desk.apply(RecordingCommand::Start);
    desk.follow_source();
    assert!(desk.view().is_on());
}

#[test]
fn the_same_source_opened_again_goes_on_and_a_closed_one_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    desk.apply(RecordingCommand::Start);
    desk.saw(&frame(1));
    // Its thread ended and was started again: none is open for a moment, under the same number.
    let spec = desk.around.spec.take();
    desk.follow_source();
    assert!(desk.view().is_on(), "{}", desk.said());
    (desk.around.spec, desk.around.opened) = (spec, 2);
    desk.follow_source();
    desk.saw(&frame(2));
    assert!(desk.view().is_on() && desk.said().is_empty(), "{}", desk.said());
    (desk.around.spec, desk.around.opened) = (None, 3);
    desk.follow_source();
    assert!(desk.said().contains("the recording has ended"), "{}", desk.said());
    assert_eq!(desk.view().last.as_ref().map(|last| last.so_far.pairs), Some(2));
}

#[test]
fn pairs_that_the_source_itself_replaced_are_missing_and_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path(), true);
    let told = |desk: &mut Desk, opened: u64, is_live: bool, superseded: u64| {
        (desk.around.opened, desk.around.is_live, desk.around.superseded) = (opened, is_live, superseded);
        desk.follow_source();
    };
    // Before it was begun.
    told(&mut desk, 1, true, 50);
    desk.apply(RecordingCommand::Start);
    told(&mut desk, 1, true, 53);
    // Held still by the operator: nobody wants these.
    told(&mut desk, 1, false, 80);
    told(&mut desk, 1, true, 90);
    told(&mut desk, 1, true, 91);
    // Opened again it counts anew.
    told(&mut desk, 2, true, 2);
    desk.apply(RecordingCommand::Stop);
    let last = desk.view().last.clone().expect("finished");
    assert_eq!(last.so_far.dropped, 3 + 1 + 2);
    let recording = Recording::open(&last.session.join(FILE)).expect("a recording");
    assert_eq!(recording.dropped(), Some(6), "the file says it, too");
}

const FULL: &str = "PLUMBLINE_TEST_FULL_DISK";

/// In a process whose files cannot grow: it records until that is so.
fn record_until_full(folder: &Path) {
    let mut desk = Desk::new(folder, true);
    desk.apply(RecordingCommand::Start);
    let RecordingState::On { session, .. } = desk.view().state.clone() else { panic!("{:?}", desk.view()) };
    let noise = Arc::new(RgbImage::from_fn(320, 240, |x, y| Rgb([(x * y) as u8, (x ^ y) as u8, y as u8])));
    let began = Instant::now();
    let mut number = 0;
    while desk.view().is_on() {
        assert!(began.elapsed() < Duration::from_secs(60), "it never noticed");
        number += 1;
        let frame = StereoFrame { left: noise.clone(), right: noise.clone(), ..frame(number) };
        desk.saw(&frame);
        std::thread::sleep(Duration::from_millis(2));
        desk.look_after();
    }
    assert!(desk.said().contains("check that the disk is there and has room"), "{}", desk.said());
    // A small file was written as ever, and the next recording can begin.
    let recording = Recording::open(&session.join(FILE)).expect("what is there can be read");
    assert!(!recording.is_whole());
    assert!(desk.view().last.is_none(), "it was not finished");
}

#[test]
fn a_disk_that_fills_up_ends_a_recording_with_words_and_nothing_else() {
    if let Some(folder) = std::env::var_os(FULL) {
        return record_until_full(Path::new(&folder));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let test = "recording::tests::a_disk_that_fills_up_ends_a_recording_with_words_and_nothing_else";
    // Blocks of 512 bytes; the signal that goes with it would end the child.
    let script = format!("trap '' XFSZ; ulimit -f 4000; exec \"$0\" {test} --exact");
    let child = std::process::Command::new("sh")
        .args(["-c", &script])
        .arg(std::env::current_exe().expect("a test has a file"))
        .env(FULL, folder.path())
        .output()
        .expect("started");
    let said = String::from_utf8_lossy(&child.stdout).into_owned();
    assert!(child.status.success(), "{said}\n{}", String::from_utf8_lossy(&child.stderr));
    assert!(said.contains("1 passed"), "{said}");
}

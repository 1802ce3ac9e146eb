//! The robot's side driven with a made-up arm: nothing moves that was not asked for.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use plumbline_effects::RobotModel;
use plumbline_effects::rig_model::Conditions;
use plumbline_hardware::joints::{
    Grip, HoldReason, JointReading, JointState, Move, MoveId, MoveOutcome, Refusal, Setpoint, Unheard,
};
use plumbline_model::Stamp;
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::arm::{Arm, Census};
use super::command::{Destination, JogRates, RobotCommand};
use super::control::RobotControl;
use super::lead::{LeadAnswer, LeadOrder, Leader, Reins};
use super::view::Connection;
use super::{Switches, Worker};
use crate::rig_models::made_up::model_with;
use crate::twin::command::TwinCommand;
use crate::twin::{TwinDesk, TwinEyesPlug};

/// What reached the arm.
#[derive(Clone, Debug, PartialEq)]
enum Asked {
    Move(Move),
    Follow(Setpoint),
    Grip(Grip),
    Hold,
    Torque(usize, bool),
}

#[derive(Default)]
struct Record {
    asked: Vec<Asked>,
    unknown: Vec<JointIndex>,
    late: Vec<JointIndex>,
    gone: Option<String>,
    /// A joint that holds, and when it was read.
    heard: Option<(JointIndex, Instant)>,
    /// How the last move ended.
    outcome: Option<MoveOutcome>,
}

struct FakeArm {
    record: Arc<Mutex<Record>>,
    posture: Posture,
}

impl Arm for FakeArm {
    fn shorten_answers(&self) -> Result<(), Refusal> {
        Ok(())
    }

    fn state(&self) -> Option<Arc<JointState>> {
        // Once: what is locked in the literal stays locked to its end.
        let (unknown, late, gone, heard, outcome) = {
            let record = self.record.lock().expect("no test panics in here");
            let (unknown, late) = (record.unknown.clone().into(), record.late.clone().into());
            (unknown, late, record.gone.clone(), record.heard, record.outcome.clone())
        };
        let reading = |(joint, read_at)| JointReading {
            torque_on: Some(true),
            read_at: Some(read_at),
            ..JointReading::new(joint, 1)
        };
        let joints: Vec<JointReading> = heard.into_iter().map(reading).collect();
        Some(Arc::new(JointState {
            measured: Some(self.posture.clone()),
            unknown,
            late,
            commanded: Some(self.posture.clone()),
            gone,
            outcomes: outcome.into_iter().map(|outcome| (MoveId(1), outcome)).collect(),
            ..JointState::new(Stamp { seq: 1, captured_at: Instant::now() }, joints)
        }))
    }

    fn at(&self, _when: Instant) -> (Option<Posture>, Option<Posture>) {
        (Some(self.posture.clone()), Some(self.posture.clone()))
    }

    fn begin(&self, motion: Move) -> Result<MoveId, Refusal> {
        self.note(Asked::Move(motion));
        Ok(MoveId(1))
    }

    fn follow(&self, setpoint: Setpoint) -> Result<(), Refusal> {
        self.note(Asked::Follow(setpoint));
        Ok(())
    }

    fn grip(&self, grip: Grip) -> Result<(), Refusal> {
        self.note(Asked::Grip(grip));
        Ok(())
    }

    fn hold(&self) -> Result<(), Refusal> {
        self.note(Asked::Hold);
        Ok(())
    }

    fn torque(&self, joints: &[JointIndex], on: bool) -> Result<(), Refusal> {
        self.note(Asked::Torque(joints.len(), on));
        Ok(())
    }

    fn census(&self) -> Census {
        Census::default()
    }
}

impl FakeArm {
    fn note(&self, asked: Asked) {
        self.record.lock().expect("no test panics in here").asked.push(asked);
    }
}

struct Bench {
    worker: Worker,
    record: Arc<Mutex<Record>>,
    rig: Arc<Rig>,
    _folder: tempfile::TempDir,
}

impl Bench {
    /// Whether the arm was asked last to stay at its goals.
    fn stands_still(&self) -> bool {
        let is_still = |setpoint: &Setpoint| setpoint.joints.iter().all(|(_, rate)| *rate == 0.0);
        matches!(self.asked().last(), Some(Asked::Follow(setpoint)) if is_still(setpoint))
    }

    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
        let desk = TwinDesk::new(TwinEyesPlug::default());
        let worker = Worker::new(rig.clone(), folder.path(), Switches::default(), desk);
        Self { worker, record: Arc::default(), rig, _folder: folder }
    }

    fn connected() -> Self {
        let mut bench = Self::new();
        let arm = FakeArm { record: bench.record.clone(), posture: bench.rig.home() };
        bench.worker.arm = Some(Box::new(arm));
        bench.worker.connection = Connection::Connected { to: "test".to_owned(), twin: false };
        bench
    }

    fn send(&mut self, command: RobotCommand) {
        self.worker.control(RobotControl::Robot(command));
    }

    fn asked(&self) -> Vec<Asked> {
        self.record.lock().expect("no test panics in here").asked.clone()
    }

    fn refusal(&self) -> Option<String> {
        self.worker.refusal.clone()
    }

    fn joint(&self, name: &str) -> JointIndex {
        self.rig.description.find_joint(name).expect("a joint of NICO")
    }
}

#[test]
fn servos_that_answer_too_late_are_not_said_to_be_missing() {
    let mut bench = Bench::connected();
    let (elbow, shoulder) = (bench.joint("r_elbow_y"), bench.joint("r_shoulder_y"));
    {
        let mut record = bench.record.lock().expect("no test panics in here");
        (record.unknown, record.late) = (vec![elbow, shoulder], vec![shoulder]);
    }
    let bus = bench.worker.take_news().expect("it is new").robot.bus.clone();
    let servo = |joint| bench.rig.servo_of(joint).expect("a servo").id;
    assert_eq!((bus.missing.clone(), bus.late.clone()), (vec![servo(elbow)], vec![servo(shoulder)]));
    let said = bus.late_answers().expect("one is late");
    assert!(said.starts_with(&format!("Servo {} answers too late: ", servo(shoulder))), "{said}");
    assert!(said.contains("close other programs") && !said.contains("cable"), "{said}");
}

#[test]
fn a_preview_moves_nothing_and_running_it_moves_what_it_showed() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    bench.send(RobotCommand::Preview(Destination::Joint { joint: elbow, angle_rad: 1.6 }));
    assert_eq!(bench.asked(), vec![]);
    let news = bench.worker.take_news().expect("there is a preview");
    let preview = news.robot.preview.clone().expect("it is shown");
    assert!((preview.end[elbow] - 1.6).abs() < 1e-12);
    assert!(preview.path.is_ok(), "{:?}", preview.path);
    assert!(preview.duration > Duration::from_millis(50));
    bench.send(RobotCommand::RunPreview);
    match &bench.asked()[..] {
        [Asked::Move(motion)] => assert_eq!(motion.goals, vec![(elbow, 1.6)]),
        other => panic!("{other:?}"),
    }
}

#[test]
fn without_a_preview_or_a_connection_nothing_runs() {
    let mut bench = Bench::connected();
    bench.send(RobotCommand::RunPreview);
    assert!(bench.refusal().is_some_and(|reason| reason.contains("No move is shown")));
    assert_eq!(bench.asked(), vec![]);
    let mut bench = Bench::new();
    bench.send(RobotCommand::Preview(Destination::Pose { name: "home".to_owned() }));
    assert!(bench.refusal().is_some_and(|reason| reason.contains("Connect")));
}

#[test]
fn a_way_through_the_table_is_shown_as_refused_and_does_not_run() {
    let mut bench = Bench::connected();
    let joints = ["r_shoulder_y", "r_elbow_y", "r_arm_x"].map(|name| bench.joint(name));
    let down = bench.rig.home().with(&joints, &[0.3, 3.1, 0.1]);
    bench.send(RobotCommand::Preview(Destination::Posture(down)));
    let news = bench.worker.take_news().expect("a preview");
    let path = news.robot.preview.as_ref().expect("it is shown").path.clone();
    assert!(path.expect_err("the table is in the way").to_string().contains("would run into"));
    bench.send(RobotCommand::RunPreview);
    assert_eq!(bench.asked(), vec![]);
    assert!(bench.refusal().is_some_and(|reason| reason.contains("would run into")));
}

#[test]
fn jogging_ends_by_itself_when_the_key_is_no_longer_heard_of() {
    let mut bench = Bench::connected();
    bench.send(RobotCommand::Jog(JogRates { velocity_m_s: [0.0, 0.0, 0.03], yaw_rad_s: 0.0 }));
    assert!(matches!(bench.asked()[..], [Asked::Follow(_)]), "{:?}", bench.asked());
    bench.worker.tick(Instant::now() + Duration::from_millis(50));
    assert_eq!(bench.asked().len(), 2);
    bench.worker.tick(Instant::now() + Duration::from_secs(1));
    assert!(bench.stands_still(), "it rests at its goals, or it would sink: {:?}", bench.asked());
    let sent = bench.asked().len();
    bench.worker.tick(Instant::now() + Duration::from_secs(2));
    assert_eq!(bench.asked().len(), sent, "it stays ended");
    bench.send(RobotCommand::Jog(JogRates { velocity_m_s: [0.0, 0.0, 0.03], yaw_rad_s: 0.0 }));
    bench.send(RobotCommand::EndJog);
    assert!(bench.stands_still(), "{:?}", bench.asked());
}

#[test]
fn a_lead_that_is_ended_holds_the_arm_at_once_whether_or_not_its_leader_has_noticed() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    let reins = Reins::default();
    let (leader, led) = Leader::pair("grasping", true, &reins);
    bench.worker.control(RobotControl::Lead(led));
    let way = vec![vec![(elbow, 1.6)]];
    leader.order(LeadOrder::Follow { way: way.clone(), speed_rad_s: 0.5 }).expect("it is led");
    bench.worker.tick(Instant::now());
    assert!(matches!(bench.asked()[..], [Asked::Move(_)]), "{:?}", bench.asked());
    reins.end();
    bench.worker.tick(Instant::now());
    assert_eq!(bench.asked().last(), Some(&Asked::Hold), "nobody has told it so");
    leader.order(LeadOrder::Follow { way, speed_rad_s: 0.5 }).expect("it is led");
    bench.worker.tick(Instant::now());
    let moves = bench.asked().iter().filter(|asked| matches!(asked, Asked::Move(_))).count();
    assert_eq!(moves, 1, "it is ended for good: {:?}", bench.asked());
    // What is called off is answered once.
    leader.order(LeadOrder::Hold).expect("it is led");
    bench.worker.tick(Instant::now());
    let answer = || leader.answer(Duration::ZERO).expect("not given up");
    assert!(matches!(answer(), Some(LeadAnswer::Done)));
    assert!(answer().is_none(), "an answer more would be that of the next order");
}

#[test]
fn who_leads_is_told_what_the_joints_do_also_while_an_order_is_carried_out() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    let (leader, led) = Leader::pair("grasping", true, &Reins::default());
    bench.worker.control(RobotControl::Lead(led));
    bench.worker.tick(Instant::now());
    assert!(leader.take_course().0.is_empty(), "nobody asked");
    leader.keep_course(Duration::ZERO);
    leader.order(LeadOrder::Follow { way: vec![vec![(elbow, 1.6)]], speed_rad_s: 0.5 }).expect("it is led");
    for _ in 0..3 {
        bench.worker.tick(Instant::now());
    }
    let (states, lost) = leader.take_course();
    assert_eq!((states.len(), lost), (3, 0));
    assert!(leader.answer(Duration::ZERO).expect("not given up").is_none(), "and no answer is in its place");
}

#[test]
fn a_way_on_which_a_joint_was_late_goes_on_by_itself_and_one_whose_servo_is_silent_ends() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    let (leader, led) = Leader::pair("grasping", true, &Reins::default());
    bench.worker.control(RobotControl::Lead(led));
    leader.order(LeadOrder::Follow { way: vec![vec![(elbow, 1.6)]], speed_rad_s: 0.5 }).expect("it is led");
    let began = Instant::now();
    let record = bench.record.clone();
    let ended = |outcome: Option<MoveOutcome>| {
        record.lock().expect("no test panics in here").outcome = outcome;
    };
    let moves = |bench: &Bench| bench.asked().iter().filter(|asked| matches!(asked, Asked::Move(_))).count();
    bench.worker.tick(began);
    assert_eq!(moves(&bench), 1);

    let late = Refusal::Unknown { joint: elbow, name: "Right elbow".to_owned(), why: Unheard::TooBusy };
    ended(Some(MoveOutcome::Held(HoldReason::Refused(late))));
    bench.worker.tick(began + Duration::from_secs(1));
    let said: Vec<String> = bench.worker.take_notes().into_iter().map(|(_, text)| text).collect();
    assert!(said.iter().any(|text| text.contains("goes on by itself") && text.contains("busy")), "{said:?}");
    ended(None);
    bench.worker.switches.heartbeat.beat();
    bench.worker.tick(began + Duration::from_secs(5));
    assert_eq!(moves(&bench), 1, "it is not heard yet");
    assert!(leader.waits());
    let heard_at = |bench: &mut Bench, seconds| {
        let at = began + Duration::from_secs(seconds);
        record.lock().expect("no test panics in here").heard = Some((elbow, at));
        bench.worker.switches.heartbeat.beat();
        bench.worker.tick(at);
    };
    heard_at(&mut bench, 6);
    assert_eq!(moves(&bench), 1, "one reading is not enough");
    heard_at(&mut bench, 8);
    assert_eq!(moves(&bench), 2);
    assert!(!leader.waits());
    assert!(leader.answer(Duration::ZERO).expect("not given up").is_none(), "it is under way");

    let name = "Right elbow".to_owned();
    ended(Some(MoveOutcome::Held(HoldReason::NoAnswer { joint: elbow, name, servo: 5, cycles: 25 })));
    bench.worker.tick(began + Duration::from_secs(9));
    let why = leader.answer(Duration::ZERO).expect_err("it is given up").to_string();
    assert!(why.contains("check its cable and power"), "{why}");
}

#[test]
fn whoever_moves_the_arm_ends_when_torque_is_switched_also_between_two_orders() {
    for on in [true, false] {
        let mut bench = Bench::connected();
        let elbow = bench.joint("r_elbow_y");
        let (leader, led) = Leader::pair("grasping", true, &Reins::default());
        bench.worker.control(RobotControl::Lead(led));
        let follow = || LeadOrder::Follow { way: vec![vec![(elbow, 1.6)]], speed_rad_s: 0.5 };
        leader.order(follow()).expect("it is led");
        bench.worker.tick(Instant::now());
        bench.send(RobotCommand::Torque { joints: vec![elbow], on });
        assert!(
            matches!(bench.asked()[..], [Asked::Move(_), Asked::Hold, Asked::Torque(1, _)]),
            "{:?}",
            bench.asked()
        );
        let ended = || leader.answer(Duration::ZERO).expect_err("it is given up").to_string();
        assert!(ended().contains("torque was switched"));
        for order in [follow(), LeadOrder::State] {
            leader.order(order).expect("it is led until its leader has gone");
            bench.worker.tick(Instant::now());
            assert!(ended().contains("torque was switched"));
        }
        assert_eq!(bench.asked().len(), 3, "nothing moves any more: {:?}", bench.asked());
        // Who only looks is not concerned.
        let mut bench = Bench::connected();
        let (leader, led) = Leader::pair("planning a grasp", false, &Reins::default());
        bench.worker.control(RobotControl::Lead(led));
        bench.send(RobotCommand::Torque { joints: vec![], on });
        leader.order(LeadOrder::State).expect("it is led");
        bench.worker.tick(Instant::now());
        assert!(matches!(leader.answer(Duration::ZERO), Ok(Some(LeadAnswer::State(_)))));
    }
}

#[test]
fn what_pauses_and_stands_is_not_said_to_move() {
    let mut bench = Bench::connected();
    let reins = Reins::default();
    let (_leader, led) = Leader::pair("grasping", true, &reins);
    bench.worker.control(RobotControl::Lead(led));
    let mut rests = || {
        bench.worker.tick(Instant::now());
        bench.worker.take_news().map(|news| news.robot.rests_on_the_way)
    };
    assert_eq!(rests(), Some(false), "it may move at any time");
    reins.hold_tight(true);
    assert_eq!(rests(), Some(true), "it stands until it is let go on, and that is told at once");
    reins.hold_tight(false);
    assert_eq!(rests(), Some(false));
}

#[test]
fn a_twin_whose_port_was_unplugged_is_found_again_and_is_the_same() {
    let mut bench = Bench::new();
    bench.send(RobotCommand::Scan);
    assert!(bench.refusal().is_some_and(|why| why.contains("Nothing is connected")), "{:?}", bench.refusal());
    bench.send(RobotCommand::ConnectTwin { scenario: "perfect".to_owned() });
    assert_eq!(bench.refusal(), None);
    let fault = |bench: &mut Bench, on: bool| {
        let name = "port-closed".to_owned();
        bench.worker.control(RobotControl::Twin(TwinCommand::Fault { name, on }));
    };
    fault(&mut bench, true);
    let began = Instant::now();
    while !matches!(bench.worker.connection, Connection::Lost { .. }) {
        assert!(began.elapsed() < Duration::from_secs(30), "{:?}", bench.worker.connection);
        std::thread::sleep(Duration::from_millis(10));
        bench.worker.tick(Instant::now());
    }
    fault(&mut bench, false);
    bench.send(RobotCommand::Scan);
    assert_eq!(bench.refusal(), None);
    let found = Connection::Connected { to: "twin \"perfect\"".to_owned(), twin: true };
    assert_eq!(
        (&bench.worker.connection, bench.worker.twins_started),
        (&found, 1),
        "no other one is started"
    );
}

#[test]
fn while_stop_is_latched_nothing_is_jogged() {
    let mut bench = Bench::connected();
    bench.worker.switches.stop.press();
    bench.send(RobotCommand::Jog(JogRates { velocity_m_s: [0.0, 0.0, 0.03], yaw_rad_s: 0.0 }));
    assert_eq!(bench.asked(), vec![]);
    bench.send(RobotCommand::ReleaseStop);
    assert!(!bench.worker.switches.stop.is_pressed());
    assert_eq!(bench.asked(), vec![], "releasing moves nothing");
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut bench = Bench::connected();
    for command in [
        RobotCommand::Jog(JogRates { velocity_m_s: [f64::NAN, 0.0, 0.0], yaw_rad_s: 0.0 }),
        RobotCommand::Speed(f64::NAN),
        RobotCommand::Speed(0.0),
        RobotCommand::Speed(1e-30),
        RobotCommand::Speed(0.009),
        RobotCommand::Speed(2.1),
        RobotCommand::Speed(f64::INFINITY),
        RobotCommand::Jog(JogRates { velocity_m_s: [1e308, 0.0, 0.0], yaw_rad_s: 0.0 }),
        RobotCommand::Jog(JogRates { velocity_m_s: [0.0; 3], yaw_rad_s: f64::NEG_INFINITY }),
        RobotCommand::Preview(Destination::TipPosition { point_m: [f64::INFINITY, 0.0, 0.3] }),
    ] {
        bench.worker.refusal = None;
        bench.send(command.clone());
        assert!(bench.refusal().is_some(), "{command:?}");
    }
    assert_eq!(bench.asked(), vec![]);
    bench.send(RobotCommand::Speed(1e-30));
    let why = bench.refusal().expect("refused");
    assert!(why.contains("0.01 to 2 times"), "{why}");
    bench.send(RobotCommand::Speed(0.01));
    assert_eq!(bench.refusal(), None);
}

#[test]
fn a_port_that_vanishes_is_told_with_its_reason() {
    let mut bench = Bench::connected();
    bench.record.lock().expect("no test panics in here").gone = Some("the cable was pulled".to_owned());
    bench.worker.tick(Instant::now());
    let news = bench.worker.take_news().expect("news");
    match &news.robot.connection {
        Connection::Lost { reason, .. } => assert!(reason.contains("cable was pulled"), "{reason}"),
        other => panic!("{other:?}"),
    }
    assert!(bench.worker.take_notes().iter().any(|(_, text)| text.contains("cable was pulled")));
}

#[test]
fn a_pose_of_ones_own_can_be_saved_previewed_and_deleted() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    bench.send(RobotCommand::SavePose { title: "Mine".to_owned(), joints: vec![elbow] });
    let poses = bench.worker.take_news().expect("news").robot.poses.clone();
    let own = poses.iter().find(|pose| pose.own).expect("it was saved").clone();
    assert_eq!(own.joints.len(), 1);
    bench.send(RobotCommand::Preview(Destination::Pose { name: own.name.clone() }));
    assert!(bench.worker.take_news().expect("news").robot.preview.is_some());
    bench.send(RobotCommand::DeletePose { name: own.name });
    assert!(bench.worker.take_news().expect("news").robot.poses.iter().all(|pose| !pose.own));
}

#[test]
fn torque_is_switched_for_the_joints_named_or_for_all() {
    let mut bench = Bench::connected();
    let elbow = bench.joint("r_elbow_y");
    bench.send(RobotCommand::Torque { joints: vec![elbow], on: false });
    bench.send(RobotCommand::Torque { joints: vec![], on: true });
    assert_eq!(bench.asked(), vec![Asked::Torque(1, false), Asked::Torque(22, true)]);
}

#[test]
fn the_twin_is_not_commanded_while_it_does_not_run() {
    let mut bench = Bench::new();
    bench.worker.control(RobotControl::Twin(TwinCommand::HideBoard));
    assert!(bench.refusal().is_some_and(|reason| reason.contains("not running")));
}

#[test]
fn what_is_known_of_the_robot_decides_where_it_is_sent_and_taken_back_all_is_as_before() {
    const POINT_M: [f64; 3] = [0.3, -0.2, 0.2];
    let mut bench = Bench::connected();
    let shown = |bench: &mut Bench| {
        bench.send(RobotCommand::Preview(Destination::TipPosition { point_m: POINT_M }));
        bench.worker.preview.clone().expect("it is shown").1
    };
    let before = shown(&mut bench);
    assert_eq!((&*before.model, before.tip_sigma_m), ("as described", Some(0.0)));
    let place = bench.worker.take_news().expect("news").robot.tip_place.expect("known");

    let effects = model_with(&bench.rig, &[("joint-zero", "r_elbow_y", &[0.08])]);
    let known = RobotModel::new(bench.rig.clone(), Arc::new(effects)).expect("it fits");
    bench.worker.control(RobotControl::UseModel(Arc::new(known.clone())));
    assert!(bench.worker.preview.is_none(), "it was found with another arm");
    let with = shown(&mut bench);
    assert_eq!(&*with.model, "with 1 effect");
    let arm = known.arm("right_palm_center").expect("a tip");
    let beside_m = |end: &Posture| {
        let tip = arm.tip(end, &Conditions::default());
        tip.distance_m(&plumbline_model::Point::new(POINT_M[0], POINT_M[1], POINT_M[2]))
    };
    assert!(beside_m(&with.end) < 1e-4 && beside_m(&before.end) > 5e-3);
    let robot = bench.worker.take_news().expect("news").robot.clone();
    assert_eq!(&*robot.model, "with 1 effect");
    assert!(robot.tip_place.expect("known").point.distance_m(&place.point) > 5e-3);

    let nominal = RobotModel::nominal(bench.rig.clone());
    bench.worker.control(RobotControl::UseModel(Arc::new(nominal)));
    assert_eq!(shown(&mut bench), before);
    assert_eq!(bench.worker.take_news().expect("news").robot.tip_place, Some(place));
}

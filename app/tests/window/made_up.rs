//! Views that no engine made: a robot, its twin and a mount in every state that can be drawn.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_engine::View;
use plumbline_engine::view::{
    BusView, Connection, FaultView, GraspHand, HandEyeBody, HandEyeSummary, HandFigures, HandMiss,
    HandOutcome, HeadViewSummary, InTheWay, JointSample, JointView, MotionState, MountSummary, MountView,
    PathCheck, PoseView, Preview, RobotView, StepState, TipPlace, ToyView, TwinView,
};
use plumbline_model::frame::{Point, Pose};
use plumbline_model::robot::{JointIndex, Posture, Rig};

/// The rig that comes with the program.
pub fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

/// A joint by its name.
pub fn joint(name: &str) -> JointIndex {
    rig().description.find_joint(name).expect("a joint of this robot")
}

/// The twin is connected, holds its arms at home and its head at the table.
pub fn connected() -> RobotView {
    let rig = rig();
    let look = rig.pose("look-table").expect("in the rig file");
    let measured = look.applied_to(&rig.home());
    let joints: Vec<JointView> =
        rig.servos.iter().enumerate().map(|(i, servo)| joint_view(&rig, i, servo, &measured)).collect();
    let tip = rig.arms[0].tips[0].link.clone();
    let link = rig.description.find_link(&tip).expect("a link of this robot");
    let at = rig.description.forward(&measured).of(link).isometry.translation.vector;
    let trail = (0..40).map(|i| {
        Point::new(
            at.x - 0.002 * f64::from(40 - i),
            at.y + 0.06 * (f64::from(i) * 0.12).sin(),
            at.z + 0.001 * f64::from(40 - i),
        )
    });
    let poses = rig.poses.iter().map(|pose| PoseView {
        name: pose.name.clone(),
        title: pose.title.clone(),
        about: pose.about.clone(),
        joints: pose.joints.clone(),
        own: false,
    });
    let own = PoseView {
        name: "own-1".to_owned(),
        title: "Above the screen".to_owned(),
        about: "Saved by the operator.".to_owned(),
        joints: vec![(joint("r_elbow_y"), 1.5)],
        own: true,
    };
    RobotView {
        connection: Connection::Connected { to: "twin \"lab\"".to_owned(), twin: true },
        motion: MotionState::Holding { why: None },
        joints: joints.into(),
        measured: Some(measured.clone()),
        commanded: Some(measured),
        tip,
        tip_place: Some(TipPlace { point: Point::new(at.x, at.y, at.z), yaw_rad: 0.2, sigma_m: 0.0 }),
        trail: trail.collect(),
        poses: poses.chain([own]).collect(),
        bus: BusView { cycles_per_s: Some(62.4), cycles: 12_345, ..BusView::default() },
        speed: 1.0,
        rig: Some(rig),
        ..RobotView::default()
    }
}

fn joint_view(rig: &Rig, i: usize, servo: &plumbline_model::robot::Servo, measured: &Posture) -> JointView {
    let limits = rig.limits(servo.joint);
    let phase = i as f64;
    let history = (0..240).map(|t| JointSample {
        at_s: f64::from(t) * 0.5,
        load: Some(0.2 * (f64::from(t) * 0.05 + phase).sin()),
        temperature_c: Some(36.0 + 0.02 * f64::from(t)),
    });
    JointView {
        limits_now: rig.limits_in(servo.joint, measured),
        angle_rad: Some(measured[servo.joint] + 0.002 * phase.sin()),
        goal_rad: Some(measured[servo.joint]),
        speed_rad_s: Some(0.0),
        load: Some(0.3 * phase.sin()),
        temperature_c: Some(36.0 + (i % 7) as f64),
        voltage_v: Some(12.1),
        torque_on: Some(true),
        age: Some(Duration::from_millis(12)),
        history: history.collect(),
        ..JointView::unheard(servo, limits)
    }
}

/// A preview of the right arm reaching over the table.
pub fn preview(path: Result<PathCheck, InTheWay>) -> Preview {
    let measured = connected().measured.expect("read");
    let joints = ["r_shoulder_y", "r_arm_x", "r_elbow_y", "head_z"].map(joint);
    let end = measured.with(&joints, &[0.9, 0.35, 1.3, -0.4]);
    Preview {
        title: "right elbow to 92°".to_owned(),
        end,
        path,
        duration: Duration::from_millis(1400),
        largest_turn: Some(("Right elbow".to_owned(), 0.61)),
        model: "as described".into(),
        tip_sigma_m: None,
    }
}

/// A path that keeps its distance.
pub fn free_path() -> Result<PathCheck, InTheWay> {
    Ok(PathCheck { smallest_m: 0.043, between: "right palm and table".to_owned() })
}

/// The twin with its toys, the board held up.
pub fn twin() -> TwinView {
    let toys = [
        ("tomato", Some([0.33, -0.12]), 0.030, [206, 42, 34]),
        ("banana", Some([0.42, 0.10]), 0.034, [238, 205, 62]),
        ("duck", Some([0.28, 0.14]), 0.032, [245, 196, 40]),
        ("mushroom", None, 0.026, [196, 120, 84]),
        ("onion", Some([0.46, -0.20]), 0.028, [168, 92, 130]),
        ("orange", None, 0.031, [240, 138, 36]),
    ];
    let toys = toys.map(|(name, at, radius_m, rgb)| ToyView {
        name: name.to_owned(),
        place: at.map(|[x, y]| Point::new(x, y, 0.054 + radius_m)),
        radius_m,
        rgb,
    });
    let faults = [
        ("silent-servo", "Servo 31 does not answer"),
        ("garbled", "One answer in a hundred is garbled"),
        ("late", "Answers come late"),
    ];
    TwinView {
        running: true,
        scenarios: vec![
            ("lab".to_owned(), "Misses about as much as the real robot.".to_owned()),
            ("perfect".to_owned(), "As drawn: nothing is off.".to_owned()),
        ],
        scenario: "lab".to_owned(),
        time_s: 312.0,
        real_time_factor: 1.0,
        eyes_on_s: 250.0,
        toys: toys.into(),
        board: None,
        board_places: 24,
        few_board_places: 12,
        faults: faults
            .map(|(name, about)| FaultView { name: name.to_owned(), about: about.to_owned(), on: false })
            .into(),
        ..TwinView::default()
    }
}

/// The board lies on the table, its face up.
pub fn lying_board() -> Pose<plumbline_model::frame::Robot, plumbline_model::frame::Board> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
    Pose::new(Isometry3::from_parts(Translation3::new(0.28, 0.09, 0.06), turn))
}

/// A mount that was solved.
pub fn solved_mount() -> MountSummary {
    MountSummary {
        head_from_left: rig().eyes.head_from_left,
        moved_m: [0.0012, -0.0008, 0.0021],
        turned_rad: [0.004, -0.021, 0.013],
        moved_sd_m: [0.0004, 0.0003, 0.0006],
        turned_sd_rad: [0.0005, 0.0006, 0.0008],
        rms_px: 0.183,
        views: 13,
        rejected: vec![("view-09".to_owned(), "the head had not settled".to_owned())],
        not_seen: Vec::new(),
        remarks: Vec::new(),
        at: Timestamp::now(),
    }
}

/// Views taken, with a proposal.
pub fn mount() -> MountView {
    let views = (0..13u32).map(|i| HeadViewSummary {
        is_colder: false,
        name: format!("view-{:02}", i + 1),
        pan_rad: 0.35 * (f64::from(i) * 0.9).sin(),
        tilt_rad: -0.45 - 0.12 * (f64::from(i) * 0.7).cos(),
        corners: (40, 40),
        rms_px: Some(0.12 + 0.01 * f64::from(i)),
    });
    MountView {
        step: StepState::NotDone,
        views: views.collect(),
        proposal: Some(solved_mount()),
        ..MountView::default()
    }
}

/// Everything runs.
pub fn everything() -> View {
    View {
        robot: Arc::new(connected()),
        twin: Arc::new(twin()),
        mount: Arc::new(MountView::default()),
        ..View::default()
    }
}

/// The same with another robot.
pub fn with_robot(robot: RobotView) -> View {
    View { robot: Arc::new(robot), ..everything() }
}

/// What came of a look at the hands: one arm is tied, the other was not seen.
pub fn looked_at_hands() -> HandEyeSummary {
    let miss = |k: usize, off_m: Option<[f64; 2]>| HandMiss {
        at_m: [0.22 + 0.05 * (k % 4) as f64, -0.3 + 0.12 * (k / 4) as f64],
        off_m,
    };
    let figures = HandFigures {
        looked: 12,
        found: 11,
        before_m: Some(0.0121),
        after_m: Some(0.0014),
        before: (0..12).map(|k| miss(k, (k > 0).then_some([0.011, -0.005]))).collect(),
        after: (0..12).map(|k| miss(k, (k > 0).then_some([0.001, -0.001]))).collect(),
    };
    HandEyeSummary {
        at: jiff::Timestamp::now(),
        body: Some(HandEyeBody {
            neck_rad: 0.02,
            neck_sd_rad: 0.0016,
            rms_px: 0.17,
            points: 1380,
            share_of_described: None,
        }),
        screen: None,
        table: None,
        hands: vec![
            (GraspHand::Right, HandOutcome::Sized(figures)),
            (GraspHand::Left, HandOutcome::Stays("it was not seen".to_owned())),
        ],
    }
}

/// Everything, and what came of a look at the hands.
pub fn with_hands_looked_at() -> View {
    let mut view = everything();
    Arc::make_mut(&mut view.handeye).proposal = Some(Arc::new(looked_at_hands()));
    view
}

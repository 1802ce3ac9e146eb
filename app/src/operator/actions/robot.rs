//! What can be asked for by name of the robot, its twin, and the mount of the eyes.

use std::borrow::Cow;

use plumbline_engine::view::{Connection, GraspPhase, MotionState, StepState, TouchPhase, TrialsPhase};
use plumbline_engine::{
    Command, Destination, MountCommand, RobotCommand, SourceCommand, SourceSpec, TwinCommand, View,
};
use serde::Serialize;

use crate::operator::words::eyes::WARM_AFTER_MINUTES;

/// Of the robot and its twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobotAction {
    /// Chooses what to connect to.
    Connect,
    /// Starts the twin.
    ConnectTwin,
    /// Looks through the twin's eyes.
    TwinEyes,
    /// Lets the connection go.
    Disconnect,
    /// Asks the bus who is there.
    Scan,
    /// Lets servos answer sooner, which is written to their permanent memory.
    ShortenAnswers,
    /// Runs the move that is shown.
    Move,
    /// Shows the move to where the arms are in nothing's way; opens where it is shown.
    ShowHome,
    /// Forgets the move that is shown.
    ForgetMove,
    /// Releases a latched STOP.
    ReleaseStop,
    /// All joints hold.
    TorqueOn,
    /// All joints go limp (asks first).
    TorqueOff,
    /// Saves the present posture (asks for a name).
    SavePose,
    /// Shows the board at all places of the twin, or ends that.
    TourBoard,
    /// Shows it at the few places that suffice where it is then looked at on the table.
    TourFew,
    /// Goes on with showing it where that was broken off.
    TourRest,
    /// Shows it at the next place, whatever it waits for where it is.
    SkipPlace,
    /// Lays the board on the twin's table.
    LayBoard,
    /// Puts the board away.
    HideBoard,
    /// Lets the eyes warm up, as far as it takes.
    WarmUp,
    /// Cold eyes.
    CoolEyes,
    /// Puts everything on the twin's table back.
    ResetTwin,
}

/// Of calibrating how the eyes sit in the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MountAction {
    /// Plans head poses.
    Plan,
    /// Turns the head to all of them.
    Tour,
    /// Takes a view where the head stands.
    Capture,
    /// Solves.
    Solve,
    /// Puts the proposal in use.
    Accept,
    /// Forgets the proposal.
    Discard,
    /// Removes the views of eyes that were colder than in the others.
    DeleteColder,
    /// Removes all views.
    DeleteAll,
    /// Goes back to the nominal mount.
    UseNominal,
}

/// Where the board lies when it is laid down: ahead of the robot, well inside of what the eyes
/// see at the working pose of the head. Robot frame, m.
const BOARD_ON_TABLE_M: [f64; 2] = [0.34, 0.0];

/// Its long side across: lying the long way, its far squares are too small for the eyes.
const BOARD_TURN_RAD: f64 = -std::f64::consts::FRAC_PI_2;

type Refusal = Option<Cow<'static, str>>;

fn when(possible: bool, why: &'static str) -> Refusal {
    (!possible).then_some(Cow::Borrowed(why))
}

impl RobotAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 22] = [
        Self::Connect,
        Self::ConnectTwin,
        Self::TwinEyes,
        Self::Disconnect,
        Self::Scan,
        Self::ShortenAnswers,
        Self::Move,
        Self::ShowHome,
        Self::ForgetMove,
        Self::ReleaseStop,
        Self::TorqueOn,
        Self::TorqueOff,
        Self::SavePose,
        Self::TourBoard,
        Self::TourFew,
        Self::TourRest,
        Self::SkipPlace,
        Self::LayBoard,
        Self::HideBoard,
        Self::WarmUp,
        Self::CoolEyes,
        Self::ResetTwin,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Connect => "Connect the robot…",
            Self::ConnectTwin => "Connect the twin",
            Self::TwinEyes => "Look through the twin's eyes",
            Self::Disconnect => "Disconnect the robot",
            Self::Scan => "Look for servos again",
            Self::ShortenAnswers => "Shorten answers…",
            Self::Move => "Move there",
            Self::ShowHome => "Show the way home",
            Self::ForgetMove => "Forget the shown move",
            Self::ReleaseStop => "Release STOP",
            Self::TorqueOn => "Hold all joints",
            Self::TorqueOff => "Let all joints go limp…",
            Self::SavePose => "Save this posture…",
            Self::TourBoard => "Show the board at all places",
            Self::TourFew => "Show the board at the places that suffice",
            Self::TourRest => "Show the board at the other places",
            Self::SkipPlace => "Skip this place",
            Self::LayBoard => "Lay the board on the table",
            Self::HideBoard => "Put the board away",
            Self::WarmUp => "Warm the twin's eyes up",
            Self::CoolEyes => "Cool the twin's eyes",
            Self::ResetTwin => "Put the twin's table back",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Refusal {
        let robot = &view.robot;
        let connected = robot.connection.is_connected();
        match self {
            Self::Connect => None,
            Self::ConnectTwin => match robot.connection {
                Connection::Connected { twin: true, .. } => Some("the twin is connected".into()),
                Connection::Connecting { .. } => Some("a connection is being made".into()),
                _ => None,
            },
            Self::Disconnect => when(
                connected || matches!(robot.connection, Connection::Connecting { .. }),
                "no robot is connected",
            ),
            Self::ShortenAnswers => when(
                connected && robot.bus.slow_answers > 0,
                "no servo waits longer before its answers than it needs to",
            )
            .or_else(|| {
                when(robot.motion == MotionState::Limp, "servos take it only while all joints are limp")
            }),
            // What was lost is looked for where it was.
            Self::Scan => when(
                connected || matches!(robot.connection, Connection::Lost { .. }),
                "no robot is connected",
            ),
            Self::SavePose => when(connected, "no robot is connected"),
            Self::Move => move_refusal(view),
            Self::ShowHome => home_refusal(view),
            Self::ForgetMove => when(robot.preview.is_some(), "no move is shown"),
            Self::ReleaseStop => when(robot.stopped, "STOP is not latched"),
            Self::TorqueOn if robot.stopped => Some("STOP is latched: release it first".into()),
            Self::TorqueOn | Self::TorqueOff => when(connected, "no robot is connected"),
            Self::HideBoard => when(view.twin.board.is_some(), "the board is put away"),
            Self::TourBoard | Self::TourFew => when(
                view.twin.running && view.twin.board_places > 0,
                "the twin does not run; connect it first",
            ),
            Self::TourRest => when(
                view.twin.running && view.twin.board_places_left > 0,
                "the board was not on its way through places",
            ),
            Self::SkipPlace => when(
                view.twin.running && view.twin.board_tour.is_some(),
                "the board is not on its way through places",
            ),
            Self::TwinEyes if matches!(view.source.spec, Some(SourceSpec::Twin)) => {
                Some("the twin's eyes are open".into())
            }
            Self::TwinEyes | Self::LayBoard | Self::WarmUp | Self::CoolEyes | Self::ResetTwin => {
                when(view.twin.running, "the twin does not run; connect it first")
            }
        }
    }

    /// The command that it stands for; `None` where the window has to ask first.
    pub fn command(self, view: &View) -> Option<Command> {
        let all = Vec::new;
        Some(match self {
            Self::Connect | Self::TorqueOff | Self::SavePose | Self::ShortenAnswers => return None,
            Self::ConnectTwin => RobotCommand::ConnectTwin { scenario: default_scenario(view) }.into(),
            Self::TwinEyes => SourceCommand::Open(SourceSpec::Twin).into(),
            Self::Disconnect => RobotCommand::Disconnect.into(),
            Self::Scan => RobotCommand::Scan.into(),
            Self::Move => RobotCommand::RunPreview.into(),
            Self::ShowHome => RobotCommand::Preview(Destination::Pose { name: HOME.to_owned() }).into(),
            Self::ForgetMove => RobotCommand::ClearPreview.into(),
            Self::ReleaseStop => RobotCommand::ReleaseStop.into(),
            Self::TorqueOn => RobotCommand::Torque { joints: all(), on: true }.into(),
            Self::TourBoard => TwinCommand::TourBoard(true).into(),
            Self::TourFew => TwinCommand::TourFew.into(),
            Self::TourRest => TwinCommand::TourRest.into(),
            Self::SkipPlace => TwinCommand::SkipPlace.into(),
            Self::LayBoard => {
                let [x_m, y_m] = BOARD_ON_TABLE_M;
                TwinCommand::LayBoard { x_m, y_m, yaw_rad: BOARD_TURN_RAD }.into()
            }
            Self::HideBoard => TwinCommand::HideBoard.into(),
            Self::WarmUp => TwinCommand::AdvanceWarmUp { minutes: to_be_warm_min(view) }.into(),
            Self::CoolEyes => TwinCommand::CoolEyes.into(),
            Self::ResetTwin => TwinCommand::Reset.into(),
        })
    }
}

/// By how much the twin's eyes have to warm up: until they are as warm as when they were calibrated, else as warm as
/// they get, min.
fn to_be_warm_min(view: &View) -> f64 {
    let until_warm = WARM_AFTER_MINUTES - view.twin.eyes_on_s / 60.0;
    view.eyes.health.colder_wait_min.unwrap_or(until_warm).ceil().max(1.0)
}

/// What moves the robot by itself just now, so that nobody moves it by hand; `None`: nothing does.
pub fn led_by(view: &View) -> Option<&'static str> {
    if matches!(view.touch.phase, TouchPhase::Waiting { .. } | TouchPhase::Running { .. }) {
        Some("touches move the arm: pause them first")
    } else if view.grasp.phase.is_paused() {
        Some("a grasp holds the arm: go on with it or end it, on the screen Grasp")
    } else if matches!(view.grasp.phase, GraspPhase::Hand { .. }) {
        Some("a step of the hand moves the arm: wait until it is made")
    } else if view.grasp.phase.moves() || matches!(view.trials.phase, TrialsPhase::Running { .. }) {
        Some("a grasp moves the arm: pause it first")
    } else if view.mount.tour.is_some() || view.handeye.is_looking {
        Some("the robot moves to be looked at: wait for the end, or cancel it")
    } else {
        None
    }
}

/// Name of the pose in which the arms are in nothing's way.
const HOME: &str = "home";

/// Why the way home cannot be shown.
fn home_refusal(view: &View) -> Refusal {
    let robot = &view.robot;
    if !robot.connection.is_connected() {
        return Some("no robot is connected".into());
    }
    if !robot.poses.iter().any(|pose| pose.name == HOME) {
        return Some("this robot has no pose of this name".into());
    }
    led_by(view).map(Cow::Borrowed)
}

/// Why the shown move cannot be run.
fn move_refusal(view: &View) -> Refusal {
    let robot = &view.robot;
    if !robot.connection.is_connected() {
        return Some("no robot is connected".into());
    }
    if robot.stopped {
        return Some("STOP is latched: release it first".into());
    }
    if let Some(why) = led_by(view) {
        return Some(why.into());
    }
    if matches!(robot.motion, MotionState::Moving { .. }) {
        return Some("the robot is moving".into());
    }
    match &robot.preview {
        None => Some("no move is shown: drag a joint or choose a pose".into()),
        Some(preview) => match &preview.path {
            Err(why) => Some(why.to_string().into()),
            Ok(_) => super::would_drop(view, &preview.end),
        },
    }
}

/// The scenario in use, else the first.
pub fn default_scenario(view: &View) -> String {
    let twin = &view.twin;
    if !twin.scenario.is_empty() {
        return twin.scenario.clone();
    }
    twin.scenarios.first().map_or_else(|| "lab".to_owned(), |(name, _)| name.clone())
}

impl MountAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 9] = [
        Self::Plan,
        Self::Tour,
        Self::Capture,
        Self::Solve,
        Self::Accept,
        Self::Discard,
        Self::DeleteColder,
        Self::DeleteAll,
        Self::UseNominal,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::Plan => "Plan head poses",
            Self::Tour => "Turn the head to the planned poses",
            Self::Capture => "Take a view from here",
            Self::Solve => "Solve the mount of the eyes",
            Self::Accept => "Accept the mount",
            Self::Discard => "Discard the proposed mount",
            Self::DeleteColder => "Delete the views of colder eyes",
            Self::DeleteAll => "Delete all views",
            Self::UseNominal => "Use the nominal mount",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Refusal {
        let mount = &view.mount;
        let busy = mount.step == StepState::Running;
        match self {
            Self::Plan | Self::Tour | Self::Capture if !view.robot.connection.is_connected() => {
                Some("no robot is connected: the head's angles are needed".into())
            }
            Self::Plan | Self::Capture => when(!busy, "work on the mount is under way"),
            Self::Tour if view.robot.stopped => Some("STOP is latched: release it first".into()),
            Self::Tour if busy => Some("work on the mount is under way".into()),
            Self::Tour => when(!mount.planned.is_empty(), "no head poses are planned"),
            Self::Solve if busy => Some("work on the mount is under way".into()),
            Self::Solve | Self::DeleteAll => when(!mount.views.is_empty(), "there is no view yet"),
            Self::DeleteColder => {
                let is_one_colder = mount.views.iter().any(|view| view.is_colder);
                when(is_one_colder, "the eyes were about as warm in all views")
            }
            Self::Accept if mount.proposal_stale.is_some() => {
                Some("views were taken or deleted since it was solved: solve again".into())
            }
            Self::Accept | Self::Discard => when(mount.proposal.is_some(), "nothing is proposed"),
            Self::UseNominal => when(mount.in_use.is_some(), "the nominal mount is in use"),
        }
    }

    /// The command that it stands for.
    pub fn command(self) -> Command {
        match self {
            Self::Plan => MountCommand::Plan,
            Self::Tour => MountCommand::Tour,
            Self::Capture => MountCommand::Capture,
            Self::Solve => MountCommand::Solve,
            Self::Accept => MountCommand::Accept,
            Self::Discard => MountCommand::Discard,
            Self::DeleteColder => MountCommand::DeleteColder,
            Self::DeleteAll => MountCommand::DeleteAll,
            Self::UseNominal => MountCommand::UseNominal,
        }
        .into()
    }
}

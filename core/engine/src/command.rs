//! What the operator can ask for: one enum per workflow, serializable, so that a journal of
//! commands is a replay.

use serde::{Deserialize, Serialize};

pub use crate::ground::jobs::{JobCommand, JobId};
pub use crate::ground::notice::NoticeCommand;
pub use crate::ground::watched::WatchCommand;

macro_rules! commands {
    ($($(#[$about:meta])* $workflow:ident($($room:ident)::+ / $type:ident);)+) => {
        $(pub use crate::$($room)::+::command::*;)+

        /// Anything that the window (or a script) can ask of the engine.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "workflow", content = "command", rename_all = "kebab-case")]
        pub enum Command {
            $($(#[$about])* $workflow($type),)+
            /// Long work that is running.
            Job(JobCommand),
            /// Messages to the operator.
            Notice(NoticeCommand),
            /// The program's own threads.
            Watch(WatchCommand),
        }

        into_command!($($workflow: $type,)+ Job: JobCommand, Notice: NoticeCommand, Watch: WatchCommand);
    };
}

macro_rules! into_command {
    ($($workflow:ident: $type:ty),+) => {
        $(impl From<$type> for Command {
            fn from(command: $type) -> Self {
                Self::$workflow(command)
            }
        })+
    };
}

commands! {
    /// Where the images come from.
    Source(source / SourceCommand);
    /// Recording what works live.
    Recording(recording / RecordingCommand);
    /// What is computed from them, live.
    Live(live / LiveCommand);
    /// Detecting objects in those images, live.
    Detect(detect / DetectCommand);
    /// Watching whether places stay where they are.
    Drift(drift / DriftCommand);
    /// Calibrating the eyes.
    Eyes(eyes / EyesCommand);
    /// The robot: connecting and moving it.
    Robot(robot / RobotCommand);
    /// The twin's table, clock and faults.
    Twin(twin / TwinCommand);
    /// The twin's truth beside what is measured.
    Truth(truth / TruthCommand);
    /// Calibrating how the eyes sit in the head.
    Mount(mount / MountCommand);
    /// Touching the screen.
    Touch(touch / TouchCommand);
    /// Correction models, and the tables of grasp height and yaw.
    Models(models / ModelsCommand);
    /// Finding, naming and adding what makes measurement differ from the model.
    Gap(gap / GapCommand);
    /// Grasping.
    Grasp(grasp / GraspCommand);
    /// Tying the arms to the eyes.
    HandEye(handeye / HandEyeCommand);
    /// The experiment with grasps.
    Trials(trials / TrialsCommand);
    /// The way from a robot that was just switched on to its first good grasp.
    Commission(commission / CommissionCommand);
    /// Everything that was put in use, taken back, found and checked.
    Timeline(timeline / TimelineCommand);
    /// The lab's own data sets: images with boxes.
    Labels(labels / LabelsCommand);
    /// Judging detectors.
    Scores(scores / ScoresCommand);
}

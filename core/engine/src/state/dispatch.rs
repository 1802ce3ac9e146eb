//! Who gets which command and which result, and what the window sees of whom.

use std::time::Instant;

use super::State;
use super::actions::Action;
use super::rooms::all_rooms;
use crate::command::{Command, JobCommand, NoticeCommand};
use crate::commission::CommissionWorkflow;
use crate::detect::DetectWorkflow;
use crate::drift::DriftWorkflow;
use crate::eyes::EyesWorkflow;
use crate::gap::GapWorkflow;
use crate::grasp::GraspWorkflow;
use crate::ground::jobs::JobId;
use crate::ground::stage::Skipped;
use crate::ground::{Moment, Workflow, World};
use crate::handeye::HandEyeWorkflow;
use crate::labels::LabelsWorkflow;
use crate::live::LiveWorkflow;
use crate::models::ModelsWorkflow;
use crate::mount::MountWorkflow;
use crate::recording::RecordingWorkflow;
use crate::scores::ScoresWorkflow;
use crate::source::SourceWorkflow;
use crate::timeline::TimelineWorkflow;
use crate::touch::TouchWorkflow;
use crate::trials::TrialsWorkflow;
use crate::truth::TruthWorkflow;
use crate::view::View;
use crate::work::WorkResult;

macro_rules! dispatched {
    (
        once { $($one:ident: $Single:ident, $single:ident;)+ }
        per_world { $($each:ident: $Worldly:ident, $worldly:ident, $whose:ident;)+ }
        without_work { $($silent:ident: $Silent:ident, $quiet:ident;)+ }
    ) => {
        impl State {
            /// Everybody reads what was accepted before.
            pub(super) fn restore(&mut self) {
                $(self.with::<$Single>(World::default(), |room, around, context| {
                    Workflow::restore(room, around, context);
                });)+
                for world in World::ALL {
                    $(self.with::<$Worldly>(world, |room, around, context| {
                        Workflow::restore(room, around, context);
                    });)+
                }
            }

            /// Applies a command of the operator.
            pub fn apply(&mut self, command: Command) {
                match command {
                    $(Command::$single(command) => {
                        self.with::<$Single>(World::default(), |room, around, context| {
                            Workflow::apply(room, command, around, context);
                        });
                    })+
                    $(Command::$worldly(command) => {
                        self.with::<$Worldly>(self.$whose, |room, around, context| {
                            Workflow::apply(room, command, around, context);
                        });
                    })+
                    $(Command::$quiet(command) => {
                        self.with::<$Silent>(World::default(), |room, around, context| {
                            Workflow::apply(room, command, around, context);
                        });
                    })+
                    Command::Robot(command) => self.actions.push(Action::Robot(command.into())),
                    Command::Twin(command) => self.actions.push(Action::Robot(command.into())),
                    Command::Job(JobCommand::Cancel(id)) if self.jobs.is_running(id) => {
                        self.actions.push(Action::Cancel(id));
                    }
                    Command::Job(JobCommand::Cancel(id) | JobCommand::Dismiss(id)) => self.jobs.dismiss(id),
                    // Whoever owns the threads has done it.
                    Command::Watch(_) => {}
                    Command::Notice(NoticeCommand::Add { level, text }) => self.notices.add(level, text),
                    Command::Notice(NoticeCommand::Clear) => self.notices.clear(),
                }
            }

            /// What the window shows.
            pub fn view(&mut self, skipped: Skipped, lost_commands: u64, now: Instant) -> View {
                self.revision += 1;
                let moment = Moment { now, skipped };
                View {
                    revision: self.revision,
                    $($one: self.view_of::<$Single>(World::default(), &moment),)+
                    $($each: self.view_of::<$Worldly>(self.$whose, &moment),)+
                    $($silent: self.view_of::<$Silent>(World::default(), &moment),)+
                    robot: self.robot.clone(),
                    twin: self.twin.clone(),
                    jobs: self.jobs.view(),
                    notices: self.notices.view(),
                    threads: self.faults.values().cloned().collect(),
                    kept: self.kept.clone(),
                    lost_commands,
                }
            }

            /// Whoever asked for the work gets what came of it.
            pub(super) fn work_done(&mut self, id: JobId, result: WorkResult) {
                let world = self.world_of(id);
                match result {
                    $(WorkResult::$single(result) => self.with::<$Single>(world, |room, around, context| {
                        Workflow::work_done(room, id, *result, around, context);
                    }),)+
                    $(WorkResult::$worldly(result) => self.with::<$Worldly>(world, |room, around, context| {
                        Workflow::work_done(room, id, *result, around, context);
                    }),)+
                }
            }

            /// Nothing came of the work, whoever asked for it.
            pub(super) fn work_gave_nothing(&mut self, id: JobId, why: Option<&str>) {
                let world = self.world_of(id);
                $(self.with::<$Single>(world, |room, around, context| {
                    Workflow::work_ended(room, id, why, around, context);
                });)+
                $(self.with::<$Worldly>(world, |room, around, context| {
                    Workflow::work_ended(room, id, why, around, context);
                });)+
            }
        }
    };
}

all_rooms!(dispatched);

//! Every workflow of the program, and where it is kept.

use std::path::Path;

use crate::commission::CommissionWorkflow;
use crate::detect::DetectWorkflow;
use crate::drift::DriftWorkflow;
use crate::eyes::EyesWorkflow;
use crate::gap::GapWorkflow;
use crate::grasp::GraspWorkflow;
use crate::ground::{PerWorld, Workflow, World};
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

/// All workflows, in the order in which they are restored and told: field, type, name in the sums,
/// and for those that there are once per world whose the operator speaks to.
macro_rules! all_rooms {
    ($then:ident) => {
        $then! {
        once {
            labels: LabelsWorkflow, Labels;
            detect: DetectWorkflow, Detect;
            scores: ScoresWorkflow, Scores;
            source: SourceWorkflow, Source;
            recording: RecordingWorkflow, Recording;
            drift: DriftWorkflow, Drift;
        }
        per_world {
            eyes: EyesWorkflow, Eyes, shown;
            mount: MountWorkflow, Mount, shown;
            touch: TouchWorkflow, Touch, arm_of;
            models: ModelsWorkflow, Models, arm_of;
            gap: GapWorkflow, Gap, arm_of;
            grasp: GraspWorkflow, Grasp, arm_of;
            handeye: HandEyeWorkflow, HandEye, arm_of;
            trials: TrialsWorkflow, Trials, arm_of;
            commission: CommissionWorkflow, Commission, arm_of;
            timeline: TimelineWorkflow, Timeline, arm_of;
        }
        without_work {
            live: LiveWorkflow, Live;
            truth: TruthWorkflow, Truth;
        }
        }
    };
}
pub(super) use all_rooms;

/// What a workflow can see of the rest, and what follows for the rest when it has changed.
pub(super) trait Neighbors<W: Workflow> {
    /// What it can see.
    fn around(&self, world: World) -> W::Around;

    /// It may have changed.
    fn after(&mut self, _world: World) {}
}

/// Where a workflow is kept.
pub(super) trait Keeps<W> {
    fn room(&mut self, world: World) -> &mut W;
}

macro_rules! kept {
    (
        once { $($one:ident: $Single:ident, $single:ident;)+ }
        per_world { $($each:ident: $Worldly:ident, $worldly:ident, $whose:ident;)+ }
        without_work { $($silent:ident: $Silent:ident, $quiet:ident;)+ }
    ) => {
        /// All workflows.
        #[derive(Clone, Debug)]
        pub(super) struct Rooms {
            $(pub $one: $Single,)+
            $(pub $each: PerWorld<$Worldly>,)+
            $(pub $silent: $Silent,)+
        }

        impl Rooms {
            /// Nothing done yet.
            pub fn new(data_dir: &Path) -> Self {
                Self {
                    $($one: Workflow::new(data_dir),)+
                    $($each: PerWorld::new(|world| Workflow::new(&world.folder(data_dir))),)+
                    $($silent: Workflow::new(data_dir),)+
                }
            }
        }

        $(impl Keeps<$Silent> for Rooms {
            fn room(&mut self, _: World) -> &mut $Silent {
                &mut self.$silent
            }
        })+

        $(impl Keeps<$Single> for Rooms {
            fn room(&mut self, _: World) -> &mut $Single {
                &mut self.$one
            }
        })+

        $(impl Keeps<$Worldly> for Rooms {
            fn room(&mut self, world: World) -> &mut $Worldly {
                self.$each.of_mut(world)
            }
        })+
    };
}

all_rooms!(kept);

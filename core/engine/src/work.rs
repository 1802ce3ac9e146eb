//! Work that takes longer than a frame, of whatever workflow.

use plumbline_model::JobContext;

use crate::ground::jobs::JobError;
use crate::ground::notice::NoticeLevel;
use crate::ground::{LongWork, Nothing};

macro_rules! works {
    ($($(#[$about:meta])* $workflow:ident($room:ident / $work:ident);)+) => {
        $(use crate::$room::work::$work;)+

        /// Something to do beside the window.
        #[derive(Clone, Debug)]
        pub enum Work {
            $($(#[$about])* $workflow(Box<$work>),)+
        }

        /// What came out.
        #[derive(Clone, Debug)]
        pub enum WorkResult {
            $($(#[$about])* $workflow(Box<<$work as LongWork>::Result>),)+
        }

        $(impl From<$work> for Work {
            fn from(work: $work) -> Self {
                Self::$workflow(Box::new(work))
            }
        })+

        impl Work {
            /// What it does, for people.
            pub fn title(&self) -> String {
                match self {
                    $(Self::$workflow(work) => work.title(),)+
                }
            }

            /// Does it, on the thread of the caller.
            ///
            /// # Errors
            /// A sentence that says what is wrong and what to do, or that it was cancelled.
            pub fn run(self, context: &dyn JobContext) -> Result<WorkResult, JobError> {
                match self {
                    $(Self::$workflow(work) => work.run(context).map(Box::new).map(WorkResult::$workflow),)+
                }
            }
        }

        impl WorkResult {
            /// The result in a sentence.
            pub fn summary(&self) -> String {
                match self {
                    $(Self::$workflow(result) => result.summary(),)+
                }
            }
        }
    };
}

works! {
    /// Of the source.
    Source(source / SourceWork);
    /// Part of recording.
    Recording(recording / RecordingWork);
    /// Part of watching drift.
    Drift(drift / DriftWork);
    /// Part of detection.
    Detect(detect / DetectWork);
    /// Part of calibrating the eyes.
    Eyes(eyes / EyesWork);
    /// Part of calibrating how they sit in the head.
    Mount(mount / MountWork);
    /// Part of touching the screen.
    Touch(touch / TouchWork);
    /// Part of correction models and tables.
    Models(models / ModelsWork);
    /// Part of the gap.
    Gap(gap / GapWork);
    /// Part of grasping.
    Grasp(grasp / GraspWork);
    /// Part of tying the arms to the eyes.
    HandEye(handeye / HandEyeWork);
    /// Part of the experiment with grasps.
    Trials(trials / TrialsWork);
    /// Part of commissioning.
    Commission(commission / CommissionWork);
    /// Part of the timeline of results.
    Timeline(timeline / TimelineWork);
    /// Part of the lab's own data sets.
    Labels(labels / LabelsWork);
    /// Part of judging detectors.
    Scores(scores / ScoresWork);
}

impl WorkResult {
    /// What kind of news it is that this is done.
    pub fn level(&self) -> NoticeLevel {
        match self {
            Self::Gap(result) => result.level(),
            _ => NoticeLevel::Success,
        }
    }
}

impl From<Nothing> for Work {
    fn from(none: Nothing) -> Self {
        match none {}
    }
}

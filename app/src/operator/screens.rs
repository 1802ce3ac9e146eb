//! The steps of the work, and the panes in them.

use serde::{Deserialize, Serialize};

/// A screen: one arrangement of tiles, kept as the operator leaves it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Screen {
    /// The way from a robot that was just switched on to its first good grasp.
    Commission,
    /// Looking at the eyes.
    #[default]
    Live,
    /// Calibrating the eyes: choosing the board, collecting pairs, solving.
    Collect,
    /// Calibrating the eyes: judging what was solved.
    Judge,
    /// Calibrating the eyes: comparing with what is in use, accepting, files.
    Accept,
    /// Calibrating how the eyes sit in the head.
    Mount,
    /// Touching the screen: planning, running, placing the screen.
    Touch,
    /// Correction models, and the tables of grasp height and yaw.
    Models,
    /// The gap between model and measurement: compare, find, name, add, show.
    Gap,
    /// Tying the arms to the eyes.
    HandEye,
    /// Grasping things.
    Grasp,
    /// Watching whether places stay where they are.
    Drift,
    /// Everything that was put in use, taken back, found and checked.
    Timeline,
    /// The robot: its joints, moving it.
    Robot,
    /// Detectors judged on a labeled data set.
    Scores,
    /// The lab's own data sets: capturing images, drawing boxes.
    Images,
}

impl Screen {
    /// All of them, in the order of work.
    pub const ALL: [Self; 16] = [
        Self::Commission,
        Self::Live,
        Self::Collect,
        Self::Judge,
        Self::Accept,
        Self::Mount,
        Self::Touch,
        Self::Models,
        Self::Gap,
        Self::HandEye,
        Self::Grasp,
        Self::Drift,
        Self::Timeline,
        Self::Robot,
        Self::Scores,
        Self::Images,
    ];

    /// Whether it belongs to "Detect".
    pub fn is_detect(self) -> bool {
        matches!(self, Self::Scores | Self::Images)
    }

    /// Whether it belongs to the step "Eyes".
    pub fn is_eyes(self) -> bool {
        matches!(self, Self::Collect | Self::Judge | Self::Accept)
    }
}

/// What a tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pane {
    /// The steps of commissioning.
    CommissionSteps,
    /// The left eye as its camera delivers it.
    LeftEye,
    /// The right eye.
    RightEye,
    /// The aimed pair with its epipolar lines.
    Rectified,
    /// The aimed pair in red and cyan.
    Anaglyph,
    /// The aimed pair in turns.
    Blink,
    /// Disparity as colors.
    Disparity,
    /// Distance as colors.
    Depth,
    /// Which board, and the lens model.
    Board,
    /// Where the board has been.
    Coverage,
    /// The collected pairs.
    Pairs,
    /// Error of every pair and eye.
    PairErrors,
    /// The chosen pair with what is left of its errors.
    Residuals,
    /// The verdict and its figures.
    Figures,
    /// How well places on the table are known.
    Uncertainty,
    /// How far places on the table move against the calibration in use.
    Difference,
    /// Both calibrations side by side.
    Comparison,
    /// Reading and writing calibration files; earlier calibrations.
    Files,
    /// Robot, table and objects in three dimensions.
    Scene,
    /// What is looked at so that the arms are tied to the eyes, and what was seen.
    HandEyeParts,
    /// Where the hands are seen over the table.
    HandEyeMap,
    /// The joints: where they are, where they should be.
    Joints,
    /// Moving a tip while a key is held.
    Jog,
    /// Poses with a name.
    Poses,
    /// What stands on the twin's table, its clock, its faults.
    Twin,
    /// Head poses from which the board was seen.
    HeadViews,
    /// How the eyes sit in the head: nominal, in use, proposed.
    EyeMount,
    /// What shall be touched, and what that will tell.
    TouchPlan,
    /// Targets and touches on the glass.
    TouchMap,
    /// The run under way, its figures, its last touches.
    TouchRun,
    /// Where the screen lies: nominal, in use, proposed.
    ScreenPlace,
    /// Training correction models.
    ModelTraining,
    /// All methods on the same held-out touches.
    ModelComparison,
    /// A model over the table, before and after, and its border.
    ModelMap,
    /// The tables of grasp height and yaw.
    GraspTables,
    /// Sessions and model, and how far they lie apart.
    GapCompare,
    /// What is missing, by name.
    GapNames,
    /// What the data say about every effect of the library.
    GapCandidates,
    /// What is left over the table.
    GapMap,
    /// Before and after on held-out rows.
    GapShown,
    /// What to measure next.
    GapNext,
    /// Models and findings so far.
    GapHistory,
    /// What is grasped and how, the attempt as it goes on, its result.
    GraspRun,
    /// What became of attempts.
    GraspAttempts,
    /// The experiment with grasps.
    GraspExperiment,
    /// How far places wander, over time.
    DriftCourse,
    /// How far they have wandered over the table.
    DriftTable,
    /// The 9 by 4 evaluation.
    DriftGrid,
    /// Everything that was put in use, taken back, found and checked, on one line.
    TimelineLine,
    /// What is in use.
    TimelineInUse,
    /// Two entries of the timeline.
    TimelineCompared,
    /// Which detectors are judged on what.
    ScoreChoice,
    /// Detectors compared.
    ScoreTable,
    /// Each class by itself.
    ScoreClasses,
    /// What was taken for what.
    ScoreConfusion,
    /// The images behind a cell of it.
    ScoreCell,
    /// The images of a data set.
    LabelList,
    /// One image, to draw boxes.
    LabelCanvas,
    /// The images as small pictures.
    LabelGallery,
    /// What is wrong in a data set; an import before it is accepted.
    LabelChecks,
}

impl Pane {
    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::CommissionSteps => "Commissioning",
            Self::LeftEye => "Left eye",
            Self::RightEye => "Right eye",
            Self::Rectified => "Rectified pair",
            Self::Anaglyph => "Anaglyph",
            Self::Blink => "Blink",
            Self::Disparity => "Disparity",
            Self::Depth => "Depth",
            Self::Board => "Board",
            Self::Coverage => "Coverage",
            Self::Pairs => "Pairs",
            Self::PairErrors => "Error per pair",
            Self::Residuals => "Residuals",
            Self::Figures => "Verdict",
            Self::Uncertainty => "Uncertainty at the table",
            Self::Difference => "Difference at the table",
            Self::Comparison => "Comparison",
            Self::Files => "Files",
            Self::Scene => "Scene",
            Self::Joints => "Joints",
            Self::Jog => "Jog",
            Self::Poses => "Poses",
            Self::Twin => "Twin",
            Self::HeadViews => "Views",
            Self::EyeMount => "Mount of the eyes",
            Self::TouchPlan => "Plan",
            Self::TouchMap => "Touches",
            Self::TouchRun => "Run",
            Self::ScreenPlace => "Place of the screen",
            Self::ModelTraining => "Training",
            Self::ModelComparison => "Models compared",
            Self::ModelMap => "Model over the table",
            Self::GraspTables => "Grasp height and yaw",
            Self::GapCompare => "Compare",
            Self::GapNames => "Name and add",
            Self::GapCandidates => "Candidates",
            Self::GapMap => "Gap over the table",
            Self::GapShown => "Before and after",
            Self::GapNext => "Next experiment",
            Self::GapHistory => "History",
            Self::HandEyeParts => "Hand-eye",
            Self::HandEyeMap => "Hands over the table",
            Self::GraspRun => "Grasp",
            Self::GraspAttempts => "Attempts",
            Self::GraspExperiment => "Experiment",
            Self::DriftCourse => "Drift",
            Self::DriftTable => "Drift over the table",
            Self::DriftGrid => "9×4 evaluation",
            Self::TimelineLine => "Timeline",
            Self::TimelineInUse => "In use",
            Self::TimelineCompared => "Two compared",
            Self::ScoreChoice => "Detectors and data set",
            Self::ScoreTable => "Detectors compared",
            Self::ScoreClasses => "Per class",
            Self::ScoreConfusion => "Confusion",
            Self::ScoreCell => "Images of the cell",
            Self::LabelList => "Data set",
            Self::LabelCanvas => "Boxes",
            Self::LabelGallery => "Gallery",
            Self::LabelChecks => "Checks",
        }
    }
}

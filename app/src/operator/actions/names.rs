//! What actions are called: by scripts, and by people.

use plumbline_engine::ExportFormat;
use serde_json::Value;

use super::{
    Action, CommissionAction, GapAction, GraspAction, HandEyeAction, LabelsAction, ModelsAction, MountAction,
    RobotAction, TouchAction, TrialsAction, all,
};
use crate::operator::screens::Screen;
use crate::operator::snapshot::models::Method;

impl Action {
    /// What scripts call it, by the parts that it is serialized of: `touch-plan-corners`.
    pub fn name(self) -> String {
        let parts = serde_json::to_value(self).map(|value| parts(&value)).unwrap_or_default();
        parts.join("-")
    }

    /// All that have a name in scripts: what has a place in the palette, and the three models.
    pub fn named() -> impl Iterator<Item = Self> {
        let models = Method::ALL.into_iter().flat_map(|m| [ModelsAction::Accept(m), ModelsAction::Show(m)]);
        all().chain(models.map(Self::Models))
    }

    /// What it is called everywhere.
    pub fn label(self) -> String {
        match self {
            Self::Stop => "Stop everything",
            Self::Next => "Do what comes next",
            Self::OpenFolder => "Open a folder of pairs…",
            Self::OpenTwoFolders => "Open two folders…",
            Self::OpenVideos => "Open two videos…",
            Self::OpenCameras => "Use USB cameras…",
            Self::OpenPath => "Open a typed path…",
            Self::CloseSource => "Close the source",
            Self::RetrySource => "Try the source again",
            Self::PlayPause => "Play or pause",
            Self::StepForward => "One pair forward",
            Self::StepBack => "One pair back",
            Self::ToggleLoop => "Loop the recording",
            Self::Go(Screen::Commission) => "Go to Commission",
            Self::Go(Screen::Live) => "Go to Live",
            Self::Go(Screen::Collect) => "Go to Eyes: collect",
            Self::Go(Screen::Judge) => "Go to Eyes: judge",
            Self::Go(Screen::Accept) => "Go to Eyes: accept",
            Self::Go(Screen::Mount) => "Go to Mount",
            Self::Go(Screen::Touch) => "Go to Touch",
            Self::Go(Screen::Models) => "Go to Models",
            Self::Go(Screen::Gap) => "Go to Gap",
            Self::Go(Screen::HandEye) => "Go to Hand-eye",
            Self::Go(Screen::Grasp) => "Go to Grasp",
            Self::Go(Screen::Drift) => "Go to Drift",
            Self::Go(Screen::Timeline) => "Go to Timeline",
            Self::Go(Screen::Robot) => "Go to Robot",
            Self::Go(Screen::Images) => "Go to Detect: images",
            Self::Go(Screen::Scores) => "Go to Detect: scores",
            Self::Robot(action) => action.label(),
            Self::Mount(action) => action.label(),
            Self::Touch(action) => action.label(),
            Self::Models(action) => action.label(),
            Self::Gap(action) => action.label(),
            Self::Grasp(action) => action.label(),
            Self::HandEye(action) => action.label(),
            Self::Trials(action) => action.label(),
            Self::Grid(action) => action.label(),
            Self::Commission(action) => action.label(),
            Self::Timeline(action) => action.label(),
            Self::Labels(action) => action.label(),
            Self::Scores(action) => action.label(),
            Self::Detect(action) => action.label(),
            Self::ToggleRecording => "Record, or stop recording",
            Self::PlayLastRecording => "Play the last recording",
            Self::ExportRecording => "Export as LeRobot data set…",
            Self::WatchDrift => "Watch drift, or stop watching",
            Self::ExplainDrift => "Explain what was watched",
            Self::ToggleTruth => "Show the twin's truth, or hide it",
            Self::RecognizeBoard => "Recognize the board",
            Self::UseSeenBoard => "Use the recognized board",
            Self::Capture => "Capture pair",
            Self::ToggleAutoCapture => "Capture by itself",
            Self::CollectRecording => "Use all pairs of the folder or recording",
            Self::DeleteLast => "Delete the last pair",
            Self::DeleteAll => "Delete all pairs",
            Self::Undo => "Undo",
            Self::Solve => "Solve the collected pairs",
            Self::JudgeHealth => "Is the calibration still good?",
            Self::Accept => "Accept calibration",
            Self::Discard => "Discard the proposal",
            Self::Import => "Import a calibration…",
            Self::StartAgain(thread) => return Self::start_again_label(thread),
            Self::Export(_, format) => return format!("Export as {}…", format_name(format)),
            Self::CancelJob => "Cancel the running job",
            Self::SaveWindow => "Save a picture of the window…",
            Self::Palette => "All commands",
            Self::Help => "Help: the manual at this screen",
            Self::About => "About Plumbline",
            Self::ToggleInspector => "Inspector",
            Self::ToggleLog => "Log",
            Self::ToggleNotices => "Messages",
            Self::ToggleTheme => "Change between dark and light",
            Self::ResetArrangement => "Reset the tiles of this screen",
            Self::ResetAllArrangements => "Reset the tiles of all screens",
            Self::ToggleFrameTimes => "Frame times",
            Self::Quit => "Quit",
        }
        .to_owned()
    }

    /// Whether the robot begins to move with it.
    pub fn moves_the_robot(self) -> bool {
        matches!(
            self,
            Self::HandEye(HandEyeAction::Look)
                | Self::Mount(MountAction::Tour)
                | Self::Touch(TouchAction::Start | TouchAction::Resume)
                | Self::Grasp(GraspAction::Grasp | GraspAction::Resume | GraspAction::Hand(_))
        )
    }

    /// Whether it lets something of the robot move, at once.
    pub fn begins_to_move(self) -> bool {
        matches!(
            self,
            Self::Robot(RobotAction::Move)
                | Self::Mount(MountAction::Tour)
                | Self::Touch(TouchAction::Start | TouchAction::Resume | TouchAction::Prepared)
                | Self::HandEye(HandEyeAction::Look)
                | Self::Grasp(GraspAction::Grasp | GraspAction::Resume | GraspAction::Hand(_))
                | Self::Trials(TrialsAction::GoOn | TrialsAction::Placed)
                | Self::Commission(CommissionAction::Next)
        )
    }

    /// Whether it puts a proposal in use.
    pub fn puts_in_use(self) -> bool {
        matches!(
            self,
            Self::Accept
                | Self::Mount(MountAction::Accept)
                | Self::Touch(TouchAction::AcceptScreen)
                | Self::Models(ModelsAction::AcceptShown | ModelsAction::Accept(_))
                | Self::Gap(GapAction::Add)
                | Self::HandEye(HandEyeAction::Accept)
                | Self::Labels(LabelsAction::AcceptProposals | LabelsAction::AcceptImport)
        )
    }
}

/// Names and values, the outer ones first.
fn parts(value: &Value) -> Vec<String> {
    match value {
        Value::String(text) => vec![text.clone()],
        Value::Array(values) => values.iter().flat_map(parts).collect(),
        Value::Object(fields) => {
            fields.iter().flat_map(|(name, value)| [vec![name.clone()], parts(value)].concat()).collect()
        }
        other => vec![other.to_string()],
    }
}

/// What people call a file format.
pub fn format_name(format: ExportFormat) -> &'static str {
    match format {
        ExportFormat::Plumbline => "Plumbline file",
        ExportFormat::RosCameraInfo => "ROS camera_info",
        ExportFormat::OpenCv => "OpenCV FileStorage",
        ExportFormat::Kalibr => "Kalibr camchain",
        ExportFormat::MrcalCorners => "mrcal corners",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_name_of_its_own() {
        let mut names: Vec<String> = Action::named().map(Action::name).collect();
        for name in ["solve", "go-judge", "touch-plan-corners", "models-accept-m3", "export-in-use-kalibr"] {
            assert!(names.iter().any(|known| known == name), "{name}");
        }
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(names.iter().all(|name| !name.is_empty() && !name.contains(':')), "{names:?}");
    }
}

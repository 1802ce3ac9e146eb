//! Why an action cannot be done now.

use std::borrow::Cow;

use jiff::Timestamp;
use plumbline_engine::view::{HealthState, RecordingState, SourceStatus};
use plumbline_engine::{Exported, View};

use super::Action;
use crate::operator::words::recording_to_export;

impl Action {
    /// Why it cannot be done now; `None` when it can.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let eyes = &view.eyes;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::CloseSource => when(view.source.status != SourceStatus::None, "no source is open"),
            Self::RetrySource => {
                when(matches!(view.source.status, SourceStatus::Lost { .. }), "no source is lost")
            }
            Self::PlayPause | Self::StepForward | Self::StepBack | Self::ToggleLoop => {
                when(view.source.replay.is_some(), "no recording is open")
            }
            Self::RecognizeBoard | Self::Capture => when(view.live.raw.is_some(), "there is no image yet"),
            Self::UseSeenBoard => when(
                eyes.board_seen.as_ref().is_some_and(|s| s.inner_corners.is_some()),
                "no board was recognized",
            ),
            Self::ToggleRecording if view.recording.is_on() => match view.recording.state {
                RecordingState::On { .. } => None,
                _ => Some("the file is being written".into()),
            },
            Self::ToggleRecording => when(
                view.source.replay.is_none() && view.source.status == SourceStatus::Running,
                "no eyes are live",
            ),
            Self::WatchDrift if view.drift.is_watching => None,
            Self::WatchDrift => when(
                view.source.status == SourceStatus::Running && !view.source.photographs,
                "no eyes are live",
            ),
            Self::ToggleTruth if view.truth.is_on => None,
            Self::ToggleTruth => when(
                view.twin.running && view.robot.connection.is_connected(),
                "no twin is connected: of a real robot nobody knows the truth",
            ),
            Self::PlayLastRecording => when(view.recording.last.is_some(), "nothing was recorded yet"),
            Self::ExportRecording if view.recording.exporting.is_some() => {
                Some("a recording is being exported".into())
            }
            Self::ExportRecording => {
                when(recording_to_export(view).is_some(), "no recording is open, and none was made")
            }
            Self::CollectRecording => when(view.source.replay.is_some(), "no recording is open"),
            Self::ExplainDrift if view.gap.searching.is_some() => Some("the gap is being looked for".into()),
            Self::ExplainDrift => view.drift.unexplained.map(Cow::Borrowed),
            Self::DeleteLast | Self::DeleteAll => when(!eyes.collected.is_empty(), "no pair is collected"),
            Self::Solve if eyes.solving.is_some() => Some("a solution is being computed".into()),
            Self::Solve => when(!eyes.collected.is_empty(), "no pair is collected"),
            Self::JudgeHealth if eyes.health.state == HealthState::Judging => {
                Some("what both eyes see is being compared".into())
            }
            Self::JudgeHealth if eyes.in_use.is_none() => Some("no calibration is in use".into()),
            Self::JudgeHealth => when(view.source.status != SourceStatus::None, "no source is open"),
            Self::Accept if eyes.health.is_against_proposal() => {
                let is_outdated = eyes.health.when.is_some_and(|when| when.is_outdated(Timestamp::now()));
                Some(match is_outdated {
                    true => "what was judged of it does not stand any more: judge it again".into(),
                    false => "by what the eyes see it is not better than the one in use".into(),
                })
            }
            Self::Accept | Self::Discard => when(eyes.proposal.is_some(), "nothing is proposed"),
            Self::Export(Exported::InUse, _) => when(eyes.in_use.is_some(), "no calibration is in use"),
            Self::Export(Exported::Proposal, _) => when(eyes.proposal.is_some(), "nothing is proposed"),
            Self::Robot(action) => action.refusal(view),
            Self::Mount(action) => action.refusal(view),
            Self::Touch(action) => action.refusal(view),
            Self::Models(action) => action.refusal(view),
            Self::Gap(action) => action.refusal(view),
            Self::Grasp(action) => action.refusal(view),
            Self::HandEye(action) => action.refusal(view),
            Self::Trials(action) => action.refusal(view),
            Self::Grid(action) => action.refusal(view),
            Self::Commission(action) => action.refusal(view),
            Self::Timeline(action) => action.refusal(view),
            Self::Labels(action) => action.refusal(view),
            Self::Scores(action) => action.refusal(view),
            Self::Detect(action) => action.refusal(view),
            Self::StartAgain(thread) => Self::start_again_refusal(thread, view).map(Cow::Borrowed),
            Self::CancelJob => when(view.running_job().is_some(), "no job is running"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::actions::RobotAction;

    #[test]
    fn without_anything_open_the_reasons_are_said() {
        let view = View::default();
        assert_eq!(Action::Solve.refusal(&view).as_deref(), Some("no pair is collected"));
        assert_eq!(Action::PlayPause.refusal(&view).as_deref(), Some("no recording is open"));
        let going = Action::Robot(RobotAction::Move).refusal(&view);
        assert_eq!(going.as_deref(), Some("no robot is connected"));
        assert_eq!(Action::Stop.refusal(&view), None, "stop can always be asked for");
    }
}

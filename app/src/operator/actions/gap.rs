//! What can be asked for by name of the gap.

use std::borrow::Cow;

use plumbline_engine::{Command, Correction, GapCommand, GapModel, TouchCommand, View};
use plumbline_model::touch_plan::{Finger, PlanOptions};
use serde::Serialize;

use super::touch::{CHECK_SEED, Preset, TouchAction, other_targets, usual_area};
use crate::operator::snapshot::gap::{Finding, plan_for};

/// Of the gap between model and measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GapAction {
    /// Looks anew which sessions there are.
    ListSessions,
    /// Chooses the folder of a session.
    OpenSession,
    /// Compares with the robot's description alone.
    CompareNominal,
    /// Compares with the model in use.
    CompareInUse,
    /// Looks for the gap.
    Find,
    /// Adds all effects of the shown finding that can be added and are not left out.
    Add,
    /// Corrects the arm by all usual effects, although none has a name.
    Size,
    /// Plans new touches, each with the effects and without them.
    Prove,
    /// Takes over the next experiment as a plan of touches.
    NextExperiment,
    /// Writes a page about the finding as HTML (asks where to).
    ReportHtml,
    /// The same as PDF.
    ReportPdf,
    /// Deletes the shown finding.
    Delete,
    /// Back to the model before.
    Undo,
    /// Puts back what was taken back last.
    Redo,
    /// Takes all effects out of the model.
    UseNominal,
}

impl GapAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 15] = [
        Self::ListSessions,
        Self::OpenSession,
        Self::CompareInUse,
        Self::CompareNominal,
        Self::Find,
        Self::Add,
        Self::Size,
        Self::Prove,
        Self::NextExperiment,
        Self::ReportHtml,
        Self::ReportPdf,
        Self::Delete,
        Self::Undo,
        Self::Redo,
        Self::UseNominal,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::ListSessions => "Look for sessions to compare",
            Self::OpenSession => "Open a session to compare…",
            Self::CompareNominal => "Compare with the nominal model",
            Self::CompareInUse => "Compare with the model in use",
            Self::Find => "Find what is missing",
            Self::Add => "Add the found effects to the model",
            Self::Size => "Correct the arm without a name",
            Self::Prove => "Plan touches with and without the effects",
            Self::NextExperiment => "Plan the next experiment",
            Self::ReportHtml => "Report of the gap (HTML)…",
            Self::ReportPdf => "Report of the gap (PDF)…",
            Self::Delete => "Delete the shown finding",
            Self::Undo => "Undo the last change of the robot model",
            Self::Redo => "Put back what was taken back of the robot model",
            Self::UseNominal => "Take all effects out of the robot model",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let gap = &view.gap;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::ListSessions | Self::OpenSession | Self::CompareNominal | Self::CompareInUse => None,
            Self::Find if gap.searching.is_some() => Some("the gap is being looked for".into()),
            Self::Find => when(!gap.chosen.is_empty(), "no session is chosen"),
            Self::Add => match &gap.stale {
                Some(why) => Some(why.clone().into()),
                None if gap.addable().is_empty() => Some("nothing was found that could be added".into()),
                None => when(!gap.wanted().is_empty(), "all that was found is left out: tick what to add"),
            },
            Self::Size => when(gap.sizes_arm, "nothing was found in touches that could correct the arm"),
            Self::Prove if gap.model.effects.is_empty() => Some("no effect is in the model".into()),
            Self::NextExperiment if plan(view).is_none() => Some("no experiment is waiting".into()),
            Self::NextExperiment | Self::Prove => TouchAction::Plan(Preset::Check).refusal(view),
            Self::ReportHtml | Self::ReportPdf | Self::Delete => {
                when(gap.shown.is_some(), "nothing was looked for yet")
            }
            Self::Undo => when(gap.model.can_undo, "there was no other model before"),
            Self::Redo => when(gap.model.can_redo, "nothing was taken back that could be put back"),
            Self::UseNominal => when(!gap.model.effects.is_empty(), "the model has no effects"),
        }
    }

    /// The command that it stands for; `None` where the window has to ask first.
    pub fn command(self, view: &View) -> Option<Command> {
        Some(
            match self {
                Self::ListSessions => GapCommand::ListSessions,
                Self::CompareNominal => GapCommand::CompareWith(GapModel::Nominal),
                Self::CompareInUse => GapCommand::CompareWith(GapModel::InUse),
                Self::Find => GapCommand::Find { seed: 1 },
                Self::Add => GapCommand::Add { effects: view.gap.wanted() },
                Self::Size => GapCommand::Add { effects: vec![] },
                Self::Delete => GapCommand::Delete { id: view.gap.shown.as_ref()?.entry.id.clone() },
                Self::Undo => GapCommand::Undo,
                Self::Redo => GapCommand::Redo,
                Self::UseNominal => GapCommand::UseNominal,
                Self::OpenSession
                | Self::NextExperiment
                | Self::Prove
                | Self::ReportHtml
                | Self::ReportPdf => return None,
            }
            .into(),
        )
    }
}

/// What touched when the finding was measured: its candidates sit in that arm.
fn finger_of(view: &View, finding: &Finding) -> Finger {
    let chain = view.robot.rig.as_ref().and_then(|rig| rig.chain(Finger::Left.tip()).ok());
    let of_left = |site: &String| chain.as_ref().is_some_and(|chain| chain.names().contains(site));
    let left = finding.candidates.iter().any(|candidate| of_left(&candidate.site));
    if left { Finger::Left } else { Finger::Right }
}

/// Places that are touched with the effects and without them.
const PROVED: usize = 10;

/// Touches that show what the effects in the model are worth, as commands to the touch step.
pub fn proof(view: &View) -> Option<[Command; 2]> {
    let finger = view.gap.finding().map_or_else(Finger::default, |finding| finger_of(view, finding));
    let options = PlanOptions::prove(usual_area(view, finger)?, PROVED, CHECK_SEED);
    let plan = other_targets(view, PlanOptions { finger, ..options });
    Some([TouchCommand::CorrectWith(Some(Correction::Effects)).into(), TouchCommand::Plan(plan).into()])
}

/// The next experiment as a command to the touch step.
pub fn plan(view: &View) -> Option<Command> {
    let finding = view.gap.finding()?;
    let finger = finger_of(view, finding);
    let plan = plan_for(finding.next.as_ref()?, finger, usual_area(view, finger)?)?;
    Some(TouchCommand::Plan(plan).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_anything_found_the_reasons_are_said() {
        let view = View::default();
        assert_eq!(GapAction::Find.refusal(&view).as_deref(), Some("no session is chosen"));
        assert_eq!(GapAction::Add.refusal(&view).as_deref(), Some("nothing was found that could be added"));
        assert_eq!(GapAction::NextExperiment.refusal(&view).as_deref(), Some("no experiment is waiting"));
        assert_eq!(GapAction::OpenSession.refusal(&view), None);
    }
}

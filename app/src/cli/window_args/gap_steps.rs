//! Steps of a script that speak of the gap between model and measurement.

use plumbline_engine::GapCommand;

use crate::operator::{Action, GapAction, Pane, Screen};
use crate::panels::GapErrors;
use crate::window::ScriptStep;

type Step = Result<ScriptStep, String>;

/// The step of this name; `None` when there is none.
pub(super) fn step(name: &str, value: &str) -> Option<Step> {
    Some(Ok(match name {
        "gap" => ScriptStep::Act(Action::Go(Screen::Gap)),
        "gap-session" => return Some(session(value)),
        "gap-pane-compare" => ScriptStep::ShowPane(Pane::GapCompare),
        "gap-pane-names" => ScriptStep::ShowPane(Pane::GapNames),
        "gap-pane-candidates" => ScriptStep::ShowPane(Pane::GapCandidates),
        "gap-pane-shown" => ScriptStep::ShowPane(Pane::GapShown),
        "gap-pane-next" => ScriptStep::ShowPane(Pane::GapNext),
        "gap-pane-history" => ScriptStep::ShowPane(Pane::GapHistory),
        "gap-map-before" => ScriptStep::ShowGapErrors(GapErrors::Before),
        "gap-map-after" => ScriptStep::ShowGapErrors(GapErrors::After),
        "gap-map-both" => ScriptStep::ShowGapErrors(GapErrors::Both),
        "gap-report" | "gap-report-pdf" if value.is_empty() => {
            return Some(Err(format!("{name}:FILE wants a file")));
        }
        "gap-report" => report(value, false),
        "gap-report-pdf" => report(value, true),
        _ => ScriptStep::Act(Action::Gap(action(name)?)),
    }))
}

fn action(name: &str) -> Option<GapAction> {
    Some(match name {
        "gap-list" => GapAction::ListSessions,
        "gap-nominal" => GapAction::CompareNominal,
        "gap-in-use" => GapAction::CompareInUse,
        "gap-find" => GapAction::Find,
        "gap-add" => GapAction::Add,
        "gap-next" => GapAction::NextExperiment,
        "gap-delete" => GapAction::Delete,
        "gap-undo" => GapAction::Undo,
        "gap-take-out" => GapAction::UseNominal,
        _ => return None,
    })
}

fn session(folders: &str) -> Step {
    if folders.is_empty() {
        return Err(
            "gap-session:FOLDER wants the folder of a session; several are joined by commas".to_owned()
        );
    }
    let sessions = folders.split(',').map(Into::into).collect();
    Ok(ScriptStep::Send(GapCommand::Choose { sessions }.into()))
}

fn report(file: &str, pdf: bool) -> ScriptStep {
    ScriptStep::Send(GapCommand::Report { file: file.into(), pdf }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_say_what_they_want() {
        assert_eq!(step("gap-find", ""), Some(Ok(ScriptStep::Act(Action::Gap(GapAction::Find)))));
        let two = GapCommand::Choose { sessions: vec!["a".into(), "b".into()] };
        assert_eq!(step("gap-session", "a,b"), Some(Ok(ScriptStep::Send(two.into()))));
        assert!(step("gap-session", "").expect("known").is_err());
        assert!(step("gap-report", "").expect("known").is_err());
        assert_eq!(step("gap-dance", ""), None);
    }
}

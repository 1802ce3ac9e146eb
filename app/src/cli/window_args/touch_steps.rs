//! Steps of a script that speak of touching the screen and of correction models.

use plumbline_engine::correction::Method;
use plumbline_engine::{Correction, TouchCommand};

use crate::operator::{Action, ModelsAction, Pane, Preset, Screen, TouchAction};
use crate::panels::MapErrors;
use crate::window::ScriptStep;

type Step = Result<ScriptStep, String>;

/// The step of this name; `None` when there is none.
pub(super) fn step(name: &str, value: &str) -> Option<Step> {
    if name == "touch-correct" {
        return Some(correct_with(value));
    }
    let shown = look(name).map(Ok);
    shown.or_else(|| action(name).map(|action| Ok(ScriptStep::Act(action))))
}

/// What is only looked at differently.
fn look(name: &str) -> Option<ScriptStep> {
    Some(match name {
        "models-training" => ScriptStep::ShowPane(Pane::ModelTraining),
        "models-compared" => ScriptStep::ShowPane(Pane::ModelComparison),
        "models-map" => ScriptStep::ShowPane(Pane::ModelMap),
        "models-tables" => ScriptStep::ShowPane(Pane::GraspTables),
        "models-map-before" => ScriptStep::ShowErrors(MapErrors::Before),
        "models-map-after" => ScriptStep::ShowErrors(MapErrors::After),
        "models-map-both" => ScriptStep::ShowErrors(MapErrors::Both),
        _ => return None,
    })
}

fn action(name: &str) -> Option<Action> {
    let plan = |preset| Action::Touch(TouchAction::Plan(preset));
    Some(match name {
        "touch" => Action::Go(Screen::Touch),
        "models" => Action::Go(Screen::Models),
        "touch-plan-corners" => plan(Preset::Corners),
        "touch-plan-quick" => plan(Preset::Quick),
        "touch-plan-train" => plan(Preset::First),
        "touch-plan-rich" => plan(Preset::Rich),
        "touch-plan-check" => plan(Preset::Check),
        "touch-start" => Action::Touch(TouchAction::Start),
        "touch-pause" => Action::Touch(TouchAction::Pause),
        "touch-resume" => Action::Touch(TouchAction::Resume),
        "touch-skip" => Action::Touch(TouchAction::Skip),
        "touch-prepared" => Action::Touch(TouchAction::Prepared),
        "touch-finish" => Action::Touch(TouchAction::Finish),
        "touch-close" => Action::Touch(TouchAction::Close),
        "touch-accept-screen" => Action::Touch(TouchAction::AcceptScreen),
        "touch-discard-screen" => Action::Touch(TouchAction::DiscardScreen),
        "touch-nominal-screen" => Action::Touch(TouchAction::NominalScreen),
        "touch-window" => Action::Touch(TouchAction::ToggleWindow),
        "models-list" => Action::Models(ModelsAction::ListSessions),
        "models-train" => Action::Models(ModelsAction::TrainAll),
        "models-accept" => Action::Models(ModelsAction::AcceptShown),
        "models-accept-m1" => Action::Models(ModelsAction::Accept(Method::M1)),
        "models-accept-m2" => Action::Models(ModelsAction::Accept(Method::M2)),
        "models-accept-m3" => Action::Models(ModelsAction::Accept(Method::M3)),
        "models-show-m1" => Action::Models(ModelsAction::Show(Method::M1)),
        "models-show-m2" => Action::Models(ModelsAction::Show(Method::M2)),
        "models-show-m3" => Action::Models(ModelsAction::Show(Method::M3)),
        "models-check" => Action::Models(ModelsAction::Check),
        "models-discard" => Action::Models(ModelsAction::Discard),
        "models-undo" => Action::Models(ModelsAction::Undo),
        "models-none" => Action::Models(ModelsAction::UseNone),
        _ => return None,
    })
}

fn correct_with(value: &str) -> Step {
    let correction = Correction::of_name(value);
    if correction.is_none() && value != "none" {
        return Err("touch-correct:METHOD wants M1, M2, M3, effects or none".to_owned());
    }
    Ok(ScriptStep::Send(TouchCommand::CorrectWith(correction).into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_say_what_they_want() {
        let start = ScriptStep::Act(Action::Touch(TouchAction::Start));
        assert_eq!(step("touch-start", ""), Some(Ok(start)));
        let with = TouchCommand::CorrectWith(Some(Method::M3.into()));
        assert_eq!(step("touch-correct", "m3"), Some(Ok(ScriptStep::Send(with.into()))));
        assert!(step("touch-correct", "M4").expect("known").expect_err("no method").contains("none"));
        assert_eq!(step("models-map-after", ""), Some(Ok(ScriptStep::ShowErrors(MapErrors::After))));
        let use_m3 = ScriptStep::Act(Action::Models(ModelsAction::Accept(Method::M3)));
        assert_eq!(step("models-accept-m3", ""), Some(Ok(use_m3)));
        assert_eq!(step("touch-dance", ""), None);
    }
}

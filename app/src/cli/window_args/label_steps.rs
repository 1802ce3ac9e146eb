//! Steps of a script that speak of data sets and of judging detectors.

use plumbline_engine::{ConfusionCell, LabelsCommand, ScoresCommand, SetPart};
use plumbline_model::{ClassIndex, PixelBox};

use crate::operator::{Action, LabelsAction, Pane, ScoresAction, Screen};
use crate::window::ScriptStep;

type Step = Result<ScriptStep, String>;

/// The step of this name; `None` when there is none.
pub(super) fn step(name: &str, value: &str) -> Option<Step> {
    let wants_path = [
        "labels-open",
        "labels-new",
        "labels-import",
        "labels-export",
        "labels-image",
        "scores-model",
        "scores-set",
        "scores-csv",
    ];
    if wants_path.contains(&name) && value.is_empty() {
        return Some(Err(format!("{name}:PATH wants a path or a name")));
    }
    let labels = |command: LabelsCommand| ScriptStep::Send(command.into());
    let scores = |command: ScoresCommand| ScriptStep::Send(command.into());
    Some(Ok(match name {
        "images" => ScriptStep::Act(Action::Go(Screen::Images)),
        "scores" => ScriptStep::Act(Action::Go(Screen::Scores)),
        "labels-open" => labels(LabelsCommand::Open { path: value.into() }),
        "labels-new" => {
            let names = plumbline_model::detection::PUBLISHED_CLASSES.map(str::to_owned).to_vec();
            labels(LabelsCommand::Create { folder: value.into(), names })
        }
        "labels-image" => labels(LabelsCommand::Choose { image: value.into() }),
        "labels-import" => labels(LabelsCommand::Import { path: value.into() }),
        "labels-export" => labels(LabelsCommand::Export { folder: value.into(), train_percent: 80, seed: 1 }),
        "labels-box" => return Some(drawn(value)),
        "labels-choose" => return Some(number(name, value).map(ScriptStep::ChooseBox)),
        "labels-checks" => ScriptStep::ShowPane(Pane::LabelChecks),
        "labels-list" => ScriptStep::ShowPane(Pane::LabelList),
        "scores-model" => scores(ScoresCommand::AddModels { files: vec![value.into()] }),
        "scores-set" => scores(ScoresCommand::ChooseSet { path: value.into() }),
        "scores-train" => scores(ScoresCommand::ChoosePart(SetPart::Train)),
        "scores-csv" => scores(ScoresCommand::ExportCsv { file: value.into() }),
        "scores-evaluate" => ScriptStep::Act(Action::Scores(ScoresAction::Evaluate)),
        "scores-classes" => ScriptStep::ShowPane(Pane::ScoreClasses),
        "scores-table" => ScriptStep::ShowPane(Pane::ScoreTable),
        "scores-cell" => return Some(cell(value)),
        "scores-picture" => {
            return Some(number(name, value).map(|place| scores(ScoresCommand::ShowPicture(Some(place)))));
        }
        _ => ScriptStep::Act(Action::Labels(action(name)?)),
    }))
}

fn action(name: &str) -> Option<LabelsAction> {
    Some(match name {
        "labels-add" => LabelsAction::Capture,
        "labels-next" => LabelsAction::Next,
        "labels-previous" => LabelsAction::Previous,
        "labels-next-open" => LabelsAction::NextUnlabeled,
        "labels-undo" => LabelsAction::Undo,
        "labels-redo" => LabelsAction::Redo,
        "labels-copy" => LabelsAction::CopyPrevious,
        "labels-propose" => LabelsAction::Propose,
        "labels-accept" => LabelsAction::AcceptProposals,
        "labels-nothing" => LabelsAction::NothingHere,
        "labels-to-check" => LabelsAction::ToggleToCheck,
        "labels-accept-import" => LabelsAction::AcceptImport,
        "labels-close" => LabelsAction::Close,
        _ => return None,
    })
}

fn number(name: &str, text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("{name}:N wants a number"))
}

fn drawn(text: &str) -> Step {
    let numbers: Vec<f32> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let [class, x0, y0, x1, y1] = numbers[..] else {
        return Err("labels-box:CLASS,X0,Y0,X1,Y1 wants a class number from 1 on and four edges".to_owned());
    };
    if class < 1.0 {
        return Err("labels-box: classes count from 1, as the keys do".to_owned());
    }
    Ok(ScriptStep::DrawBox(ClassIndex(class as usize - 1), PixelBox::new(x0, y0, x1, y1)))
}

/// `7,-`: class 7 that was missed; `-` is background.
fn cell(text: &str) -> Step {
    let of = |part: &str| match part.trim() {
        "-" => Some(None),
        part => part.parse::<usize>().ok().and_then(|class| class.checked_sub(1)).map(Some),
    };
    let parts = text.split_once(',').and_then(|(truth, found)| Some((of(truth)?, of(found)?)));
    let (truth, found) = parts.ok_or("scores-cell:TRUTH,FOUND wants two classes from 1 on, or -")?;
    Ok(ScriptStep::Send(ScoresCommand::OpenCell { model: 0, cell: ConfusionCell { truth, found } }.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_say_what_they_want() {
        let open = LabelsCommand::Open { path: "toys".into() };
        assert_eq!(step("labels-open", "toys"), Some(Ok(ScriptStep::Send(open.into()))));
        assert!(step("labels-open", "").expect("known").is_err());
        let area = PixelBox::new(1.0, 2.0, 30.5, 40.0);
        assert_eq!(step("labels-box", "8,1,2,30.5,40"), Some(Ok(ScriptStep::DrawBox(ClassIndex(7), area))));
        assert!(step("labels-box", "8,1,2").expect("known").is_err());
        assert!(step("scores-cell", "x").expect("known").is_err());
        let missed = ConfusionCell { truth: Some(6), found: None };
        let open = ScoresCommand::OpenCell { model: 0, cell: missed };
        assert_eq!(step("scores-cell", "7,-"), Some(Ok(ScriptStep::Send(open.into()))));
        assert_eq!(step("labels-dance", ""), None);
    }
}

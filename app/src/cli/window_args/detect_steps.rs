//! Steps of a script that speak of detection.

use plumbline_engine::{DetectCommand, DetectorChoice};

use crate::operator::{Action, DetectAction};
use crate::window::ScriptStep;

type Step = Result<ScriptStep, String>;

/// The step of this name; `None` when there is none.
pub(super) fn step(name: &str, value: &str) -> Option<Step> {
    Some(match name {
        "detect-boxes" => Ok(act(DetectAction::ToggleBoxes)),
        "detect-shipped" => Ok(act(DetectAction::UseShipped)),
        "detect-off" => Ok(act(DetectAction::Off)),
        "detect-all-classes" => Ok(act(DetectAction::ShowAll)),
        "detect-reset" => Ok(act(DetectAction::ResetRates)),
        "detect-file" if value.is_empty() => Err("detect-file:FILE wants an ONNX file".to_owned()),
        "detect-file" => Ok(send(DetectCommand::Use(DetectorChoice::File(value.into())))),
        "detect-confidence" => share(value)
            .map(|share| send(DetectCommand::Confidence(share)))
            .ok_or_else(|| "detect-confidence:SHARE wants a number between 0 and 1".to_owned()),
        "detect-overlap" => share(value)
            .map(|share| send(DetectCommand::Iou(share)))
            .ok_or_else(|| "detect-overlap:SHARE wants a number between 0 and 1".to_owned()),
        "detect-hide" => Ok(send(DetectCommand::Show { class: value.to_owned(), shown: false })),
        "detect-show" => Ok(send(DetectCommand::Show { class: value.to_owned(), shown: true })),
        "object" => Ok(ScriptStep::ChooseObject(value.to_owned())),
        _ => return None,
    })
}

fn act(action: DetectAction) -> ScriptStep {
    ScriptStep::Act(Action::Detect(action))
}

fn send(command: DetectCommand) -> ScriptStep {
    ScriptStep::Send(command.into())
}

fn share(text: &str) -> Option<f32> {
    text.parse().ok().filter(|share| (0.0..=1.0).contains(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_say_what_they_want() {
        let half = send(DetectCommand::Confidence(0.5));
        assert_eq!(step("detect-confidence", "0.5"), Some(Ok(half)));
        assert!(step("detect-confidence", "50").expect("known").is_err());
        assert!(step("detect-file", "").expect("known").is_err());
        assert_eq!(step("detect-dance", ""), None);
    }
}

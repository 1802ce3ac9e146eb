//! What can be asked for by name of detection on the Live screen.

use std::borrow::Cow;

use plumbline_engine::view::DetectorState;
use plumbline_engine::{Command, DetectCommand, DetectorChoice, View};
use serde::Serialize;

/// Of detection, live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DetectAction {
    /// Shows boxes, or hides them and detects nothing.
    ToggleBoxes,
    /// Chooses an ONNX file.
    ChooseFile,
    /// Uses the detector that comes with the program.
    UseShipped,
    /// Uses none.
    Off,
    /// Reads the chosen detector again.
    Retry,
    /// Shows all classes.
    ShowAll,
    /// Thresholds and filter as they come with the program.
    UsualThresholds,
    /// Counts anew how reliably classes are seen.
    ResetRates,
}

impl DetectAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 8] = [
        Self::ToggleBoxes,
        Self::ChooseFile,
        Self::UseShipped,
        Self::Off,
        Self::Retry,
        Self::ShowAll,
        Self::UsualThresholds,
        Self::ResetRates,
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::ToggleBoxes => "Show or hide boxes of objects",
            Self::ChooseFile => "Choose a detector file…",
            Self::UseShipped => "Use Plumbline's own detector",
            Self::Off => "Detect nothing",
            Self::Retry => "Read the detector again",
            Self::ShowAll => "Show all classes of objects",
            Self::UsualThresholds => "Usual thresholds of the detector",
            Self::ResetRates => "Count anew how often objects are seen",
        }
    }

    /// On a button that stands beside the detector.
    pub fn button(self) -> &'static str {
        match self {
            Self::ChooseFile => "Choose a detector…",
            Self::UseShipped => "Use Plumbline's own",
            Self::Off => "Off",
            other => other.label(),
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        let detect = &view.detect;
        let when = |possible: bool, why| (!possible).then_some(Cow::Borrowed(why));
        match self {
            Self::Retry => when(detect.settings.detector != DetectorChoice::Off, "no detector is chosen"),
            Self::Off => when(detect.detector != DetectorState::Off, "detection is off already"),
            Self::ResetRates => when(detect.counted > 0, "nothing was counted yet"),
            _ => None,
        }
    }

    /// The command that it stands for; `None` where the window does it or asks first.
    pub fn command(self) -> Option<Command> {
        let command = match self {
            Self::ToggleBoxes | Self::ChooseFile => return None,
            Self::UseShipped => DetectCommand::Use(DetectorChoice::Shipped),
            Self::Off => DetectCommand::Use(DetectorChoice::Off),
            Self::Retry => DetectCommand::Retry,
            Self::ShowAll => DetectCommand::ShowAll,
            Self::UsualThresholds => DetectCommand::UsualThresholds,
            Self::ResetRates => DetectCommand::ResetRates,
        };
        Some(command.into())
    }
}

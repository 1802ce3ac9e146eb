//! Where the images come from: what is open, and what else can be opened.

use std::collections::VecDeque;

use egui::{Button, Ui};
use plumbline_engine::view::SourceStatus;
use plumbline_engine::{SourceCommand, SourceSpec, View};
use plumbline_widgets::theme;

use crate::operator::words::source_name;
use crate::operator::{Action, Outbox, shortcut_text};

/// Longest name on the button, characters.
const LONGEST: usize = 28;

/// What can be opened, what was opened before, and closing it.
pub(super) fn entries(view: &View, recent: &VecDeque<SourceSpec>, ui: &mut Ui, outbox: &mut Outbox) {
    for action in [
        Action::OpenFolder,
        Action::OpenTwoFolders,
        Action::OpenVideos,
        Action::OpenCameras,
        Action::OpenPath,
    ] {
        let button =
            Button::new(action.label()).shortcut_text(shortcut_text(ui.ctx(), action).unwrap_or_default());
        if ui.add(button).clicked() {
            outbox.act(action);
            ui.close();
        }
    }
    ui.separator();
    let record = if view.recording.is_on() { "Stop recording" } else { "Record" };
    let export = Action::ExportRecording.label();
    let recording = [
        (record, Action::ToggleRecording),
        ("Play the last recording", Action::PlayLastRecording),
        (export.as_str(), Action::ExportRecording),
    ];
    for (text, action) in recording {
        let refusal = action.refusal(view);
        let button = Button::new(text).shortcut_text(shortcut_text(ui.ctx(), action).unwrap_or_default());
        let button = ui.add_enabled(refusal.is_none(), button);
        if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
            outbox.act(action);
            ui.close();
        }
    }
    if !recent.is_empty() {
        ui.separator();
        ui.label(theme::small(ui, "Opened before"));
        for spec in recent {
            if ui.button(shortened(&source_name(spec))).on_hover_text(long_name(spec)).clicked() {
                outbox.send(SourceCommand::Open(spec.clone()));
                ui.close();
            }
        }
    }
    if view.source.status != SourceStatus::None {
        ui.separator();
        if ui.button(Action::CloseSource.label()).clicked() {
            outbox.act(Action::CloseSource);
            ui.close();
        }
    }
}

pub(super) fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let kept: String = name.chars().take(LONGEST - 1).collect();
    format!("{kept}…")
}

fn long_name(spec: &SourceSpec) -> String {
    match spec {
        SourceSpec::Folder(path) | SourceSpec::Recording { file: path, .. } => path.display().to_string(),
        SourceSpec::Folders { left, right } | SourceSpec::Videos { left, right } => {
            format!("left: {}\nright: {}", left.display(), right.display())
        }
        SourceSpec::Cameras { .. } | SourceSpec::Twin => source_name(spec),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_shortened_by_characters_not_bytes() {
        assert_eq!(shortened("ä".repeat(28).as_str()).chars().count(), 28);
        assert_eq!(shortened("ä".repeat(40).as_str()).chars().count(), 28);
    }
}

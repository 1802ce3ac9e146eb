//! Where the images come from: what is open, and what else can be opened.

use std::collections::VecDeque;
use std::path::Path;

use egui::{Button, Ui};
use plumbline_engine::view::SourceStatus;
use plumbline_engine::{SourceCommand, SourceSpec, View};
use plumbline_widgets::theme;

use super::actions::Action;
use super::outbox::Outbox;
use super::shortcuts::shortcut_text;

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
    if !recent.is_empty() {
        ui.separator();
        ui.label(theme::small(ui, "Opened before"));
        for spec in recent {
            if ui.button(shortened(&short_name(spec))).on_hover_text(long_name(spec)).clicked() {
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

/// The last parts of the paths.
pub(crate) fn short_name(spec: &SourceSpec) -> String {
    let last = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    match spec {
        SourceSpec::Folder(folder) => last(folder),
        SourceSpec::Folders { left, right } => match (left.parent(), right.parent()) {
            // The usual layout: one folder with `left` and `right` in it.
            (Some(a), Some(b)) if a == b => last(a),
            _ => format!("{} and {}", last(left), last(right)),
        },
        SourceSpec::Videos { left, right } => format!("{} and {}", last(left), last(right)),
        SourceSpec::Twin => "the twin's eyes".to_owned(),
        SourceSpec::Cameras { left_index, right_index } => format!("cameras {left_index} and {right_index}"),
    }
}

fn long_name(spec: &SourceSpec) -> String {
    match spec {
        SourceSpec::Folder(folder) => folder.display().to_string(),
        SourceSpec::Folders { left, right } | SourceSpec::Videos { left, right } => {
            format!("left: {}\nright: {}", left.display(), right.display())
        }
        SourceSpec::Cameras { .. } | SourceSpec::Twin => short_name(spec),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_folders_of_one_parent_are_called_by_the_parent() {
        let spec = SourceSpec::Folders { left: "data/board/left".into(), right: "data/board/right".into() };
        assert_eq!(short_name(&spec), "board");
        let spec = SourceSpec::Folders { left: "a/left".into(), right: "b/right".into() };
        assert_eq!(short_name(&spec), "left and right");
    }

    #[test]
    fn long_names_are_shortened_by_characters_not_bytes() {
        assert_eq!(shortened("ä".repeat(28).as_str()).chars().count(), 28);
        assert_eq!(shortened("ä".repeat(40).as_str()).chars().count(), 28);
    }
}

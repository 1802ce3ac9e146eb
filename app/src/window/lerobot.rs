//! The sheet that asks where a recording is written as a LeRobot data set, and what was being done in it.

use std::path::{Path, PathBuf};

use egui::{TextEdit, Ui};
use plumbline_engine::RecordingCommand;
use plumbline_widgets::theme;

use super::ask::expand_home;
use super::sheet::{Asked, buttons, title};

/// As `plumbline lerobot` says it where nobody says more.
const TASK: &str = "Recorded with Plumbline.";

/// What is being typed.
#[derive(Clone, Debug)]
pub struct LerobotAsk {
    file: PathBuf,
    folder: String,
    task: String,
}

impl LerobotAsk {
    /// Of a recording, into a folder of its session.
    pub fn of(file: PathBuf) -> Self {
        let folder = file.with_file_name("lerobot").display().to_string();
        Self { file, folder, task: TASK.to_owned() }
    }

    /// Draws the sheet.
    pub fn show(&mut self, ui: &mut Ui) -> Asked {
        let about = format!(
            "{} of {}: one episode with both eyes, the angles of all joints, intrinsics and extrinsics (version 3 of the layout).",
            self.file.file_name().unwrap_or_default().to_string_lossy(),
            self.file.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy()
        );
        title(ui, "Export as LeRobot data set", &about);
        for (name, text) in [
            ("Folder, which must be empty or new", &mut self.folder),
            ("What was being done, a sentence", &mut self.task),
        ] {
            let label = ui.label(theme::weak(ui, name));
            ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY)).labelled_by(label.id);
        }
        let (folder, task) = (self.folder.trim(), self.task.trim());
        match buttons(ui, "Write the data set", !folder.is_empty() && !task.is_empty()) {
            Some(false) => Asked::Closed,
            Some(true) => {
                let (file, folder) = (self.file.clone(), expand_home(folder));
                let task = task.to_owned();
                Asked::Command(RecordingCommand::ExportLerobot { file, folder, task }.into())
            }
            None => Asked::Open,
        }
    }
}

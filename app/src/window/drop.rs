//! Files and folders dropped on the window.

use std::path::{Path, PathBuf};

use egui::{Align2, Context, LayerId, Order, Stroke, StrokeKind, TextStyle};
use plumbline_engine::{Command, EyesCommand, FileLength, LabelsCommand, ScoresCommand, SourceCommand};
use plumbline_widgets::buttons::STOP_SIZE;
use plumbline_widgets::theme::{self, space};

use crate::operator::Screen;

/// What the dropped paths are taken for; an error says what could be dropped instead.
pub fn command_for(paths: &[PathBuf], screen: Screen) -> Result<Command, String> {
    match (paths, screen) {
        ([], _) => Err("Nothing that can be opened was dropped.".to_owned()),
        (files, Screen::Scores) if files.iter().all(|file| has_extension(file, &["onnx"])) => {
            Ok(ScoresCommand::AddModels { files: files.to_vec() }.into())
        }
        ([set], Screen::Scores) => Ok(ScoresCommand::ChooseSet { path: set.clone() }.into()),
        ([set], Screen::Images) => Ok(LabelsCommand::Open { path: set.clone() }.into()),
        (_, Screen::Scores | Screen::Images) => {
            Err("Drop one folder with a data.yaml, or ONNX files on Scores.".to_owned())
        }
        (paths, _) => command_elsewhere(paths),
    }
}

/// On the screens that look at pairs.
fn command_elsewhere(paths: &[PathBuf]) -> Result<Command, String> {
    match paths {
        [set] if is_data_set(set) => {
            Err(format!("{} is a data set: go to Detect, Images, and drop it there.", name(set)))
        }
        paths if paths.iter().all(|path| is_calibration(path)) && paths.len() <= 2 => {
            Ok(EyesCommand::Import { files: ordered(paths), length: FileLength::AsPrescribed }.into())
        }
        paths => Ok(SourceCommand::OpenPaths(ordered(paths)).into()),
    }
}

/// What will happen, while the files are still held over the window.
pub fn preview(paths: &[PathBuf], screen: Screen) -> String {
    match command_for(paths, screen) {
        Ok(Command::Labels(_)) => "Drop to open this data set".to_owned(),
        Ok(Command::Scores(ScoresCommand::AddModels { .. })) => "Drop to judge these detectors".to_owned(),
        Ok(Command::Scores(_)) => "Drop to judge on this data set".to_owned(),
        Ok(Command::Eyes(_)) => "Drop to read this calibration as a proposal".to_owned(),
        Ok(Command::Source(SourceCommand::OpenPaths(paths))) => match paths.as_slice() {
            [path] => format!("Drop to open {} as the source", name(path)),
            [left, right] => {
                format!("Drop to open {} as the left eye and {} as the right eye", name(left), name(right))
            }
            more => format!("Drop to open {} files as pairs", more.len()),
        },
        Ok(_) => "Drop to open".to_owned(),
        Err(why) => why,
    }
}

/// Draws the preview over the whole window.
pub fn paint_preview(ctx: &Context, text: &str) {
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, egui::Id::unique("drop preview")));
    let tokens = theme::tokens_of(ctx);
    // Below the top line: nothing may cover STOP.
    let rect = ctx.content_rect().with_min_y(ctx.content_rect().top() + STOP_SIZE.y + 12.0);
    painter.rect_filled(rect, 0.0, tokens.background.gamma_multiply(0.85));
    let frame = rect.shrink(space::L);
    painter.rect_stroke(frame, 8.0, Stroke::new(2.0, tokens.accent), StrokeKind::Inside);
    let font = TextStyle::Heading.resolve(&ctx.global_style());
    painter.text(rect.center(), Align2::CENTER_CENTER, text, font, tokens.text_strong);
}

/// A folder with a `data.yaml` and no eyes beside it, or that file.
fn is_data_set(path: &Path) -> bool {
    let has_eyes = ["left", "right", "stereo"].iter().any(|folder| path.join(folder).is_dir());
    name(path) == "data.yaml" || (path.join("data.yaml").is_file() && !has_eyes)
}

fn is_calibration(path: &Path) -> bool {
    has_extension(path, &["yaml", "yml", "xml"])
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    extensions.contains(&extension.as_str())
}

/// Left eye first, as far as the names tell; file managers give no useful order.
fn ordered(paths: &[PathBuf]) -> Vec<PathBuf> {
    let mut ordered = paths.to_vec();
    let says_right = |path: &Path| name(path).to_lowercase().contains("right");
    ordered.sort_by_key(|path| (says_right(path), path.clone()));
    ordered
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn two_videos_are_opened_left_eye_first() {
        let command = command_for(&paths(&["a/right.mp4", "a/left.mp4"]), Screen::Live).expect("two videos");
        assert_eq!(command, SourceCommand::OpenPaths(paths(&["a/left.mp4", "a/right.mp4"])).into());
    }

    #[test]
    fn a_calibration_file_is_proposed_not_opened() {
        let command = command_for(&paths(&["rig-cameras.yaml"]), Screen::Live).expect("a calibration");
        assert_eq!(
            command,
            EyesCommand::Import { files: paths(&["rig-cameras.yaml"]), length: FileLength::AsPrescribed }
                .into()
        );
    }

    #[test]
    fn detect_takes_data_sets_and_detectors() {
        let set = command_for(&paths(&["toys/data.yaml"]), Screen::Images);
        assert_eq!(set, Ok(LabelsCommand::Open { path: "toys/data.yaml".into() }.into()));
        let set = command_for(&paths(&["toys"]), Screen::Scores);
        assert_eq!(set, Ok(ScoresCommand::ChooseSet { path: "toys".into() }.into()));
        let models = command_for(&paths(&["a.onnx", "b.ONNX"]), Screen::Scores);
        assert_eq!(models, Ok(ScoresCommand::AddModels { files: paths(&["a.onnx", "b.ONNX"]) }.into()));
        assert!(command_for(&paths(&["a", "b"]), Screen::Images).is_err());
    }

    #[test]
    fn a_data_set_elsewhere_is_told_where_it_belongs_and_no_source() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let set = folder.path().join("toys");
        std::fs::create_dir_all(set.join("images")).expect("a folder");
        let says = |paths: &[PathBuf]| preview(paths, Screen::Live);
        assert_eq!(says(std::slice::from_ref(&set)), "Drop to open toys as the source");
        std::fs::write(set.join("data.yaml"), "names: [tomato]").expect("written");
        for path in [set.clone(), set.join("data.yaml")] {
            let said = command_for(std::slice::from_ref(&path), Screen::Live).expect_err("it is no source");
            assert!(said.contains("is a data set: go to Detect, Images"), "{said}");
            assert_eq!(says(&[path]), said, "said before it is dropped");
        }
        // Pairs that were labeled are pairs all the same.
        std::fs::create_dir(set.join("left")).expect("a folder");
        assert!(command_for(&[set], Screen::Live).is_ok());
    }

    #[test]
    fn the_preview_says_which_eye_is_which() {
        let text = preview(&paths(&["b/right", "b/left"]), Screen::Live);
        assert_eq!(text, "Drop to open left as the left eye and right as the right eye");
    }
}

//! What is dropped on the window, and how the window looks after itself.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Key, Modifiers};
use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::{Command, EyesCommand, FileLength, SourceCommand, View};

use crate::fake::{Fake, shows};

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the window has no reason to read it".to_owned())
    }
}

fn drop_on(fake: &Fake, paths: &[&str]) -> Vec<Command> {
    let mut window = fake.window(WindowSettings::default());
    let files = paths.iter().map(|path| Arc::new(Dropped(path.into())) as egui::DroppedFileHandle);
    window.input_mut().dropped_files = files.collect();
    window.run_steps(2);
    fake.take_sent()
}

#[test]
fn dropped_folders_are_opened_left_eye_first() {
    let fake = Fake::over(View::default());
    let sent = drop_on(&fake, &["board/right", "board/left"]);
    assert_eq!(sent, [SourceCommand::OpenPaths(vec!["board/left".into(), "board/right".into()]).into()]);
}

#[test]
fn a_dropped_calibration_becomes_a_proposal() {
    let fake = Fake::over(View::default());
    let sent = drop_on(&fake, &["rig-cameras.yaml"]);
    let files = vec!["rig-cameras.yaml".into()];
    assert_eq!(sent, [EyesCommand::Import { files, length: FileLength::AsPrescribed }.into()]);
}

#[test]
fn both_themes_draw_every_screen_at_every_size() {
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for screen in Screen::ALL {
            for size in [[960.0, 600.0], [1280.0, 800.0], [3840.0, 2160.0]] {
                let fake = Fake::over(View::default());
                let settings = WindowSettings { theme, screen, log_open: true, ..WindowSettings::default() };
                let window = fake.window_of_size(settings, size);
                assert!(shows(&window, "STOP") && shows(&window, "Log"), "{theme:?} {screen:?} {size:?}");
            }
        }
    }
}

#[test]
fn screens_are_reached_by_the_rail_and_by_keys() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num3);
    window.run_steps(3);
    assert!(shows(&window, "Nothing to judge yet"));
    crate::fake::click(&mut window, "Compare");
    assert!(shows(&window, "No calibration yet"));
    crate::fake::click(&mut window, "Live");
    assert!(shows(&window, "Where do the images come from?"));
}

//! Typing: the command palette, paths, and keys that must not do anything meanwhile.

use egui::{Key, Modifiers};
use plumbline::WindowSettings;
use plumbline_engine::{Command, SourceCommand, View};

use crate::fake::{Fake, click, says, shows};

#[test]
fn the_palette_finds_a_command_by_a_part_of_its_name() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    assert!(shows(&window, "Search commands"));
    window.event(egui::Event::Text("cameras".to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    window.run_steps(3);
    assert!(!shows(&window, "Search commands"), "it closes when something was chosen");
    assert_eq!(fake.take_sent(), [Command::from(SourceCommand::ListCameras)]);
    assert!(shows(&window, "Use these cameras"));
}

#[test]
fn what_cannot_be_done_says_why_and_does_nothing() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    window.run_steps(3);
    assert_eq!(fake.take_sent(), []);
    assert!(says(&window, "no pair is collected"));
}

#[test]
fn a_typed_path_is_opened() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    click(&mut window, "Open a folder of pairs…");
    assert!(shows(&window, "Open a folder of pairs"), "without a desktop dialog the path is typed");
    window.event(egui::Event::Text("pairs of today".to_owned()));
    window.run_steps(2);
    // Space goes into the text and stops nothing.
    assert_eq!(fake.take_sent(), []);
    click(&mut window, "Open");
    assert_eq!(fake.take_sent(), [Command::from(SourceCommand::OpenPaths(vec!["pairs of today".into()]))]);
    assert!(!shows(&window, "Open a folder of pairs"));
}

#[test]
fn escape_closes_a_sheet() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    for (open, inside) in [(Key::K, "Search commands"), (Key::L, "Folder"), (Key::M, "Clear messages")] {
        window.key_press_modifiers(Modifiers::COMMAND, open);
        window.run_steps(3);
        assert!(shows(&window, inside), "{inside}");
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert!(!shows(&window, inside), "{inside}");
    }
}

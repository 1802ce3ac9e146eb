//! Undo: the same word, place and key on every screen, and it says what it would take back.

use std::sync::Arc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{Screen, WindowSettings};
use plumbline_engine::view::{EyesView, Subject};
use plumbline_engine::{Command, EyesCommand, TimelineCommand, View};

use crate::fake::{Fake, click, says, shows};
use crate::timeline::results;

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

fn with_results() -> View {
    View {
        timeline: Arc::new(results()),
        eyes: Arc::new(EyesView { can_undo: true, ..EyesView::default() }),
        ..View::default()
    }
}

/// What Undo asks for on each screen that has something to take back: one command, of a result the timeline's.
fn wanted() -> [(Screen, Vec<Command>); 5] {
    let back = |subject, to: Option<String>| -> Vec<Command> {
        vec![TimelineCommand::TakeBack { subject, to }.into()]
    };
    let screen = back(Subject::Screen, None);
    [
        (Screen::Collect, vec![EyesCommand::Undo.into()]),
        (Screen::Accept, back(Subject::Eyes, Some("id-1".to_owned()))),
        (Screen::Mount, back(Subject::Mount, None)),
        (Screen::Touch, screen.clone()),
        (Screen::Timeline, screen),
    ]
}

#[test]
fn one_button_and_one_key_take_back_what_was_put_in_use_on_each_screen() {
    for (screen, commands) in wanted() {
        let fake = Fake::over(with_results());
        let mut window = fake.window(on(screen));
        fake.take_sent();
        click(&mut window, "Undo");
        assert_eq!(fake.take_sent(), commands, "{screen:?} by the button");
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(3);
        assert_eq!(fake.take_sent(), commands, "{screen:?} by the key");
        window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        window.run_steps(3);
        assert!(!fake.take_sent().iter().any(|sent| commands.contains(sent)), "{screen:?}: redo is no undo");
    }
}

#[test]
fn where_there_is_nothing_the_key_says_so_and_the_button_rests() {
    for screen in Screen::ALL {
        let fake = Fake::over(View::default());
        let mut window = fake.window(on(screen));
        let button = window.get_all_by_label("Undo").next().expect("it stands on every screen");
        assert!(button.accesskit_node().is_disabled(), "{screen:?}");
        fake.take_sent();
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(3);
        assert_eq!(fake.take_sent(), [], "{screen:?}");
        assert!(says(&window, "Undo: "), "{screen:?} says why");
    }
}

#[test]
fn the_key_belongs_to_the_text_while_one_is_typed() {
    let fake = Fake::over(with_results());
    let mut window = fake.window(on(Screen::Mount));
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    assert!(shows(&window, "Search commands"));
    window.event(egui::Event::Text("mount".to_owned()));
    window.run_steps(2);
    fake.take_sent();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert_eq!(fake.take_sent(), []);
}

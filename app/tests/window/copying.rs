//! What is taken out of tiles: rows, pictures, pages.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, WindowSettings};

use crate::fake::{Fake, click, says, shows};
use crate::layout::much_to_show;
use crate::{made_up, made_up_touch};

/// What was put on the clipboard in the newest frame: text, and sizes of pictures.
fn copied(window: &Harness<'_, PlumblineWindow>) -> (Vec<String>, Vec<[usize; 2]>) {
    let (mut texts, mut pictures) = (vec![], vec![]);
    for command in &window.output().platform_output.commands {
        match command {
            egui::OutputCommand::CopyText(text) => texts.push(text.clone()),
            egui::OutputCommand::CopyImage(picture) => pictures.push(picture.size),
            _ => {}
        }
    }
    (texts, pictures)
}

/// Answers a request for a picture of the window, if there is one.
fn photograph(window: &Harness<'_, PlumblineWindow>, size: [usize; 2]) -> bool {
    let mut asked = false;
    for output in window.output().viewport_output.values() {
        for command in &output.commands {
            if let egui::ViewportCommand::Screenshot(callback) = command {
                let picture = egui::ColorImage::filled(size, egui::Color32::GRAY);
                callback.clone().complete(Arc::new(picture));
                asked = true;
            }
        }
    }
    asked
}

fn running() -> Harness<'static, PlumblineWindow> {
    let fake = Fake::over(made_up_touch::with_touch(made_up_touch::running()));
    let settings = WindowSettings { screen: Screen::Touch, ..WindowSettings::default() };
    fake.window_of_size(settings, [1440.0, 900.0])
}

#[test]
fn the_rows_of_a_tile_are_copied_as_csv() {
    let touches = made_up_touch::running().touches.len();
    let mut window = running();
    click(&mut window, "Copy or save Run");
    window.get_by_label("Copy as CSV").click();
    let mut text = Vec::new();
    for _ in 0..3 {
        window.run_steps(1);
        text.extend(copied(&window).0);
    }
    assert_eq!(text.len(), 1, "{text:?}");
    let lines: Vec<&str> = text[0].lines().collect();
    assert_eq!(lines.len(), touches + 1);
    assert!(lines[0].starts_with("touch,target_u_px,"), "{}", lines[0]);
    assert!(says(&window, "The table is on the clipboard"));
}

#[test]
fn a_tile_is_copied_as_it_stands_once_the_menu_is_gone() {
    let mut window = running();
    click(&mut window, "Copy or save Run");
    window.get_by_label("Copy as image").click();
    let mut pictures = vec![];
    for _ in 0..10 {
        window.run_steps(1);
        let asked = photograph(&window, [1440, 900]);
        assert!(!asked || !shows(&window, "Copy as image"), "the menu lies in the picture");
        pictures.extend(copied(&window).1);
    }
    let [[width, height]] = pictures[..] else { panic!("{pictures:?}") };
    assert!((300..1440).contains(&width) && (100..900).contains(&height), "{width} by {height}");
}

#[test]
fn a_tile_is_written_as_a_page_of_which_a_message_tells() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.pdf");
    let mut window = running();
    click(&mut window, "Copy or save Run");
    window.get_by_label("Save as PDF…").click();
    for _ in 0..10 {
        window.run_steps(1);
        photograph(&window, [1440, 900]);
    }
    assert!(shows(&window, "Save the tile as PDF"), "a file is asked for");
    let field = window.get_by_label("File");
    field.focus();
    window.run_steps(1);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.run_steps(1);
    window.event(egui::Event::Text(file.to_string_lossy().into_owned()));
    window.run_steps(2);
    click(&mut window, "Save");
    let until = std::time::Instant::now() + std::time::Duration::from_secs(20);
    while !says(&window, "Saved ") {
        assert!(std::time::Instant::now() < until, "nothing was written");
        std::thread::sleep(std::time::Duration::from_millis(20));
        window.run_steps(1);
    }
    let written = std::fs::read(&file).expect("written");
    assert!(written.starts_with(b"%PDF") && written.len() > 10_000);
    assert!(shows(&window, "Open"), "it can be opened from its message");
}

/// Every plot and every table stands in a tile, and every tile in front has the menu.
#[test]
fn every_tile_of_every_screen_can_be_taken_along() {
    let everything = Screen::ALL.map(|screen| (screen, made_up::everything()));
    for (screen, view) in everything.into_iter().chain(much_to_show()) {
        for size in [[1024.0, 700.0], [1440.0, 900.0]] {
            let fake = Fake::over(view.clone());
            let settings = WindowSettings { screen, ..WindowSettings::default() };
            let window = fake.window_of_size(settings, size);
            let tiles: Vec<plumbline::Pane> = window.state().tiles().collect();
            assert!(!tiles.is_empty(), "{screen:?}");
            for pane in tiles {
                let label = format!("Copy or save {}", pane.title());
                assert!(shows(&window, &label), "{screen:?} {size:?}: {label}");
            }
        }
    }
}

//! Tables on the clipboard.

use egui_kittest::kittest::Queryable as _;
use plumbline::{Screen, WindowSettings};

use crate::fake::Fake;
use crate::made_up_touch;

/// What was put on the clipboard in the newest frame.
fn copied(window: &egui_kittest::Harness<'_, plumbline::PlumblineWindow>) -> Vec<String> {
    let commands = &window.output().platform_output.commands;
    let texts = commands.iter().filter_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    texts.collect()
}

#[test]
fn the_table_of_a_tile_is_copied_as_csv() {
    let view = made_up_touch::with_touch(made_up_touch::running());
    let touches = view.touch.touches.len();
    let fake = Fake::over(view);
    let settings = WindowSettings { screen: Screen::Touch, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, [1440.0, 900.0]);
    window.get_by_label("Copy Run as a table").click();
    let mut text = Vec::new();
    for _ in 0..3 {
        window.run_steps(1);
        text.extend(copied(&window));
    }
    assert_eq!(text.len(), 1, "{text:?}");
    let lines: Vec<&str> = text[0].lines().collect();
    assert_eq!(lines.len(), touches + 1);
    assert!(lines[0].starts_with("touch,target_u_px,"), "{}", lines[0]);
    assert!(window.query_all_by_label_contains("The table is on the clipboard").next().is_some());
}

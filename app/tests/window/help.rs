//! Help and about.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, WindowSettings};

use crate::fake::{Fake, click, says, shows};
use crate::made_up;

fn press(window: &mut Harness<'_, PlumblineWindow>, key: egui::Key) {
    window.key_press(key);
    window.run_steps(3);
}

/// Also that every letter of every page can be drawn.
#[test]
fn help_opens_the_manual_at_the_screen_and_esc_closes_it_and_stops_nothing() {
    for screen in Screen::ALL {
        let fake = Fake::over(made_up::everything());
        let settings = WindowSettings { screen, ..WindowSettings::default() };
        let mut window = fake.window_of_size(settings, [1024.0, 700.0]);
        press(&mut window, egui::Key::F1);
        assert!(shows(&window, "Close help"), "{screen:?}");
        let title = match screen {
            Screen::Commission => "Commissioning: from switched on",
            Screen::Live => "Look and measure",
            Screen::Collect | Screen::Judge | Screen::Accept => "Calibrate the eyes",
            Screen::Mount => "Calibrate how the eyes sit in the head",
            Screen::Touch => "Touch: place the screen",
            Screen::Models => "Train correction models",
            Screen::Gap => "Find what the model is missing",
            Screen::HandEye => "Hand-eye: tie the arms",
            Screen::Grasp => "Grasp: plan, grasp, judge",
            Screen::Drift => "Drift: do places stay",
            Screen::Timeline => "The timeline of results",
            Screen::Robot => "Move the robot",
            Screen::Images | Screen::Scores => "Detect objects",
        };
        assert!(says(&window, title), "{screen:?}");
        press(&mut window, egui::Key::Escape);
        assert!(!shows(&window, "Close help"));
        assert_eq!(fake.take_stops(), 0, "Esc closes what lies on top");
    }
}

#[test]
fn help_follows_the_screen_and_stays_while_something_else_is_clicked() {
    let fake = Fake::over(made_up::everything());
    let mut window = fake.window_of_size(WindowSettings::default(), [1440.0, 900.0]);
    press(&mut window, egui::Key::F1);
    click(&mut window, "Timeline");
    assert!(shows(&window, "Close help") && says(&window, "The timeline of results"));
    click(&mut window, "Close help");
    assert!(!shows(&window, "Close help"));
}

#[test]
fn about_says_the_versions() {
    let fake = Fake::over(made_up::everything());
    let mut window = fake.window_of_size(
        WindowSettings { screen: Screen::Timeline, ..WindowSettings::default() },
        [1440.0, 900.0],
    );
    click(&mut window, "View");
    click(&mut window, "About Plumbline");
    let until = std::time::Instant::now() + std::time::Duration::from_secs(20);
    while says(&window, "being asked") {
        assert!(std::time::Instant::now() < until, "nobody answers");
        std::thread::sleep(std::time::Duration::from_millis(20));
        window.run_steps(1);
    }
    for name in ["Plumbline", "OpenCV", "MuJoCo", "ONNX Runtime"] {
        assert!(says(&window, name), "{name}");
    }
    window.run_steps(3);
    click(&mut window, "Close");
    assert!(!says(&window, "MuJoCo"));
}

#[test]
fn a_step_that_is_pointed_at_says_what_it_waits_for() {
    let fake = Fake::over(plumbline_engine::View::default());
    let settings = WindowSettings { screen: Screen::Timeline, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, [1440.0, 900.0]);
    window.get_by_label("Models").hover();
    for _ in 0..60 {
        window.run_steps(1);
    }
    assert!(says(&window, "Touch the screen first"));
}

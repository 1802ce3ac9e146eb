//! Walks through every page of the gallery in both themes and uses the widgets by their labels,
//! as a screen reader would.
//!
//! With `PLUMBLINE_GALLERY=<folder>` every page is also drawn into a PNG there, to look at.

use egui::accesskit::Role;
use egui_kittest::{Harness, kittest::NodeT, kittest::Queryable};
use plumbline_widgets::gallery::{self, GalleryState, PAGES};
use plumbline_widgets::theme;

fn page(name: &str, theme: egui::Theme, picture: bool) -> Harness<'static, GalleryState> {
    let page = PAGES.iter().find(|page| page.name == name).expect("a page of the gallery");
    let builder = Harness::builder()
        .with_size(egui::vec2(1280.0, 800.0))
        .with_theme(theme)
        .with_max_steps(12)
        .with_step_dt(0.02)
        .with_context_setup(move |ctx| theme::apply(ctx, theme));
    let builder = if picture { builder.wgpu() } else { builder };
    let mut harness = builder.build_ui_state(
        move |ui, state| {
            egui::CentralPanel::default().show(ui, |ui| gallery::show(ui, page, state));
        },
        GalleryState::default(),
    );
    // Spinners and toasts ask for repaints forever, so run a number of steps instead of to rest.
    harness.run_steps(4);
    harness.check_accessibility();
    harness
}

fn dark(name: &str) -> Harness<'static, GalleryState> {
    page(name, egui::Theme::Dark, false)
}

#[test]
fn every_page_draws_in_both_themes() {
    let folder = std::env::var_os("PLUMBLINE_GALLERY").map(std::path::PathBuf::from);
    for each in &PAGES {
        for theme in [egui::Theme::Dark, egui::Theme::Light] {
            let mut harness = page(each.name, theme, folder.is_some());
            let named = harness.root().children_recursive().filter(|n| n.accesskit_node().label().is_some());
            assert!(named.count() > 0, "{} has nothing with a label", each.name);
            if let Some(folder) = &folder {
                let file = format!("{} {theme:?}.png", each.name).to_lowercase().replace(' ', "-");
                let image = harness.render().expect("the test renderer draws");
                image.save(folder.join(file)).expect("the folder can be written");
            }
        }
    }
}

#[test]
fn a_bar_is_found_by_its_value_and_selects_its_pair() {
    let mut harness = dark("Bars");
    harness.get_by_label_contains("pair-09, left eye").click();
    harness.run_steps(2);
    assert_eq!(harness.state().selected_pair, Some(8));
    assert_eq!(harness.state().last, "pair-09 left");
}

#[test]
fn bars_are_pressed_by_keyboard() {
    let mut harness = dark("Bars");
    harness.get_by_label_contains("pair-03, right eye").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(2);
    assert_eq!(harness.state().last, "pair-03 right");
}

#[test]
fn every_pair_has_a_bar_for_each_eye_and_says_what_is_special() {
    let harness = dark("Bars");
    let bars: Vec<String> = harness
        .root()
        .children_recursive()
        .filter_map(|node| node.accesskit_node().label())
        .filter(|label| label.starts_with("pair-"))
        .collect();
    assert_eq!(bars.len(), 60);
    assert!(bars.iter().any(|label| label == "pair-22, left eye: board not seen"), "{bars:?}");
    assert!(bars.iter().any(|label| label.starts_with("pair-05") && label.ends_with(", dropped")));
}

#[test]
fn sorting_brings_the_worst_pair_to_the_left() {
    let mut harness = dark("Bars");
    let x = |harness: &Harness<'_, GalleryState>| {
        harness.get_by_label_contains("pair-09, left eye").rect().left()
    };
    let before = x(&harness);
    harness.get_by_label("Worst first").click();
    harness.run_steps(2);
    let first = harness.get_by_label_contains("pair-01, left eye").rect().left();
    assert!(x(&harness) < before && x(&harness) < first);
}

#[test]
fn stop_works_by_pointer_and_by_keyboard() {
    let mut harness = dark("Window");
    let stop = harness.get_by_role_and_label(Role::Button, "STOP");
    assert_eq!(stop.value().as_deref(), Some("arm held"));
    stop.click();
    harness.run_steps(2);
    assert_eq!(harness.state().last, "stop");
    harness.state_mut().last.clear();
    harness.get_by_label("STOP").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(2);
    assert_eq!(harness.state().last, "stop");
}

#[test]
fn the_rail_says_its_states_and_selects() {
    let mut harness = dark("Window");
    let value =
        |harness: &Harness<'_, GalleryState>, name| harness.get_by_role_and_label(Role::Tab, name).value();
    assert_eq!(value(&harness, "Mount").as_deref(), Some("stale"));
    assert_eq!(value(&harness, "Touch").as_deref(), Some("running"));
    assert_eq!(value(&harness, "Drift").as_deref(), Some("failed"));
    harness.get_by_role_and_label(Role::Tab, "Models").click();
    harness.run_steps(2);
    assert_eq!(harness.state().step, 4);
}

#[test]
fn the_bottom_line_cancels_and_opens_the_log() {
    let mut harness = dark("Window");
    for (button, action) in [("Cancel", "Cancel"), ("Log", "OpenLog")] {
        harness.get_by_label(button).click();
        harness.run_steps(2);
        assert_eq!(harness.state().last, action);
    }
}

#[test]
fn an_empty_view_offers_the_way_to_fill_it() {
    let mut harness = dark("Image states");
    assert!(harness.query_by_label_contains("Open a folder of pairs").is_some());
    harness.get_by_label("Open folder…").click();
    harness.run_steps(2);
    assert_eq!(harness.state().last, "open folder");
}

#[test]
fn a_disabled_primary_button_does_nothing_and_says_why() {
    let mut harness = dark("Buttons and progress");
    assert!(harness.query_by_label("At least three pairs are needed.").is_some());
    assert!(harness.get_by_label("Solve 0 pairs").accesskit_node().is_disabled());
    harness.get_by_label("Capture pair").click();
    harness.run_steps(2);
    assert_eq!(harness.state().last, "capture");
}

fn wheel(harness: &mut Harness<'_, GalleryState>, at: egui::Pos2, points: f32) {
    harness.hover_at(at);
    harness.run_steps(2);
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, points),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run_steps(20);
}

#[test]
fn the_wheel_zooms_both_linked_views_and_a_double_click_fits() {
    let mut harness = dark("Image views");
    let rect = harness.get_by_label("Left eye, rectified").rect();
    assert!(harness.state().pair_view.is_fit());
    wheel(&mut harness, rect.center() + egui::vec2(30.0, -20.0), 200.0);
    assert!(!harness.state().pair_view.is_fit());
    for _ in 0..2 {
        harness.get_by_label("Right eye, rectified").click();
        harness.run_steps(1);
    }
    harness.run_steps(2);
    assert!(harness.state().pair_view.is_fit());
}

#[test]
fn a_click_says_which_pixel() {
    let mut harness = dark("Image views");
    harness.get_by_label("Left eye, rectified").click();
    harness.run_steps(2);
    assert_eq!(harness.state().last, "clicked Left eye, rectified at (159.5, 119.5)");
}

#[test]
fn views_zoom_by_keyboard() {
    let mut harness = dark("Image views");
    harness.get_by_label("Left eye, rectified").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Plus);
    harness.run_steps(2);
    assert!(!harness.state().pair_view.is_fit());
    harness.key_press(egui::Key::Num0);
    harness.run_steps(2);
    assert!(harness.state().pair_view.is_fit());
}

#[test]
fn pixels_are_uploaded_once_while_nothing_changes() {
    let mut harness = page("Image views", egui::Theme::Dark, false);
    harness.run_steps(10);
    let uploads = |harness: &Harness<'_, GalleryState>, key| {
        harness.state().textures.last(key).map(plumbline_widgets::Picture::uploads)
    };
    assert_eq!(uploads(&harness, "Left eye, rectified"), Some(1));
    let rect = harness.get_by_label("Left eye, rectified").rect();
    wheel(&mut harness, rect.center(), 900.0);
    // Deep in, hard pixels need a second texture; once.
    assert_eq!(uploads(&harness, "Left eye, rectified"), Some(2));
}

#[test]
fn figures_are_found_as_whole_rows() {
    let harness = dark("Inspector");
    assert!(harness.query_by_label("baseline: 68.240 ± 0.061 mm").is_some());
    assert!(harness.query_by_label("cross-validated: —").is_some());
}

#[test]
fn notifications_are_dismissed_from_the_screen_only() {
    let mut harness = dark("Notifications");
    let toasts = |harness: &Harness<'_, GalleryState>| harness.query_all_by_label("Dismiss").count();
    assert_eq!(
        toasts(&harness),
        3,
        "of the two that ask for nothing only the newer one stands on the screen"
    );
    harness.get_all_by_label("Dismiss").next().expect("a toast").click();
    harness.run_steps(2);
    assert_eq!(toasts(&harness), 2);
    assert_eq!(harness.state().notifications.history().count(), 4);
}

//! Training curves, intervals, and points on the table, used by their labels.

use egui::{Key, Pos2, vec2};
use egui_kittest::{Harness, kittest::NodeT, kittest::Queryable};
use plumbline_widgets::gallery::{self, GalleryState, PAGES};
use plumbline_widgets::theme;

fn page(name: &str) -> Harness<'static, GalleryState> {
    let page = PAGES.iter().find(|page| page.name == name).expect("a page of the gallery");
    let mut harness = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_max_steps(12)
        .with_step_dt(0.02)
        .with_context_setup(|ctx| theme::apply(ctx, egui::Theme::Dark))
        .build_ui_state(
            move |ui, state| {
                egui::CentralPanel::default().show(ui, |ui| gallery::show(ui, page, state));
            },
            GalleryState::default(),
        );
    harness.run_steps(4);
    harness
}

fn drag(harness: &mut Harness<'_, GalleryState>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(2);
    harness.drag_at(from);
    harness.run_steps(2);
    for part in [0.3, 0.7, 1.0] {
        harness.hover_at(from.lerp(to, part));
        harness.run_steps(2);
    }
    harness.drop_at(to);
    harness.run_steps(3);
}

#[test]
fn charts_say_what_came_of_it() {
    let harness = page("Training");
    assert!(harness.query_by_label("M3: held out 9.42 mm").is_some());
    assert!(harness.query_by_label("M4: nothing trained yet").is_some());
}

#[test]
fn a_row_of_the_comparison_is_said_with_its_interval_and_chosen() {
    let mut harness = page("Training");
    harness.get_by_label("M2: 4.70 mm, 4.20 to 5.20 mm").click();
    harness.run_steps(2);
    assert_eq!(harness.state().last, "M2");
    harness.get_by_label_contains("M1: 8.60 mm").focus();
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    assert_eq!(harness.state().last, "M1");
}

/// The points of the page begin on the map; the labels are counted from 1.
fn point(harness: &Harness<'_, GalleryState>, number: usize) -> Pos2 {
    harness.get_by_label_contains(&format!("point {number}:")).rect().center()
}

#[test]
fn a_point_is_dragged_by_as_much_as_the_pointer_moves() {
    let mut harness = page("Model map and points");
    let from = point(&harness, 2);
    let before = harness.state().points_m[1];
    // Not grabbed in its middle: it must not jump to the pointer.
    drag(&mut harness, from + vec2(4.0, -3.0), from + vec2(34.0, -23.0));
    assert_eq!(harness.state().last, "moved point 2");
    assert_eq!(harness.state().chosen_point, Some(1));
    let moved = point(&harness, 2) - from;
    assert!((moved - vec2(30.0, -20.0)).length() < 2.0, "{moved:?}");
    let after = harness.state().points_m[1];
    // Up is forward, right is the robot's right.
    assert!(after[0] > before[0] && after[1] < before[1], "{before:?} {after:?}");
}

#[test]
fn a_point_does_not_leave_the_map() {
    let mut harness = page("Model map and points");
    let map = harness.get_by_label("Points of the height table").rect();
    let from = point(&harness, 2);
    drag(&mut harness, from, map.left_top() - vec2(80.0, 200.0));
    let [x, y] = harness.state().points_m[1];
    assert!(x <= 0.56 + 1e-6 && y <= 0.3 + 1e-6, "{x} {y}");
    assert!(x > 0.55 && y > 0.29, "{x} {y}");
}

#[test]
fn a_click_chooses_a_point_and_beside_them_says_where() {
    let mut harness = page("Model map and points");
    harness.get_by_label_contains("point 3:").click();
    harness.run_steps(2);
    assert_eq!(harness.state().chosen_point, Some(2));
    assert_eq!(harness.state().last, "", "a click moves nothing");
    // A long press is no drag either.
    let at = point(&harness, 4);
    drag(&mut harness, at, at + vec2(0.5, 0.5));
    assert_eq!(harness.state().last, "");
    assert_eq!(harness.state().chosen_point, Some(3));
    let map = harness.get_by_label("Points of the height table").rect();
    let at = map.right_top() + vec2(-12.0, 40.0);
    harness.hover_at(at);
    harness.run_steps(1);
    harness.drag_at(at);
    harness.run_steps(1);
    harness.drop_at(at);
    harness.run_steps(2);
    assert_eq!(harness.state().last, "clicked beside the points");
}

#[test]
fn arrow_keys_push_the_chosen_point_by_a_millimeter() {
    let mut harness = page("Model map and points");
    let before = harness.state().points_m[2];
    harness.get_by_label_contains("point 3:").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowUp);
    harness.run_steps(2);
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
    let after = harness.state().points_m[2];
    assert!((after[0] - before[0] - 0.001).abs() < 1e-9, "{before:?} {after:?}");
    assert!((after[1] - before[1] - 0.001).abs() < 1e-9, "{before:?} {after:?}");
}

#[test]
fn faint_points_cannot_be_touched() {
    let harness = page("Model map and points");
    assert!(harness.query_by_label_contains("point 13:").is_none());
    let found = harness.root().children_recursive().filter_map(|node| node.accesskit_node().label());
    assert!(found.filter(|label| label.starts_with("point ")).count() >= 8);
}

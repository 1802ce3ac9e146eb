//! Stop by Esc and space anywhere, and what must not be stolen from a text or a focused button.

use egui::Key;
use egui_kittest::{Harness, kittest::Queryable};
use plumbline_widgets::{ArmState, stop_button, stop_keys, stop_pressed, theme};

#[derive(Default)]
struct State {
    stops: usize,
    other_clicks: usize,
    text: String,
    window_disabled: bool,
}

fn harness() -> Harness<'static, State> {
    Harness::builder().with_context_setup(|ctx| theme::apply(ctx, egui::Theme::Dark)).build_ui_state(
        |ui, state: &mut State| {
            state.stops += usize::from(stop_keys(ui.ctx()));
            if state.window_disabled {
                ui.disable();
            }
            state.stops += usize::from(stop_pressed(&stop_button(ui, ArmState::Moving)));
            state.other_clicks += usize::from(ui.button("Other").clicked());
            let label = ui.label("Name");
            ui.text_edit_singleline(&mut state.text).labelled_by(label.id);
        },
        State::default(),
    )
}

#[test]
fn escape_and_space_stop_and_a_focused_button_is_not_pressed() {
    let mut harness = harness();
    harness.get_by_label("Other").focus();
    harness.run();
    for (presses, key) in [(1, Key::Space), (2, Key::Escape)] {
        harness.key_press(key);
        harness.run();
        assert_eq!(harness.state().stops, presses, "{key:?}");
    }
    assert_eq!(harness.state().other_clicks, 0);
}

#[test]
fn space_is_typed_into_a_text_and_escape_still_stops() {
    let mut harness = harness();
    harness.get_by_label("Name").click();
    harness.get_by_role(egui::accesskit::Role::TextInput).focus();
    harness.run();
    harness.get_by_role(egui::accesskit::Role::TextInput).type_text("left eye");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!((harness.state().stops, harness.state().text.as_str()), (0, "left eye"));
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state().stops, 1);
}

#[test]
fn the_button_stops_on_the_way_down() {
    let mut harness = harness();
    let at = harness.get_by_label("STOP").rect().center();
    harness.drag_at(at);
    harness.run();
    assert!(harness.state().stops >= 1, "pressed but not yet released");
}

#[test]
fn the_button_says_what_the_arm_does() {
    let harness = harness();
    assert_eq!(harness.get_by_label("STOP").value().as_deref(), Some("arm moving"));
}

#[test]
fn the_button_works_in_a_window_that_is_disabled() {
    let mut harness = harness();
    harness.state_mut().window_disabled = true;
    harness.run();
    harness.get_by_label("Other").click();
    harness.get_by_label("STOP").click();
    harness.run();
    assert_eq!(harness.state().other_clicks, 0);
    assert!(harness.state().stops >= 1);
}

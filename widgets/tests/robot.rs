//! The widgets that concern the robot, used as an operator would: by pointer, keys and labels.

use std::cell::RefCell;
use std::rc::Rc;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Pos2, vec2};
use egui_kittest::{Harness, kittest::NodeT, kittest::Queryable};
use nalgebra::{Point3, Translation3, Vector3};
use plumbline_widgets::joint_row::{Freshness, JointRow, JointState, ReducedRange};
use plumbline_widgets::scene3d::{PickId, Scene, Scene3d, SceneCamera, Shape, Solid, Tint, ViewPreset};
use plumbline_widgets::{JogIntent, JogPad, JogSpeed, theme};

fn harness<State>(
    size: egui::Vec2,
    state: State,
    app: impl FnMut(&mut egui::Ui, &mut State) + 'static,
) -> Harness<'static, State> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_step_dt(0.02)
        .with_context_setup(|ctx| theme::apply(ctx, egui::Theme::Dark))
        .build_ui_state(app, state);
    harness.run_steps(3);
    harness.check_accessibility();
    harness
}

// ---------------------------------------------------------------- joint row

#[derive(Default)]
struct Joint {
    state: JointState,
    proposals: Vec<f64>,
    refused: Option<String>,
    torque: Option<bool>,
    reduced: Option<[f64; 2]>,
    silent: bool,
}

fn joint() -> Harness<'static, Joint> {
    let state = JointState {
        present_rad: Some(1.0),
        goal_rad: Some(1.0),
        temperature_c: Some(41.0),
        torque_on: Some(true),
        ..JointState::default()
    };
    harness(vec2(760.0, 160.0), Joint { state, ..Joint::default() }, |ui, joint: &mut Joint| {
        let reduced = joint.reduced.map(|range_rad| ReducedRange { range_rad, reason: "the head is turned" });
        let freshness = if joint.silent {
            Freshness::NoAnswer { from: "servo 31", since: Some(std::time::Duration::from_secs(3)) }
        } else {
            Freshness::Live
        };
        let shown = JointRow::new("elbow", "r_elbow_y", [0.0, 2.0], joint.state)
            .reduced(reduced)
            .freshness(freshness)
            .show(ui);
        if let Some(angle_rad) = shown.proposed_rad {
            joint.proposals.push(angle_rad);
            joint.state.proposed_rad = Some(angle_rad);
        }
        joint.refused = shown.refused.or(joint.refused.take());
        joint.torque = shown.torque.or(joint.torque.take());
    })
}

fn drag<State>(harness: &mut Harness<'_, State>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(1);
    harness.drag_at(from);
    harness.run_steps(1);
    for i in 1..=5 {
        harness.hover_at(from.lerp(to, i as f32 / 5.0));
        harness.run_steps(1);
    }
    harness.drop_at(to);
    harness.run_steps(2);
}

fn type_goal(harness: &mut Harness<'_, Joint>, text: &str) {
    harness.get_by_label("elbow goal in degrees").focus();
    harness.run_steps(2);
    // The old number is selected: typing replaces it.
    harness.get_by_label("elbow goal in degrees").type_text(text);
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
}

#[test]
fn dragging_proposes_a_goal_inside_the_limits() {
    let mut harness = joint();
    let rect = harness.get_by_label("elbow goal").rect();
    drag(&mut harness, rect.center(), rect.center() + vec2(40.0, 0.0));
    let first = *harness.state().proposals.last().expect("a proposal");
    assert!(first > 1.1 && first < 2.0, "{first}");
    // Past the end means the end.
    drag(&mut harness, rect.center(), rect.right_center() + vec2(60.0, 0.0));
    assert_eq!(harness.state().proposals.last(), Some(&2.0));
    harness.state_mut().reduced = Some([0.5, 1.25]);
    drag(&mut harness, rect.center(), rect.right_center());
    assert_eq!(harness.state().proposals.last(), Some(&1.25));
}

#[test]
fn arrow_keys_propose_in_steps_of_a_degree() {
    let mut harness = joint();
    harness.get_by_label("elbow goal").focus();
    harness.run_steps(2);
    for _ in 0..3 {
        harness.key_press(Key::ArrowRight);
        harness.run_steps(1);
    }
    let goal = *harness.state().proposals.last().expect("a proposal");
    assert!((goal - 1.0 - 3f64.to_radians()).abs() < 1e-9, "{goal}");
}

#[test]
fn a_typed_goal_is_proposed() {
    let mut harness = joint();
    type_goal(&mut harness, "80,5°");
    let goal = harness.state().proposals.clone();
    assert_eq!(goal.len(), 1);
    assert!((goal[0] - 80.5f64.to_radians()).abs() < 1e-12);
}

#[test]
fn a_click_into_the_number_selects_it() {
    let mut harness = joint();
    harness.get_by_label("elbow goal in degrees").click();
    harness.run_steps(3);
    harness.get_by_label("elbow goal in degrees").type_text("30");
    harness.run_steps(2);
    // Leaving it is as good as the enter key.
    harness.get_by_label("elbow goal").focus();
    harness.run_steps(3);
    assert_eq!(harness.state().proposals, [30f64.to_radians()]);
}

#[test]
fn what_cannot_be_is_refused_with_its_reason_until_something_can() {
    let mut harness = joint();
    type_goal(&mut harness, "150");
    assert!(harness.state().proposals.is_empty());
    assert!(harness.query_by_label_contains("150.0° is beyond the limits").is_some());
    assert!(harness.state().refused.as_deref().is_some_and(|reason| reason.contains("0.0° to 114.6°")));
    type_goal(&mut harness, "soon");
    assert!(harness.query_by_label_contains("“soon” is not an angle").is_some());
    harness.state_mut().reduced = Some([0.5, 1.25]);
    type_goal(&mut harness, "90");
    assert!(harness.query_by_label_contains("cannot be while the head is turned").is_some());
    assert!(harness.state().proposals.is_empty());
    type_goal(&mut harness, "60");
    assert_eq!(harness.state().proposals.len(), 1);
    assert!(harness.query_by_label_contains("cannot be while").is_none());
}

#[test]
fn leaving_the_number_untouched_proposes_nothing() {
    let mut harness = joint();
    harness.get_by_label("elbow goal in degrees").focus();
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    assert!(harness.state().proposals.is_empty() && harness.state().refused.is_none());
}

#[test]
fn torque_is_asked_for_and_a_silent_servo_takes_nothing() {
    let mut harness = joint();
    harness.get_by_label("elbow torque").click();
    harness.run_steps(2);
    assert_eq!(harness.state().torque, Some(false));
    harness.state_mut().silent = true;
    harness.state_mut().torque = None;
    harness.run_steps(2);
    assert!(harness.query_by_label("no answer from servo 31 for 3 s").is_some());
    assert!(harness.query_by_label("elbow goal").is_none());
    let torque = harness.get_by_label("elbow torque");
    assert!(torque.accesskit_node().is_disabled());
    torque.click();
    harness.run_steps(2);
    assert_eq!(harness.state().torque, None);
}

#[test]
fn temperature_says_its_state_in_words() {
    let mut harness = joint();
    for (celsius, word) in [(54.9, "good"), (55.0, "warning"), (70.0, "danger")] {
        harness.state_mut().state.temperature_c = Some(celsius);
        harness.run_steps(2);
        assert!(harness.query_by_label_contains(&format!("°C, {word}")).is_some(), "{celsius}");
    }
    harness.state_mut().state.temperature_c = None;
    harness.run_steps(2);
    assert!(harness.query_by_label("elbow servo —, off").is_some());
}

// ------------------------------------------------------------------ jog pad

#[derive(Default)]
struct Jog {
    intent: Option<JogIntent>,
    ever: bool,
    why_not: Option<&'static str>,
    elsewhere: bool,
    speed: JogSpeed,
    text: String,
}

fn jog() -> Harness<'static, Jog> {
    harness(vec2(460.0, 420.0), Jog::default(), |ui, jog: &mut Jog| {
        let pad = JogPad::new("right hand").why_not(jog.why_not).enabled_elsewhere(jog.elsewhere);
        jog.intent = pad.show(ui, &mut jog.speed).intent;
        jog.ever |= jog.intent.is_some();
        ui.add_space(30.0);
        let label = ui.label("Name");
        ui.text_edit_singleline(&mut jog.text).labelled_by(label.id);
    })
}

fn shift(harness: &Harness<'_, Jog>, down: bool) {
    let modifiers = if down { Modifiers::SHIFT } else { Modifiers::NONE };
    harness.event(Event::ModifiersChanged(modifiers));
}

fn press_shifted(harness: &Harness<'_, Jog>, key: Key) {
    harness.event(Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::SHIFT,
    });
}

/// Presses the mouse on something and keeps it down.
fn hold(harness: &mut Harness<'_, Jog>, label: &str) -> Pos2 {
    let at = harness.get_by_role_and_label(Role::Button, label).rect().center();
    harness.hover_at(at);
    harness.run_steps(1);
    harness.drag_at(at);
    harness.run_steps(2);
    at
}

#[test]
fn nothing_moves_without_the_enable_key() {
    let mut harness = jog();
    for word in ["Forward", "Back", "Left", "Right", "Up", "Down", "Turn left", "Turn right"] {
        let at = hold(&mut harness, word);
        harness.drop_at(at);
        harness.run_steps(1);
    }
    for key in [Key::ArrowUp, Key::ArrowLeft, Key::PageDown, Key::Q, Key::Enter] {
        harness.key_down(key);
        harness.run_steps(2);
        harness.key_up(key);
        harness.run_steps(1);
    }
    assert!(!harness.state().ever);
}

#[test]
fn shift_and_a_held_direction_move_and_letting_go_of_either_stops() {
    let mut harness = jog();
    shift(&harness, true);
    let at = hold(&mut harness, "Forward");
    let intent = harness.state().intent.expect("a motion");
    assert_eq!(intent.velocity_m_s, Vector3::new(0.005, 0.0, 0.0));
    shift(&harness, false);
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None, "the enable key was released");
    shift(&harness, true);
    harness.run_steps(1);
    assert!(harness.state().intent.is_some());
    // Only the button: the pointer stays where it is, and shift is still held.
    let button = egui::PointerButton::Primary;
    harness.event(Event::PointerButton { pos: at, button, pressed: false, modifiers: Modifiers::SHIFT });
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None, "the direction was released");
}

/// Longer than any click, and with a hand that is not quite still.
#[test]
fn what_is_held_for_long_moves_for_as_long() {
    let mut harness = jog();
    shift(&harness, true);
    let at = hold(&mut harness, "Forward");
    for step in 0..20 {
        harness.hover_at(at + vec2(f32::from(step % 3_i16) * 4.0, 0.0));
        harness.run_steps(1);
        assert!(harness.state().intent.is_some(), "step {step}");
    }
    harness.drop_at(at);
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None);
    // And so it is with the button that enables.
    shift(&harness, false);
    let at = hold(&mut harness, "Hold to move");
    harness.key_down(Key::PageUp);
    for step in 0..20 {
        harness.run_steps(1);
        assert!(harness.state().intent.is_some(), "step {step}");
    }
    harness.drop_at(at);
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None);
}

#[test]
fn the_enable_button_and_keys_move_at_the_chosen_speed() {
    let mut harness = jog();
    harness.get_by_label_contains("Fast").click();
    harness.run_steps(2);
    let at = hold(&mut harness, "Hold to move");
    assert_eq!(harness.state().intent, None, "enabled, but no direction");
    harness.key_down(Key::PageUp);
    harness.run_steps(1);
    assert_eq!(harness.state().intent.map(|i| i.velocity_m_s), Some(Vector3::new(0.0, 0.0, 0.06)));
    harness.drop_at(at);
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None);
}

#[test]
fn shift_elsewhere_in_the_window_does_not_enable() {
    let mut harness = jog();
    harness.hover_at(egui::pos2(450.0, 410.0));
    shift(&harness, true);
    press_shifted(&harness, Key::ArrowUp);
    harness.run_steps(2);
    assert!(!harness.state().ever);
    // Nor while a text is being typed, wherever the pointer is.
    let forward = harness.get_by_label("Forward").rect().center();
    harness.get_by_role(Role::TextInput).focus();
    harness.hover_at(forward);
    harness.run_steps(2);
    press_shifted(&harness, Key::Q);
    harness.run_steps(2);
    assert!(!harness.state().ever);
}

#[test]
fn a_window_without_the_keyboard_and_a_pad_that_may_not_move_give_nothing() {
    let mut harness = jog();
    shift(&harness, true);
    hold(&mut harness, "Up");
    assert!(harness.state().intent.is_some());
    harness.input_mut().focused = false;
    harness.run_steps(1);
    assert_eq!(harness.state().intent, None, "another window has the keyboard");
    harness.input_mut().focused = true;
    harness.state_mut().why_not = Some("The arm is free. Switch its torque on first.");
    harness.state_mut().elsewhere = true;
    harness.run_steps(2);
    assert_eq!(harness.state().intent, None, "not now");
}

#[test]
fn the_enable_key_of_a_gamepad_counts() {
    let mut harness = jog();
    harness.state_mut().elsewhere = true;
    hold(&mut harness, "Turn right");
    let intent = harness.state().intent.expect("a turn");
    assert!(intent.yaw_rate_rad_s < 0.0 && intent.velocity_m_s == Vector3::zeros());
}

// -------------------------------------------------------------------- scene

#[derive(Default)]
struct View {
    scene: Scene,
    camera: SceneCamera,
    renders: u64,
    clicked: Option<(Option<PickId>, Option<Point3<f64>>)>,
    button: Rc<RefCell<bool>>,
}

fn view() -> Harness<'static, View> {
    let camera = SceneCamera::default();
    let ball = Solid::new(
        Shape::Ellipsoid { radii_m: [0.08; 3] },
        Translation3::from(camera.target_m.coords).into(),
        Tint::Measured,
    );
    let scene = Scene { solids: vec![ball.pick(PickId(7))], ..Scene::default() };
    harness(vec2(640.0, 480.0), View { scene, camera, ..View::default() }, |ui, view: &mut View| {
        let shown = Scene3d::new("Robot", &view.scene).show(ui, &mut view.camera);
        view.renders = shown.stats.renders;
        view.clicked = shown.clicked.map(|picked| (picked.pick, picked.point_m)).or(view.clicked.take());
        *view.button.borrow_mut() |= shown.button_clicked;
    })
}

#[test]
fn the_scene_is_drawn_only_when_something_changed() {
    let mut harness = view();
    harness.run_steps(10);
    assert_eq!(harness.state().renders, 1);
    harness.state_mut().scene.solids[0].tint = Tint::Warning;
    harness.run_steps(5);
    assert_eq!(harness.state().renders, 2);
    harness.state_mut().camera.zoom(1.5);
    harness.run_steps(5);
    assert_eq!(harness.state().renders, 3);
}

#[test]
fn a_large_scene_is_drawn_finer_once_it_stands_still() {
    let mut harness = view();
    harness.set_size(vec2(1200.0, 900.0));
    harness.run_steps(3);
    let moving = harness.state().renders;
    std::thread::sleep(std::time::Duration::from_millis(230));
    harness.run_steps(3);
    assert_eq!(harness.state().renders, moving + 1);
    std::thread::sleep(std::time::Duration::from_millis(230));
    harness.run_steps(3);
    assert_eq!(harness.state().renders, moving + 1, "and only once");
}

#[test]
fn a_click_picks_and_a_drag_does_not() {
    let mut harness = view();
    harness.get_by_label("Robot").click();
    harness.run_steps(2);
    let (pick, point) = harness.state_mut().clicked.take().expect("a click");
    assert_eq!(pick, Some(PickId(7)));
    let camera = SceneCamera::default();
    let range = (point.expect("its surface") - camera.target_m).norm();
    assert!((range - 0.08).abs() < 2e-3, "{range}");
    let rect = harness.get_by_label("Robot").rect();
    drag(&mut harness, rect.center(), rect.center() + vec2(80.0, 20.0));
    assert_eq!(harness.state().clicked, None);
}

#[test]
fn dragging_turns_shift_moves_the_wheel_goes_nearer_and_reset_brings_it_back() {
    let mut harness = view();
    let rect = harness.get_by_label("Robot").rect();
    let home = SceneCamera::default();
    drag(&mut harness, rect.center(), rect.center() + vec2(60.0, 30.0));
    let turned = harness.state().camera;
    assert!(turned.heading_rad != home.heading_rad && turned.pitch_rad > home.pitch_rad);
    assert_eq!(turned.target_m, home.target_m);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    drag(&mut harness, rect.center(), rect.center() + vec2(60.0, 30.0));
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    assert_ne!(harness.state().camera.target_m, home.target_m);
    harness.hover_at(rect.center());
    harness.run_steps(2);
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(20);
    assert!(harness.state().camera.distance_m < home.distance_m);
    harness.get_by_label("Reset view").click();
    harness.run_steps(2);
    assert_eq!(harness.state().camera, home);
    harness.get_by_label("Top").click();
    harness.run_steps(2);
    assert_eq!(harness.state().camera, SceneCamera::preset(ViewPreset::Top));
}

#[test]
fn the_scene_is_used_by_keyboard() {
    let mut harness = view();
    harness.get_by_label("Robot").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
    harness.key_press(Key::Plus);
    harness.run_steps(2);
    let camera = harness.state().camera;
    assert!(camera.heading_rad < SceneCamera::default().heading_rad);
    assert!(camera.distance_m < SceneCamera::default().distance_m);
    harness.key_press(Key::Num0);
    harness.run_steps(2);
    assert_eq!(harness.state().camera, SceneCamera::default());
}

#[test]
fn an_empty_scene_says_how_to_fill_it() {
    let mut harness = view();
    harness.state_mut().scene.solids.clear();
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Start the twin or connect the robot").is_some());
}
